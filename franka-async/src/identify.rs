//! Torques that an arm takes in addition to its model, measured by a minute of small motions: see
//! [`Robot::identify`] and [`Builder::known`](crate::connection::Builder::known).

use std::future::IntoFuture;
use std::pin::pin;
use std::time::Duration;

use franka_rt::identify::{Fit, Plan};
use tokio::sync::broadcast::error::RecvError;

pub use franka_rt::identify::{
    Estimate, Identified, IdentifiedJoint, IdentifiedLoad, PlannedMotion, Reach,
};

use crate::arm::Engage;
use crate::error::IdentifyError;
use crate::robot::Robot;

/// Motions that would show friction and bias of the joints and the load at the flange. Made by
/// [`Robot::identify`]; nothing moves before [`Self::run`] is awaited.
#[derive(Clone, Debug)]
#[must_use = "an identification does nothing until it is run"]
pub struct Identify {
    robot: Robot,
    plan: Plan,
}

impl Robot {
    /// Plans motions from the present position of the arm that identify it. In each of six poses
    /// all joints go 0.2 rad to and fro twice, at 0.2 rad/s. The arm must be free to go so far
    /// ([`Identify::reach`]), and carry the load that it should be identified with.
    ///
    /// ```no_run
    /// # async fn run(robot: franka_async::Robot) -> Result<(), franka_async::Error> {
    /// let identify = robot.identify();
    /// for motion in identify.motions() {
    ///     println!("{motion}");
    /// }
    /// println!("{:.0?}, up to {:.2} m away", identify.duration(), identify.reach().end_effector);
    /// let found = identify.run().await?;
    /// println!("{found}");
    /// # Ok(())
    /// # }
    /// ```
    pub fn identify(&self) -> Identify {
        Identify {
            plan: Plan::new(self.model(), &self.state()),
            robot: self.clone(),
        }
    }
}

impl Identify {
    /// Planned motions, in this order; the last one ends where the first one begins. `Display` is a
    /// line for each.
    pub fn motions(&self) -> &[PlannedMotion] {
        self.plan.motions()
    }

    /// About how long it will take.
    pub fn duration(&self) -> Duration {
        self.plan.duration()
    }

    /// Distance that the arm will go from where it is. A compliant arm is some millimetres off its
    /// reference.
    pub fn reach(&self) -> Reach {
        self.plan.reach()
    }

    /// Moves the arm and returns its identified values. Nothing changes at the robot or in this
    /// connection, which learns in any motion. Pass the result to
    /// [`Builder::known`](crate::connection::Builder::known) of later connections, and declare the
    /// load by [`Robot::set_load`] if you like.
    ///
    /// # Errors
    /// [`IdentifyError`] if a motion fails, if the arm is no longer where it was planned from, or
    /// if something held or pushed it.
    ///
    /// # Cancel safety
    /// Dropping the future brakes the arm, in the background, as dropping a motion does; the
    /// measurements are lost.
    pub async fn run(self) -> Result<Identified, IdentifyError> {
        let Self { robot, plan } = self;
        let state = robot.state();
        for (i, (&got, &expected)) in state.q.iter().zip(plan.start()).enumerate() {
            // A non-finite position counts as moved.
            let stayed = (got - expected).abs() < MOVED;
            if !stayed {
                let joint = i + 1;
                return Err(IdentifyError::Moved {
                    joint,
                    got,
                    expected,
                });
            }
        }
        let mut fit = Fit::new(robot.model(), &state);
        let mut records = robot.records();
        let arm = robot
            .engage(Engage::default().limits(plan.budget()))
            .await?;
        for motion in plan.motions() {
            let moving = arm.move_joints(motion.to).tolerance(Plan::TOLERANCE);
            let mut moving = pin!(moving.into_future());
            let mut is_open = true;
            loop {
                tokio::select! {
                    biased;
                    record = records.recv(), if is_open => match record {
                        Ok(record) => fit.on_record(&record),
                        Err(RecvError::Lagged(_)) => {}
                        // The motion has the reason.
                        Err(RecvError::Closed) => is_open = false,
                    },
                    outcome = &mut moving => {
                        outcome?;
                        break;
                    }
                }
            }
        }
        arm.disengage().await?;
        Ok(fit.finish()?)
    }
}

/// Distance that a joint may be from where the motions begin, `[rad]`. The robot's controller lets
/// it sink less than that after a motion.
const MOVED: f64 = 0.02;
