//! Detects an arm that ignores its commands: it stands still while the robot reports a motion and
//! no error.
//!
//! The cause may be closed brakes or a controller that has stopped. An arm can also stand still
//! because something holds it, which is visible as an external torque, or because of friction,
//! which a few N m overcome. Therefore an arm counts as unresponsive if all its joints stand still
//! for [`HOLD`] cycles in a row and, in each of these cycles, one of these conditions is true:
//!
//! | backend | condition |
//! |---|---|
//! | the session's own law | at one joint, the torque of the law and the external torque differ by more than [`RESISTS`] |
//! | the robot's joint controller | at one joint, the setpoint is further away than [`APART`], and the external torque is below [`FELT`] |
//! | the robot's Cartesian controller | the commanded pose is further away than [`AWAY`], and all external torques are below [`FELT`] |
//! | both controllers of the robot | the robot's setpoint stands still, and the robot keeps refusing the setpoints sent to it |
//!
//! Smaller commands do not count, because friction may hold the arm against them.

use franka_model::JointVector;
use franka_proto::RobotState;
use nalgebra::Vector3;

use crate::law::Gains;
use crate::session::arrival::REST_VELOCITY;
use crate::session::backend::Controller;

/// Counts for how long the arm has ignored its commands.
#[derive(Debug)]
pub(crate) struct Unresponsive {
    /// Number of cycles in which the arm stood still under commands that should move it.
    still: u32,
    /// Number of cycles in which the robot refused its setpoints.
    refusing: u32,
    /// Number of cycles since the robot's setpoint last differed from the setpoint that was sent.
    since_refused: u32,
    /// The robot's setpoint in the last state, `[rad]`.
    setpoint: JointVector,
    /// True if the last command differed from the setpoint that the session requested.
    changed: bool,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Commanded<'a> {
    /// Torques without gravity, `[N m]`, as the law demands them, before smoothing.
    Torques(&'a JointVector),
    /// A setpoint for a controller of the robot.
    Setpoint {
        controller: Controller,
        /// True if the setpoint in the state differs from the setpoint that was last sent.
        differs: bool,
        /// True if the backstop changed the setpoint of this cycle.
        changed: bool,
    },
}

impl Default for Unresponsive {
    fn default() -> Self {
        Self {
            still: 0,
            refusing: 0,
            since_refused: REFUSED_WITHIN,
            setpoint: JointVector::zeros(),
            changed: false,
        }
    }
}

impl Unresponsive {
    /// Records one cycle. Returns true if the arm has ignored its commands for long enough.
    ///
    /// Comparisons with NaN are false, so a state with NaN never counts.
    pub(crate) fn watch(&mut self, state: &RobotState, commanded: Commanded<'_>) -> bool {
        let stands = JointVector::from(state.dq).amax() < REST_VELOCITY;
        let (q, external) = (&state.q, &state.tau_ext_hat_filtered);
        let untouched = |i: usize| external[i].abs() < FELT[i];
        let (ignored, refused) = match commanded {
            Commanded::Torques(torques) => {
                let off = |i: usize| (torques[i] - external[i]).abs();
                (stands && (0..7).any(|i| off(i) > RESISTS[i]), false)
            }
            Commanded::Setpoint {
                controller,
                differs,
                changed,
            } => {
                let refused = self.is_refused(&state.q_d, differs);
                self.changed = changed;
                let apart = |i: usize| (state.q_d[i] - q[i]).abs() > APART && untouched(i);
                let ignored = || match controller {
                    Controller::JointImpedance => (0..7).any(apart),
                    Controller::CartesianImpedance => {
                        (0..7).all(untouched) && distance(state) > AWAY
                    }
                };
                (stands && ignored(), refused)
            }
        };
        let counted = |cycles: u32, on: bool| if on { cycles.saturating_add(1) } else { 0 };
        self.still = counted(self.still, ignored);
        self.refusing = counted(self.refusing, stands && refused);
        self.still >= HOLD || self.refuses()
    }

    /// True if the robot accepts no setpoints. A reference that follows the robot's own setpoint
    /// then cannot stop.
    pub(crate) fn refuses(&self) -> bool {
        self.refusing >= HOLD
    }

    /// True if the robot's setpoint has not moved, and the robot has recently refused a setpoint. A
    /// setpoint that the backstop changed does not count as refused, because it differs from the
    /// robot's setpoint in any case.
    fn is_refused(&mut self, setpoint: &[f64; 7], differs: bool) -> bool {
        let setpoint = JointVector::from(*setpoint);
        let stays = core::mem::replace(&mut self.setpoint, setpoint) == setpoint;
        self.since_refused = match differs && !self.changed {
            true => 0,
            false => self.since_refused.saturating_add(1),
        };
        stays && self.since_refused < REFUSED_WITHIN
    }
}

/// Returns the distance between the measured end effector and its commanded pose, `[m]`.
fn distance(state: &RobotState) -> f64 {
    let at = |pose: &[f64; 16]| Vector3::new(pose[12], pose[13], pose[14]);
    (at(state.commanded_pose()) - at(&state.O_T_EE)).norm()
}

/// Number of cycles after which an arm that stands still counts as unresponsive.
const HOLD: u32 = 200;

/// Number of cycles for which a refused setpoint counts. If a slow motion repeatedly begins from
/// rest, tens of cycles pass until its setpoint differs from the robot's setpoint by more than
/// rounding.
const REFUSED_WITHIN: u32 = 100;

/// Greatest difference between commanded and external torque that friction and bias can explain,
/// `[N m]`: the friction of the worst simulated arms, and the bias from half a kilogram.
const RESISTS: [f64; 7] = Gains::COMPENSATION;

/// Distance between a joint and the robot's setpoint that friction does not explain, `[rad]`,
/// unless the user made the controller softer than about 25 N m/rad.
const APART: f64 = 0.1;

/// Distance between the hand and the commanded pose that friction does not explain, `[m]`, unless
/// the user made the controller softer than about 200 N/m. The joints do not count, because this
/// controller hardly holds the elbow.
const AWAY: f64 = 0.05;

/// External torque that the robot may estimate at an untouched joint, `[N m]`, because of friction
/// at the link, bias of the sensor or an undeclared load.
const FELT: [f64; 7] = [2.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0];

#[cfg(test)]
mod tests {
    use super::*;

    fn state(external: f64, dq: f64) -> RobotState {
        RobotState {
            tau_ext_hat_filtered: [external, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            dq: [0.0, 0.0, 0.0, dq, 0.0, 0.0, 0.0],
            ..RobotState::default()
        }
    }

    /// Returns the first cycle, from 1, in which the guard reports an arm that gets this command in
    /// every cycle.
    fn named(state: &RobotState, commanded: Commanded<'_>) -> Option<u32> {
        let mut this = Unresponsive::default();
        (1..=1000).find(|_| this.watch(state, commanded))
    }

    #[test]
    fn torques_beyond_friction_that_move_nothing_are_ignored() {
        let of = |torque: f64, external: f64, dq: f64| {
            let mut torques = JointVector::zeros();
            torques[0] = torque;
            named(&state(external, dq), Commanded::Torques(&torques))
        };
        assert_eq!(of(8.0, 0.5, 0.0), Some(HOLD));
        assert_eq!(of(-8.0, 0.5, 1e-3), Some(HOLD));
        // Four cases: friction may hold the arm; an obstacle holds the arm; another joint moves;
        // the robot has no estimate.
        for (torque, external, dq) in [
            (1.6, 0.0, 0.0),
            (-4.9, 0.0, 0.0),
            (40.0, 38.0, 0.0),
            (8.0, 0.5, 0.05),
            (8.0, f64::NAN, 0.0),
        ] {
            assert_eq!(of(torque, external, dq), None, "{torque} {external} {dq}");
        }
    }

    fn setpoint(controller: Controller, differs: bool) -> Commanded<'static> {
        Commanded::Setpoint {
            controller,
            differs,
            changed: false,
        }
    }

    #[test]
    fn a_setpoint_far_from_a_still_joint_is_ignored() {
        let of = |away: f64, external: f64, controller: Controller| {
            let mut state = state(external, 0.0);
            state.q_d[0] = state.q[0] + away;
            named(&state, setpoint(controller, false))
        };
        let joints = Controller::JointImpedance;
        assert_eq!(of(0.11, 0.5, joints), Some(HOLD));
        assert_eq!(
            of(0.05, 0.5, joints),
            None,
            "a soft controller, and friction"
        );
        assert_eq!(of(0.11, 5.0, joints), None, "a wall");
        let cartesian = Controller::CartesianImpedance;
        assert_eq!(of(0.11, 0.5, cartesian), None, "an elbow that was pushed");
    }

    #[test]
    fn a_commanded_pose_far_from_a_still_hand_is_ignored() {
        let of = |away: f64, external: f64| {
            let mut state = state(external, 0.0);
            state.O_T_EE_c[13] = state.O_T_EE[13] + away;
            named(&state, setpoint(Controller::CartesianImpedance, false))
        };
        assert_eq!(of(0.06, 0.5), Some(HOLD));
        assert_eq!(of(0.04, 0.5), None, "a soft controller, and friction");
        assert_eq!(of(0.06, 5.0), None, "a wall");
    }

    #[test]
    fn setpoints_that_the_robot_refuses_are_ignored() {
        let controller = Controller::JointImpedance;
        let still = state(0.5, 0.0);
        assert_eq!(named(&still, setpoint(controller, false)), None);
        assert_eq!(named(&still, setpoint(controller, true)), Some(HOLD));
        let held_back = Commanded::Setpoint {
            controller,
            differs: true,
            changed: true,
        };
        let mut this = Unresponsive::default();
        this.watch(&still, held_back);
        assert!(
            !(0..1000).any(|_| this.watch(&still, held_back)),
            "the backstop"
        );
        // One refusal, as after a lost command, and many refusals while the setpoint moves.
        this = Unresponsive::default();
        this.watch(&still, setpoint(controller, true));
        let later = (0..1000).any(|_| this.watch(&still, setpoint(controller, false)));
        assert!(!later, "one refusal");
        let mut moving = state(0.5, 0.0);
        let moved = (0..1000).any(|_| {
            moving.q_d[6] += 1e-6;
            this.watch(&moving, setpoint(controller, true))
        });
        assert!(!moved, "a setpoint that moves");
    }
}
