//! The generator, which consists of a plan and the current cycle of the plan.

use crate::axis::can_stop;
use crate::cycle::CYCLE;
use crate::error::{PlanError, Quantity};
use crate::limits::Limits;
use crate::plan::{Plan, PlanStart, Synchronisation};
use crate::state::{AxisState, State, check_finite};
use crate::straight_line::StraightLine;

/// Moves `N` axes to a target that may change at any time, within limits of velocity, acceleration
/// and jerk.
///
/// - Input: [`set_target`](Self::set_target), [`set_moving_target`](Self::set_moving_target),
///   [`set_limits`](Self::set_limits), [`brake`](Self::brake), [`set_state`](Self::set_state). Each
///   of these methods creates a new plan from the current state, unless nothing changes.
/// - Output: call [`step`](Self::step) once per command, and [`sample`](Self::sample) to look
///   ahead.
/// - Getters: [`state`](Self::state), [`target`](Self::target),
///   [`time_to_target`](Self::time_to_target), [`remaining`](Self::remaining),
///   [`is_done`](Self::is_done).
///
/// Real-time threads may call all methods: they take bounded time and do not allocate. After an
/// error, the generator is unchanged.
///
/// ```
/// use franka_otg::{Generator, Limits, State};
///
/// let limits = Limits::from_arrays([2.0; 2], [10.0; 2], [5000.0; 2])?;
/// let mut generator = Generator::new(State::at_rest([0.0, 0.5]), limits)?;
/// generator.set_target(&[0.3, -0.2])?;
/// while !generator.is_done() {
///     generator.step();
/// }
/// assert_eq!(generator.state(), &State::at_rest([0.3, -0.2]));
/// # Ok::<(), franka_otg::PlanError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Generator<const N: usize> {
    limits: Limits<N>,
    synchronisation: Synchronisation,
    heading: Heading<N>,
    plan: Plan<N>,
    /// Number of cycles since the creation of the plan.
    cycle: u64,
    /// State at this cycle.
    state: State<N>,
}

/// The destination of the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Heading<const N: usize> {
    /// The target state.
    Target(State<N>),
    /// Rest, reached in the least time.
    Rest,
}

impl<const N: usize> Generator<N> {
    /// Creates a generator at `state` without a target. If the state is in motion, the axes stop in
    /// the least time.
    ///
    /// The synchronisation is [`Synchronisation::Straight`].
    ///
    /// # Errors
    /// Returns [`PlanError::NotFinite`] if a value of the state is not finite, and
    /// [`PlanError::OutOfRange`] if a value of the state, in units of the limits, is beyond 100
    /// orders of magnitude.
    pub fn new(state: State<N>, limits: Limits<N>) -> Result<Self, PlanError> {
        Self::towards(state, limits, None)
    }

    /// Creates a generator at `state` with an optional target at rest.
    ///
    /// # Errors
    /// Returns the same errors as [`new`](Self::new) and [`set_target`](Self::set_target).
    pub fn towards(
        state: State<N>,
        limits: Limits<N>,
        target: Option<&[f64; N]>,
    ) -> Result<Self, PlanError> {
        let mut generator = Self {
            limits,
            synchronisation: Synchronisation::default(),
            heading: Heading::Rest,
            plan: Plan::at_rest(state.position),
            cycle: 0,
            state,
        };
        generator.restart(state, limits, target)?;
        Ok(generator)
    }

    /// Replaces the state, the limits and the target. The new motion ends at rest at `target`;
    /// without a target, it stops in the least time. This method is equivalent to a new generator,
    /// but needs no copy of the generator, whose size is a few kilobytes.
    ///
    /// # Errors
    /// Returns the same errors as [`new`](Self::new) and [`set_target`](Self::set_target). After an
    /// error, the current motion continues.
    pub fn restart(
        &mut self,
        state: State<N>,
        limits: Limits<N>,
        target: Option<&[f64; N]>,
    ) -> Result<(), PlanError> {
        let heading = match target {
            None => Heading::Rest,
            Some(target) => {
                check_finite(target, Quantity::Target)?;
                Heading::Target(State::at_rest(*target))
            }
        };
        self.begin(state, limits, heading)
    }

    fn begin(
        &mut self,
        state: State<N>,
        limits: Limits<N>,
        heading: Heading<N>,
    ) -> Result<(), PlanError> {
        state.check()?;
        check_range(&state, &limits)?;
        let start = PlanStart {
            state,
            line: None,
            limits: &limits,
        };
        match &heading {
            Heading::Target(target) => self.plan.go_to(target, &start, self.synchronisation)?,
            Heading::Rest => self.plan.stop(&start),
        }
        self.limits = limits;
        self.heading = heading;
        self.cycle = 0;
        self.state = state;
        Ok(())
    }

    /// Sets the synchronisation of the axes for the next plan and all later plans.
    #[must_use]
    pub fn with_synchronisation(mut self, synchronisation: Synchronisation) -> Self {
        self.synchronisation = synchronisation;
        self
    }

    /// Starts a motion from the current state to rest at `target`. A call with the current target
    /// has no effect.
    ///
    /// # Errors
    /// Returns [`PlanError::NotFinite`] if a value is not finite, and [`PlanError::OutOfRange`] if
    /// the magnitudes differ too much. After an error, the current motion continues.
    pub fn set_target(&mut self, target: &[f64; N]) -> Result<(), PlanError> {
        if let Heading::Target(now) = &self.heading
            && now.position == *target
            && now.is_at_rest()
        {
            return Ok(());
        }
        check_finite(target, Quantity::Target)?;
        self.plan_target(&State::at_rest(*target))
    }

    /// Starts a motion to `target` that arrives with the target's velocity and acceleration, in the
    /// least time that is feasible for all axes. A call with the current target has no effect.
    ///
    /// Use this method to follow a moving object (set a new target before each arrival), or to pass
    /// through points without a stop. If no new target is set, the motion continues for one cycle
    /// past the old target, and then stops in the least time. An arm therefore stops if the program
    /// stalls.
    ///
    /// All axes are at the target at [`time_to_target`](Self::time_to_target). An axis that would
    /// be early cannot wait at a moving target. Such an axis moves back and approaches again,
    /// possibly after it has passed the target. All axes arrive later if one axis needs more time
    /// for this.
    ///
    /// # Errors
    /// Returns [`PlanError::NotFinite`] if a value is not finite, and [`PlanError::OutOfRange`] if
    /// the magnitudes differ too much. Returns [`PlanError::TargetMotion`] if
    /// `|velocity| + acceleration^2 / (2 jerk limit)` exceeds the velocity limit, or if the
    /// acceleration exceeds its limit. After an error, the current motion continues.
    pub fn set_moving_target(&mut self, target: &State<N>) -> Result<(), PlanError> {
        if target.is_at_rest() {
            return self.set_target(&target.position);
        }
        if self.heading == Heading::Target(*target) {
            return Ok(());
        }
        check_finite(&target.position, Quantity::Target)?;
        check_finite(&target.velocity, Quantity::TargetVelocity)?;
        check_finite(&target.acceleration, Quantity::TargetAcceleration)?;
        self.plan_target(target)
    }

    /// Changes the limits of the current motion, which keeps its target. A call with the current
    /// limits has no effect.
    ///
    /// If the current state is outside the new limits, the axes brake until they are within them.
    ///
    /// # Errors
    /// Returns [`PlanError::TargetMotion`] if the target moves faster than the new limits allow,
    /// and [`PlanError::OutOfRange`] if the magnitudes differ too much. After an error, the
    /// previous limits still apply.
    pub fn set_limits(&mut self, limits: Limits<N>) -> Result<(), PlanError> {
        if limits == self.limits {
            return Ok(());
        }
        check_range(&self.state, &limits)?;
        let before = core::mem::replace(&mut self.limits, limits);
        match self.heading {
            Heading::Target(target) => self
                .plan_target(&target)
                .inspect_err(|_| self.limits = before),
            Heading::Rest => {
                self.plan_stop();
                Ok(())
            }
        }
    }

    /// Drops the target and stops in the least time.
    ///
    /// A motion on a straight line stops on this line. If all axes have the same ratio of
    /// acceleration limit to jerk limit, such a stop takes no longer than separate stops of the
    /// axes. Otherwise it takes longer, by about the difference between these ratios (which are
    /// times). If the motion is not on a line, each axis stops separately. Braking cannot fail,
    /// because all inputs have been checked.
    pub fn brake(&mut self) {
        if self.heading != Heading::Rest {
            self.plan_stop();
        }
    }

    /// Multiplies the velocity by the factor `share`, between 0 and 1, and creates a new plan to
    /// the target. If no target is set, it plans a stop. A motion on a straight line stays on this
    /// line.
    ///
    /// The velocity of the output jumps, so the caller must ensure that `share` is close to 1.
    ///
    /// # Errors
    /// Returns [`PlanError::OutOfRange`] or [`PlanError::TargetMotion`] if no plan exists. After an
    /// error, the current motion continues.
    pub fn slow_down(&mut self, share: f64) -> Result<(), PlanError> {
        let line = self.plan.line_at(self.elapsed());
        let state = State {
            velocity: self.state.velocity.map(|velocity| share * velocity),
            ..self.state
        };
        let line = line.map(|(line, along)| {
            let velocity = share * along.velocity;
            (line, AxisState { velocity, ..along })
        });
        self.go_on_from(state, line)
    }

    /// Moves the output back on its straight line to the point nearest to `position`, and
    /// multiplies the velocity by the factor `share`, between 0 and 1. The output never moves
    /// forward. A new plan begins at that point; it leads to the target, or to a stop if no target
    /// is set. Returns `false` and changes nothing if the motion is not on a straight line.
    ///
    /// The output jumps, so the caller must ensure that it is close to `position` and that `share`
    /// is close to 1.
    ///
    /// # Errors
    /// Returns [`PlanError::OutOfRange`] or [`PlanError::TargetMotion`] if no plan exists. After an
    /// error, the current motion continues.
    pub fn hold_back(&mut self, position: &[f64; N], share: f64) -> Result<bool, PlanError> {
        let Some((line, mut along)) = self.plan.line_at(self.elapsed()) else {
            return Ok(false);
        };
        let back = line.nearest(position) - along.position;
        if back * along.velocity < 0.0 {
            along.position += back;
        }
        along.velocity *= share;
        self.go_on_from(line.state(along), Some((line, along)))?;
        Ok(true)
    }

    /// Creates a plan from `state`, which is at this state of a straight line if it moves on one.
    fn go_on_from(
        &mut self,
        state: State<N>,
        line: Option<(StraightLine<N>, AxisState)>,
    ) -> Result<(), PlanError> {
        let start = PlanStart {
            state,
            line,
            limits: &self.limits,
        };
        match &self.heading {
            Heading::Target(target) => self.plan.go_to(target, &start, self.synchronisation)?,
            Heading::Rest => self.plan.stop(&start),
        }
        self.cycle = 0;
        self.state = state;
        Ok(())
    }

    /// Sets the current state to `state`, and creates a new plan from there to the target. If no
    /// target is set, it plans a stop in the least time.
    ///
    /// The output jumps to `state`, so the caller must ensure that `state` is close to the last
    /// output.
    ///
    /// # Errors
    /// Returns [`PlanError::NotFinite`] if a value is not finite, and [`PlanError::OutOfRange`] if
    /// the magnitudes differ too much. After an error, the current motion continues.
    pub fn set_state(&mut self, state: State<N>) -> Result<(), PlanError> {
        self.begin(state, self.limits, self.heading)
    }

    /// Advances by one nominal cycle, [`CYCLE`], and returns the state to command.
    ///
    /// In the cycle in which the motion ends, and in all later cycles, the state is exactly the
    /// target with zero velocity and acceleration. After a moving target, it is the position beyond
    /// the target at which the motion stops.
    pub fn step(&mut self) -> &State<N> {
        self.cycle = self.cycle.saturating_add(1);
        self.state = self.plan.sample(self.elapsed());
        &self.state
    }

    /// Returns the state `t` seconds from now if the target and the limits do not change. If `t` is
    /// negative, returns the current state.
    #[must_use]
    pub fn sample(&self, t: f64) -> State<N> {
        if t > 0.0 {
            self.plan.sample(self.elapsed() + t)
        } else {
            self.state
        }
    }

    /// Returns the current state.
    #[must_use]
    pub const fn state(&self) -> &State<N> {
        &self.state
    }

    /// Returns the position of the target. Without a target, this is the position at which the stop
    /// ends.
    #[must_use]
    pub const fn target(&self) -> &[f64; N] {
        match &self.heading {
            Heading::Target(target) => &target.position,
            Heading::Rest => self.plan.end(),
        }
    }

    /// Returns the position at which the current motion stops if the target and the limits do not
    /// change. This is the target, a position beyond a moving target, or the end of the stop.
    #[must_use]
    pub const fn end(&self) -> &[f64; N] {
        self.plan.end()
    }

    /// Returns the current limits.
    #[must_use]
    pub const fn limits(&self) -> &Limits<N> {
        &self.limits
    }

    /// Returns the duration of the current motion in seconds, counted from the creation of its
    /// plan.
    #[must_use]
    pub const fn duration(&self) -> f64 {
        self.plan.duration()
    }

    /// Returns the time in seconds until the motion is at the target, or until rest if no target is
    /// set. The time is zero afterwards.
    #[must_use]
    pub fn time_to_target(&self) -> f64 {
        if self.is_done() {
            0.0
        } else {
            (self.plan.arrival() - self.elapsed()).max(0.0)
        }
    }

    /// Returns the time until rest, in seconds, or zero at rest. The first whole cycle after this
    /// time returns a state at rest.
    #[must_use]
    pub fn remaining(&self) -> f64 {
        if self.is_done() {
            0.0
        } else {
            (self.plan.duration() - self.elapsed()).max(0.0)
        }
    }

    /// Returns true if the motion has ended, so that the current state is at rest.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.state.position == *self.plan.end() && self.state.is_at_rest()
    }

    fn elapsed(&self) -> f64 {
        self.cycle as f64 * CYCLE
    }

    fn plan_target(&mut self, target: &State<N>) -> Result<(), PlanError> {
        let start = PlanStart {
            state: self.state,
            line: self.plan.line_at(self.elapsed()),
            limits: &self.limits,
        };
        self.plan.go_to(target, &start, self.synchronisation)?;
        self.heading = Heading::Target(*target);
        self.cycle = 0;
        Ok(())
    }

    fn plan_stop(&mut self) {
        let start = PlanStart {
            state: self.state,
            line: self.plan.line_at(self.elapsed()),
            limits: &self.limits,
        };
        self.plan.stop(&start);
        self.heading = Heading::Rest;
        self.cycle = 0;
    }
}

/// Returns an error if the state and the limits differ by too many orders of magnitude to plan a
/// stop.
fn check_range<const N: usize>(state: &State<N>, limits: &Limits<N>) -> Result<(), PlanError> {
    match (0..N).find(|&i| !can_stop(state.axis(i), limits.axis(i))) {
        Some(index) => Err(PlanError::OutOfRange { axis: index + 1 }),
        None => Ok(()),
    }
}
