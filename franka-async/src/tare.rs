//! The external wrench without the offset that the robot reports with nothing attached: see
//! [`Robot::tare`].

use std::ops::ControlFlow;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use franka_proto::RobotState;
use franka_rt::tare::{TareRefused, Taring, WrenchTare};
use futures::{Stream, StreamExt};

use crate::error::TareError;
use crate::robot::Robot;
use crate::states::States;

/// A state and its external wrench minus a tare: see [`Robot::tared_states`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TaredState {
    /// The state, as the robot reports it.
    pub state: RobotState,
    /// Wrench minus the tare, as [`WrenchTare::compensate`] returns it, `[N, N m]`. `None` if the
    /// robot has no estimate.
    pub wrench: Option<[f64; 6]>,
    /// Largest change of any joint position since the tare, `[rad]`. The tare is assumed to hold
    /// within [`WrenchTare::NEAR`].
    pub turned: f64,
}

/// Stream of the newest state as it changes, with the wrench minus a tare: see
/// [`Robot::tared_states`].
#[derive(Clone, Debug)]
pub struct TaredStates {
    states: States,
    tare: WrenchTare,
}

impl TaredStates {
    /// Returns the newest state that was published.
    pub fn newest(&self) -> TaredState {
        self.tared(self.states.newest())
    }

    fn tared(&self, state: RobotState) -> TaredState {
        TaredState {
            wrench: self.tare.compensate(&state),
            turned: self.tare.turned(&state),
            state,
        }
    }
}

impl Stream for TaredStates {
    type Item = TaredState;

    fn poll_next(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<TaredState>> {
        let state = self.states.poll_next_unpin(context);
        state.map(|state| state.map(|state| self.tared(state)))
    }
}

impl Robot {
    /// Averages the robot's estimate of external forces and torques over half a second of its
    /// clock. Subtract this average later, because robots report a newton or two with nothing
    /// attached. [`Self::tare_over`] averages over a different duration.
    ///
    /// The arm must rest, and nothing may touch it. A tare is valid for the posture in which it was
    /// taken. In a different posture, an undeclared load, cables and errors of the model pull
    /// differently, and friction differs after each motion. [`WrenchTare::turned`] reports how far
    /// the arm has turned since; if this exceeds [`WrenchTare::NEAR`], take a new tare. The robot
    /// itself does not change: its contact and collision thresholds apply to the wrench as before.
    ///
    /// ```no_run
    /// use franka_async::condition::force_z;
    /// # use franka_async::{Offset, Pose};
    /// # async fn run(robot: franka_async::Robot) -> Result<(), franka_async::Error> {
    ///
    /// let tare = robot.tare().await?;
    /// let down = Offset::base(Pose::translation(0.0, 0.0, -0.02));
    /// robot.move_to(down).speed(0.1).until(force_z(8.0).tared(&tare)).await?;
    /// let state = robot.state();
    /// if let Some([_, _, force, ..]) = tare.compensate(&state) {
    ///     println!("the arm presses with {:.1} N", -force);
    /// }
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Returns [`TareError::Refused`] if the arm moves, is touched or guided, or if the robot has
    /// no estimate in this posture. Returns [`TareError::Read`] if states no longer come.
    ///
    /// # Cancel safety
    /// Dropping the future takes no tare and moves nothing.
    pub async fn tare(&self) -> Result<WrenchTare, TareError> {
        self.tare_over(WrenchTare::DURATION).await
    }

    /// Takes a tare as [`Self::tare`] does, over a given duration: 20 ms to a minute.
    ///
    /// # Errors
    /// Returns the errors of [`Self::tare`], and refuses a duration out of range.
    ///
    /// # Cancel safety
    /// See [`Self::tare`].
    pub async fn tare_over(&self, duration: Duration) -> Result<WrenchTare, TareError> {
        let mut taring = Taring::over(duration)?;
        self.check_reference()?;
        let taken = self.read(|state| match taring.push(state) {
            Ok(None) => ControlFlow::Continue(()),
            Ok(Some(tare)) => ControlFlow::Break(Ok(tare)),
            Err(refused) => ControlFlow::Break(Err(refused)),
        });
        let tare = taken.await??;
        self.check_reference()?;
        Ok(tare)
    }

    /// Returns the stream of [`Self::states`] with each state's wrench minus `tare`. The stream
    /// keeps this tare until it is dropped, also across postures, which each
    /// [`turned`](TaredState::turned) shows.
    pub fn tared_states(&self, tare: &WrenchTare) -> TaredStates {
        TaredStates {
            states: self.states(),
            tare: *tare,
        }
    }

    /// Returns an error while the reference moves, because friction may still hold an arm that
    /// should move.
    fn check_reference(&self) -> Result<(), TareRefused> {
        let moves = |dq: &f64| dq.abs() > 1e-4;
        match self.reference() {
            Some(reference) if reference.dq.iter().any(moves) => Err(TareRefused::UnderWay),
            _ => Ok(()),
        }
    }
}
