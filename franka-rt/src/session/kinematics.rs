//! From a moving pose to moving joints: one step of differential inverse kinematics, inside the
//! joints' bounds.

use franka_model::differential_ik::{DifferentialIk, JointBox, Side};
use franka_model::limits::JointLimits;
use franka_model::{EndEffector, Frame, JointVector, Model, Twist, rotation};

use crate::law::hybrid::Reference;
use crate::session::pose::MovingPose;
use crate::session::{Budget, rigid};

/// Nominal length of a cycle, `[s]`.
const CYCLE: f64 = 1e-3;

/// Share of each joint's velocity limit that the reference may use.
const VELOCITY_CAP: f64 = 0.7;

/// How much faster than its budget a joint may move for the sake of a pose. On a straight line near
/// a singular posture joints have to turn fast while the hand hardly moves, which nobody beside the
/// arm expects. At 2 an arm that stretches at the default pace is held back needlessly.
const HASTE: f64 = 3.0;

/// Share of each joint's acceleration limit that the reference may use.
const ACCELERATION_CAP: f64 = 0.9;

/// Share of each joint's jerk limit that the reference may use.
const JERK_CAP: f64 = 0.9;

/// Distance kept from the ends of each joint's range, `[rad]`.
const POSITION_MARGIN: f64 = 0.05;

/// Deceleration, `[rad/s^2]`, with which a joint has to be able to stop before that margin. Less
/// than half of what the robot's velocity envelope reckons with at joint 2, its gentlest (2.585):
/// the arm is a spring behind the reference and swings past it where it slows down.
const BRAKING: f64 = 1.2;

/// Rate, `[1/s]`, at which an error between the joints and the pose that they follow dies out. It
/// is fed only by rounding and by bounds that bound; a faster rate would turn those into jerks.
const FEEDBACK: f64 = 100.0;

/// Rate, `[1/s]`, at which the free direction of the arm returns to the posture where the motion
/// began.
const POSTURE: f64 = 1.0;

/// Speed of the end effector, `[m/s]`, from which on the posture is followed at the full rate. It
/// fades with the speed, so that an arm at its target rests.
const POSTURE_SPEED: f64 = 0.1;

/// Time, `[s]`, in which a motion of the arm's free direction fades that a pose takes over from
/// joints.
const FADE: f64 = 0.3;

/// What is left of a motion over the joints that a pose has taken over: its part in the arm's free
/// direction, which the pose says nothing about. It fades; dropped at once it would step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drift {
    velocity: JointVector,
    cycle: u32,
}

impl Drift {
    /// Of joints that move at `velocity`, `[rad/s]`.
    pub(super) fn of(velocity: JointVector) -> Self {
        Self { velocity, cycle: 0 }
    }

    /// The share that is left in the next cycle: from 1 to 0, at either end without a slope.
    fn share(&mut self) -> f64 {
        self.cycle = self.cycle.saturating_add(1);
        let gone = (f64::from(self.cycle) * CYCLE / FADE).min(1.0);
        1.0 - gone * gone * (3.0 - 2.0 * gone)
    }
}

/// What held joints back in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Held {
    /// Their velocity.
    pub(super) velocity: bool,
    /// The ends of their ranges.
    pub(super) position: bool,
    /// Their acceleration or jerk.
    pub(super) acceleration: bool,
}

impl Held {
    /// Whether anything did.
    pub(super) fn any(self) -> bool {
        self != Self::default()
    }
}

/// Moves the joints of `reference` towards `pose` for one cycle, and tells which bounds held them
/// back.
pub(super) fn follow(
    model: &Model,
    ee: &EndEffector,
    posture: &JointVector,
    drift: &mut Drift,
    reference: &Reference,
    pose: &MovingPose,
    budget: &Budget,
) -> (Reference, Held) {
    let (now, jacobian) = model.pose_and_jacobian(Frame::EndEffector, &reference.q, ee);
    let now = rigid(&now);
    let offset = pose.pose.translation.vector - now.translation.vector;
    let turn = rotation::error(&pose.pose.rotation, &now.rotation);
    // What the pose itself moves by in this cycle is no error. Counted as one, it would kick
    // whatever begins to follow it.
    let error =
        Twist::new(offset.x, offset.y, offset.z, turn.x, turn.y, turn.z) - pose.twist * CYCLE;
    let twist = pose.twist + error * FEEDBACK;

    let fade = (pose.twist.fixed_rows::<3>(0).norm() / POSTURE_SPEED).min(1.0);
    let back = (posture - reference.q) * (POSTURE * fade);
    let left = drift.share();
    let free = drift.velocity * left + back * (1.0 - left);
    let open: [Interval; 7] =
        core::array::from_fn(|i| Interval::of(i, model.joint_limits(), reference, budget));
    let bounds = JointBox::new(
        &JointVector::from_fn(|i, _| open[i].lower.velocity),
        &JointVector::from_fn(|i, _| open[i].upper.velocity),
    );
    let solution =
        DifferentialIk::smooth().solve(&jacobian, &twist, &free, &bounds, [Side::Free; 7]);

    let mut held = Held::default();
    for (side, open) in solution.active.into_iter().zip(&open) {
        let cause = match side {
            Side::Free => continue,
            Side::Lower => open.lower.cause,
            Side::Upper => open.upper.cause,
        };
        match cause {
            Cause::Velocity => held.velocity = true,
            Cause::Position => held.position = true,
            Cause::Acceleration => held.acceleration = true,
        }
    }
    let dq = solution.velocity;
    let next = Reference {
        // As a plan of the joints goes on, which may have come before: a robot differences
        // positions, and would take another rule for half of the acceleration in one cycle.
        q: reference.q + (reference.dq + dq) * (0.5 * CYCLE),
        dq,
        ddq: (dq - reference.dq) / CYCLE,
    };
    (next, held)
}

/// Velocities open to a joint in the next cycle.
///
/// It keeps below its cap and able to stop before the end of its range, and it comes there with an
/// acceleration that can be taken back in time. Where the bounds contradict each other jerk wins
/// over acceleration, and both over velocity and position: they are what the robot feels at once.
#[derive(Clone, Copy, Debug)]
struct Interval {
    lower: Bound,
    upper: Bound,
}

/// An end of an interval, and what put it there.
#[derive(Clone, Copy, Debug)]
struct Bound {
    /// `[rad/s]`.
    velocity: f64,
    cause: Cause,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    Velocity,
    Position,
    Acceleration,
}

impl Interval {
    fn of(i: usize, limits: &JointLimits, reference: &Reference, budget: &Budget) -> Self {
        let (q, dq, ddq) = (reference.q[i], reference.dq[i], reference.ddq[i]);
        let ramp = JERK_CAP * limits.jerk[i] * CYCLE;
        let most = ACCELERATION_CAP * limits.acceleration[i];
        let cap = (VELOCITY_CAP * limits.velocity[i]).min(HASTE * budget.joints[i].velocity);
        let felt = |a: f64| a.clamp(-most, most).clamp(ddq - ramp, ddq + ramp);
        // Upwards; downwards is the same in a mirror.
        let up = |v: f64, room: f64| {
            let stopping = (2.0 * BRAKING * room.max(0.0)).sqrt();
            let free = (fastest(cap - v, ramp), Cause::Velocity);
            let braked = (towards_stop(stopping - v, ramp), Cause::Position);
            if braked.0 < free.0 { braked } else { free }
        };
        let bound = |sign: f64, (a, cause): (f64, Cause)| {
            let a = sign * a;
            let felt = felt(a);
            Bound {
                velocity: dq + felt * CYCLE,
                cause: if felt == a {
                    cause
                } else {
                    Cause::Acceleration
                },
            }
        };
        Self {
            lower: bound(-1.0, up(-dq, q - limits.lower[i] - POSITION_MARGIN)),
            upper: bound(1.0, up(dq, limits.upper[i] - POSITION_MARGIN - q)),
        }
    }
}

/// The greatest acceleration of the next cycle, `[rad/s^2]`, after which a velocity that has `room`
/// left, `[rad/s]`, does not exceed its bound, if the acceleration then falls by `ramp` a cycle.
/// Without room, the one that brings it back.
///
/// From an acceleration between `n` and `n + 1` ramps it takes `n` cycles to the last one that
/// still accelerates, and `(n + 1) a - n (n + 1) / 2 ramp` is what all of them add up to.
fn fastest(room: f64, ramp: f64) -> f64 {
    let rate = room / CYCLE;
    if rate <= 0.0 {
        return rate;
    }
    let n = (((1.0 + 8.0 * rate / ramp).sqrt() - 1.0) / 2.0).floor();
    (rate + ramp * n * (n + 1.0) / 2.0) / (n + 1.0)
}

/// The same below a bound that falls with the deceleration of a joint that stops. At the bound the
/// joint need not slow down before it moves.
fn towards_stop(room: f64, ramp: f64) -> f64 {
    (fastest(room, ramp) - BRAKING).max((room / CYCLE).min(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::READY;
    use nalgebra::{Isometry3, Translation3, Vector3};

    /// A pose that moves on from that of `reference` as its joints move it.
    fn taken_up(model: &Model, ee: &EndEffector, reference: &Reference) -> MovingPose {
        let twist = model.zero_jacobian(Frame::EndEffector, &reference.q, ee) * reference.dq;
        let now = rigid(&model.pose(Frame::EndEffector, &reference.q, ee));
        let turn = Vector3::new(twist[3], twist[4], twist[5]) * CYCLE;
        MovingPose {
            pose: Isometry3::from_parts(
                Translation3::from(
                    now.translation.vector + twist.fixed_rows::<3>(0).into_owned() * CYCLE,
                ),
                rotation::exp(&turn) * now.rotation,
            ),
            twist,
        }
    }

    #[test]
    fn joints_that_begin_to_follow_their_own_pose_go_on_without_a_kick() {
        for model in [Model::fr3(), Model::fer()] {
            let (ee, budget) = (EndEffector::default(), Budget::of(model.joint_limits()));
            let moving = Reference {
                dq: JointVector::from_fn(|i, _| 0.1 * (i as f64 - 3.0)),
                ..Reference::at_rest(READY)
            };
            let pose = taken_up(model, &ee, &moving);
            let mut drift = Drift::of(moving.dq);
            let (next, held) = follow(model, &ee, &READY, &mut drift, &moving, &pose, &budget);
            assert!(!held.any(), "{held:?}");
            // What is left is the fading drift, and the curvature of the way.
            assert!(next.ddq.amax() < 0.3, "{}", next.ddq);
        }
    }

    #[test]
    fn an_interval_is_never_beyond_one_cycle_of_acceleration_and_of_jerk() {
        let limits = Model::fr3().joint_limits();
        for sign in [-1.0, 1.0] {
            let moving = Reference {
                dq: JointVector::from_fn(|i, _| 3.0 - i as f64),
                ddq: limits.acceleration * sign,
                ..Reference::at_rest(READY)
            };
            for i in 0..7 {
                let open = Interval::of(i, limits, &moving, &Budget::of(limits));
                for bound in [open.lower, open.upper] {
                    let ddq = (bound.velocity - moving.dq[i]) / CYCLE;
                    assert!(ddq.abs() <= ACCELERATION_CAP * limits.acceleration[i] + 1e-9);
                    assert!((ddq - moving.ddq[i]).abs() <= limits.jerk[i] * CYCLE);
                }
            }
        }
    }

    #[test]
    fn a_joint_inside_its_margin_may_only_leave_it() {
        let limits = Model::fr3().joint_limits();
        let mut q = READY;
        q[3] = limits.upper[3] - 0.5 * POSITION_MARGIN;
        let open = Interval::of(3, limits, &Reference::at_rest(q), &Budget::of(limits));
        assert_eq!(open.upper.velocity, 0.0);
        assert_eq!(open.upper.cause, Cause::Position);
        assert!(open.lower.velocity < 0.0);
    }

    /// Drives joint `i` upwards as hard as it may, for a second and a half.
    fn drive(i: usize, model: &Model, mut reference: Reference, budget: &Budget) -> Vec<Reference> {
        let limits = model.joint_limits();
        let mut passed = Vec::new();
        for _ in 0..1500 {
            let dq = Interval::of(i, limits, &reference, budget).upper.velocity;
            reference.ddq[i] = (dq - reference.dq[i]) / CYCLE;
            reference.dq[i] = dq;
            reference.q[i] += dq * CYCLE;
            passed.push(reference);
        }
        passed
    }

    #[test]
    fn a_joint_comes_to_its_cap_and_to_the_end_of_its_range_within_its_jerk() {
        for model in [Model::fr3(), Model::fer()] {
            let limits = model.joint_limits();
            for i in 0..7 {
                for speed in [0.02, 0.3, 1.0, 5.0] {
                    let budget = Budget::of(limits).scaled(speed);
                    let mut q = READY;
                    q[i] = limits.upper[i] - POSITION_MARGIN - 0.3;
                    let cap =
                        (HASTE * budget.joints[i].velocity).min(VELOCITY_CAP * limits.velocity[i]);
                    let mut last = 0.0;
                    for now in drive(i, model, Reference::at_rest(q), &budget) {
                        let (v, a) = (now.dq[i], now.ddq[i]);
                        let case = (i + 1, speed, v, a);
                        assert!(v <= cap + 1e-12, "{case:?}");
                        assert!(a.abs() <= limits.acceleration[i], "{case:?}");
                        assert!((a - last).abs() <= limits.jerk[i] * CYCLE, "{case:?}");
                        let beyond = now.q[i] - (limits.upper[i] - POSITION_MARGIN);
                        assert!(beyond < 1e-4, "{case:?}: {beyond} rad");
                        last = a;
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_left_of_a_motion_over_the_joints_fades_without_a_step() {
        let mut drift = Drift::of(JointVector::repeat(1.0));
        let mut last = 1.0;
        for _ in 0..300 {
            let share = drift.share();
            assert!(share <= last && last - share < 1.5 * CYCLE / FADE + 1e-12);
            last = share;
        }
        assert!(last < 1e-9);
        assert!(drift.share() < 1e-12);
    }
}
