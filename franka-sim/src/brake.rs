//! Time-optimal stop of each joint under bounded acceleration and jerk.

use franka_model::JointVector;

use crate::signal::JointSignal;

/// A stop in progress. Every joint stops in its own shortest time.
#[derive(Debug, Clone)]
pub(crate) struct Brake {
    axes: [AxisStop; 7],
    elapsed: f64,
}

impl Brake {
    /// Plans the stop from `start` under the bounds on acceleration `[rad/s²]` and jerk
    /// `[rad/s³]`.
    pub(crate) fn from(
        start: &JointSignal,
        acceleration: &JointVector,
        jerk: &JointVector,
    ) -> Self {
        Self {
            axes: core::array::from_fn(|i| {
                AxisStop::plan(
                    start.q[i],
                    start.dq[i],
                    start.ddq[i],
                    acceleration[i],
                    jerk[i],
                )
            }),
            elapsed: 0.0,
        }
    }

    /// Advances by `dt` seconds, and returns the joint signal at that time.
    pub(crate) fn advance(&mut self, dt: f64) -> JointSignal {
        self.elapsed += dt;
        let mut signal = JointSignal::resting(JointVector::zeros());
        for (i, axis) in self.axes.iter().enumerate() {
            (signal.q[i], signal.dq[i], signal.ddq[i]) = axis.at(self.elapsed);
        }
        signal
    }

    /// True if all joints have stopped.
    pub(crate) fn is_over(&self) -> bool {
        self.axes.iter().all(|axis| self.elapsed >= axis.duration())
    }
}

/// The stop of one joint in three phases of constant jerk: deceleration rises to its peak, stays
/// there, and returns to zero.
#[derive(Debug, Clone, Copy)]
struct AxisStop {
    position: f64,
    velocity: f64,
    acceleration: f64,
    /// Duration `[s]` and jerk `[1/s³]` of each phase.
    phases: [(f64, f64); 3],
}

impl AxisStop {
    fn plan(position: f64, velocity: f64, acceleration: f64, limit: f64, jerk: f64) -> Self {
        // `left` is the velocity that would remain if the acceleration now fell to zero. Its sign
        // decides the direction of the peak. The problem is mirrored to make this velocity positive
        // and the peak negative.
        let left = velocity + acceleration * acceleration.abs() / (2.0 * jerk);
        let side = if left < 0.0 { -1.0 } else { 1.0 };
        let (v, a) = (side * velocity, side * acceleration);
        let peak = (jerk * v + a * a / 2.0).max(0.0).sqrt().max(-a);
        // An acceleration beyond the limit cannot be avoided; it can only be reduced.
        let peak = peak.min(limit.max(-a));
        let ramp = ((a + peak) / jerk).max(0.0);
        let release = peak / jerk;
        let v_lost = (2.0 * peak * peak - a * a) / (2.0 * jerk);
        let hold = if peak > 0.0 {
            ((v - v_lost) / peak).max(0.0)
        } else {
            0.0
        };
        Self {
            position,
            velocity,
            acceleration,
            phases: [(ramp, -side * jerk), (hold, 0.0), (release, side * jerk)],
        }
    }

    fn duration(&self) -> f64 {
        self.phases.iter().map(|(duration, _)| duration).sum()
    }

    /// Position, velocity and acceleration after `time`; at rest once the stop is over.
    fn at(&self, time: f64) -> (f64, f64, f64) {
        let (mut q, mut v, mut a) = (self.position, self.velocity, self.acceleration);
        let mut left = time;
        for (duration, jerk) in self.phases {
            let t = left.min(duration);
            q += t * (v + t * (a / 2.0 + t * jerk / 6.0));
            v += t * (a + t * jerk / 2.0);
            a += t * jerk;
            left -= t;
        }
        if left >= 0.0 && time >= self.duration() {
            (q, 0.0, 0.0)
        } else {
            (q, v, a)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: f64 = 10.0;
    const JERK: f64 = 5000.0;

    #[test]
    fn stops_from_any_state_within_its_bounds() {
        for v in [-2.6, -0.5, -0.001, 0.0, 0.004, 0.3, 2.6] {
            for a in [-10.0, -4.0, 0.0, 0.1, 9.9] {
                let stop = AxisStop::plan(1.0, v, a, LIMIT, JERK);
                let duration = stop.duration();
                assert!(duration < 0.3, "{v} {a}: {duration}");
                let mut last = (1.0, v, a);
                for k in 1..=400 {
                    let now = stop.at(f64::from(k) * 1e-3);
                    assert!(now.2.abs() <= LIMIT + 1e-9, "{v} {a}: {now:?}");
                    assert!((now.2 - last.2).abs() <= JERK * 1e-3 + 1e-6, "{v} {a}");
                    assert!((now.1 - last.1).abs() <= LIMIT * 1e-3 + 1e-9, "{v} {a}");
                    assert!((now.0 - last.0).abs() <= 2.7e-3, "{v} {a}");
                    last = now;
                }
                // Checks that the last phase itself ends at rest, because `at` returns rest after
                // the end in any case.
                let (_, v_end, a_end) = stop.at(duration - 1e-9);
                assert!(
                    v_end.abs() < 1e-6 && a_end.abs() < 1e-4,
                    "{v} {a}: {v_end} {a_end}"
                );
            }
        }
    }

    #[test]
    fn a_resting_arm_is_already_stopped() {
        let start = JointSignal::resting(JointVector::repeat(0.4));
        let limit = JointVector::repeat(LIMIT);
        let mut brake = Brake::from(&start, &limit, &JointVector::repeat(JERK));
        assert!(brake.is_over());
        assert_eq!(brake.advance(1e-3), start);
    }
}
