//! Work submitted to a session, and the outcomes that it may have.

use std::time::Duration;

use franka_lockstep::{Lockstep, Outcome, pose_of};
use franka_model::EndEffector;
use franka_rt::driver::Record;
use franka_rt::lifecycle::{MotionError, MotionReport};
use franka_rt::session::{
    GoalId, Guard, Lapse, OnArrival, OnTimeout, PoseError, Target, Tolerance, Watchdog,
};
use franka_sim::Tool;

use super::causes::Causes;

/// Time in which an update is sure to be taken up, `[ms]`.
const IN_FLIGHT: u64 = 3;

/// Guards that may keep an arm from its target.
const HINDRANCES: [Guard; 9] = [
    Guard::Leash,
    Guard::InverseKinematics,
    Guard::JointVelocity,
    Guard::PositionEnvelope,
    Guard::TorqueClamp,
    Guard::ForceCap,
    Guard::Clearance,
    Guard::Deviation,
    Guard::TorqueRate,
];

/// The kinds of work that resolve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Work {
    Goal(Target),
    /// Successive chunks.
    Chunks,
    Session,
    Stop,
}

/// Submitted work, and all events that may affect its outcome.
#[derive(Clone, Debug)]
pub(super) struct Submission {
    pub(super) id: GoalId,
    pub(super) work: Work,
    pub(super) on_arrival: OnArrival,
    pub(super) watchdog: Option<Watchdog>,
    /// Target if its condition becomes true.
    pub(super) reaction: Option<Target>,
    /// The times of its updates, `[ms]`.
    pub(super) heard: Vec<u64>,
    pub(super) superseded: bool,
    /// Cancelled by its owner.
    pub(super) cancelled: bool,
    /// Stopped together with other work.
    pub(super) stopped: bool,
    /// For a session: its end was requested. For a goal: its session was ending.
    pub(super) released: bool,
    /// Ended by a goal that had to end the session.
    pub(super) finishing: bool,
    /// Its deadman timed out.
    pub(super) deadman: bool,
    /// Tolerance of arrival, unless it is soft.
    pub(super) tolerance: Tolerance,
    /// The springs may be too soft to reach the target.
    pub(super) soft: bool,
    /// A guard kept the arm from the target.
    hindered: bool,
}

impl Submission {
    pub(super) fn new(id: GoalId, work: Work, on_arrival: OnArrival, now: u64) -> Self {
        Self {
            id,
            work,
            on_arrival,
            watchdog: None,
            reaction: None,
            heard: vec![now],
            superseded: false,
            cancelled: false,
            stopped: false,
            released: false,
            finishing: false,
            deadman: false,
            tolerance: Tolerance::default(),
            soft: false,
            hindered: false,
        }
    }

    /// Records one more cycle.
    pub(super) fn observe(&mut self, record: &Record) {
        self.hindered |= HINDRANCES
            .into_iter()
            .any(|guard| record.bindings.contains(guard));
    }

    /// Checks its outcome against the recorded events.
    ///
    /// # Panics
    /// If no event explains the outcome.
    pub(super) fn judge(&self, outcome: &Outcome, lockstep: &Lockstep, causes: &Causes) {
        let fits = match outcome {
            Ok(report) => self.may_be_ok(report) && self.is_there(report, lockstep),
            Err(error) => self.may_fail(error, lockstep.now(), causes),
        };
        assert!(
            fits,
            "at {} {self:?}: {outcome:?} after {causes:?}",
            lockstep.now()
        );
    }

    fn may_be_ok(&self, report: &MotionReport) -> bool {
        let reacted = report.reacted.is_some();
        if reacted && self.reaction.is_none() {
            return false;
        }
        match self.work {
            // A goal whose motion is ending was reached, regardless of later events.
            Work::Goal(_) if self.on_arrival == OnArrival::ReportAndFinish && self.stopped => true,
            Work::Goal(_) | Work::Chunks => {
                (self.on_arrival != OnArrival::Hold || reacted)
                    && !self.cancelled
                    && !self.superseded
                    && !self.stopped
            }
            Work::Session => self.released,
            Work::Stop => true,
        }
    }

    /// True if the arm is in the reported pose, and that pose is the target.
    fn is_there(&self, report: &MotionReport, lockstep: &Lockstep) -> bool {
        let target = match (self.work, self.reaction, report.reacted) {
            (Work::Goal(_), Some(then), Some(_)) => then,
            (Work::Goal(target), ..) => target,
            _ => Target::Rest,
        };
        let target = match target {
            Target::Pose(pose) => pose,
            Target::Joints(q) => {
                let tool = Tool::hand();
                let ee = EndEffector {
                    f_t_ee: tool.f_t_ne,
                    ..EndEffector::default()
                };
                pose_of(&q.into(), &ee)
            }
            _ => return report.final_error.is_none(),
        };
        let Some(reported) = report.final_error else {
            return false;
        };
        let off = PoseError::between(&lockstep.arm_pose(), &target);
        let most = self.tolerance;
        let within = reported.translation <= most.translation && reported.rotation <= most.rotation;
        // The arm swings on a little after the measurement.
        (self.soft || within)
            && off.translation <= reported.translation.max(most.translation) + 1e-3
            && off.rotation <= reported.rotation.max(most.rotation) + 2e-3
    }

    fn may_fail(&self, error: &MotionError, now: u64, causes: &Causes) -> bool {
        let goal = matches!(self.work, Work::Goal(_) | Work::Chunks);
        match error {
            MotionError::Superseded => goal && self.superseded,
            MotionError::Stopped => {
                self.stopped || (goal && self.cancelled) || self.finishing || self.released
            }
            MotionError::Disengaged => goal && self.released,
            MotionError::Held(Lapse::Deadman) => self.deadman && self.work != Work::Stop,
            MotionError::Held(Lapse::Silent { silence }) => {
                goal && self.was_silent(OnTimeout::Hold, *silence, now)
            }
            MotionError::Braked(Lapse::Silent { silence }) => {
                goal && self.was_silent(OnTimeout::Brake, *silence, now)
            }
            MotionError::TargetNotReached(short) => {
                let (off, most) = (short.error, Tolerance::default());
                let far = off.translation > most.translation || off.rotation > most.rotation;
                let may = causes.pushed || self.hindered;
                // Under drawn gains an arm may also swing about its target indefinitely.
                (far && may || self.soft) && (goal || self.finishing)
            }
            // A session ends with the error of the goal that had to end it.
            MotionError::AfterReaction { error, .. } => {
                let reacts = self.reaction.is_some() || (!goal && self.finishing);
                reacts && self.may_fail(error, now, causes)
            }
            MotionError::Braked(Lapse::Displaced) => causes.pushed,
            MotionError::Braked(Lapse::Blocked { .. }) => self.hindered,
            MotionError::Control(error) => causes.explains(error),
            MotionError::Rejected(_) => causes.any(),
            _ => false,
        }
    }

    fn was_silent(&self, how: OnTimeout, reported: Duration, now: u64) -> bool {
        let Some(Watchdog {
            silence,
            on_timeout,
            ..
        }) = self.watchdog
        else {
            return false;
        };
        // A gap in the states makes the silence longer, but not longer than it is now. News of the
        // last cycles may have come too late.
        let in_time = |heard: &&u64| **heard + IN_FLIGHT <= now;
        let heard = self.heard.iter().rev().find(in_time);
        let heard = heard.unwrap_or(&self.heard[0]);
        let since = Duration::from_millis(now + 1 - heard);
        on_timeout == how && reported >= silence && reported <= since
    }
}
