//! Step two where no cruise fits: slow down first, and go for the target late.
//!
//! Needed where an axis is slowing down into a target just past its stop point and should lose a
//! little time, up to a fifth of the duration. It follows its least-time stop for a while, and then
//! takes the least-time profile to the target from where that has led. The duration of the whole
//! grows with the while: from the least at zero, since what follows a piece of one profile is a
//! profile with that piece fixed, which cannot be better than one with a shorter piece fixed; and
//! continuously, to that of coming to a rest and moving on from there. A longer one waits at that
//! rest. So every duration has its profile. None overshoots: along a stop the stop point stays
//! where it is, short of the target, and from there the way is a push and a stop.
//!
//! A target that is the stop point itself has no way to be late without overshooting; what is said
//! above then gives the stop, and a wait at the target.
//!
//! Lowering the acceleration limit instead slows down more gently, but beyond the gentlest stop
//! that ends at the target there is nothing left to lower: the axis would be early, or overshoot.

use crate::brake::Pieces;
use crate::given_duration::{Lasting, SAME};
use crate::least_time::{Least, least_time};
use crate::root::{Point, root};
use crate::task::Task;
use crate::transfer::stop;

/// The profile of `duration` that follows the stop first, in the frame of `least`, which takes
/// less.
pub(crate) fn late_push(least: &Least, duration: f64) -> Lasting {
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
        return Lasting::new(before, &last);
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
    Lasting::new(before, &least_time(left))
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
