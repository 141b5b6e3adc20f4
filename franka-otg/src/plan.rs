//! A motion of all axes over time.

use crate::axis::{Axis, Refusal, lay_out_stop};
use crate::error::PlanError;
use crate::feasible_durations::CANDIDATES;
use crate::limits::Limits;
use crate::profile::Profile;
use crate::state::{AxisState, State};
use crate::straight_line::StraightLine;

/// Synchronisation of the axes of a motion to a target. In both cases, all axes arrive at the
/// same instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Synchronisation {
    /// The axes move in phase on a straight line if the current motion allows it, which is always
    /// the case from rest. Otherwise the axes move as with [`Time`](Self::Time).
    #[default]
    Straight,
    /// Each axis has its own motion, so the path may be curved. All axes arrive as early as the
    /// slowest axis can.
    Time,
}

/// The current motion, as a function of the time since it was planned.
#[derive(Debug, Clone)]
pub(crate) struct Plan<const N: usize> {
    path: Path<N>,
    /// Motion along the straight line.
    along: Profile,
    /// Separate motion of each axis.
    axes: [Profile; N],
    /// Time at which the axes are at the target, in seconds from the start.
    arrival: f64,
    /// Position of rest: the target, or a position beyond a moving target.
    end: [f64; N],
    duration: f64,
}

#[derive(Debug, Clone)]
enum Path<const N: usize> {
    /// The axes move separately.
    PerAxis,
    /// The axes move on a straight line.
    Straight(StraightLine<N>),
}

/// The start of a plan.
pub(crate) struct PlanStart<'a, const N: usize> {
    pub(crate) state: State<N>,
    /// Straight line on which the state moves, and the state along this line.
    pub(crate) line: Option<(StraightLine<N>, AxisState)>,
    pub(crate) limits: &'a Limits<N>,
}

impl<const N: usize> Plan<N> {
    pub(crate) fn at_rest(position: [f64; N]) -> Self {
        Self {
            path: Path::PerAxis,
            along: Profile::at_rest(0.0),
            axes: position.map(Profile::at_rest),
            arrival: 0.0,
            end: position,
            duration: 0.0,
        }
    }

    /// Replaces the plan with the motion to `target`. For a moving target, the plan continues and
    /// ends at rest beyond the target.
    ///
    /// # Errors
    /// Returns [`PlanError::OutOfRange`] or [`PlanError::TargetMotion`] if an axis has no plan. The
    /// plan is then unchanged.
    pub(crate) fn go_to(
        &mut self,
        target: &State<N>,
        start: &PlanStart<'_, N>,
        synchronisation: Synchronisation,
    ) -> Result<(), PlanError> {
        // A single axis always moves on a line.
        if synchronisation == Synchronisation::Straight && N > 1 {
            let kept = start.line.as_ref().and_then(|(line, along)| {
                let to = line.state_of(target)?;
                Some((*line, *along, to))
            });
            let straight = kept.or_else(|| {
                let (line, along) = StraightLine::through(&start.state, target)?;
                let to = line.state_of(target)?;
                Some((line, along, to))
            });
            if let Some((line, along, to)) = straight {
                return self.follow_line(line, along, to, target, start.limits);
            }
        }
        self.move_axes(&start.state, target, start.limits)?;
        self.path = Path::PerAxis;
        Ok(())
    }

    fn follow_line(
        &mut self,
        line: StraightLine<N>,
        along: AxisState,
        to: AxisState,
        target: &State<N>,
        limits: &Limits<N>,
    ) -> Result<(), PlanError> {
        let axis = Axis::new(along, to, limits.along(line.direction()))
            .map_err(|refusal| refusal.of_axis(1))?;
        let least = axis.least_duration();
        axis.lay_out(least, &mut self.along);
        self.duration = self.along.duration();
        if target.is_at_rest() {
            self.arrival = self.duration;
            self.end = target.position;
        } else {
            self.arrival = least;
            self.end = line.state(AxisState::at_rest(self.along.end())).position;
        }
        self.path = Path::Straight(line);
        Ok(())
    }

    /// Writes the motion of all axes. They arrive together with the slowest axis, or at the next
    /// duration that is feasible for all axes.
    fn move_axes(
        &mut self,
        state: &State<N>,
        target: &State<N>,
        limits: &Limits<N>,
    ) -> Result<(), PlanError> {
        let mut axes: [_; N] =
            core::array::from_fn(|i| Axis::new(state.axis(i), target.axis(i), limits.axis(i)));
        let mut duration = 0.0_f64;
        for (i, axis) in axes.iter().enumerate() {
            match axis {
                Ok(axis) => duration = duration.max(axis.least_duration()),
                Err(refusal) => return Err(refusal.of_axis(i + 1)),
            }
        }
        let moves = !target.is_at_rest();
        if moves {
            let common = common_duration(&axes, duration);
            if common < duration {
                for axis in axes.iter_mut().flatten() {
                    axis.round_to(common);
                }
            }
            duration = common;
        }
        for (axis, profile) in axes.iter().flatten().zip(&mut self.axes) {
            axis.lay_out(duration, profile);
        }
        self.arrival = duration;
        self.duration = self.arrival;
        self.end = target.position;
        if moves {
            for (i, profile) in self.axes.iter().enumerate() {
                self.duration = self.duration.max(profile.duration());
                self.end[i] = profile.end();
            }
        }
        Ok(())
    }

    /// Replaces the plan with the least-time stop, along the line of the state or separately for
    /// each axis.
    pub(crate) fn stop(&mut self, start: &PlanStart<'_, N>) {
        if let Some((line, along)) = &start.line {
            lay_out_stop(
                *along,
                start.limits.along(line.direction()),
                &mut self.along,
            );
            self.duration = self.along.duration();
            self.arrival = self.duration;
            self.end = line.state(AxisState::at_rest(self.along.end())).position;
            self.path = Path::Straight(*line);
            return;
        }
        self.duration = 0.0;
        for (i, profile) in self.axes.iter_mut().enumerate() {
            lay_out_stop(start.state.axis(i), start.limits.axis(i), profile);
            self.duration = self.duration.max(profile.duration());
            self.end[i] = profile.end();
        }
        self.arrival = self.duration;
        self.path = Path::PerAxis;
    }

    /// Returns the position of rest at the end of the plan.
    pub(crate) const fn end(&self) -> &[f64; N] {
        &self.end
    }

    /// Returns the time at which the axes are at the target, in seconds from the start of the plan.
    /// It is the time of rest, unless the target moves.
    pub(crate) const fn arrival(&self) -> f64 {
        self.arrival
    }

    /// Returns the time at which all axes are at rest, in seconds from the start of the plan.
    pub(crate) const fn duration(&self) -> f64 {
        self.duration
    }

    /// Returns the state `t >= 0` seconds after the start of the plan. After the plan's duration,
    /// the state is exactly at rest at the end.
    pub(crate) fn sample(&self, t: f64) -> State<N> {
        if t >= self.duration - SLACK {
            return State::at_rest(self.end);
        }
        match &self.path {
            Path::PerAxis => self.sample_axes(t),
            Path::Straight(line) => line.state(self.along.sample(t)),
        }
    }

    fn sample_axes(&self, t: f64) -> State<N> {
        let mut state = State::at_rest(self.end);
        for (i, profile) in self.axes.iter().enumerate() {
            state.set_axis(i, profile.sample(t));
        }
        state
    }

    /// Returns the straight line of the motion at `t`, and the state along this line, or `None` at
    /// rest.
    pub(crate) fn line_at(&self, t: f64) -> Option<(StraightLine<N>, AxisState)> {
        match &self.path {
            Path::Straight(line) if t < self.duration - SLACK => {
                Some((*line, self.along.sample(t)))
            }
            _ => None,
        }
    }
}

/// Returns the smallest duration, not below `at_least`, that is feasible for all axes.
///
/// If a duration is infeasible for an axis, the axis requests its next feasible duration, which is
/// one of its candidates. The duration only grows, so each axis requests each candidate at most
/// once.
///
/// Rounding alone must not cause a detour: the feasible durations of one axis may end just before a
/// duration that another axis knows with less precision.
fn common_duration<const N: usize>(axes: &[Result<Axis, Refusal>; N], at_least: f64) -> f64 {
    let axes = || axes.iter().flatten();
    let mut duration = at_least;
    for _ in 0..N * CANDIDATES {
        let next = axes().fold(duration, |next, axis| axis.from(next));
        if next == duration {
            break;
        }
        let earlier = axes()
            .filter_map(|axis| axis.before(duration))
            .fold(duration, f64::min);
        if axes().all(|axis| axis.can_take(earlier)) {
            return earlier;
        }
        duration = next;
    }
    duration
}

impl Refusal {
    fn of_axis(self, axis: usize) -> PlanError {
        match self {
            Self::OutOfRange => PlanError::OutOfRange { axis },
            Self::TargetMotion => PlanError::TargetMotion { axis },
        }
    }
}

/// Time before the end, in seconds, at which a motion counts as ended. Without this tolerance,
/// rounding of the duration could add a cycle.
///
/// The value is a millionth of a cycle. The distance that remains is its third power times a sixth
/// of the jerk limit.
const SLACK: f64 = 1e-9;
