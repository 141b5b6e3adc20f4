//! The run over a directory of vectors.

use std::fmt;
use std::fs;
use std::io;
use std::path::Path;

use serde_json::Value;

use super::{Malformed, Node, Report};

/// A file of vectors and the function that checks it.
#[derive(Clone, Copy, Debug)]
pub struct Suite {
    /// Path below the directory of the vectors.
    pub file: &'static str,
    /// Checks the whole document.
    pub check: fn(&Node<'_>) -> Result<Report, Malformed>,
}

/// What became of one suite.
#[derive(Debug)]
pub struct Outcome {
    /// Path below the directory of the vectors.
    pub file: &'static str,
    /// How it ended.
    pub verdict: Verdict,
}

/// How the check of one file ended.
#[derive(Debug)]
pub enum Verdict {
    /// The directory does not hold the file: nothing was checked.
    Absent,
    /// The file cannot be read, is no JSON, or does not have the shape that the suite reads.
    Unreadable(String),
    /// The cases were checked, with or without success.
    Checked(Report),
}

/// Checks each of `suites` against its file in `dir`, one after the other.
pub fn run(dir: &Path, suites: &[Suite]) -> Vec<Outcome> {
    let outcome = |suite: &Suite| Outcome {
        file: suite.file,
        verdict: verdict(&dir.join(suite.file), suite),
    };
    suites.iter().map(outcome).collect()
}

fn verdict(path: &Path, suite: &Suite) -> Verdict {
    let text = match fs::read(path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Verdict::Absent,
        Err(error) => return Verdict::Unreadable(error.to_string()),
    };
    let value: Value = match serde_json::from_slice(&text) {
        Ok(value) => value,
        Err(error) => return Verdict::Unreadable(format!("not JSON: {error}")),
    };
    match (suite.check)(&Node::root(&value)) {
        Ok(report) if report.cases() == 0 => Verdict::Unreadable("holds no cases".to_owned()),
        Ok(report) => Verdict::Checked(report),
        Err(malformed) => Verdict::Unreadable(format!("malformed: {malformed}")),
    }
}

/// Whether a run proves nothing or something wrong: a failed case, an unreadable file, or every
/// file absent.
pub fn failed(outcomes: &[Outcome]) -> bool {
    outcomes.iter().all(Outcome::absent) || outcomes.iter().any(Outcome::failed)
}

impl Outcome {
    /// Whether the directory does not hold the file.
    pub fn absent(&self) -> bool {
        matches!(self.verdict, Verdict::Absent)
    }

    /// Whether something is wrong with the file or with a case of it.
    pub fn failed(&self) -> bool {
        match &self.verdict {
            Verdict::Absent => false,
            Verdict::Unreadable(_) => true,
            Verdict::Checked(report) => report.passed() < report.cases(),
        }
    }
}

/// One line; the first failures follow on lines of their own.
impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = self.file;
        match &self.verdict {
            Verdict::Absent => write!(f, "skip  {file:<FILE_WIDTH$}  absent"),
            Verdict::Unreadable(why) => write!(f, "FAIL  {file:<FILE_WIDTH$}  {why}"),
            Verdict::Checked(report) => {
                let word = if self.failed() { "FAIL" } else { "ok  " };
                let (passed, cases) = (report.passed(), report.cases());
                write!(f, "{word}  {file:<FILE_WIDTH$}  {passed}/{cases} passed, ")?;
                match report.worst() {
                    None => write!(f, "all comparisons exact")?,
                    Some(worst) => write!(
                        f,
                        "worst error {:.1e} of {:.0e} allowed ({} of {})",
                        worst.error, worst.tolerance, worst.quantity, worst.case
                    )?,
                }
                for failure in report.failures() {
                    write!(f, "\n      {}: {}", failure.case, failure.what)?;
                }
                let shown = report.failures().len();
                match cases - passed {
                    hidden if hidden > shown => {
                        write!(f, "\n      and {} more cases", hidden - shown)
                    }
                    _ => Ok(()),
                }
            }
        }
    }
}

/// Width of the column of file names: the longest so far.
const FILE_WIDTH: usize = 38;

#[cfg(test)]
mod tests {
    use std::env;

    use super::*;

    const SUITES: &[Suite] = &[Suite {
        file: "doubles.json",
        check: doubles,
    }];

    fn doubles(root: &Node<'_>) -> Result<Report, Malformed> {
        let mut report = Report::default();
        for case in root.get("cases")?.list()? {
            let [x, double] = case.numbers()?;
            report.case(case.path(), |case| {
                case.near("double", &[2.0 * x], &[double], 1e-9)
            });
        }
        Ok(report)
    }

    /// Runs the suite on a directory whose only file has this text.
    fn run_on(name: &str, text: Option<&str>) -> Outcome {
        let dir = env::temp_dir().join(format!("franka-golden-{}-{name}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        if let Some(text) = text {
            fs::write(dir.join("doubles.json"), text).unwrap();
        }
        let mut outcomes = run(&dir, SUITES);
        fs::remove_dir_all(&dir).unwrap();
        outcomes.remove(0)
    }

    #[test]
    fn a_good_file_passes_with_its_counts_and_worst_error() {
        let outcome = run_on("good", Some(r#"{"cases": [[1, 2], [2, 4.0000000001]]}"#));
        assert!(!outcome.failed());
        let line = outcome.to_string();
        assert!(line.starts_with("ok"), "{line}");
        assert!(
            line.contains("2/2 passed, worst error 1.0e-10 of 1e-9 allowed (double of cases[1])"),
            "{line}"
        );
    }

    #[test]
    fn an_absent_file_is_named_and_does_not_count_as_a_failure() {
        let outcome = run_on("absent", None);
        assert!(!outcome.failed());
        assert!(outcome.to_string().contains("doubles.json"));
        // But a directory that holds none of the files proves nothing.
        assert!(failed(&[outcome]));
    }

    #[test]
    fn what_is_wrong_in_the_file_is_said() {
        for (name, text, said) in [
            (
                "wrong",
                r#"{"cases": [[1, 2], [2, 5]]}"#,
                "cases[1]: double: off by 1.000e0",
            ),
            ("cut", r#"{"cases": [[1, 2]"#, "not JSON"),
            (
                "shape",
                r#"{"cases": [[1]]}"#,
                "cases[0]: expected 2 numbers",
            ),
            ("empty", r#"{"cases": []}"#, "holds no cases"),
        ] {
            let outcome = run_on(name, Some(text));
            assert!(outcome.failed(), "{name}");
            let line = outcome.to_string();
            assert!(
                line.starts_with("FAIL") && line.contains(said),
                "{name}: {line}"
            );
        }
    }
}
