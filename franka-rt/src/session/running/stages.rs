//! The stages of a goal, from the motion to its end.

use franka_model::{Frame, Model};

use super::line::Line;
use super::{Drive, RunningSession, Standing};
use crate::session::arrival::{self, Landing, PoseError, Release, Verdict};
use crate::session::guard::joint_bounds;
use crate::session::reference::Reference;
use crate::session::{
    Lapse, OnArrival, OnTimeout, SessionEvent, Settlement, Target, Tolerance, rigid,
};

/// Joint velocity below which the reference may be stopped in one cycle, `[rad/s]`. Joints at their
/// bounds may still creep after the pose has arrived.
const REFERENCE_REST: f64 = 1e-3;

#[derive(Debug)]
pub(super) enum GoalStage {
    /// The reference moves, or holds a goal that is still current.
    UnderWay,
    /// The reference has arrived; the arm settles.
    Landing(Landing),
    /// The goal has ended, and the arm is held there.
    Staying,
    /// The spring is being released, so that the torques end at zero.
    Releasing(Release),
    /// The arm was released but does not stop. The robot must stop it.
    Restless,
    /// The last command was sent. The value is the distance of the arm from its target at the
    /// release, if the arm was released.
    Finished(Option<PoseError>),
}

impl GoalStage {
    /// True if the arm is being released or was released.
    pub(super) fn lets_go(&self) -> bool {
        match self {
            Self::Releasing(_) | Self::Restless | Self::Finished(_) => true,
            Self::UnderWay | Self::Landing(_) | Self::Staying => false,
        }
    }
}

impl RunningSession {
    /// Advances the stage of a goal that ends. No other function advances it. The report is written
    /// to `event`.
    pub(super) fn advance_stage(
        &mut self,
        model: &Model,
        at_rest: bool,
        now: u64,
        event: &mut Option<SessionEvent>,
    ) {
        match &mut self.stage {
            GoalStage::UnderWay => self.end_way(model),
            GoalStage::Landing(landing) => {
                let working = matches!(&self.drive, Drive::Torques(effort) if effort.is_working());
                // The robot's own report decides. Under its Cartesian controllers, the correction
                // belongs to the setpoint, at the place where the reference was last taken from the
                // robot.
                let measured = self.arm.as_reported();
                let (mut settlement, held) = match landing.judge(&measured, at_rest, working) {
                    Verdict::Settling => return,
                    Verdict::Settled(settlement, held) => (settlement, held),
                };
                let target = landing.target();
                let reference = model.pose(Frame::EndEffector, &self.reference.q, &self.hand);
                let reference = rigid(&reference) * self.correction.unwrap_or_default();
                let out_of_reach =
                    !self.obstructed && landing.is_short_at(&reference, &self.arm.pose);
                if self.goal.on_arrival == OnArrival::ReportAndFinish
                    && self.reference.dq.amax() > REFERENCE_REST
                    && !self.response.refuses()
                {
                    if self.aim.target() != Target::Rest {
                        self.turn_to(Target::Rest);
                    }
                    return;
                }
                let effort = match &self.drive {
                    Drive::Torques(effort) => Some(effort),
                    Drive::Setpoints(_) => None,
                };
                if let (Settlement::TargetNotReached(short), Some(effort)) =
                    (&mut settlement, effort)
                {
                    short.pull = Some(effort.pull(&self.arm.jacobian).into());
                    short.limited = effort.limited();
                }
                if let Settlement::TargetNotReached(short) = settlement
                    && let Some(near) = self.tolerance_with_others()
                    && short.error.within(&near)
                {
                    settlement = Settlement::Arrived(short.error);
                }
                if out_of_reach && matches!(settlement, Settlement::TargetNotReached(_)) {
                    let joint = joint_bounds::at_end(model.joint_limits(), &self.reference.q);
                    settlement = Settlement::Braked(Lapse::OutOfReach { joint });
                }
                let compensation = effort.map(|effort| effort.compensated().into());
                self.stage = match (self.goal.on_arrival, &self.drive) {
                    (OnArrival::Hold | OnArrival::ReportAndHold, _) => GoalStage::Staying,
                    (OnArrival::ReportAndFinish, Drive::Torques(_)) => {
                        self.route.rest();
                        GoalStage::Releasing(Release::new(target, self.arm.q, &self.reference.q))
                    }
                    // The robot holds the arm at its setpoint, so nothing must be released.
                    (OnArrival::ReportAndFinish, Drive::Setpoints(_)) => GoalStage::Finished(None),
                };
                *event = Some(SessionEvent::Settled {
                    goal: self.goal.id,
                    settlement: match self.standing {
                        Standing::GivenUp { action, cause, .. } => {
                            if action == OnTimeout::Hold || cause == Lapse::Deadman {
                                Settlement::Held(cause)
                            } else {
                                Settlement::Braked(cause)
                            }
                        }
                        Standing::InForce | Standing::TakenBack | Standing::Reacted(_) => {
                            settlement
                        }
                    },
                    reacted: self.reacted(),
                    duration_ms: (now - self.since).saturating_sub(held),
                    compensation,
                    line_deviation: self.line.as_ref().map(Line::deviation),
                });
            }
            GoalStage::Releasing(release) => {
                self.reference = Reference::at_rest(release.reference());
                self.route.rest();
                if release.is_over(at_rest) {
                    self.stage = GoalStage::Finished(release.error(&self.arm.as_reported()));
                } else if release.is_in_vain() {
                    self.stage = GoalStage::Restless;
                    *event = Some(SessionEvent::Restless);
                }
            }
            GoalStage::Staying | GoalStage::Restless | GoalStage::Finished(_) => {}
        }
    }

    /// Begins the landing when the reference has arrived, or if something held it back for too
    /// long.
    fn end_way(&mut self, model: &Model) {
        let stalled = self.progress.is_stalled();
        let heading = self.heading();
        let pursued = heading != Target::Rest && !self.is_given_up();
        let done = self.route.is_done() || !pursued && self.response.refuses();
        if !stalled && !done {
            return;
        }
        if self.has_braked_before(&heading) {
            return self.turn_to(heading);
        }
        // The hand may reach its target before the elbow does.
        let turns =
            self.goal.posture.is_some() && self.reference.dq.amax() > arrival::REST_VELOCITY;
        // A reference that halts on its way also rests. If other arms wait for this arm and
        // something held it back for too long, it gives up.
        let arrived = done && !turns && !(pursued && self.waits);
        let stalled = stalled && !(pursued && self.waits && !self.lags);
        let paused = pursued && self.goal.paused;
        if arrived && !paused && self.refine(&heading) {
            return;
        }
        let ends = self.goal.on_arrival != OnArrival::Hold && !paused;
        if ends && (arrived || stalled) {
            if stalled && let Some(lapse) = self.route.hindrance() {
                self.give_up(lapse);
            } else if stalled && heading != Target::Rest {
                self.turn_to(Target::Rest);
            }
            let target = match heading {
                // A goal that was given up counts as held at any place.
                _ if self.is_given_up() => None,
                Target::Rest | Target::Guide(_) => None,
                Target::Pose(pose) | Target::MovingPose { pose, .. } => {
                    // Use the target of the hand. At the object, its lever would not count.
                    Some(pose * self.grasp.unwrap_or_default().inverse())
                }
                Target::Joints(q) | Target::MovingJoints { q, .. } => {
                    // The change of the correction along the way must not count as an error of the
                    // report.
                    self.renew_correction();
                    Some(rigid(&model.pose(Frame::EndEffector, &q.into(), &self.ee)))
                }
            };
            let tolerance = self.goal.tolerance.unwrap_or_else(|| match &self.drive {
                Drive::Torques(_) => Tolerance::of(&self.goal.gains),
                Drive::Setpoints(stream) => Tolerance::under(stream.controller()),
            });
            self.obstructed = stalled && self.progress.is_obstructed();
            self.stage = GoalStage::Landing(Landing::new(target, tolerance, self.goal.settling));
        }
    }
}
