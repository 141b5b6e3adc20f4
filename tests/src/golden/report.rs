//! Result of the check of one file.

use std::fmt::{self, Debug, Display};

/// Counts, the first failures, and the comparison that came closest to its tolerance.
#[derive(Debug, Default)]
pub struct Report {
    cases: usize,
    passed: usize,
    /// Share of the tolerance, and text.
    worst: Option<(f64, String)>,
    /// The first failures: they show the defect, a thousand more would not.
    failures: Vec<String>,
}

/// One case while it is checked. It passes if every comparison made on it does, and at least one
/// was made.
#[derive(Debug)]
pub struct Case<'a> {
    report: &'a mut Report,
    name: String,
    comparisons: usize,
    failure: Option<String>,
}

impl Report {
    /// Checks one case: `compare` makes its comparisons on the [`Case`] that it is given.
    pub fn case(&mut self, name: impl Display, compare: impl FnOnce(&mut Case<'_>)) {
        let mut case = Case {
            name: name.to_string(),
            comparisons: 0,
            failure: None,
            report: self,
        };
        compare(&mut case);
        if case.comparisons == 0 {
            case.fail("nothing was compared");
        }
        let (name, failure) = (case.name, case.failure);
        self.cases += 1;
        match failure {
            None => self.passed += 1,
            Some(failure) if self.failures.len() < FAILURES_MAX => {
                self.failures.push(format!("{name}: {failure}"));
            }
            Some(_) => {}
        }
    }

    /// Checks each item of a list as a case with the name `list[index]`.
    pub fn each<T>(
        &mut self,
        list: impl Display,
        items: impl IntoIterator<Item = T>,
        mut compare: impl FnMut(&mut Case<'_>, T),
    ) {
        for (index, item) in items.into_iter().enumerate() {
            self.case(format!("{list}[{index}]"), |case| compare(case, item));
        }
    }

    /// Cases checked.
    pub fn cases(&self) -> usize {
        self.cases
    }

    /// Cases with only successful comparisons.
    pub fn passed(&self) -> usize {
        self.passed
    }
}

/// The counts on one line; the first failures follow on separate lines.
impl Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let worst = self.worst.as_ref();
        let worst = worst.map_or("all comparisons exact", |(_, text)| text);
        write!(f, "{}/{} passed, {worst}", self.passed, self.cases)?;
        for failure in &self.failures {
            write!(f, "\n      {failure}")?;
        }
        match self.cases - self.passed - self.failures.len() {
            0 => Ok(()),
            hidden => write!(f, "\n      and {hidden} more cases"),
        }
    }
}

impl Case<'_> {
    /// Compares numbers element by element: each may differ by `tolerance`, in their own unit. A
    /// number that is non-finite on one side only, or a different length, fails.
    pub fn near(&mut self, quantity: &str, got: &[f64], want: &[f64], tolerance: f64) {
        if got.len() != want.len() {
            let (got, want) = (got.len(), want.len());
            return self.fail(format!("{quantity}: {got} numbers, expected {want}"));
        }
        self.comparisons += 1;
        let apart = |(&got, &want): (&f64, &f64)| match got - want {
            _ if got == want => 0.0,
            apart if apart.is_nan() => f64::INFINITY,
            apart => apart.abs(),
        };
        let error = got.iter().zip(want).map(apart).fold(0.0, f64::max);
        // A tolerance of zero is used up by any error and by none.
        let share = if error == 0.0 { 0.0 } else { error / tolerance };
        let worst = &mut self.report.worst;
        if error > 0.0 && worst.as_ref().is_none_or(|(worst, _)| share > *worst) {
            let name = &self.name;
            let text = format!("worst {error:.1e} of {tolerance:.0e} ({quantity} of {name})");
            *worst = Some((share, text));
        }
        if error > tolerance {
            self.fail(format!(
                "{quantity}: off by {error:.3e}, allowed {tolerance:.3e}"
            ));
        }
    }

    /// Compares values that must be the same.
    pub fn equal<A: PartialEq<B> + Debug, B: Debug>(&mut self, quantity: &str, got: A, want: B) {
        self.comparisons += 1;
        if got != want {
            self.fail(format!("{quantity}: {got:?}, expected {want:?}"));
        }
    }

    /// Compares the numbers of a result; an error fails.
    pub fn result<const N: usize>(
        &mut self,
        got: Result<[f64; N], impl Display>,
        want: &[f64; N],
        tolerance: f64,
    ) {
        match got {
            Ok(got) => self.near("expected", &got, want, tolerance),
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Fails the case for the given reason.
    pub fn fail(&mut self, what: impl Into<String>) {
        self.comparisons += 1;
        self.failure.get_or_insert_with(|| what.into());
    }
}

/// Failures that a report keeps.
const FAILURES_MAX: usize = 5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_fails_with_any_comparison_and_without_one() {
        let nan = [f64::NAN];
        for (got, want) in [
            (&[1.0][..], &[1.1][..]),
            (&[1.0], &[1.0, 1.0]),
            (&nan, &[1.0]),
            (&[1.0], &nan),
            (&[f64::INFINITY], &[1.0]),
        ] {
            let mut report = Report::default();
            report.case("bad", |case| {
                case.near("x", got, want, 1e-3);
                case.near("y", &[f64::INFINITY], &[f64::INFINITY], 0.0);
            });
            report.case("good", |case| case.equal("z", vec![1], [1]));
            report.case("empty", |_| ());
            assert_eq!(
                (report.cases(), report.passed()),
                (3, 1),
                "{got:?} {want:?}"
            );
            let text = report.to_string();
            assert!(
                text.contains("bad: x: ") && text.contains("empty: nothing"),
                "{text}"
            );
        }
    }

    #[test]
    fn the_worst_comparison_used_up_most_of_its_tolerance() {
        let mut report = Report::default();
        report.each(
            "list",
            [(1e-3, 1e-1), (1e-5, 2e-5)],
            |case, (error, tolerance)| {
                case.near("x", &[error], &[0.0], tolerance);
            },
        );
        let text = report.to_string();
        assert_eq!(text, "2/2 passed, worst 1.0e-5 of 2e-5 (x of list[1])");
    }
}
