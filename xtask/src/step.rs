//! Steps: a header, what they do, how long it took; at the end one line for all of them.

use std::env;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};

/// How a step that did not fail ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// All of it ran and succeeded.
    Passed,
    /// What ran succeeded, and this is what could not be checked.
    Partly(String),
    /// Nothing was checked, for this reason.
    Skipped(String),
}

impl Outcome {
    /// What a step comes to for which something is missing: skipped, and with `CI=true` failed.
    ///
    /// # Errors
    /// With `CI=true`.
    pub fn without(why: String) -> anyhow::Result<Self> {
        if is_ci() {
            bail!("{why}; with CI=true this step has to run");
        }
        Ok(Self::Skipped(why))
    }
}

/// Whether nothing that can be checked may be left out: the variable `CI`, as services set it.
pub fn is_ci() -> bool {
    env::var("CI").is_ok_and(|value| value == "true" || value == "1")
}

/// The steps taken so far.
#[derive(Debug, Default)]
pub struct Steps {
    taken: Vec<(&'static str, Outcome, Duration)>,
}

impl Steps {
    /// Takes a step: header, work, time.
    ///
    /// # Errors
    /// Those of the work.
    pub fn take(
        &mut self,
        name: &'static str,
        about: &str,
        work: impl FnOnce() -> anyhow::Result<Outcome>,
    ) -> anyhow::Result<()> {
        println!("\n=== {name}: {about}");
        let start = Instant::now();
        let result = work();
        let time = start.elapsed();
        let seconds = time.as_secs_f64();
        let outcome = result.with_context(|| {
            format!(
                "step {name} failed after {seconds:.1} s, {} passed before it",
                self.count_passed()
            )
        })?;
        match &outcome {
            Outcome::Passed => println!("=== {name}: passed in {seconds:.1} s"),
            Outcome::Partly(what) => {
                println!("=== {name}: passed in {seconds:.1} s; NOT CHECKED: {what}");
            }
            Outcome::Skipped(why) => println!("=== {name}: SKIPPED, NOTHING WAS CHECKED: {why}"),
        }
        self.taken.push((name, outcome, time));
        Ok(())
    }

    /// One line: what passed in what time, and what was skipped and why.
    pub fn summary(&self) -> String {
        let total: Duration = self.taken.iter().map(|(_, _, time)| *time).sum();
        let each = self
            .taken
            .iter()
            .map(|(name, outcome, time)| match outcome {
                Outcome::Passed => format!("{name} {:.1} s", time.as_secs_f64()),
                Outcome::Partly(what) => {
                    format!("{name} {:.1} s (NOT CHECKED: {what})", time.as_secs_f64())
                }
                Outcome::Skipped(why) => format!("{name} SKIPPED ({why})"),
            });
        format!(
            "{} steps passed, {} skipped, 0 failed in {:.1} s: {}",
            self.count_passed(),
            self.taken.len() - self.count_passed(),
            total.as_secs_f64(),
            each.collect::<Vec<_>>().join(", ")
        )
    }

    fn count_passed(&self) -> usize {
        let passed = |outcome: &Outcome| !matches!(outcome, Outcome::Skipped(_));
        self.taken.iter().filter(|(_, o, _)| passed(o)).count()
    }
}

#[cfg(test)]
mod tests {
    use anyhow::anyhow;

    use super::*;

    #[test]
    fn the_summary_tells_passed_from_skipped() {
        let mut steps = Steps::default();
        steps.take("a", "", || Ok(Outcome::Passed)).unwrap();
        let skipped = || Ok(Outcome::Skipped("no tool".to_owned()));
        steps.take("b", "", skipped).unwrap();
        let partly = || Ok(Outcome::Partly("no right".to_owned()));
        steps.take("c", "", partly).unwrap();
        let summary = steps.summary();
        assert!(
            summary.starts_with("2 steps passed, 1 skipped, 0 failed"),
            "{summary}"
        );
        assert!(summary.contains("b SKIPPED (no tool), c "), "{summary}");
        assert!(summary.ends_with("(NOT CHECKED: no right)"), "{summary}");
    }

    #[test]
    fn a_failure_names_its_step_and_ends_the_run() {
        let error = Steps::default().take("a", "", || Err(anyhow!("broken")));
        let text = format!("{:#}", error.unwrap_err());
        assert!(text.starts_with("step a failed after"), "{text}");
        assert!(text.ends_with("broken"), "{text}");
    }
}
