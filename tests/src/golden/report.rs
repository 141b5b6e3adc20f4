//! What the check of one file found.

use std::fmt::{Debug, Display};

/// Counts, the worst error and the first failures of one file.
#[derive(Debug, Default)]
pub struct Report {
    cases: usize,
    passed: usize,
    worst: Option<Worst>,
    failures: Vec<Failure>,
}

/// The comparison that used up the largest share of its tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// What was compared.
    pub quantity: String,
    /// The case it belongs to.
    pub case: String,
    /// Largest absolute difference.
    pub error: f64,
    /// What it may be.
    pub tolerance: f64,
}

/// One comparison that failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// The case it belongs to.
    pub case: String,
    /// What was compared and what came out.
    pub what: String,
}

/// One case while it is checked. It passes if every comparison made on it does, and at least one
/// was made.
#[derive(Debug)]
pub struct Case<'a> {
    report: &'a mut Report,
    name: String,
    comparisons: usize,
    failed: usize,
}

impl Report {
    /// Checks one case: `compare` makes its comparisons on the [`Case`] that it is given.
    pub fn case<T>(&mut self, name: impl Display, compare: impl FnOnce(&mut Case<'_>) -> T) -> T {
        let mut case = Case {
            name: name.to_string(),
            comparisons: 0,
            failed: 0,
            report: self,
        };
        let result = compare(&mut case);
        if case.comparisons == 0 {
            case.fail("nothing was compared");
        }
        let passed = case.failed == 0;
        self.cases += 1;
        self.passed += usize::from(passed);
        result
    }

    /// Cases checked.
    pub fn cases(&self) -> usize {
        self.cases
    }

    /// Cases of which every comparison succeeded.
    pub fn passed(&self) -> usize {
        self.passed
    }

    /// The comparison of numbers nearest to its tolerance, or furthest beyond; `None` if all
    /// comparisons were exact.
    pub fn worst(&self) -> Option<&Worst> {
        self.worst.as_ref()
    }

    /// The first failures: they tell what is wrong, a thousand more do not.
    pub fn failures(&self) -> &[Failure] {
        &self.failures
    }
}

impl Case<'_> {
    /// Compares numbers element by element: each may differ by `tolerance`, in their own unit. A
    /// number that is not finite on one side only, or a different length, fails.
    pub fn near(&mut self, quantity: &str, got: &[f64], want: &[f64], tolerance: f64) {
        if got.len() != want.len() {
            let (got, want) = (got.len(), want.len());
            return self.fail(format!("{quantity}: {got} numbers, expected {want}"));
        }
        self.comparisons += 1;
        let errors = got
            .iter()
            .zip(want)
            .map(|(got, want)| if got == want { 0.0 } else { (got - want).abs() });
        let error = errors.fold(0.0, |worst: f64, error| {
            if error.is_nan() {
                f64::INFINITY
            } else {
                worst.max(error)
            }
        });
        self.note(quantity, error, tolerance);
        if error > tolerance {
            self.failed += 1;
            self.log(format!(
                "{quantity}: off by {error:.3e}, allowed {tolerance:.3e}"
            ));
        }
    }

    /// Compares values that must be the same.
    pub fn equal<A: PartialEq<B> + Debug, B: Debug>(&mut self, quantity: &str, got: A, want: B) {
        self.comparisons += 1;
        if got != want {
            self.failed += 1;
            self.log(format!("{quantity}: {got:?}, expected {want:?}"));
        }
    }

    /// Fails the case for a reason of its own.
    pub fn fail(&mut self, what: impl Into<String>) {
        self.comparisons += 1;
        self.failed += 1;
        self.log(what.into());
    }

    fn note(&mut self, quantity: &str, error: f64, tolerance: f64) {
        // A tolerance of zero is used up by any error and by none.
        let share = |error: f64, tolerance: f64| {
            if error == 0.0 { 0.0 } else { error / tolerance }
        };
        let worst = &mut self.report.worst;
        if worst
            .as_ref()
            .is_none_or(|old| share(error, tolerance) > share(old.error, old.tolerance))
        {
            *worst = Some(Worst {
                quantity: quantity.to_owned(),
                case: self.name.clone(),
                error,
                tolerance,
            });
        }
    }

    fn log(&mut self, what: String) {
        if self.report.failures.len() < FAILURES_MAX {
            let case = self.name.clone();
            self.report.failures.push(Failure { case, what });
        }
    }
}

/// Failures that a report keeps.
const FAILURES_MAX: usize = 5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_is_what_used_up_most_of_its_tolerance() {
        let mut report = Report::default();
        report.case("a", |case| {
            case.near("mass", &[1.0, 2.0], &[1.0, 2.0 + 1e-6], 1e-3)
        });
        report.case("b", |case| case.near("pose", &[1.0], &[1.0 + 1e-12], 1e-11));
        let worst = report.worst().unwrap();
        assert_eq!(
            (worst.quantity.as_str(), worst.case.as_str()),
            ("pose", "b")
        );
        assert_eq!((report.cases(), report.passed()), (2, 2));
    }

    #[test]
    fn a_case_fails_on_any_of_its_comparisons() {
        let nan = f64::NAN;
        for (got, want) in [
            (&[1.0, nan][..], &[1.0, 1.0][..]),
            (&[1.0], &[nan]),
            (&[1.0], &[1.1]),
            (&[f64::INFINITY], &[1.0]),
            (&[1.0], &[1.0, 1.0]),
        ] {
            let mut report = Report::default();
            report.case("bad", |case| {
                case.near("x", got, want, 1e-3);
                case.near("y", &[0.0], &[0.0], 1e-3);
            });
            report.case("good", |case| case.equal("z", vec![1], [1]));
            assert_eq!(
                (report.cases(), report.passed()),
                (2, 1),
                "{got:?} {want:?}"
            );
            assert_eq!(report.failures().len(), 1);
            assert_eq!(report.failures()[0].case, "bad");
        }
    }

    #[test]
    fn a_case_without_a_comparison_does_not_pass() {
        let mut report = Report::default();
        report.case("empty", |_| ());
        assert_eq!((report.cases(), report.passed()), (1, 0));
    }
}
