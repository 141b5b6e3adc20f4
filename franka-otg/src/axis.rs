//! One axis from its state to its target: braking into the limits, the least time, a given
//! duration, and the resulting profile.

use crate::brake::{Pieces, into_limits};
use crate::cycle::CYCLE;
use crate::feasible_durations::FeasibleDurations;
use crate::given_duration::stretched;
use crate::least_time::{LeastTime, least_time};
use crate::limits::AxisLimits;
use crate::moving_target::{MovingTarget, Solution};
use crate::profile::Profile;
use crate::shape::Shape;
use crate::state::AxisState;
use crate::task::{ROUNDING, Task};
use crate::transfer::stop;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    start: AxisState,
    target: AxisState,
    limits: AxisLimits,
    /// Time unit of the axis, in seconds.
    unit: f64,
    brake: Pieces,
    /// Duration of the brake, in time units of the axis.
    braking: f64,
    motion: ToTarget,
}

/// The motion after the brake.
#[derive(Debug, Clone, Copy)]
enum ToTarget {
    AtRest(LeastTime),
    Moving(MovingTarget),
}

/// Reason why an axis has no plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Refusal {
    /// The quantities differ by too many orders of magnitude.
    OutOfRange,
    /// The limits do not allow the motion of the target.
    TargetMotion,
}

impl Axis {
    /// Finds the least-time motion.
    pub(crate) fn new(
        start: AxisState,
        target: AxisState,
        limits: AxisLimits,
    ) -> Result<Self, Refusal> {
        let (task, unit) = Task::new(start, target.position, limits).ok_or(Refusal::OutOfRange)?;
        let (brake, task) = into_limits(task);
        let motion = if target.is_at_rest() {
            ToTarget::AtRest(least_time(task))
        } else {
            let v = target.velocity / (limits.acceleration * unit);
            let a = target.acceleration / limits.acceleration;
            // The axis must reach the target from inside the limits, and must leave it inside the
            // limits.
            let fastest = v.abs() + 0.5 * a * a;
            if a.abs() > 1.0 + AT_LIMIT || fastest > task.top * (1.0 + AT_LIMIT) {
                return Err(Refusal::TargetMotion);
            }
            let size = start.position.abs().max(target.position.abs());
            let task = Task {
                top: task.top.max(fastest),
                fuzz: ROUNDING * size / (limits.jerk * unit * unit * unit),
                ..task
            };
            ToTarget::Moving(MovingTarget::new(&task, v, a))
        };
        Ok(Self {
            start,
            target,
            limits,
            unit,
            braking: brake.duration(),
            brake,
            motion,
        })
    }

    /// Returns the least duration of the motion, in seconds.
    pub(crate) fn least_duration(&self) -> f64 {
        let least = match &self.motion {
            ToTarget::AtRest(least) => least.duration,
            ToTarget::Moving(moving) => moving.least(),
        };
        self.unit * (self.braking + least)
    }

    /// Returns the smallest feasible duration that is not below `duration`. `duration` must not be
    /// below the least duration of the axis.
    pub(crate) fn from(&self, duration: f64) -> f64 {
        let ToTarget::Moving(moving) = &self.motion else {
            return duration;
        };
        let left = duration / self.unit - self.braking;
        let feasible = moving.from(left);
        if feasible == left {
            duration
        } else {
            self.unit * (self.braking + feasible)
        }
    }

    /// Returns the last feasible duration before `duration`, if `duration` is not feasible.
    pub(crate) fn before(&self, duration: f64) -> Option<f64> {
        let ToTarget::Moving(moving) = &self.motion else {
            return None;
        };
        let earlier = moving.before(duration / self.unit - self.braking)?;
        Some(self.unit * (self.braking + earlier))
    }

    /// Returns true if the axis can be at its target after `duration`, within rounding.
    pub(crate) fn can_take(&self, duration: f64) -> bool {
        let left = duration / self.unit - self.braking;
        match &self.motion {
            ToTarget::Moving(moving) => moving.can_take(left),
            ToTarget::AtRest(least) => least.duration <= left || earlier(least, left).is_some(),
        }
    }

    /// Replaces a motion to rest if its duration exceeds `duration` only by rounding.
    pub(crate) fn round_to(&mut self, duration: f64) {
        let left = duration / self.unit - self.braking;
        if let ToTarget::AtRest(least) = &mut self.motion
            && least.duration > left
            && let Some(earlier) = earlier(least, left)
        {
            *least = earlier;
        }
    }

    /// Writes the profile of `duration` seconds to `profile`. If the least-time profile takes
    /// longer, this is the least-time profile.
    ///
    /// After it passes a target in motion, the axis continues for a cycle and then stops in the
    /// least time.
    pub(crate) fn lay_out(&self, duration: f64, profile: &mut Profile) {
        let left = duration / self.unit - self.braking;
        match &self.motion {
            ToTarget::AtRest(least) => {
                self.begin(profile);
                let solution = stretched(least, left);
                let jerk = least.sign * self.limits.jerk;
                profile.push_pieces(&solution.before, jerk, self.unit);
                self.lay_out_shape(least.sign * solution.sign, &solution.shape, 0.0, profile);
            }
            ToTarget::Moving(moving) => {
                match moving.solve(left.max(moving.least())) {
                    Solution::Shape(sign, shape) => {
                        self.begin(profile);
                        self.lay_out_shape(sign, &shape, 0.0, profile);
                    }
                    Solution::Mean { up, down, weight } => {
                        let up = self.extremal(1.0, &up.0, up.1);
                        let down = self.extremal(-1.0, &down.0, down.1);
                        profile.mean_of(weight, &up, &down, self.target);
                    }
                }
                lay_out_beyond(self.limits, profile);
            }
        }
    }

    fn begin(&self, profile: &mut Profile) {
        profile.begin(self.start);
        profile.push_pieces(&self.brake, self.limits.jerk, self.unit);
    }

    /// Returns a motion that ends `beyond` the target in a direction.
    fn extremal(&self, sign: f64, shape: &Shape, beyond: f64) -> Profile {
        let mut profile = Profile::at_rest(0.0);
        self.begin(&mut profile);
        self.lay_out_shape(sign, shape, sign * beyond, &mut profile);
        profile
    }

    /// Appends a shape in the direction of `sign` that ends `beyond` the target, in units of the
    /// axis.
    fn lay_out_shape(&self, sign: f64, shape: &Shape, beyond: f64, profile: &mut Profile) {
        let unit = self.unit;
        let up = sign * self.limits.jerk;
        let per_velocity = self.limits.jerk * unit * unit;
        let [t1, t2, t3, t4, t5, t6, t7] = shape.t.map(|t| t * unit);
        let first = shape.first * up;
        profile.push(first, t1);
        profile.push(0.0, t2);
        profile.push(-first, t3);
        profile.cruise(sign * per_velocity * shape.cruise, t4);
        let beyond = beyond * per_velocity * unit;
        profile.lead_to(self.target, beyond, -up, [t5, t6, t7]);
    }
}

/// Returns the least-time motion to a position that differs from the target only by rounding.
/// Returns `None` if this motion takes clearly longer than `duration`.
///
/// Near the end of a motion, the least duration is uncertain by microseconds (the cube root of the
/// rounding of positions). In that time, a moving axis covers micrometres.
fn earlier(least: &LeastTime, duration: f64) -> Option<LeastTime> {
    let feasible = FeasibleDurations::new(&least.task, 0.0, 0.0);
    let d = least.task.d - feasible.drift(least.duration);
    let earlier = least_time(Task {
        d: d.max(least.task.stop_point().0),
        ..least.task
    });
    let takes = earlier.duration <= duration || feasible.are_same(duration, earlier.duration);
    takes.then_some(LeastTime {
        sign: least.sign * earlier.sign,
        ..earlier
    })
}

/// Returns true if the quantities differ by few enough orders of magnitude to plan a stop from
/// `start`.
pub(crate) fn can_stop(start: AxisState, limits: AxisLimits) -> bool {
    Task::new(start, start.position, limits).is_some()
}

/// Writes the least-time stop to `profile`. The state must pass [`can_stop`], or be on a plan that
/// starts from such a state.
pub(crate) fn lay_out_stop(start: AxisState, limits: AxisLimits, profile: &mut Profile) {
    profile.begin(start);
    append_stop(limits, profile);
}

/// Appends the motion beyond a target in motion. If the limits allow it, the acceleration continues
/// for a cycle plus the tolerance for simultaneous arrival. The least-time stop follows.
///
/// The first command at the target is sent up to one cycle after the last axis arrives. If the
/// caller then sets a new target, the axis still moves like the old target and has not slowed down
/// yet.
fn lay_out_beyond(limits: AxisLimits, profile: &mut Profile) {
    let AxisState {
        velocity,
        acceleration,
        ..
    } = profile.front().after(0.0, CYCLE);
    let change = 0.5 * acceleration * acceleration / limits.jerk;
    if velocity.abs() + change <= limits.velocity * (1.0 + AT_LIMIT) {
        profile.push(0.0, CYCLE);
    }
    append_stop(limits, profile);
}

fn append_stop(limits: AxisLimits, profile: &mut Profile) {
    for (jerk, t) in stop_pieces(profile.front(), limits) {
        profile.push(jerk, t);
    }
    profile.finish_here();
}

/// Returns the position at which the least-time stop from `start` ends.
#[must_use]
pub fn rest_of(start: AxisState, limits: AxisLimits) -> f64 {
    if start.is_at_rest() {
        return start.position;
    }
    let front = AxisState {
        position: 0.0,
        ..start
    };
    let pieces = stop_pieces(front, limits).into_iter();
    let way = pieces.fold(
        front,
        |state, (jerk, t)| {
            if t > 0.0 { state.after(jerk, t) } else { state }
        },
    );
    start.position + way.position
}

/// Returns the jerks of the least-time stop and their durations, in seconds. The first piece
/// reduces an excessive acceleration to its limit.
fn stop_pieces(front: AxisState, limits: AxisLimits) -> [(f64, f64); 4] {
    let (task, unit) = Task::unchecked(front, front.position, limits);
    let excess = task.a.abs() - 1.0;
    let ramp = -1_f64.copysign(task.a);
    let task = if excess > 0.0 {
        task.after(ramp, excess)
    } else {
        task
    };
    let (sign, [t1, t2, t3]) = stop(task.v, task.a);
    [
        (ramp * limits.jerk, excess * unit),
        (sign * limits.jerk, t1 * unit),
        (0.0, t2 * unit),
        (-sign * limits.jerk, t3 * unit),
    ]
}

/// Relative excess over a limit up to which a target counts as at the limit, because of rounding.
const AT_LIMIT: f64 = 1e-12;
