//! Step two where no cruise fits: follow the stop for a while, then go to the target.
//!
//! Needed where an axis slows down into a target just past its stop point and should arrive a
//! little later, by up to a fifth of the duration. It follows its least-time stop for a while, and
//! then takes the least-time profile from there to the target. The total duration grows with that
//! while: it is the least duration at zero, since a profile with its first piece fixed cannot be
//! faster than one with a shorter piece fixed; and it is continuous, up to the duration of stopping
//! and moving on from rest. For a longer duration the axis waits at that rest. So every duration
//! has its profile. None overshoots: along a stop the stop point is constant and short of the
//! target, and from there the rest is a push and a stop.
//!
//! A target that is the stop point itself cannot be reached later without overshooting; the rule
//! above then gives the stop, and a wait at the target.
//!
//! Lowering the acceleration limit instead slows down more gently, but past the gentlest stop
//! that ends at the target there is nothing to lower: the axis would be early, or overshoot.

use crate::brake::Pieces;
use crate::least_time::{LeastTime, least_time};
use crate::root::{Point, root};
use crate::shape::Stretched;
use crate::task::{SAME, Task};
use crate::transfer::stop;

/// The profile of `duration` that follows the stop first, in the frame of `least`, which takes
/// less.
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
    /// The first `theta` of it, and what is left of the task then.
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
