//! Checks of a goal before it is accepted, outside the thread. A goal that passes these checks
//! cannot fail in the cycle.

use core::time::Duration;

use franka_model::collision::Obstacle;
use franka_model::{EndEffector, JointVector, Model, Twist, inverse_kinematics};
use franka_otg::AxisLimits;
use franka_proto::{RobotState, Version};

use crate::law::Law;
use crate::session::geometry::reported_end_effector;
use crate::session::guard::speed_cap;
use crate::session::{
    Budget, ForceCap, Goal, GoalError, KeepOut, Leash, OnArrival, Settling, Target, Watchdog,
    approach,
};

impl Goal {
    /// Checks the goal for a robot in `state`.
    ///
    /// # Errors
    /// Returns a [`GoalError`] that names the first problem, the given value and the accepted
    /// values.
    pub fn check(&self, model: &Model, state: &RobotState) -> Result<(), GoalError> {
        check_budget(&self.budget, model)?;
        self.gains.check()?;
        let projected = self.gains.project_joint_gains || self.gains.law == Law::OperationalSpace;
        let guided = matches!(self.target, Target::Guide(_));
        if projected && !guided && self.gains.cartesian_stiffness == [0.0; 6] {
            return Err(GoalError::Unheld);
        }
        self.check_numbers()?;
        if let Some(Watchdog { silence, .. }) = self.watchdog {
            check_silence(silence)?;
        }
        if let Some(posture) = self.posture {
            check_joints(&posture, model, state)?;
        }
        if self.target.moves() && self.on_arrival != OnArrival::Hold {
            return Err(GoalError::Moves);
        }
        if let Some(reaction) = &self.reaction {
            reaction.check(model, state)?;
        }
        // Protocol 10 has masses in single precision. Values that are finite there are finite in
        // every version.
        super::load_of(state, Version::V10).ok_or(GoalError::Tool)?;
        if let Some(grasp) = &self.grasp {
            let finite = grasp.to_homogeneous().iter().all(|x| x.is_finite());
            if !finite {
                return Err(GoalError::NotFinite { what: "grasp" });
            }
            if !matches!(self.target, Target::Pose(_) | Target::Rest) {
                return Err(GoalError::Grasp);
            }
        }
        target(&self.hand_target(), model, state)
    }

    fn check_numbers(&self) -> Result<(), GoalError> {
        const POSITIVE: [f64; 2] = [1e-6, f64::INFINITY];
        let (least, most) = (Leash::LEAST, Leash::MOST);
        let (leash, deviation, settling) = (self.leash, self.deviation, self.settling);
        let hold = settling.hold.as_secs_f64();
        let longest = Settling::TIMEOUT_MAX.as_secs_f64();
        let mut numbers = vec![
            (
                "leash (end effector)",
                leash.translation,
                "m",
                [least.translation, most.translation],
            ),
            (
                "leash (end effector)",
                leash.rotation,
                "rad",
                [least.rotation, most.rotation],
            ),
            (
                "leash (joints)",
                leash.joints,
                "rad",
                [least.joints, most.joints],
            ),
            (
                "deviation (end effector)",
                deviation.translation,
                "m",
                POSITIVE,
            ),
            (
                "deviation (end effector)",
                deviation.rotation,
                "rad",
                POSITIVE,
            ),
            ("deviation (joints)", deviation.joints, "rad", POSITIVE),
            ("hold time of settling", hold, "s", [1e-3, longest]),
            (
                "timeout of settling",
                settling.timeout.as_secs_f64(),
                "s",
                [hold, longest],
            ),
        ];
        if let Some(tolerance) = self.tolerance {
            numbers.push((
                "tolerance (end effector)",
                tolerance.translation,
                "m",
                POSITIVE,
            ));
            numbers.push((
                "tolerance (end effector)",
                tolerance.rotation,
                "rad",
                POSITIVE,
            ));
        }
        if let Some(lead) = self.lead {
            numbers.push(("lead (end effector)", lead.translation, "m", POSITIVE));
            numbers.push(("lead (end effector)", lead.rotation, "rad", POSITIVE));
            numbers.push(("lead (joints)", lead.joints, "rad", POSITIVE));
        }
        if let ForceCap::Newtons(cap) = self.force_cap {
            let (least, most) = (*ForceCap::RANGE.start(), *ForceCap::RANGE.end());
            numbers.push(("force cap", cap, "N", [least, most]));
        }
        for (what, got, unit, [least, most]) in numbers {
            if !(least..=most).contains(&got) {
                return Err(GoalError::Number {
                    what,
                    got,
                    unit,
                    least,
                    most,
                });
            }
        }
        Ok(())
    }
}

pub(super) fn target(to: &Target, model: &Model, state: &RobotState) -> Result<(), GoalError> {
    let ee = reported_end_effector(model, state).ok_or(GoalError::Tool)?;
    match to {
        Target::Rest | Target::Guide(_) => Ok(()),
        Target::MovingJoints { q, dq } => {
            joint_speeds(dq, model)?;
            check_joints(q, model, state)
        }
        Target::MovingPose { pose, twist } => {
            speeds(twist, model)?;
            target(&Target::Pose(*pose), model, state)
        }
        Target::Joints(q) => check_joints(q, model, state),
        Target::Pose(pose) => {
            let p = pose.translation.vector;
            if !(p
                .iter()
                .chain(pose.rotation.coords.iter())
                .all(|x| x.is_finite()))
            {
                return Err(GoalError::NotFinite { what: "pose" });
            }
            let length = pose.rotation.coords.norm();
            if (length - 1.0).abs() > LENGTH_ERROR {
                return Err(GoalError::NotRotation { length });
            }
            check_reach(pose, &ee, model, &state.q.into()).map_err(|()| GoalError::Unreachable {
                x: p.x,
                y: p.y,
                z: p.z,
            })
        }
    }
}

pub(crate) fn check_keep_out(regions: &[Obstacle]) -> Result<KeepOut, GoalError> {
    let mut checked = KeepOut::default();
    for (i, region) in regions.iter().enumerate() {
        let refused = |why| GoalError::KeepOut { region: i + 1, why };
        let slot = checked.get_mut(i);
        let slot = slot.ok_or_else(|| refused("is one too many for a session"))?;
        let (finite, positive) = match region {
            Obstacle::Plane { normal, offset } => {
                (normal.iter().chain([offset]).all(|x| x.is_finite()), true)
            }
            Obstacle::Box { pose, half } => {
                let (p, r) = (pose.translation.vector, pose.rotation.coords);
                let numbers = p.iter().chain(r.iter()).chain(half.iter());
                let finite = numbers.copied().all(f64::is_finite);
                (finite, half.iter().all(|&side| side >= 0.0))
            }
        };
        if !finite {
            return Err(refused("has a number that is not finite"));
        }
        if !positive {
            return Err(refused("has a negative side"));
        }
        *slot = Some(*region);
    }
    Ok(checked)
}

/// Checks a speed cap, `[m/s]`.
pub(crate) fn check_speed_cap(got: f64) -> Result<(), GoalError> {
    let (least, most) = (speed_cap::LEAST, speed_cap::MOST);
    if (least..=most).contains(&got) {
        return Ok(());
    }
    Err(GoalError::Number {
        what: "speed cap",
        got,
        unit: "m/s",
        least,
        most,
    })
}

pub(super) fn joint_speeds(dq: &[f64; 7], model: &Model) -> Result<(), GoalError> {
    let most = model.joint_limits().velocity;
    let mut each = dq.iter().zip(&most);
    each.try_for_each(|(dq, &most)| speed("joint speed of the target", "rad/s", dq.abs(), most))
}

/// Checks that this robot's end effector can follow a target with this twist, `[m/s]` and
/// `[rad/s]`.
pub(super) fn speeds(twist: &Twist, model: &Model) -> Result<(), GoalError> {
    let most = model.cartesian_limits();
    let (linear, angular) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
    let angular = angular.norm();
    speed(
        "speed of the target",
        "m/s",
        linear.norm(),
        most.translation.velocity,
    )?;
    speed(
        "angular speed of the target",
        "rad/s",
        angular,
        most.rotation.velocity,
    )
}

fn speed(what: &'static str, unit: &'static str, got: f64, most: f64) -> Result<(), GoalError> {
    if got <= most {
        return Ok(());
    }
    let least = 0.0;
    Err(GoalError::Number {
        what,
        got,
        unit,
        least,
        most,
    })
}

pub(crate) fn check_silence(got: Duration) -> Result<(), GoalError> {
    if got < Goal::SILENCE_MIN {
        return Err(GoalError::Silence { got });
    }
    Ok(())
}

fn check_joints(q: &[f64; 7], model: &Model, state: &RobotState) -> Result<(), GoalError> {
    let limits = model.joint_limits();
    for (i, &got) in q.iter().enumerate() {
        if !got.is_finite() {
            let what = "joint positions";
            return Err(GoalError::NotFinite { what });
        }
        // If the arm is nearer to the end of its range than a plan could move it, it may stay there
        // or leave.
        let (lower, upper) = approach::range(i, limits);
        let stands = state.q[i].min(limits.upper[i]).max(limits.lower[i]);
        let (lower, upper) = (lower.min(stands), upper.max(stands));
        if !(lower..=upper).contains(&got) {
            return Err(GoalError::OutOfRange {
                joint: i + 1,
                got,
                lower,
                upper,
            });
        }
    }
    Ok(())
}

fn check_reach(
    pose: &nalgebra::Isometry3<f64>,
    ee: &EndEffector,
    model: &Model,
    seed: &JointVector,
) -> Result<(), ()> {
    inverse_kinematics::solve(model, pose, ee, seed)
        .map(|_| ())
        .map_err(|_| ())
}

/// Greatest difference between a quaternion's length and 1. Products of many quaternions drift.
const LENGTH_ERROR: f64 = 1e-3;

fn check_budget(budget: &Budget, model: &Model) -> Result<(), GoalError> {
    let joints = model.joint_limits();
    let cartesian = model.cartesian_limits();
    let axis = |what: [&'static str; 3], l: &AxisLimits, most: [f64; 3]| {
        let limits = [l.velocity, l.acceleration, l.jerk];
        for (i, got) in limits.into_iter().enumerate() {
            let (what, least, most) = (what[i], Budget::LIMITS_MIN[i], most[i]);
            if !(least..=most).contains(&got) {
                return Err(GoalError::Budget {
                    what,
                    got,
                    least,
                    most,
                });
            }
        }
        Ok(())
    };
    for (i, l) in budget.joints.iter().enumerate() {
        let most = [joints.velocity[i], joints.acceleration[i], joints.jerk[i]];
        axis(
            [
                "joint velocity [rad/s]",
                "joint acceleration [rad/s^2]",
                "joint jerk [rad/s^3]",
            ],
            l,
            most,
        )?;
    }
    let (t, r) = (cartesian.translation, cartesian.rotation);
    axis(
        [
            "translational velocity [m/s]",
            "translational acceleration [m/s^2]",
            "translational jerk [m/s^3]",
        ],
        &budget.translation,
        [t.velocity, t.acceleration, t.jerk],
    )?;
    axis(
        [
            "rotational velocity [rad/s]",
            "rotational acceleration [rad/s^2]",
            "rotational jerk [rad/s^3]",
        ],
        &budget.rotation,
        [r.velocity, r.acceleration, r.jerk],
    )
}
