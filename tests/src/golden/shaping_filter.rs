//! The low-pass filters against libfranka's: `lowpass_vectors.json`.

use franka_proto::Version;
use franka_rt::shaping::filter;

use super::shaping::{compare, fields, tagged};
use super::{Malformed, Node, Report, shaping_errors};

/// Of elements of poses: some steps of a double at 1.
const CARTESIAN: f64 = 2e-14;

/// Checks `lowpass_vectors.json`: scalars to the last bit.
pub(super) fn filters(root: &Node<'_>) -> Result<Report, Malformed> {
    let mut report = Report::default();
    for version in Version::ALL {
        let section = root.get(&format!("v{version}"))?;
        for node in section.get("lowpass")?.list()? {
            let number = |name| node.get(name)?.number();
            let (time, cutoff) = (number("sample_time")?, number("cutoff_frequency")?);
            let (current, last) = (number("current")?, number("last")?);
            let expected = [number("expected")?];
            let got = filter::low_pass(time, current, last, cutoff);
            report.case(node.path(), |case| {
                compare(case, got.map(|x| [x]), &expected, 0.0);
            });
        }
        for node in section.get("cartesian_lowpass")?.list()? {
            let number = |name| node.get(name)?.number();
            let (time, cutoff) = (number("sample_time")?, number("cutoff_frequency")?);
            let [current, last, expected] = fields(&node, ["current", "last", "expected"])?;
            let got = filter::low_pass_pose(time, &current, &last, cutoff);
            report.case(tagged(&node)?, |case| {
                compare(case, got, &expected, CARTESIAN);
            });
        }
        shaping_errors::filters(&mut report, &section.get("errors")?)?;
    }
    Ok(report)
}
