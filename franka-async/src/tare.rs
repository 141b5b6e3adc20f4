//! The external wrench without the offset that the robot reports with nothing attached: see
//! [`Robot::tare`].

use std::ops::ControlFlow;
use std::time::Duration;

use franka_rt::tare::{TareRefused, Taring, WrenchTare};

use crate::error::TareError;
use crate::robot::Robot;

impl Robot {
    /// Averages the robot's estimate of external forces and torques over half a second of its
    /// clock, to subtract it later: robots show a newton or two with nothing attached.
    /// [`Self::tare_over`] takes another time.
    ///
    /// The arm must rest, untouched. A tare belongs to the posture in which it was taken: in
    /// another posture, an undeclared load, cables and errors of the model pull differently, and
    /// friction sticks differently after each motion. [`WrenchTare::turned`] reports how far the
    /// arm has turned since; beyond [`WrenchTare::NEAR`], take a new one. Nothing is changed at the
    /// robot, whose own contact and collision thresholds see the wrench as before.
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
    /// [`TareError::Refused`] if the arm moves, is touched or guided, or the robot has no estimate
    /// there; [`TareError::Read`] if states no longer come.
    ///
    /// # Cancel safety
    /// Nothing moves and nothing is kept: dropping the future takes no tare.
    pub async fn tare(&self) -> Result<WrenchTare, TareError> {
        self.tare_over(WrenchTare::DURATION).await
    }

    /// As [`Self::tare`], over another time: 20 ms to a minute.
    ///
    /// # Errors
    /// As [`Self::tare`]; a time out of range is refused.
    ///
    /// # Cancel safety
    /// As [`Self::tare`].
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

    /// An arm that should move may still stick, while it is pushed against its friction.
    fn check_reference(&self) -> Result<(), TareRefused> {
        let moves = |dq: &f64| dq.abs() > 1e-4;
        match self.reference() {
            Some(reference) if reference.dq.iter().any(moves) => Err(TareRefused::UnderWay),
            _ => Ok(()),
        }
    }
}
