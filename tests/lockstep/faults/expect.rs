//! Expected outcomes of a motion, with the texts of the reference client where it has them.

use franka_lockstep::Outcome;
use franka_proto::{Errors, MoveStatus, RobotError, Status};
use franka_rt::lifecycle::MotionError;

use crate::faults::trial::Trial;

/// The expected outcome of a motion.
#[derive(Clone, Debug)]
pub(crate) enum Expect {
    /// Success.
    Done,
    /// Stopped on request.
    Stopped,
    /// Rejected by the robot, which was in the mode of this name.
    Refused(&'static str),
    /// The robot stopped itself, for all of the `certain` reasons and perhaps some of the
    /// `possible` ones.
    Reflex { certain: Errors, possible: Errors },
    /// Ended by the user stop.
    UserStop,
    /// Another error with this text, which the function recognises.
    Other(fn(&MotionError) -> bool, String),
}

impl Expect {
    /// Returns a reflex for exactly these reasons.
    pub(crate) fn reflex(errors: impl IntoIterator<Item = RobotError>) -> Self {
        let errors: Errors = errors.into_iter().collect();
        Self::Reflex {
            certain: errors,
            possible: errors,
        }
    }

    /// Checks an outcome of the trial.
    pub(crate) fn check(&self, trial: &Trial, outcome: &Outcome) {
        let error = match (self, outcome) {
            (Self::Done, Ok(_)) => return,
            (Self::Done, Err(error)) => panic!("expected to be done, got {error:?}: {error}"),
            (_, Ok(report)) => panic!("expected {self:?}, got {report:?}"),
            (_, Err(error)) => error,
        };
        let text = match self {
            Self::Done | Self::Stopped => {
                assert_eq!(error, &MotionError::Stopped);
                return;
            }
            Self::Refused(mode) => {
                let MotionError::Rejected(refusal) = error else {
                    panic!("expected {self:?}, got {error:?}");
                };
                let status = Status::Move(MoveStatus::CommandNotPossibleRejected);
                assert_eq!(refusal.status(), status);
                let recover = if *mode == "Reflex" {
                    " (call `recover` first)"
                } else {
                    ""
                };
                format!(
                    "libfranka: Move command rejected: command not possible in the current mode (\"{mode}\")!{recover}"
                )
            }
            Self::Reflex { certain, possible } => {
                let errors = reflex_reasons(error);
                let missing = certain.iter().find(|&certain| !errors.contains(certain));
                let surplus = errors.iter().find(|&got| !possible.contains(got));
                assert_eq!((missing, surplus), (None, None), "{self:?}: {error}");
                reflex_text(trial, errors)
            }
            Self::UserStop => {
                let control = error.control().expect("ended by the robot");
                assert!(!control.is_reflex(), "{error:?}");
                "libfranka: Move command aborted: User Stop pressed!".to_owned()
            }
            Self::Other(is, text) => {
                assert!(is(error), "expected {text}, got {error:?}");
                text.clone()
            }
        };
        assert_eq!(error.to_string(), text);
    }
}

/// The reasons of a reflex.
fn reflex_reasons(error: &MotionError) -> Errors {
    let control = error.control().unwrap_or_else(|| panic!("{error:?}"));
    assert!(control.is_reflex(), "{error:?}");
    control.failure.reflex_reason
}

/// The text of a reflex: libfranka 0.21, `robot_impl.cpp`, which before the first cycle names no
/// reasons, and has no log to take a rate from.
fn reflex_text(trial: &Trial, errors: Errors) -> String {
    let rate = trial.success_rate();
    match (trial.cycles, trial.finishing) {
        (0, 0) => format!("libfranka: Move command aborted: motion aborted by reflex! {errors}"),
        (_, 0) => {
            format!("libfranka: Move command aborted: motion aborted by reflex! {errors}{rate}")
        }
        _ => format!("Motion finished commanded, but the robot is still moving! {errors}{rate}"),
    }
}
