//! Steps, each with a header, work and a duration, and one line at the end for all of them.

use std::fmt;
use std::fs;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};

use crate::workspace::{Workspace, is_ci};

/// A step that can be chosen with `--only`.
#[derive(Debug)]
pub struct Step {
    /// The name of the step for `--only`.
    pub name: &'static str,
    /// One line of description.
    pub about: &'static str,
    /// The work.
    pub run: fn(&Workspace) -> anyhow::Result<Outcome>,
}

/// A step of this name, description and work.
pub const fn step(
    name: &'static str,
    about: &'static str,
    run: fn(&Workspace) -> anyhow::Result<Outcome>,
) -> Step {
    Step { name, about, run }
}

/// Runs the chosen steps, or all if none is chosen, up to the first failure.
///
/// # Errors
/// The error of the first step that fails, or an unknown name among the chosen ones.
pub fn run(workspace: &Workspace, steps: &[Step], only: &[String]) -> anyhow::Result<()> {
    check_names(steps, only)?;
    let mut taken = Steps::default();
    for Step { name, about, run } in steps {
        if only.is_empty() || only.iter().any(|chosen| chosen == name) {
            taken.take(name, about, || run(workspace))?;
        }
    }
    println!("\n{}", taken.summary());
    Ok(())
}

/// Fails for a name that no step has.
///
/// # Errors
/// The name, and the names of the steps.
pub fn check_names(steps: &[Step], only: &[String]) -> anyhow::Result<()> {
    let names: Vec<_> = steps.iter().map(|step| step.name).collect();
    match only.iter().find(|name| !names.contains(&name.as_str())) {
        None => Ok(()),
        Some(name) => bail!(
            "got the step `{name}`, expected one of {}",
            names.join(", ")
        ),
    }
}

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

/// The error of work whose requirement this machine lacks. A step that returns it is skipped, or
/// fails with `CI=true`.
#[derive(Debug)]
pub struct Missing(pub String);

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Missing {}

/// Separates a missing requirement, which becomes the inner error, from failures.
///
/// # Errors
/// All errors except [`Missing`].
pub fn or_missing<T>(result: anyhow::Result<T>) -> anyhow::Result<Result<T, String>> {
    match result {
        Err(error) => error.downcast().map(|Missing(why)| Err(why)),
        Ok(value) => Ok(Ok(value)),
    }
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
struct Steps {
    taken: Vec<(String, Outcome, Cost)>,
}

impl Steps {
    /// Runs a step: header, work, time.
    fn take(
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
        let result = match or_missing(result) {
            Ok(Err(why)) if is_ci() => Err(Missing(why)).context("with CI=true this step must run"),
            Ok(Err(why)) => Ok(Outcome::Skipped(why)),
            Ok(Ok(outcome)) => Ok(outcome),
            Err(error) => Err(error),
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
    fn summary(&self) -> String {
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
    fn a_missing_requirement_skips_a_step_except_on_ci() {
        let mut steps = Steps::default();
        let missing = || Err(Missing("no npm".to_owned()).into());
        match steps.take("a", "", missing) {
            Ok(()) => assert!(steps.summary().ends_with("a SKIPPED (no npm)")),
            Err(error) => assert!(is_ci() && format!("{error:#}").ends_with("no npm")),
        }
    }

    #[test]
    fn a_name_without_a_step_is_refused() {
        let steps = [step("a", "", |_| Ok(Outcome::Passed))];
        check_names(&steps, &["a".to_owned()]).unwrap();
        let error = check_names(&steps, &["b".to_owned()]).unwrap_err();
        assert_eq!(error.to_string(), "got the step `b`, expected one of a");
    }

    #[test]
    fn a_failure_names_its_step_and_ends_the_run() {
        let error = Steps::default().take("a", "", || Err(anyhow!("broken")));
        let text = format!("{:#}", error.unwrap_err());
        assert!(text.starts_with("step a failed after"), "{text}");
        assert!(text.ends_with("broken"), "{text}");
    }
}
