//! The pace of a path. A path has its own time, which stops while the path is paused, and waits
//! while something holds the arm back.

use franka_otg::{AxisLimits, Generator, Limits, State};

use crate::shaping::CYCLE;

/// Limits with which the time of a path stops and resumes. The unit of speed is the robot's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pace(AxisLimits);

impl Pace {
    /// Computes the pace for motions with these greatest speeds and these limits. Stopping the time
    /// uses half of the limits.
    pub(super) fn of(motions: impl Iterator<Item = (f64, AxisLimits)>) -> Self {
        let gentle = AxisLimits {
            velocity: 1.0 / STOP_MIN,
            acceleration: 4.0 / (STOP_MIN * STOP_MIN),
            jerk: 0.0,
        };
        let moving = motions.filter(|(speed, _)| *speed > 0.0);
        let pace = moving.fold(gentle, |pace, (speed, limits)| AxisLimits {
            velocity: pace.velocity.min(0.5 * limits.acceleration / speed),
            acceleration: pace.acceleration.min(0.5 * limits.jerk / speed),
            jerk: 0.0,
        });
        // The change of the pace reaches its greatest value within a tenth of the time that it may
        // take.
        let jerk = 10.0 * pace.acceleration * pace.velocity.max(pace.acceleration / pace.velocity);
        Self(AxisLimits { jerk, ..pace })
    }

    /// Returns a generator that leads from the constant pace `pace` to other paces.
    fn at(self, pace: f64) -> Option<Generator<1>> {
        let limits = Limits::per_axis([self.0]).ok()?;
        Generator::towards(State::at_rest([pace]), limits, Some(&[pace])).ok()
    }
}

/// Shortest time in which the time of a path stops, `[s]`.
const STOP_MIN: f64 = 0.05;

#[derive(Debug)]
pub(super) struct PathTime {
    /// Time along the path, `[s]`.
    pub(super) time: f64,
    pace: Pace,
    /// Speed of the path's time: 1 at full pace, 0 in a pause.
    axis: Generator<1>,
    /// Factor that slows the path's time while the arm lags.
    share: f64,
}

impl PathTime {
    pub(super) fn new(pace: Pace) -> Option<Self> {
        Some(Self {
            time: -CYCLE,
            pace,
            axis: pace.at(1.0)?,
            share: 1.0,
        })
    }

    /// Stops or resumes the time. If the path has not begun and is paused, it does not begin.
    pub(super) fn set_paused(&mut self, paused: bool) {
        if paused
            && self.time < 0.0
            && let Some(axis) = self.pace.at(0.0)
        {
            (self.time, self.axis) = (0.0, axis);
        }
        let wanted = if paused { 0.0 } else { 1.0 };
        // Both values are within the range for which the limits were checked.
        let _ = self.axis.set_target(&[wanted]);
    }

    /// Advances by one cycle, for an arm whose lag is `lag` times the permitted lag.
    pub(super) fn step(&mut self, lag: f64) {
        self.share = (1.0 - (lag - 0.1) / 0.9).clamp(0.0, 1.0);
        self.axis.step();
        self.time += CYCLE * self.rate();
    }

    /// Returns how many seconds of the path pass in one second of the robot.
    pub(super) fn rate(&self) -> f64 {
        self.axis.state().position[0].clamp(0.0, 1.0) * self.share
    }

    /// Returns the derivative of [`rate`](Self::rate), `[1/s]`, without the influence of the lag.
    pub(super) fn change(&self) -> f64 {
        self.axis.state().velocity[0] * self.share
    }
}
