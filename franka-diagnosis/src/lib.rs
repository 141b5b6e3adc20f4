//! Why the robot ended a motion: what was exceeded, by how much, since when, what led up to it and
//! what to change.
//!
//! ```text
//! errors, log, model ──> findings (one error each: commanded | measured | touch | link)
//!                           └─> causes (step | link | touch | pose) ──> advice
//! ```
//!
//! Everything here is read off the last cycles of the motion, outside the real-time path, when the
//! error is made. The robot names errors and nothing else: no joint, no number. Joint and number
//! come from the same differences and limits that it checks by (FCI documentation), so far as they
//! are published and as states of single precision show them. What the log does not show is not
//! guessed: a [`Diagnosis`] then says that it is not visible.
//!
//! What a log cannot hold: thresholds of collisions (a threshold is told by the two values that it
//! lies between), virtual walls, filters of the robot's own, and whatever happened before its first
//! cycle.

mod advice;
mod cause;
mod commanded;
mod evidence;
mod finding;
mod judge;
mod link;
mod measured;
mod pose;
mod step;
#[cfg(test)]
mod tests;
mod touch;

use core::fmt;

use evidence::Evidence;
use franka_model::Model;
use franka_proto::{Errors, RobotError};
use franka_rt::driver::{ControlLog, MotionStatistics};
use franka_rt::lifecycle::{ControlError, MotionError};

pub use advice::Advice;
pub use cause::Cause;
pub use finding::{Axis, Bound, Finding, Origin, Quantity, Subject};
pub use franka_rt::driver::Commander;

/// Errors that carry the log of the motion that they ended.
pub trait Diagnose {
    /// Why the robot stopped itself, as far as the log shows; `None` for any other end of a motion.
    ///
    /// Computed at each call, which allocates and takes up to a few milliseconds.
    fn diagnose(&self) -> Option<Diagnosis>;
}

impl Diagnose for ControlError {
    fn diagnose(&self) -> Option<Diagnosis> {
        self.is_reflex().then(|| {
            Diagnosis::of(&Case {
                commander: self.commander,
                errors: self.failure.reflex_reason,
                log: &self.log,
                model: &self.model,
                statistics: Some(&self.statistics),
            })
        })
    }
}

impl Diagnose for MotionError {
    fn diagnose(&self) -> Option<Diagnosis> {
        self.control()?.diagnose()
    }
}

/// Why the robot ended a motion, as far as its last cycles show.
///
/// `Display` is a few lines: what was exceeded, what led up to it, other errors, what to change.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Diagnosis {
    /// Who commanded the motion.
    pub commander: Commander,
    /// The errors that the robot named.
    pub errors: Errors,
    /// Of them, the one that explains the others; `None` if it named none.
    pub error: Option<RobotError>,
    /// The limit behind it, if the log shows that.
    pub finding: Option<Finding>,
    /// What led up to it, the most likely first. Empty if the log shows nothing.
    pub causes: Vec<Cause>,
    /// What to change, the most promising first; [`Advice::text`] has the settings of this
    /// commander.
    pub advice: Vec<Advice>,
    /// The state that shows the end of the motion, by its `message_id`; `None` without a log.
    pub end: Option<u64>,
    /// Cycles that the log holds.
    pub cycles: usize,
}

/// What a diagnosis is made of.
#[derive(Clone, Copy, Debug)]
pub struct Case<'a> {
    /// Who commanded the motion.
    pub commander: Commander,
    /// `reflex_reason` of the state that ended the motion.
    pub errors: Errors,
    /// The last cycles of the motion.
    pub log: &'a ControlLog,
    /// The robot's, with its limits.
    pub model: &'a Model,
    /// Counts over the motion, for commands that left too late; `None` if they were not kept.
    pub statistics: Option<&'a MotionStatistics>,
}

impl Diagnosis {
    /// Reads a case. This allocates, and takes up to a few milliseconds for fifty cycles of a
    /// Cartesian motion: not for the control thread.
    pub fn of(case: &Case<'_>) -> Self {
        let evidence = Evidence {
            commander: case.commander,
            entries: case.log.iter().collect(),
            model: case.model,
            statistics: case.statistics,
        };
        Self::of_evidence(case.errors, &evidence)
    }

    fn of_evidence(errors: Errors, evidence: &Evidence<'_>) -> Self {
        let (error, finding) = judge::explaining(evidence, errors);
        let causes = error.map_or_else(Vec::new, |error| {
            judge::causes(evidence, error, finding.as_ref())
        });
        Self {
            commander: evidence.commander,
            errors,
            error,
            advice: error.map_or_else(Vec::new, |error| judge::advice(error, &causes)),
            finding,
            causes,
            end: evidence.last().map(|state| state.message_id),
            cycles: evidence.entries.len(),
        }
    }

    /// Cycles from the one in which the limit was first exceeded to the one that shows the end of
    /// the motion.
    pub fn cycles_before_end(&self) -> Option<u64> {
        Some(self.end?.saturating_sub(self.finding?.since))
    }

    /// The errors besides the one that explains them.
    fn others(&self) -> Errors {
        let mut others = self.errors;
        if let Some(error) = self.error {
            others.remove(error);
        }
        others
    }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(error) = self.error else {
            return write!(f, "the robot named no error");
        };
        match (&self.finding, self.cycles_before_end()) {
            (Some(finding), Some(before)) => {
                write!(f, "{finding}, since cycle {} ms, ", finding.since)?;
                match before {
                    0 => write!(f, "the last one")?,
                    1 => write!(f, "the one before the stop")?,
                    cycles => write!(f, "{cycles} cycles before the stop")?,
                }
                write!(f, " ({error})")?;
            }
            _ if self.cycles == 0 => write!(
                f,
                "{error}: no cycle of the motion is in the log, which would show why"
            )?,
            _ => write!(
                f,
                "{error}: not visible in the log of {} cycles",
                self.cycles
            )?,
        }
        for (i, cause) in self.causes.iter().take(CAUSES_SHOWN).enumerate() {
            let lead = if i == 0 { "led up to by" } else { "and by" };
            write!(f, "\n{lead}: {cause}")?;
        }
        let others = self.others();
        if !others.is_empty() {
            write!(f, "\nwith it:")?;
            for (i, other) in others.iter().enumerate() {
                write!(f, "{} {other}", if i == 0 { "" } else { "," })?;
            }
        }
        for (i, advice) in self.advice.iter().enumerate() {
            let lead = if i == 0 { "\nchange:" } else { "; or" };
            write!(f, "{lead} {}", advice.text(self.commander))?;
        }
        Ok(())
    }
}

/// Causes that `Display` has lines for.
const CAUSES_SHOWN: usize = 3;
