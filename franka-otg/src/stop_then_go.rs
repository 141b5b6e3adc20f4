//! Step two if no cruise fits: the axis follows its stop for a while, and then moves to the target.
//!
//! This case occurs if an axis slows down towards a target just past its stop point, and must
//! arrive slightly later (by up to a fifth of the duration). The axis follows its least-time stop
//! for some time, and then takes the least-time profile to the target. The total duration grows
//! continuously with the time on the stop, because a profile with a longer fixed first piece cannot
//! be faster. It begins with the least duration, and ends with the duration of a complete stop and
//! a motion from rest. For a still longer duration, the axis waits at rest. Therefore every
//! duration has a profile. No profile overshoots: during the stop, the stop point is constant and
//! short of the target, and the rest of the motion is a push and a stop.
//!
//! If the target is exactly at the stop point, the axis cannot arrive later without overshoot. The
//! result is then the stop, followed by a wait at the target.
//!
//! A lower acceleration limit would slow down the axis more gently. However, the gentlest stop that
//! ends at the target has a certain duration. For longer durations, such an axis would be early or
//! overshoot.

use crate::brake::Pieces;
use crate::least_time::{LeastTime, least_time};
use crate::root::{Point, root};
use crate::shape::Stretched;
use crate::task::{SAME, Task};
use crate::transfer::stop;

/// Returns the profile of `duration` that follows the stop first, in the frame of `least`.
/// `duration` must be longer than the duration of `least`.
pub(crate) fn stop_then_go(least: &LeastTime, duration: f64) -> Stretched {
    let task = least.task;
    let (sign, times) = stop(task.v, task.a);
    let stop = Stop { task, sign, times };
    let whole: f64 = times.iter().sum();
    let (mut before, rest) = stop.after(whole);
    let rest = Task {
        v: 0.0,
        a: 0.0,
        ..rest
    };
    let last = least_time(rest);
    let wait = duration - whole - last.duration;
    if wait >= 0.0 {
        before.push(rest, 0.0, wait);
        return stretched(before, &last);
    }
    let first = Point {
        at: 0.0,
        value: least.duration - duration,
    };
    let end = Point {
        at: whole,
        value: -wait,
    };
    let theta = root(first, end, SAME * duration, |theta| {
        theta + least_time(stop.after(theta).1).duration - duration
    });
    let (before, left) = stop.after(theta);
    stretched(before, &least_time(left))
}

/// The least-time stop of a task.
struct Stop {
    task: Task,
    sign: f64,
    times: [f64; 3],
}

impl Stop {
    /// Returns the first `theta` of time of the stop, and the remaining task.
    fn after(&self, theta: f64) -> (Pieces, Task) {
        let (mut pieces, mut task, mut left) = (Pieces::NONE, self.task, theta);
        for (jerk, t) in [self.sign, 0.0, -self.sign].into_iter().zip(self.times) {
            task = pieces.push(task, jerk, t.min(left));
            left -= t;
        }
        (pieces, task)
    }
}

fn stretched(before: Pieces, least: &LeastTime) -> Stretched {
    Stretched {
        before,
        sign: least.sign,
        shape: least.shape,
    }
}
