//! Brings a state outside the limits back into them.
//!
//! States outside the limits come from measurements and from lowered limits. The brake returns such
//! a state into the limits as early as possible. It uses full jerk, then the acceleration limit,
//! until the velocity is at its limit and will stay there. This rule is a convention and does not
//! always yield the shortest motion. Other rules may be shorter, but the velocity then exceeds its
//! limit for longer. The state is never clamped, because a clamp would be a step in the command to
//! the robot.

use crate::scalar::sqrt;
use crate::task::Task;

/// Pieces of a motion before its shape: jerks in units of the limit, and their durations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pieces {
    list: [(f64, f64); 4],
    len: usize,
}

impl Pieces {
    pub(crate) const NONE: Self = Self {
        list: [(0.0, 0.0); 4],
        len: 0,
    };

    pub(crate) fn iter(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.list[..self.len].iter().copied()
    }

    pub(crate) fn duration(&self) -> f64 {
        self.iter().map(|(_, t)| t).sum()
    }

    /// Appends a piece, and returns the remaining task.
    pub(crate) fn push(&mut self, task: Task, jerk: f64, t: f64) -> Task {
        // Pieces have positive durations; NaN cannot occur here.
        if t > 0.0 && self.len < self.list.len() {
            self.list[self.len] = (jerk, t);
            self.len += 1;
            task.after(jerk, t)
        } else {
            task
        }
    }
}

/// Brakes the task into its limits. Does nothing if the task is within its limits and can stay
/// within them.
pub(crate) fn into_limits(task: Task) -> (Pieces, Task) {
    let mut pieces = Pieces::NONE;
    let mut task = task;
    if task.a.abs() > 1.0 + TOLERANCE {
        let sign = 1_f64.copysign(task.a);
        task = pieces.push(task, -sign, task.a.abs() - 1.0);
    }
    let top = task.top * (1.0 + TOLERANCE);
    let (v, a, coasting) = (task.v, task.a, task.coasting_velocity());
    let too_high = (v > top && coasting >= -top) || (a > 0.0 && coasting > top);
    let too_low = (v < -top && coasting <= top) || (a < 0.0 && coasting < -top);
    if too_high {
        task = slow_down(&mut pieces, task, 1.0);
    } else if too_low {
        task = slow_down(&mut pieces, task, -1.0);
    }
    // If the velocity exceeds the limit only by rounding, this plan uses the velocity as the
    // limit.
    let coasting = task.coasting_velocity().abs();
    if coasting <= task.top * (1.0 + 4.0 * TOLERANCE) {
        task.top = task.top.max(coasting);
    }
    (pieces, task)
}

/// Reduces a velocity that exceeds the limit, or will exceed it, to the limit. The velocity is
/// positive in the mirrored frame.
fn slow_down(pieces: &mut Pieces, task: Task, sign: f64) -> Task {
    let Task { v, a, top, .. } = task.mirrored(sign);
    let to_acceleration_limit = a + 1.0;
    let to_top = a + sqrt((a * a + 2.0 * (v - top)).max(0.0));
    // The deceleration must be reduced by then, or the velocity would fall below the lower limit.
    let to_undershoot = a + sqrt((0.5 * a * a + v + top).max(0.0));
    let ramp = to_top.min(to_undershoot);
    if to_acceleration_limit >= ramp {
        return pieces.push(task, -sign, ramp);
    }
    let task = pieces.push(task, -sign, to_acceleration_limit);
    let v = sign * task.v;
    let hold = (v - top).min(v + top - 0.5);
    pieces.push(task, 0.0, hold)
}

/// Largest excess over a limit that counts as rounding.
const TOLERANCE: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;

    fn task(v: f64, a: f64, top: f64) -> Task {
        Task {
            d: 0.0,
            v,
            a,
            top,
            fuzz: 0.0,
        }
    }

    #[test]
    fn a_state_inside_the_limits_is_left_alone() {
        for (v, a) in [
            (0.0, 0.0),
            (9.0, -1.0),
            (-9.4, -1.0),
            (9.5, 1.0),
            (10.0, 0.0),
        ] {
            assert_eq!(into_limits(task(v, a, 10.0)).0.duration(), 0.0, "{v} {a}");
        }
    }

    #[test]
    fn after_braking_the_velocity_can_be_kept_inside() {
        for v in [-80.0, -11.0, -3.0, 0.0, 2.0, 9.9, 10.5, 300.0] {
            for a in [-40.0, -1.5, -1.0, -0.2, 0.0, 0.4, 1.0, 1.1, 25.0] {
                for top in [0.01, 0.3, 10.0] {
                    let (_, after) = into_limits(task(v, a, top));
                    let slack = 1e-11 * (top + v.abs() + a * a);
                    assert!(after.a.abs() <= 1.0 + 1e-12, "{v} {a} {top}");
                    assert!(
                        after.coasting_velocity().abs() <= top + slack,
                        "{v} {a} {top}: {after:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn braking_ends_as_soon_as_the_velocity_is_back() {
        // The cases: ramp only; ramp and hold; and a hold that is shortened, because the velocity
        // would otherwise fall below the lower limit.
        for (v, top, expected) in [(10.2, 10.0, 10.0), (12.0, 10.0, 10.0), (3.0, 0.1, 0.4)] {
            let (_, after) = into_limits(task(v, 0.0, top));
            assert!((after.v - expected).abs() < 1e-14, "{v} {top}: {after:?}");
        }
    }

    #[test]
    fn mirrored_states_brake_alike() {
        let (up, _) = into_limits(task(12.0, 1.3, 10.0));
        let (down, _) = into_limits(task(-12.0, -1.3, 10.0));
        for ((j, t), (k, u)) in up.iter().zip(down.iter()) {
            assert_eq!((j, t), (-k, u));
        }
    }
}
