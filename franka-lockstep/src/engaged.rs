//! Sessions that move the arm from goal to goal.

use franka_rt::lifecycle::{Engagement, MotionError, NewMotion, Tuning};
use franka_rt::session::{Backend, Chunk, Goal, GoalId, OnArrival, Target, Waypoint};

use super::Lockstep;
use super::guard::CommandGuard;

impl Lockstep {
    /// Begins a session with default options, and advances until the session holds the arm.
    ///
    /// # Panics
    /// Panics if the session is refused, or does not begin within a second.
    pub fn engage(&mut self) -> GoalId {
        self.engage_with(Engagement::default())
    }

    /// Like [`Self::engage`], with the given options, for example a deadman timeout.
    ///
    /// # Panics
    /// Panics like [`Self::engage`].
    pub fn engage_with(&mut self, engagement: Engagement) -> GoalId {
        let id = self.begin_session(engagement);
        for _ in 0..1000 {
            self.tick();
            if self.client.record.goal == id.0 {
                return id;
            }
        }
        panic!("no session after a second: {:?}", self.client.lifecycle);
    }

    /// Requests a session, without waiting until it holds the arm.
    ///
    /// # Panics
    /// Panics if the session is refused immediately.
    pub fn begin_session(&mut self, engagement: Engagement) -> GoalId {
        // The robot itself checks setpoints, so only torques need a check here.
        self.guard = (engagement.backend == Backend::Torques)
            .then(|| CommandGuard::new(*self.model.joint_limits()));
        self.try_engage(engagement).expect("nothing else moves")
    }

    /// Requests a session.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::begin`](franka_rt::lifecycle::Lifecycle::begin).
    pub fn try_engage(&mut self, engagement: Engagement) -> Result<GoalId, MotionError> {
        let goal = self.goal(Target::Rest, OnArrival::Hold);
        self.client.begin(NewMotion::Session {
            goal: Box::new(goal),
            engagement,
        })
    }

    /// Submits a goal to the session `engaged`. `on_arrival` decides whether the goal ends on
    /// arrival, or holds the target until the next goal.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::begin`](franka_rt::lifecycle::Lifecycle::begin).
    pub fn within(
        &mut self,
        engaged: GoalId,
        target: Target,
        on_arrival: OnArrival,
    ) -> Result<GoalId, MotionError> {
        let goal = self.goal(target, on_arrival);
        self.submit_within(engaged, goal)
    }

    /// Submits this goal to the session `engaged`.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::begin`](franka_rt::lifecycle::Lifecycle::begin).
    pub fn submit_within(&mut self, engaged: GoalId, goal: Goal) -> Result<GoalId, MotionError> {
        self.client.begin(NewMotion::Goal {
            goal: Box::new(goal),
            path: None,
            ticket: None,
            session: Some(engaged),
        })
    }

    /// Moves through `waypoints`, in a separate motion, or within the session `engaged` if given.
    ///
    /// # Errors
    /// Returns the errors of [`Chunk::through`] and
    /// [`Lifecycle::begin`](franka_rt::lifecycle::Lifecycle::begin).
    pub fn through(
        &mut self,
        engaged: Option<GoalId>,
        waypoints: &[Waypoint],
    ) -> Result<GoalId, MotionError> {
        let on_arrival = match engaged {
            Some(_) => OnArrival::ReportAndHold,
            None => OnArrival::ReportAndFinish,
        };
        let last = waypoints.last().map_or(Target::Rest, |last| *last.target());
        let motion = NewMotion::Goal {
            goal: Box::new(self.goal(last, on_arrival)),
            path: None,
            ticket: None,
            session: engaged,
        };
        self.client.begin_along(waypoints, motion)
    }

    /// Sends a chunk (a series of timed points) to the session.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::chunk`](franka_rt::lifecycle::Lifecycle::chunk).
    pub fn chunk(&mut self, engaged: GoalId, chunk: Chunk) -> Result<(), MotionError> {
        let goal = self.goal(chunk.target(), OnArrival::Hold);
        self.submit_chunk(engaged, goal, chunk).map(|_| ())
    }

    /// Sends a chunk with this goal. The id of the goal identifies the chunk, unless the chunk
    /// continues an earlier chunk.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::chunk`](franka_rt::lifecycle::Lifecycle::chunk).
    pub fn submit_chunk(
        &mut self,
        engaged: GoalId,
        goal: Goal,
        chunk: Chunk,
    ) -> Result<GoalId, MotionError> {
        let client = &mut self.client;
        let sent = client.lifecycle.chunk(engaged, goal, chunk, &client.state);
        client.carry_out();
        sent.map(|()| goal.id)
    }

    /// Changes the gains, the budget or the force limit of the session.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::tune`](franka_rt::lifecycle::Lifecycle::tune).
    pub fn tune(&mut self, engaged: GoalId, tuning: Tuning) -> Result<(), MotionError> {
        let client = &mut self.client;
        client.lifecycle.tune(engaged, tuning, &client.state)
    }

    /// Ends the session.
    pub fn disengage(&mut self, engaged: GoalId) {
        let client = &mut self.client;
        client.lifecycle.disengage(engaged);
        self.client.carry_out();
    }
}
