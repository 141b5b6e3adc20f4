//! The low-pass filters against libfranka's: `lowpass_vectors.json`.

use franka_rt::shaping::filter;
use serde::Deserialize;

use super::shaping_errors::{self, Refused};
use super::{Report, Versions};

/// Tolerance of elements of poses: some steps of a double at 1.
const CARTESIAN: f64 = 2e-14;

#[derive(Deserialize)]
struct Section {
    lowpass: Vec<Filtered<f64>>,
    cartesian_lowpass: Vec<Filtered<[f64; 16]>>,
    errors: Vec<Refused>,
}

#[derive(Deserialize)]
struct Filtered<T> {
    sample_time: f64,
    current: T,
    last: T,
    cutoff_frequency: f64,
    expected: T,
}

/// Checks `lowpass_vectors.json`: scalars to the last bit.
pub(super) fn filters(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: Versions<Section> = serde_json::from_slice(text)?;
    for (version, section) in file.each() {
        let part = format!("v{version}");
        report.each(format!("{part}.lowpass"), &section.lowpass, |case, v| {
            let got = filter::low_pass(v.sample_time, v.current, v.last, v.cutoff_frequency);
            case.result(got.map(|x| [x]), &[v.expected], 0.0);
        });
        let list = format!("{part}.cartesian_lowpass");
        report.each(list, &section.cartesian_lowpass, |case, v| {
            let (time, cutoff) = (v.sample_time, v.cutoff_frequency);
            let got = filter::low_pass_pose(time, &v.current, &v.last, cutoff);
            case.result(got, &v.expected, CARTESIAN);
        });
        shaping_errors::filters(&mut report, &part, &section.errors)?;
    }
    Ok(report)
}
