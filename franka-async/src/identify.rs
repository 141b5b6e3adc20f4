//! Measures the torques of an arm that its model does not contain, with small motions that take a
//! minute: see [`Robot::identify`] and [`Builder::known`](crate::connection::Builder::known).

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

/// Planned motions that measure the friction and bias of the joints, and the load at the flange.
/// [`Robot::identify`] plans them; nothing moves until [`Self::run`] is awaited.
#[derive(Clone, Debug)]
#[must_use = "an identification does nothing until it is run"]
pub struct Identify {
    robot: Robot,
    plan: Plan,
}

impl Robot {
    /// Plans motions that identify the friction, the bias and the load of the arm. They begin at
    /// the arm's present position. In each of six poses, all joints move to and fro twice, by 0.2
    /// rad at 0.2 rad/s. The space around the arm must be free ([`Identify::reach`]), and the arm
    /// must carry the load that you want to identify.
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
    /// Returns the planned motions in order; the last one ends where the first one begins.
    /// `Display` prints one line for each.
    pub fn motions(&self) -> &[PlannedMotion] {
        self.plan.motions()
    }

    /// Returns the approximate duration of all motions.
    pub fn duration(&self) -> Duration {
        self.plan.duration()
    }

    /// Returns how far the motions take the arm from its present position. Leave some more
    /// millimetres free, because a compliant arm deviates from its commanded path.
    pub fn reach(&self) -> Reach {
        self.plan.reach()
    }

    /// Moves the arm and returns its identified values. This changes neither the robot nor this
    /// connection; the driver learns the values in every motion anyway. Pass the result to
    /// [`Builder::known`](crate::connection::Builder::known) for later connections, and declare the
    /// load with [`Robot::set_load`] if you like.
    ///
    /// # Errors
    /// Returns [`IdentifyError`] if a motion fails, if the arm is no longer where the plan begins,
    /// or if something held or pushed the arm.
    ///
    /// # Cancel safety
    /// Dropping the future brakes the arm in the background; the measurements are lost.
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
                        // The motion itself reports the reason.
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

/// Largest distance of a joint from the start of the motions, `[rad]`. Under the robot's
/// controller, a joint sinks by less than this after a motion.
const MOVED: f64 = 0.02;
