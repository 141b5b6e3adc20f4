//! The generator: a plan, and the cycle that it has reached.

use super::axis::can_stop;
use super::error::{PlanError, Quantity};
use super::limits::Limits;
use super::plan::{Plan, Start, Synchronisation};
use super::state::{State, check_finite};

/// One nominal cycle of the robot, in seconds (FCI documentation: 1 kHz).
///
/// The generator advances by this per command, whatever the time between two states: to the robot, two
/// milliseconds' motion in one command is a doubled velocity.
pub const CYCLE: f64 = 1e-3;

/// Moves `N` axes to rest at a target that may change at any time, inside limits of velocity, acceleration
/// and jerk.
///
/// - Input: [`set_target`](Self::set_target), [`set_limits`](Self::set_limits), [`brake`](Self::brake),
///   [`set_state`](Self::set_state). Each plans anew from the present state, unless nothing changes.
/// - Output: [`step`](Self::step) once per command, [`sample`](Self::sample) to look ahead.
/// - Getters: [`state`](Self::state), [`target`](Self::target), [`remaining`](Self::remaining),
///   [`is_done`](Self::is_done).
///
/// All of it is bounded work without allocation, fit for the real-time thread. An error leaves the generator
/// as it was.
///
/// ```
/// use franka_rt::otg::{Generator, Limits, State};
///
/// let limits = Limits::from_arrays([2.0; 2], [10.0; 2], [5000.0; 2])?;
/// let mut generator = Generator::new(State::at_rest([0.0, 0.5]), limits)?;
/// generator.set_target(&[0.3, -0.2])?;
/// while !generator.is_done() {
///     generator.step();
/// }
/// assert_eq!(generator.state(), &State::at_rest([0.3, -0.2]));
/// # Ok::<(), franka_rt::otg::PlanError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Generator<const N: usize> {
    limits: Limits<N>,
    synchronisation: Synchronisation,
    goal: Goal,
    plan: Plan<N>,
    /// Cycles since the plan was made.
    cycle: u64,
    /// The state at that cycle.
    state: State<N>,
}

/// What the plan is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Goal {
    /// Rest at the plan's end because the caller asked for that place.
    Target,
    /// Rest wherever it is reached first.
    Rest,
}

impl<const N: usize> Generator<N> {
    /// A generator at `state` without a target: if it moves, it comes to rest in the least time.
    ///
    /// Synchronisation is [`Synchronisation::Straight`].
    ///
    /// # Errors
    /// [`PlanError::NotFinite`] for the state; [`PlanError::OutOfRange`] if it lies more than 100 decades
    /// from the limits.
    pub fn new(state: State<N>, limits: Limits<N>) -> Result<Self, PlanError> {
        let mut generator = Self {
            limits,
            synchronisation: Synchronisation::default(),
            goal: Goal::Rest,
            plan: Plan::at_rest(state.position),
            cycle: 0,
            state,
        };
        generator.set_state(state)?;
        Ok(generator)
    }

    /// The same generator with another way of moving the axes together, from the next plan on.
    #[must_use]
    pub fn with_synchronisation(mut self, synchronisation: Synchronisation) -> Self {
        self.synchronisation = synchronisation;
        self
    }

    /// Moves to rest at `target` from the present state on. The target in force already is not planned again.
    ///
    /// # Errors
    /// [`PlanError::NotFinite`] or [`PlanError::OutOfRange`]; the motion in progress goes on.
    pub fn set_target(&mut self, target: &[f64; N]) -> Result<(), PlanError> {
        if self.goal == Goal::Target && self.plan.end() == target {
            return Ok(());
        }
        check_finite(target, Quantity::Target)?;
        self.plan_target(target)
    }

    /// Changes the limits of the motion in progress, which keeps its target. Equal limits change nothing.
    ///
    /// A state outside the new limits brakes back into them.
    ///
    /// # Errors
    /// [`PlanError::OutOfRange`]; the limits before stay in force.
    pub fn set_limits(&mut self, limits: Limits<N>) -> Result<(), PlanError> {
        if limits == self.limits {
            return Ok(());
        }
        check_range(&self.state, &limits)?;
        let before = core::mem::replace(&mut self.limits, limits);
        match self.goal {
            Goal::Target => {
                let target = *self.plan.end();
                self.plan_target(&target)
                    .inspect_err(|_| self.limits = before)
            }
            Goal::Rest => {
                self.plan_stop();
                Ok(())
            }
        }
    }

    /// Gives up the target and comes to rest in the least time.
    ///
    /// On a straight line the stop stays on it. That takes no longer than stopping each axis on its own if the
    /// axes have the same ratio of acceleration to jerk, and about the difference of these ratios longer
    /// otherwise. Off a line each axis stops by itself. Braking cannot fail: state and limits were checked when
    /// they came in.
    pub fn brake(&mut self) {
        if self.goal != Goal::Rest {
            self.plan_stop();
        }
    }

    /// Re-anchors the generator at `state` and plans anew: to the target if there is one, else to rest in the
    /// least time.
    ///
    /// The output steps to `state`; that it is close to the last output is for the caller to see to.
    ///
    /// # Errors
    /// [`PlanError::NotFinite`] or [`PlanError::OutOfRange`]; the motion in progress goes on.
    pub fn set_state(&mut self, state: State<N>) -> Result<(), PlanError> {
        state.check()?;
        check_range(&state, &self.limits)?;
        let start = Start {
            state,
            line: None,
            limits: &self.limits,
        };
        match self.goal {
            Goal::Target => {
                let target = *self.plan.end();
                self.plan.go_to(&target, &start, self.synchronisation)?;
            }
            Goal::Rest => self.plan.stop(&start),
        }
        self.cycle = 0;
        self.state = state;
        Ok(())
    }

    /// Advances by one nominal cycle, [`CYCLE`], and returns the state to command.
    ///
    /// The cycle in which the motion ends, and all after it, give exactly the target without velocity and
    /// acceleration.
    pub fn step(&mut self) -> &State<N> {
        self.cycle = self.cycle.saturating_add(1);
        self.state = self.plan.sample(self.elapsed());
        &self.state
    }

    /// The state `t` seconds from now if nothing changes; a negative `t` means now.
    #[must_use]
    pub fn sample(&self, t: f64) -> State<N> {
        if t > 0.0 {
            self.plan.sample(self.elapsed() + t)
        } else {
            self.state
        }
    }

    /// The present state.
    #[must_use]
    pub const fn state(&self) -> &State<N> {
        &self.state
    }

    /// Position at which the motion in progress comes to rest: the target, or where braking ends.
    #[must_use]
    pub const fn target(&self) -> &[f64; N] {
        self.plan.end()
    }

    /// The limits in force.
    #[must_use]
    pub const fn limits(&self) -> &Limits<N> {
        &self.limits
    }

    /// Duration of the motion in progress from where it was planned, in seconds.
    #[must_use]
    pub const fn duration(&self) -> f64 {
        self.plan.duration()
    }

    /// Time until rest, in seconds; zero once there. The output rests at the first whole cycle from then.
    #[must_use]
    pub fn remaining(&self) -> f64 {
        if self.is_done() {
            0.0
        } else {
            (self.plan.duration() - self.elapsed()).max(0.0)
        }
    }

    /// Whether the present state is at rest at the end of the motion.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.state.position == *self.plan.end() && self.state.is_at_rest()
    }

    fn elapsed(&self) -> f64 {
        self.cycle as f64 * CYCLE
    }

    fn plan_target(&mut self, target: &[f64; N]) -> Result<(), PlanError> {
        let start = Start {
            state: self.state,
            line: self.plan.line_at(self.elapsed()),
            limits: &self.limits,
        };
        self.plan.go_to(target, &start, self.synchronisation)?;
        self.goal = Goal::Target;
        self.cycle = 0;
        Ok(())
    }

    fn plan_stop(&mut self) {
        let start = Start {
            state: self.state,
            line: self.plan.line_at(self.elapsed()),
            limits: &self.limits,
        };
        self.plan.stop(&start);
        self.goal = Goal::Rest;
        self.cycle = 0;
    }
}

/// Refuses a state too many orders of magnitude from its limits to stop from.
fn check_range<const N: usize>(state: &State<N>, limits: &Limits<N>) -> Result<(), PlanError> {
    match (0..N).find(|&i| !can_stop(state.axis(i), limits.axis(i))) {
        Some(axis) => Err(PlanError::OutOfRange { axis }),
        None => Ok(()),
    }
}
