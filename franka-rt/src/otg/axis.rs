//! One axis from its state to its target: brake, least time, given duration, laid out as a profile.

use super::brake::{Pieces, into_limits};
use super::given_duration::lasting;
use super::least_time::{Least, least_time};
use super::limits::AxisLimits;
use super::profile::Profile;
use super::state::AxisState;
use super::task::Task;
use super::transfer::stop;

/// The solved problem of one axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    start: AxisState,
    target: f64,
    jerk: f64,
    /// Unit of time.
    unit: f64,
    brake: Pieces,
    /// Duration of the brake, in that unit.
    braking: f64,
    least: Least,
}

impl Axis {
    /// Finds the least-time motion; `None` if the numbers are too far apart for it.
    pub(super) fn new(start: AxisState, target: f64, limits: AxisLimits) -> Option<Self> {
        let (task, unit) = Task::new(start, target, limits)?;
        let (brake, task) = into_limits(task);
        Some(Self {
            start,
            target,
            jerk: limits.jerk,
            unit,
            braking: brake.duration(),
            brake,
            least: least_time(task),
        })
    }

    /// Its least duration, in seconds.
    pub(super) fn least_duration(&self) -> f64 {
        self.unit * (self.braking + self.least.duration)
    }

    /// Lays out the profile that takes `duration` seconds, or the least-time one if that takes longer.
    pub(super) fn lay_out(&self, duration: f64, profile: &mut Profile) {
        let Self { jerk, unit, .. } = *self;
        profile.begin(self.start);
        profile.push_pieces(&self.brake, jerk, unit);
        let frame = self.least.sign;
        let solution = lasting(&self.least, duration / unit - self.braking);
        let (ramp_sign, ramp) = solution.ramp;
        profile.push(frame * ramp_sign * jerk, unit * ramp);
        let unit = unit * solution.cap;
        let up = frame * solution.sign * jerk;
        let [t1, t2, t3, t4, t5, t6, t7] = solution.shape.t.map(|t| t * unit);
        let first = solution.shape.first * up;
        profile.push(first, t1);
        profile.push(0.0, t2);
        profile.push(-first, t3);
        let per_velocity = jerk * unit * unit;
        let along = frame * solution.sign;
        profile.cruise(along * per_velocity * solution.shape.cruise, t4);
        profile.finish(-up, [t5, t6, t7], self.target);
    }
}

/// Whether the numbers are close enough together to plan from `start`.
pub(super) fn can_stop(start: AxisState, limits: AxisLimits) -> bool {
    Task::new(start, start.position, limits).is_some()
}

/// Lays out the least-time stop, from a state that [`can_stop`] or that a plan from such a state leads to.
pub(super) fn lay_out_stop(start: AxisState, limits: AxisLimits, profile: &mut Profile) {
    let (task, unit) = Task::unchecked(start, start.position, limits);
    profile.begin(start);
    let excess = task.a.abs() - 1.0;
    let ramp = -1_f64.copysign(task.a);
    let task = if excess > 0.0 {
        profile.push(ramp * limits.jerk, excess * unit);
        task.after(ramp, excess)
    } else {
        task
    };
    let (sign, [t1, t2, t3]) = stop(task.v, task.a);
    profile.push(sign * limits.jerk, t1 * unit);
    profile.push(0.0, t2 * unit);
    profile.push(-sign * limits.jerk, t3 * unit);
    profile.finish_here();
}
