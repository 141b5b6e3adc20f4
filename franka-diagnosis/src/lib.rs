//! Explains why a Franka robot ended a motion, for example with a reflex. A diagnosis lists the
//! exceeded limit, the excess, the first cycle above the limit, the causes, and the recommended
//! changes. The module `reflex_reason` combines the evidence.
//!
//! ```text
//! errors, log, model --> finding (one error: commanded | measured | contact | lost cycles)
//!                          +-> causes (steps | contact | lost cycles | posture) --> advice
//! ```
//!
//! The robot reports only the names of errors, without a joint or a number. This crate finds the
//! joint and the number in the log of the motion's last cycles. It computes differences and applies
//! limits as the robot does (FCI documentation). The accuracy is limited by the published data and
//! by the single precision of the states. The crate does not guess: if the log does not show the
//! cause, the [`Diagnosis`] reports this.
//!
//! * [`Diagnose`]: diagnoses an error in the program that received it. [`Case`] and
//!   [`Diagnosis::of`]: diagnose a saved or live log.
//! * [`Finding`]: the exceeded limit. [`Cause`]: an event that led to it. [`Advice`]: a recommended
//!   change.
//!
//! | module | contents |
//! |---|---|
//! | `reflex_reason` | the error that explains the others, its checks, causes and advice |
//! | `evidence` | the log, prepared for these checks |
//! | `commanded`, `measured` | commands and sensor values relative to the limits of the model |
//! | `command_steps`, `contact`, `lost_cycles`, `posture` | causes, one kind each |
//! | `finding`, `cause`, `advice` | the parts of a diagnosis, and their text |
//!
//! This example diagnoses a saved log offline (feature `serde`):
//!
//! ```
//! use franka_diagnosis::{Case, Diagnosis};
//! use franka_model::Model;
//!
//! # fn saved() -> String {
//! #     let state = |message_id, dq| franka_proto::RobotState {
//! #         message_id,
//! #         dq: [0.0, 0.0, 0.0, dq, 0.0, 0.0, 0.0],
//! #         controller_mode: franka_proto::ControllerMode::ExternalController,
//! #         ..franka_proto::RobotState::default()
//! #     };
//! #     let command = franka_proto::RobotCommand::default();
//! #     let entry = |id, dq| serde_json::json!({ "state": state(id, dq), "command": command });
//! #     serde_json::json!({
//! #         "commander": "Function",
//! #         "errors": ["joint_velocity_violation"],
//! #         "log": [entry(7, 0.0), entry(8, 3.0)],
//! #         "statistics": null,
//! #     })
//! #     .to_string()
//! # }
//! // Written earlier: `serde_json::to_string(&Case::from(&control_error))`.
//! let case: Case = serde_json::from_str(&saved())?;
//! let diagnosis = Diagnosis::of(&case, Model::fer());
//! assert!(diagnosis.to_string().starts_with("joint 4: measured velocity 3 rad/s"));
//! # Ok::<_, serde_json::Error>(())
//! ```
//!
//! # What it does not do
//!
//! The crate reads no clock, no file and no socket. It allocates memory, so do not call it in the
//! control thread. It uses only the contents of a log. States contain no collision thresholds, no
//! virtual walls and no filters of the robot. Therefore a diagnosis can only state two values
//! between which a threshold lies. A log does not show events before its first cycle.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod advice;
mod cause;
mod command_steps;
mod commanded;
mod contact;
mod evidence;
mod finding;
mod lost_cycles;
mod measured;
mod posture;
mod reflex_reason;
#[cfg(test)]
mod tests;

use core::fmt;
use std::sync::Arc;

use evidence::Evidence;
use franka_model::Model;
use franka_proto::{Errors, RobotError};
use franka_rt::driver::ControlLog;
use franka_rt::lifecycle::{ControlError, MotionError};
use franka_rt::stats::MotionStatistics;
use franka_rt::supervision::Reflex;

pub use advice::Advice;
pub use cause::Cause;
pub use finding::{Axis, Bound, Finding, Origin, Quantity, Subject};
pub use franka_rt::driver::Commander;

// Compiles the program in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// Errors that ended a motion and contain its log.
pub trait Diagnose {
    /// Returns the diagnosis if the robot itself stopped the motion; `None` if it ended
    /// differently.
    ///
    /// Each call computes the diagnosis in the caller's thread. It allocates memory and takes up to
    /// a few milliseconds.
    fn diagnose(&self) -> Option<Diagnosis>;
}

impl Diagnose for ControlError {
    fn diagnose(&self) -> Option<Diagnosis> {
        self.is_reflex()
            .then(|| Diagnosis::of(&Case::from(self), &self.model))
    }
}

impl Diagnose for MotionError {
    fn diagnose(&self) -> Option<Diagnosis> {
        self.control()?.diagnose()
    }
}

/// Returns `None` if the reflex did not end a motion of this program.
impl Diagnose for Reflex {
    fn diagnose(&self) -> Option<Diagnosis> {
        self.error.as_deref()?.diagnose()
    }
}

/// Reason why the robot ended a motion, derived from the motion's last cycles.
///
/// The `Display` implementation writes a few lines: the exceeded limit, the causes, other errors,
/// and the advice.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Diagnosis {
    /// Source of the motion's commands.
    pub commander: Commander,
    /// The errors that the robot reported.
    pub errors: Errors,
    /// The error that explains the other errors; `None` if the robot reported no error.
    pub error: Option<RobotError>,
    /// The exceeded limit; `None` if the log does not show it.
    pub finding: Option<Finding>,
    /// Events that led to the error, most likely first; empty if the log shows no such event.
    pub causes: Vec<Cause>,
    /// Recommended changes, most promising first. [`Advice::text`] names the settings that apply to
    /// `commander`.
    pub advice: Vec<Advice>,
    /// `message_id` of the state that shows the end of the motion; `None` if there is no log.
    pub end: Option<u64>,
    /// Number of cycles in the log that the diagnosis used.
    pub cycles: usize,
}

/// The input of a diagnosis, except the model of the robot. A program can save a case and diagnose
/// it later.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Case {
    /// Source of the motion's commands.
    pub commander: Commander,
    /// `reflex_reason` of the state that ended the motion.
    pub errors: Errors,
    /// The last cycles of the motion.
    pub log: Arc<ControlLog>,
    /// Counts over the whole motion, which also show late commands; `None` if they were not
    /// recorded.
    pub statistics: Option<MotionStatistics>,
}

impl From<&ControlError> for Case {
    /// Shares the log of the error, without a copy.
    fn from(error: &ControlError) -> Self {
        Self {
            commander: error.commander,
            errors: error.failure.reflex_reason,
            log: error.log.clone(),
            statistics: Some(error.statistics),
        }
    }
}

impl Diagnosis {
    /// Largest number of cycles in a log that a diagnosis uses. It uses the newest cycles. This
    /// number is enough, because the robot checks limits in every cycle, stops after 20 lost
    /// cycles, and averages the success rate over 100 cycles.
    pub const CYCLES_MAX: usize = 200;

    /// Returns the diagnosis of a case for a robot with this model.
    pub fn of(case: &Case, model: &Model) -> Self {
        let older = case.log.len().saturating_sub(Self::CYCLES_MAX);
        let evidence = Evidence {
            commander: case.commander,
            entries: case.log.iter().skip(older).collect(),
            model,
            statistics: case.statistics.as_ref(),
            rounded: case.log.is_rounded(),
        };
        Self::of_evidence(case.errors, &evidence)
    }

    fn of_evidence(errors: Errors, evidence: &Evidence<'_>) -> Self {
        let (error, finding) = reflex_reason::explaining(evidence, errors);
        let causes = error.map_or_else(Vec::new, |error| {
            reflex_reason::causes(evidence, error, finding.as_ref())
        });
        Self {
            commander: evidence.commander,
            errors,
            error,
            advice: error.map_or_else(Vec::new, |error| {
                reflex_reason::advice(error, finding.as_ref(), &causes)
            }),
            finding,
            causes,
            end: evidence.last().map(|state| state.message_id),
            cycles: evidence.entries.len(),
        }
    }

    /// Returns the number of cycles from the first cycle above the limit to the state that shows
    /// the end of the motion; `None` without a log or a finding.
    pub fn cycles_before_end(&self) -> Option<u64> {
        Some(self.end?.saturating_sub(self.finding?.since))
    }

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
                write!(f, "{finding}, since cycle {} ms", finding.since)?;
                match before {
                    // The control thread may have detected the stop much later.
                    _ if finding.quantity == Quantity::LostCycles => {}
                    0 => write!(f, ", the last cycle")?,
                    1 => write!(f, ", the cycle before the stop")?,
                    cycles => write!(f, ", {cycles} cycles before the stop")?,
                }
                write!(f, " ({error})")?;
            }
            _ if self.cycles == 0 => write!(
                f,
                "{error}: the log has no cycle of the motion to explain it"
            )?,
            _ => write!(
                f,
                "{error}: its cause is not visible in the log of {} cycles",
                self.cycles
            )?,
        }
        for (i, cause) in self.causes.iter().take(CAUSES_SHOWN).enumerate() {
            let lead = if i == 0 { "preceded by" } else { "and by" };
            write!(f, "\n{lead}: {cause}")?;
        }
        let others = self.others();
        if !others.is_empty() {
            write!(f, "\nother errors:")?;
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

/// Largest number of causes in the text.
const CAUSES_SHOWN: usize = 3;
