//! Asynchronous joint positions. The robot plans a motion from its current state to rest at a
//! target.
//!
//! All joints share one duration and move along polynomials of fifth degree. The polynomials start
//! with the current velocity and acceleration, and end at rest. Durations are tried in steps of
//! five percent. The shortest duration that keeps velocity, acceleration and jerk within their
//! bounds is used. If no such duration exists (for example, if a joint moves fast away from the
//! target), the joints brake first.

use franka_model::limits::JointLimits;
use franka_model::{CYCLE, JointVector};

use crate::brake::Brake;
use crate::signal::JointSignal;

/// Generator of an asynchronous motion.
#[derive(Debug, Clone)]
pub(crate) struct PointToPoint {
    bounds: Bounds,
    plan: Plan,
}

#[derive(Debug, Clone)]
enum Plan {
    Resting,
    Moving(Box<Profile>),
    Braking {
        brake: Box<Brake>,
        target: JointVector,
    },
}

#[derive(Debug, Clone)]
struct Bounds {
    velocity: JointVector,
    acceleration: JointVector,
    jerk: JointVector,
}

impl PointToPoint {
    /// Returns a generator without a target. `velocity` is the largest velocity of each joint,
    /// `[rad/s]`.
    pub(crate) fn new(velocity: &JointVector, limits: &JointLimits) -> Self {
        Self {
            bounds: Bounds {
                velocity: *velocity,
                acceleration: limits.acceleration * SHARE,
                jerk: limits.jerk * SHARE,
            },
            plan: Plan::Resting,
        }
    }

    /// Replaces the target, `[rad]`; `now` is the current state of the joints.
    pub(crate) fn go_to(&mut self, target: &JointVector, now: &JointSignal) {
        self.plan = match Profile::plan(now, target, &self.bounds) {
            Some(profile) => Plan::Moving(Box::new(profile)),
            None => Plan::Braking {
                brake: Box::new(Brake::from(
                    now,
                    &self.bounds.acceleration,
                    &self.bounds.jerk,
                )),
                target: *target,
            },
        };
    }

    /// True if the generator has no target or has reached it.
    pub(crate) fn is_over(&self) -> bool {
        matches!(self.plan, Plan::Resting)
    }

    /// State of the joints one cycle after `now`.
    pub(crate) fn advance(&mut self, now: &JointSignal) -> JointSignal {
        let next = match &mut self.plan {
            Plan::Resting => return JointSignal::resting(now.q),
            Plan::Moving(profile) => {
                profile.elapsed += CYCLE;
                profile.now()
            }
            Plan::Braking { brake, .. } => brake.advance(CYCLE),
        };
        match &self.plan {
            Plan::Moving(profile) if profile.elapsed >= profile.duration => {
                self.plan = Plan::Resting;
            }
            Plan::Braking { brake, target } if brake.is_over() => {
                let target = *target;
                self.go_to(&target, &next);
            }
            _ => {}
        }
        next
    }
}

/// Fifth-degree polynomials in time, one per joint: coefficients in rising order.
#[derive(Debug, Clone)]
struct Profile {
    coefficients: [[f64; 6]; 7],
    duration: f64,
    elapsed: f64,
}

impl Profile {
    fn plan(now: &JointSignal, target: &JointVector, bounds: &Bounds) -> Option<Self> {
        // The largest derivatives of a motion from rest are 15/8 d/T, 10/√3 d/T² and 60 d/T³.
        let mut duration: f64 = CYCLE;
        for i in 0..7 {
            let distance = (target[i] - now.q[i]).abs();
            duration = duration
                .max(1.875 * distance / bounds.velocity[i])
                .max((5.7736 * distance / bounds.acceleration[i]).sqrt())
                .max((60.0 * distance / bounds.jerk[i]).cbrt());
        }
        for _ in 0..TRIALS {
            let profile = Self::lasting(now, target, duration);
            if profile.keeps(bounds) {
                return Some(profile);
            }
            duration *= 1.05;
        }
        None
    }

    fn lasting(now: &JointSignal, target: &JointVector, duration: f64) -> Self {
        let t = duration;
        let coefficients = core::array::from_fn(|i| {
            let (q, v, a) = (now.q[i], now.dq[i], now.ddq[i]);
            let d = target[i] - q;
            [
                q,
                v,
                a / 2.0,
                (10.0 * d - 6.0 * v * t - 1.5 * a * t * t) / t.powi(3),
                (-15.0 * d + 8.0 * v * t + 1.5 * a * t * t) / t.powi(4),
                (6.0 * d - 3.0 * v * t - 0.5 * a * t * t) / t.powi(5),
            ]
        });
        Self {
            coefficients,
            duration,
            elapsed: 0.0,
        }
    }

    fn keeps(&self, bounds: &Bounds) -> bool {
        (0..=SAMPLES).all(|k| {
            let t = self.duration * f64::from(k) / f64::from(SAMPLES);
            (0..7).all(|i| {
                let [_, v, a, j] = derivatives(&self.coefficients[i], t);
                v.abs() <= bounds.velocity[i] * (1.0 + SLACK)
                    && a.abs() <= bounds.acceleration[i] * (1.0 + SLACK)
                    && j.abs() <= bounds.jerk[i] * (1.0 + SLACK)
            })
        })
    }

    fn now(&self) -> JointSignal {
        let t = self.elapsed.min(self.duration);
        let mut signal = JointSignal::resting(JointVector::zeros());
        for i in 0..7 {
            let [q, v, a, _] = derivatives(&self.coefficients[i], t);
            (signal.q[i], signal.dq[i], signal.ddq[i]) = (q, v, a);
        }
        if self.elapsed >= self.duration {
            signal = JointSignal::resting(signal.q);
        }
        signal
    }
}

/// Position, velocity, acceleration and jerk at time `t`.
fn derivatives(c: &[f64; 6], t: f64) -> [f64; 4] {
    [
        c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5])))),
        c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * 5.0 * c[5]))),
        2.0 * c[2] + t * (6.0 * c[3] + t * (12.0 * c[4] + t * 20.0 * c[5])),
        6.0 * c[3] + t * (24.0 * c[4] + t * 60.0 * c[5]),
    ]
}

/// Share of the nominal acceleration and jerk that a plan uses, because the samples may miss an
/// extreme.
const SHARE: f64 = 0.9;
/// Relative tolerance of the bounds for rounding errors.
const SLACK: f64 = 1e-6;
/// Number of points at which a plan is checked.
const SAMPLES: u32 = 50;
/// Number of durations to try; the last is 17 times the first.
const TRIALS: u32 = 60;

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::{Model, READY};

    fn check(a: &JointSignal, b: &JointSignal, velocity: f64) {
        assert!(b.dq.amax() <= velocity * 1.001, "{}", b.dq);
        assert!(b.ddq.amax() <= 10.0);
        assert!((b.ddq - a.ddq).amax() <= 5000.0 * CYCLE);
        assert!((b.q - a.q).amax() <= velocity * 1.001 * CYCLE);
    }

    #[test]
    fn reaches_a_target_at_rest_within_the_velocity_given() {
        let velocity = JointVector::repeat(0.655);
        let mut generator = PointToPoint::new(&velocity, Model::fr3().joint_limits());
        let mut now = JointSignal::resting(READY);
        let target = READY.add_scalar(0.3);
        generator.go_to(&target, &now);
        for _ in 0..2000 {
            let next = generator.advance(&now);
            check(&now, &next, 0.655);
            now = next;
        }
        assert!((now.q - target).amax() < 1e-9);
        assert_eq!(now.dq, JointVector::zeros());
    }

    #[test]
    fn replans_from_motion_without_a_jump() {
        let velocity = JointVector::repeat(1.0);
        for wait in [50, 150, 300, 500] {
            let mut generator = PointToPoint::new(&velocity, Model::fr3().joint_limits());
            let mut now = JointSignal::resting(READY);
            generator.go_to(&READY.add_scalar(0.5), &now);
            for cycle in 0..4000 {
                if cycle == wait {
                    generator.go_to(&READY.add_scalar(-0.2), &now);
                }
                let next = generator.advance(&now);
                check(&now, &next, 1.0);
                now = next;
            }
            assert!((now.q - READY.add_scalar(-0.2)).amax() < 1e-9, "{wait}");
        }
    }

    #[test]
    fn a_target_that_is_here_is_reached_at_once() {
        let velocity = JointVector::repeat(1.0);
        let mut generator = PointToPoint::new(&velocity, Model::fr3().joint_limits());
        let now = JointSignal::resting(READY);
        generator.go_to(&READY, &now);
        assert!((generator.advance(&now).q - READY).amax() < 1e-12);
    }
}
