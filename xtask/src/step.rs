//! Steps, each with a header, work and a duration, and one line at the end for all of them.

use std::env;
use std::fmt;
use std::fs;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};

/// Result of a step that did not fail.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Everything ran and succeeded.
    Passed,
    /// Everything that ran succeeded; the text names the parts that could not be checked.
    Partly(String),
    /// Nothing was checked; the text is the reason.
    Skipped(String),
}

impl Outcome {
    /// Result of a step with a missing requirement: skipped, or with `CI=true` failed.
    ///
    /// # Errors
    /// If `CI=true`.
    pub fn without(why: String) -> anyhow::Result<Self> {
        if is_ci() {
            bail!("{why}; with CI=true this step must run");
        }
        Ok(Self::Skipped(why))
    }
}

/// True if nothing that can be checked may be left out: the variable `CI` is set, as services set
/// it.
pub fn is_ci() -> bool {
    env::var("CI").is_ok_and(|value| value == "true" || value == "1")
}

/// The duration of a step, in wall-clock time and processor time.
#[derive(Clone, Copy, Debug, Default)]
struct Cost {
    elapsed: Duration,
    /// User and system time of the programs that the step ran; available on Linux.
    processor: Option<f64>,
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} s", self.elapsed.as_secs_f64())?;
        match self.processor {
            Some(seconds) => write!(f, " (processors {seconds:.1} s)"),
            None => Ok(()),
        }
    }
}

/// Processor time of all programs that this process has run to their end, in seconds.
fn processor_time() -> Option<f64> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program may contain spaces. After it, fields 16 and 17 of proc(5) are
    // the 14th and 15th, in ticks of a hundredth of a second.
    let (_, fields) = stat.rsplit_once(')')?;
    let mut ticks = fields.split_whitespace().skip(13);
    let user: f64 = ticks.next()?.parse().ok()?;
    let system: f64 = ticks.next()?.parse().ok()?;
    Some((user + system) / 100.0)
}

/// The steps taken so far.
#[derive(Debug, Default)]
pub struct Steps {
    taken: Vec<(String, Outcome, Cost)>,
}

impl Steps {
    /// Runs a step: header, work, time.
    ///
    /// # Errors
    /// The errors of the work.
    pub fn take(
        &mut self,
        name: &str,
        about: &str,
        work: impl FnOnce() -> anyhow::Result<Outcome>,
    ) -> anyhow::Result<()> {
        println!("\n=== {name}: {about}");
        let (start, before) = (Instant::now(), processor_time());
        let result = work();
        let cost = Cost {
            elapsed: start.elapsed(),
            processor: processor_time()
                .zip(before)
                .map(|(now, before)| now - before),
        };
        let outcome = result.with_context(|| {
            format!(
                "step {name} failed after {cost}, {} passed before it",
                self.count_passed()
            )
        })?;
        match &outcome {
            Outcome::Passed => println!("=== {name}: passed in {cost}"),
            Outcome::Partly(what) => println!("=== {name}: passed in {cost}; NOT CHECKED: {what}"),
            Outcome::Skipped(why) => println!("=== {name}: SKIPPED, NOTHING WAS CHECKED: {why}"),
        }
        self.taken.push((name.to_owned(), outcome, cost));
        Ok(())
    }

    /// One line: the passed steps and their time, and the skipped steps with their reasons.
    pub fn summary(&self) -> String {
        let costs = self.taken.iter().map(|(_, _, cost)| cost);
        let total = Cost {
            elapsed: costs.clone().map(|cost| cost.elapsed).sum(),
            processor: costs.map(|cost| cost.processor).sum(),
        };
        let each = self
            .taken
            .iter()
            .map(|(name, outcome, cost)| match outcome {
                Outcome::Passed => format!("{name} {cost}"),
                Outcome::Partly(what) => format!("{name} {cost} (NOT CHECKED: {what})"),
                Outcome::Skipped(why) => format!("{name} SKIPPED ({why})"),
            });
        format!(
            "{} steps passed, {} skipped, 0 failed in {total}: {}",
            self.count_passed(),
            self.taken.len() - self.count_passed(),
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
