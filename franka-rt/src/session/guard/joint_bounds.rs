//! Bounds of the joints on the way to a pose: velocity cap, position envelope, acceleration and
//! jerk.

use franka_model::JointVector;
use franka_model::limits::JointLimits;

use crate::session::Budget;
use crate::session::reference::Reference;
use crate::shaping::CYCLE;

/// Share of each joint's velocity limit that the reference may use.
const VELOCITY_CAP: f64 = 0.7;

/// Factor by which a joint may exceed the velocity of its budget on the way to a pose. On a
/// straight line near a singular posture, joints turn fast while the hand hardly moves. A person
/// next to the arm does not expect this. A factor of 2 would needlessly slow an arm that stretches
/// at the default pace.
const HASTE: f64 = 3.0;

/// Share of each joint's acceleration limit that the reference may use.
const ACCELERATION_CAP: f64 = 0.9;

/// Share of each joint's jerk limit that the reference may use.
const JERK_CAP: f64 = 0.9;

/// Share of the jerk limit that may be used in the first cycle after a plan of the joints. The
/// acceleration of a plan grows within a cycle, but here it steps between two cycles. The robot
/// differentiates positions numerically: it sees five sixths of the jerk in the plan's last two
/// cycles and half of this step at the same time.
const TAKE_OVER_JERK_CAP: f64 = 1.0 / 3.0;

/// Distance that is kept from the ends of each joint's range, `[rad]`.
const POSITION_MARGIN: f64 = 0.05;

/// Deceleration with which a joint must be able to stop before that margin, `[rad/s^2]`. It is less
/// than half of the robot's own value for joint 2, which has the gentlest velocity envelope
/// (2.585). A margin is needed because the arm follows the reference like a spring and overshoots
/// when the reference slows down.
pub(crate) const BRAKING: f64 = 1.2;

/// Bounds that limited joints in a cycle. A field is true or has a value if its bound did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoundsReached {
    /// Velocity cap of a joint.
    pub(crate) velocity: bool,
    /// End of a joint's range.
    pub(crate) position: bool,
    /// Acceleration or jerk limit of a joint.
    pub(crate) acceleration: bool,
    /// Factor that reduced the joint velocities because a point of the arm reached the speed cap.
    pub(crate) speed: Option<f64>,
}

impl BoundsReached {
    pub(crate) fn any(self) -> bool {
        self != Self::default()
    }
}

/// Velocities that a joint may have in the next cycle.
///
/// The joint must stay below its velocity cap and must be able to stop before the end of its range,
/// with an acceleration that can be removed in time. If the bounds contradict each other, jerk has
/// priority over acceleration, and both have priority over velocity and position, because jerk and
/// acceleration act on the robot at once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenVelocities {
    pub(crate) lower: Bound,
    pub(crate) upper: Bound,
}

/// One end of an interval, and what caused it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bound {
    /// Velocity, `[rad/s]`.
    pub(crate) velocity: f64,
    pub(crate) cause: Cause,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    Velocity,
    Position,
    Acceleration,
}

impl OpenVelocities {
    /// Returns the bounds for joint `i`. `takes_over` is true if the joint was at rest, or a plan
    /// of the joints moved it until now.
    pub(crate) fn of(
        i: usize,
        limits: &JointLimits,
        reference: &Reference,
        budget: &Budget,
        takes_over: bool,
    ) -> Self {
        let (q, dq, ddq) = (reference.q[i], reference.dq[i], reference.ddq[i]);
        let jerk_cap = match takes_over {
            true => TAKE_OVER_JERK_CAP,
            false => JERK_CAP,
        };
        let ramp = jerk_cap * limits.jerk[i] * CYCLE;
        let most = ACCELERATION_CAP * limits.acceleration[i];
        let cap = (VELOCITY_CAP * limits.velocity[i]).min(HASTE * budget.joints[i].velocity);
        let felt = |a: f64| a.clamp(-most, most).clamp(ddq - ramp, ddq + ramp);
        // Bounds in the upward direction. The downward direction is the mirror image.
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

/// Returns how far each joint at `q` may turn down and up, `[rad]`, if time does not matter. The
/// joint may turn to the margin of its range; beyond the margin, it may not turn.
pub(crate) fn room(limits: &JointLimits, q: &JointVector) -> (JointVector, JointVector) {
    let lower = limits.lower.add_scalar(POSITION_MARGIN) - q;
    let upper = limits.upper.add_scalar(-POSITION_MARGIN) - q;
    (
        lower.map(|room| room.min(0.0)),
        upper.map(|room| room.max(0.0)),
    )
}

/// Returns the distance of each joint at `q` from the nearer end of its range, margin included,
/// `[rad]`.
pub(crate) fn distance_to_end(limits: &JointLimits, q: &JointVector) -> JointVector {
    let (lower, upper) = room(limits, q);
    upper.inf(&-lower)
}

/// Returns the first joint, from 1, that is at an end of its range, margin included, at `q`.
pub(crate) fn at_end(limits: &JointLimits, q: &JointVector) -> Option<usize> {
    let (lower, upper) = room(limits, q);
    (0..7)
        .find(|&i| lower[i] > -1e-6 || upper[i] < 1e-6)
        .map(|i| i + 1)
}

/// Returns the greatest acceleration of the next cycle, `[rad/s^2]`, for a joint whose velocity is
/// `room` below its bound, `[rad/s]`. With it, the velocity stays within its bound if the
/// acceleration afterwards falls by `ramp` per cycle. If `room` is negative, the acceleration
/// returns the velocity to its bound.
///
/// An acceleration `a` between `n` and `n + 1` ramps stays positive for `n` more cycles. The sum of
/// all these accelerations is `(n + 1) a - n (n + 1) / 2 ramp`.
fn fastest(room: f64, ramp: f64) -> f64 {
    let rate = room / CYCLE;
    if rate <= 0.0 {
        return rate;
    }
    let n = (((1.0 + 8.0 * rate / ramp).sqrt() - 1.0) / 2.0).floor();
    (rate + ramp * n * (n + 1.0) / 2.0) / (n + 1.0)
}

/// Same as [`fastest`], for a bound that falls with the deceleration of a stopping joint. A joint
/// at this bound need not slow down before the bound falls.
fn towards_stop(room: f64, ramp: f64) -> f64 {
    (fastest(room, ramp) - BRAKING).max((room / CYCLE).min(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::{Model, READY};

    #[test]
    fn velocity_interval_respects_acceleration_and_jerk() {
        let limits = Model::fr3().joint_limits();
        for sign in [-1.0, 1.0] {
            let moving = Reference {
                dq: JointVector::from_fn(|i, _| 3.0 - i as f64),
                ddq: limits.acceleration * sign,
                ..Reference::at_rest(READY)
            };
            for i in 0..7 {
                let open = OpenVelocities::of(i, limits, &moving, &Budget::of(limits), false);
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
        let rests = Reference::at_rest(q);
        let open = OpenVelocities::of(3, limits, &rests, &Budget::of(limits), true);
        assert_eq!(open.upper.velocity, 0.0);
        assert_eq!(open.upper.cause, Cause::Position);
        assert!(open.lower.velocity < 0.0);
    }

    /// Drives joint `i` upward as fast as the bounds allow, for 1.5 seconds.
    fn drive(i: usize, model: &Model, mut reference: Reference, budget: &Budget) -> Vec<Reference> {
        let limits = model.joint_limits();
        let mut passed = Vec::new();
        for _ in 0..1500 {
            let dq = OpenVelocities::of(i, limits, &reference, budget, false)
                .upper
                .velocity;
            reference.ddq[i] = (dq - reference.dq[i]) / CYCLE;
            reference.dq[i] = dq;
            reference.q[i] += dq * CYCLE;
            passed.push(reference);
        }
        passed
    }

    #[test]
    fn joint_meets_velocity_cap_and_range_end_within_jerk() {
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
}
