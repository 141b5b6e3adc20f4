//! Golden vectors: the crates against numbers and bytes that other implementations produced.
//!
//! A suite is a row of [`SUITES`]: the file it reads, below the directory of the vectors, and the
//! function that checks it. To add one, write `golden/<subject>.rs` with a struct for the file and
//! a function like this, and add the row:
//!
//! ```
//! use franka_tests::golden::Report;
//!
//! #[derive(serde::Deserialize)]
//! struct File {
//!     samples: Vec<Sample>,
//! }
//!
//! #[derive(serde::Deserialize)]
//! struct Sample {
//!     q: [f64; 2],
//!     sum: f64,
//! }
//!
//! pub fn check(text: &[u8]) -> anyhow::Result<Report> {
//!     let mut report = Report::default();
//!     let file: File = serde_json::from_slice(text)?;
//!     report.each("samples", &file.samples, |case, sample| {
//!         case.near("sum", &[sample.q[0] + sample.q[1]], &[sample.sum], 1e-12);
//!     });
//!     Ok(report)
//! }
//! # let report = check(br#"{ "samples": [{ "q": [1.0, 2.0], "sum": 3.0 }] }"#).unwrap();
//! # assert_eq!((report.cases(), report.passed()), (1, 1));
//! # assert!(check(br#"{ "samples": [{ "q": [1.0], "sum": 3.0 }] }"#).is_err());
//! ```

mod analytic_ik;
mod control_loop;
mod link_surfaces;
mod loads;
mod model;
mod otg;
mod report;
mod shaping;
mod shaping_errors;
mod shaping_filter;
mod wire;
mod wire_datagrams;
mod wire_end_effectors;
mod wire_table;

use std::fmt;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use anyhow::ensure;
use franka_proto::Version;
use serde::Deserialize;

pub use report::{Case, Report};

/// A file of vectors and the function that checks it.
#[derive(Clone, Copy, Debug)]
pub struct Suite {
    /// Path below the directory of the vectors.
    pub file: &'static str,
    /// Checks the whole document; an error if the document cannot be read.
    pub check: fn(&[u8]) -> anyhow::Result<Report>,
}

/// Every file of vectors that the project checks, in the order of the crates.
#[rustfmt::skip] // a table
pub const SUITES: &[Suite] = &[
    Suite { file: "wire_v10.json", check: wire_table::headers },
    Suite { file: "wire_v5.json", check: wire_table::headers },
    Suite { file: "wire_gripper.json", check: wire_end_effectors::gripper_headers },
    Suite { file: "wire_vacuum_gripper.json", check: wire_end_effectors::vacuum_headers },
    Suite { file: "wire_golden.json", check: wire::messages },
    Suite { file: "model/model_vectors_fr3.json", check: model::fr3 },
    Suite { file: "model/model_vectors_fer.json", check: model::fer },
    Suite { file: "model/model_vectors_fer.json", check: model::fer_physically_consistent },
    Suite { file: "model/velocity_limit_vectors_fr3.json", check: model::velocity_envelope },
    Suite { file: "model/link_surfaces.json", check: link_surfaces::covered },
    Suite { file: "model/ik_vectors.json", check: analytic_ik::all },
    Suite { file: "otg/single_axis.json", check: otg::single_axis },
    Suite { file: "otg/multi_axis.json", check: otg::multi_axis },
    Suite { file: "otg/single_axis_target_velocity.json", check: otg::target_velocity },
    Suite { file: "otg/single_axis_unavoidable_excess.json", check: otg::target_velocity },
    Suite { file: "rate_limiting_vectors.json", check: shaping::limiters },
    Suite { file: "lowpass_vectors.json", check: shaping_filter::filters },
    Suite { file: "control_loop_vectors.json", check: control_loop::traces },
];

/// The result of one suite.
#[derive(Debug)]
pub struct Outcome {
    /// Path below the directory of the vectors.
    pub file: &'static str,
    /// Result of the check; `None` if the directory does not hold the file.
    pub result: Option<anyhow::Result<Report>>,
}

/// Checks each of `suites` against its file in `dir`, one after the other.
pub fn run(dir: &Path, suites: &[Suite]) -> Vec<Outcome> {
    let check = |suite: &Suite| match fs::read(dir.join(suite.file)) {
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        text => Some(text.map_err(Into::into).and_then(|text| {
            let report = (suite.check)(&text)?;
            ensure!(report.cases() > 0, "holds no cases");
            Ok(report)
        })),
    };
    let outcome = |suite: &Suite| Outcome {
        file: suite.file,
        result: check(suite),
    };
    suites.iter().map(outcome).collect()
}

/// True if a run proves nothing or something wrong: a failed case, an unreadable file, or every
/// file absent.
pub fn failed(outcomes: &[Outcome]) -> bool {
    outcomes.iter().all(Outcome::absent) || outcomes.iter().any(Outcome::failed)
}

impl Outcome {
    /// True if the directory does not hold the file.
    pub fn absent(&self) -> bool {
        self.result.is_none()
    }

    /// True if the file cannot be read or one of its cases failed.
    pub fn failed(&self) -> bool {
        match &self.result {
            None => false,
            Some(Ok(report)) => report.passed() < report.cases(),
            Some(Err(_)) => true,
        }
    }
}

/// One line; the first failures follow on separate lines.
impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = match (self.absent(), self.failed()) {
            (true, _) => "skip",
            (_, true) => "FAIL",
            (_, false) => "ok",
        };
        write!(f, "{word:<4}  {:<FILE_WIDTH$}  ", self.file)?;
        match &self.result {
            None => f.write_str("absent"),
            Some(Ok(report)) => write!(f, "{report}"),
            Some(Err(error)) => write!(f, "{error:#}"),
        }
    }
}

/// Width of the column of file names: the longest so far.
const FILE_WIDTH: usize = 39;

/// A document with a part for each version of the protocol.
#[derive(Debug, Deserialize)]
struct Versions<T> {
    v5: T,
    v10: T,
}

impl<T> Versions<T> {
    fn each(&self) -> [(Version, &T); 2] {
        [(Version::V5, &self.v5), (Version::V10, &self.v10)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn doubles(text: &[u8]) -> anyhow::Result<Report> {
        let mut report = Report::default();
        let cases: Vec<[f64; 2]> = serde_json::from_slice(text)?;
        report.each("cases", cases, |case, [x, double]| {
            case.near("double", &[2.0 * x], &[double], 1e-9);
        });
        Ok(report)
    }

    /// Runs a suite on a directory with only one file, which has this text.
    fn run_on(name: &str, text: Option<&str>) -> Outcome {
        let suites = [Suite {
            file: "doubles.json",
            check: doubles,
        }];
        let dir = std::env::temp_dir().join(format!("franka-golden-{}-{name}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        if let Some(text) = text {
            fs::write(dir.join("doubles.json"), text).unwrap();
        }
        let mut outcomes = run(&dir, &suites);
        fs::remove_dir_all(&dir).unwrap();
        outcomes.remove(0)
    }

    #[test]
    fn every_outcome_is_told_and_only_good_ones_pass() {
        for (name, text, failed, said) in [
            (
                "good",
                Some("[[1, 2], [2, 4.0000000001]]"),
                false,
                "2/2 passed, worst 1.0e-10 of 1e-9",
            ),
            ("absent", None, false, "skip  doubles.json"),
            (
                "wrong",
                Some("[[1, 2], [2, 5]]"),
                true,
                "cases[1]: double: off by 1.000e0",
            ),
            ("cut", Some("[[1, 2]"), true, "EOF while parsing"),
            ("shape", Some("[[1]]"), true, "invalid length 1"),
            ("empty", Some("[]"), true, "holds no cases"),
        ] {
            let outcome = run_on(name, text);
            let line = outcome.to_string();
            assert_eq!(outcome.failed(), failed, "{line}");
            assert!(line.contains(said), "{name}: {line}");
        }
        // A directory that holds none of the files proves nothing.
        assert!(super::failed(&[run_on("none", None)]));
    }
}
