//! One reflex, from the time when it is noticed until the robot accepts motions again.

use core::time::Duration;
use std::sync::Arc;

use franka_proto::{Errors, RobotMode};

use super::attempts::{Attempts, Pauses};
use super::event::{NotRecovered, Reflex};
use super::policy::{Policy, Recovery};
use crate::lifecycle::{ControlError, Differences, Unready};

/// Reason why a recovery failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecoveryFailure {
    /// The robot requires a recovery by hand.
    ByHand,
    /// Any other failure: the recovery was refused or given up, or there was no answer. The
    /// recovery may be tried again.
    Other,
}

/// The robot's present reflex.
#[derive(Debug)]
pub(super) struct ReflexCase {
    pub(super) number: u64,
    pub(super) since: Duration,
    pub(super) errors: Errors,
    error: Option<Arc<ControlError>>,
    differences: Option<Differences>,
    /// True if the reflex has been reported. The report waits for the end of the motion, because
    /// the motion has the log.
    told: bool,
    stage: Stage,
    /// True if this stage has reported that a person is needed.
    stage_told: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// A person or the program must recover the robot.
    Left(NotRecovered),
    /// The user must approve the recovery.
    AgreementAwaited,
    /// The recovery is due at `at` or later, after `failed` failed attempts.
    Due { at: Duration, failed: u32 },
    /// The request to recover was sent.
    Requested { failed: u32 },
    /// The robot has answered that it recovered. A state before `until` must show it.
    Answered { until: Duration, failed: u32 },
}

#[derive(Debug, PartialEq)]
pub(super) enum Step {
    Tell(Reflex),
    Leave(NotRecovered),
    Ask(Reflex),
    Recover,
}

impl ReflexCase {
    /// Creates the data of a reflex that was noticed at `now`. The robot has these differences from
    /// the robot of the previous connection.
    pub(super) fn new(
        number: u64,
        errors: Errors,
        differences: Option<Differences>,
        policy: Option<&Policy>,
        attempts: &mut Attempts,
        now: Duration,
    ) -> Self {
        Self {
            number,
            since: now,
            errors,
            error: None,
            differences,
            told: false,
            stage: Stage::of(errors, differences.is_some(), policy, attempts, now),
            stage_told: false,
        }
    }

    pub(super) fn explain(&mut self, error: ControlError) {
        self.error.get_or_insert_with(|| Arc::new(error));
    }

    pub(super) fn is_told(&self) -> bool {
        self.told
    }

    /// Continues a reflex that was not reported yet, with more errors.
    pub(super) fn continue_from(&mut self, before: Self) {
        (self.number, self.since, self.error) = (before.number, before.since, before.error);
    }

    /// Returns the reason why the robot accepts no motions.
    pub(super) fn unready(&self) -> Unready {
        match self.stage {
            Stage::Left(_) => Unready::Reflex,
            Stage::AgreementAwaited => Unready::AgreementAwaited,
            Stage::Due { .. } | Stage::Requested { .. } | Stage::Answered { .. } => {
                Unready::Recovering
            }
        }
    }

    /// True if the supervisor has asked the robot to recover.
    pub(super) fn is_by_supervisor(&self) -> bool {
        matches!(self.stage, Stage::Requested { .. } | Stage::Answered { .. })
    }

    /// Processes the user's answer about the recovery. Returns true if an answer was awaited.
    pub(super) fn agree(&mut self, agreed: bool, now: Duration) -> bool {
        let awaited = self.stage == Stage::AgreementAwaited;
        if awaited {
            self.enter(match agreed {
                true => Stage::Due { at: now, failed: 0 },
                false => Stage::Left(NotRecovered::Declined),
            });
        }
        awaited
    }

    /// Processes the robot's answer to the request to recover.
    pub(super) fn on_answer(
        &mut self,
        answer: Result<(), RecoveryFailure>,
        pauses: &mut Pauses,
        now: Duration,
    ) {
        let Stage::Requested { failed } = self.stage else {
            return;
        };
        self.enter(match answer {
            Ok(()) => Stage::Answered {
                until: now + SHOWN_WITHIN,
                failed,
            },
            Err(RecoveryFailure::ByHand) => Stage::Left(NotRecovered::ByHand),
            Err(RecoveryFailure::Other) => Stage::again(failed + 1, pauses, now),
        });
    }

    /// Returns the next step if one is due while the robot is in this mode. `is_moving` is true
    /// until the end of the motion was reported. Each step is returned once.
    pub(super) fn step(
        &mut self,
        (mode, is_moving): (RobotMode, bool),
        recovery: Option<Recovery>,
        (attempts, pauses): (&mut Attempts, &mut Pauses),
        now: Duration,
    ) -> Option<Step> {
        if is_moving {
            return None;
        }
        if !self.told {
            self.told = true;
            return Some(Step::Tell(self.reflex()));
        }
        if let Stage::Answered { until, failed } = self.stage
            && now >= until
        {
            self.enter(Stage::again(failed + 1, pauses, now));
        }
        if let Stage::Due { at, failed } = self.stage
            && now >= at
            && mode == RobotMode::Reflex
        {
            let may = recovery
                .is_some_and(|Recovery { times, window }| attempts.note(times, window, now));
            if may {
                self.enter(Stage::Requested { failed });
                return Some(Step::Recover);
            }
            self.enter(Stage::Left(NotRecovered::TooOften));
        }
        let step = match self.stage {
            Stage::Left(why) => Step::Leave(why),
            Stage::AgreementAwaited => Step::Ask(self.reflex()),
            Stage::Due { .. } | Stage::Requested { .. } | Stage::Answered { .. } => return None,
        };
        (!core::mem::replace(&mut self.stage_told, true)).then_some(step)
    }

    fn enter(&mut self, stage: Stage) {
        (self.stage, self.stage_told) = (stage, false);
    }

    /// Returns the time at which [`Self::step`] must be called for a robot in this mode, if no
    /// other input arrives before.
    pub(super) fn deadline(&self, mode: RobotMode) -> Option<Duration> {
        match self.stage {
            Stage::Due { at, .. } if mode == RobotMode::Reflex => Some(at),
            Stage::Answered { until, .. } => Some(until),
            Stage::Due { .. }
            | Stage::Left(_)
            | Stage::AgreementAwaited
            | Stage::Requested { .. } => None,
        }
    }

    fn reflex(&self) -> Reflex {
        Reflex {
            number: self.number,
            errors: self.errors,
            error: self.error.clone(),
            differences: self.differences,
        }
    }
}

impl Stage {
    /// Returns the stage that the policy requires for a reflex with these errors, on a robot that
    /// may differ from the robot before the reconnect.
    fn of(
        errors: Errors,
        is_unlike: bool,
        policy: Option<&Policy>,
        attempts: &mut Attempts,
        now: Duration,
    ) -> Self {
        let Some((policy, recovery)) = policy.and_then(|it| Some((it, it.recovery?))) else {
            return Self::Left(NotRecovered::Never);
        };
        let Recovery { times, window } = recovery;
        let among = |only: Errors| errors != Errors::NONE && only.union(errors) == only;
        if policy.only.is_some_and(|only| !among(only)) {
            Self::Left(NotRecovered::OtherError)
        } else if !attempts.may(times, window, now) {
            Self::Left(NotRecovered::TooOften)
        } else if policy.agreement || is_unlike {
            Self::AgreementAwaited
        } else {
            Self::Due { at: now, failed: 0 }
        }
    }

    fn again(failed: u32, pauses: &mut Pauses, now: Duration) -> Self {
        Self::Due {
            at: now.saturating_add(pauses.after(failed)),
            failed,
        }
    }
}

/// Time within which a state must show that the robot has recovered, after the robot has answered
/// so.
const SHOWN_WITHIN: Duration = Duration::from_secs(2);
