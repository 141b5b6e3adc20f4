//! `franka collision`: sets the thresholds at which the robot detects a contact and stops.

use clap::{Args, ValueEnum};
use franka_async::settings::CollisionBehavior;
use serde_json::json;

use crate::connection::{Which, check_ready};
use crate::ending::Ending;
use crate::output::Output;

/// Set the collision thresholds, at which the robot stops itself
///
/// They apply until they are set again or the robot restarts.
#[derive(Debug, Args)]
pub(crate) struct Collision {
    /// Threshold preset
    #[arg(value_enum)]
    preset: Preset,
    #[command(flatten)]
    which: Which,
    #[command(flatten)]
    output: Output,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Preset {
    /// Stops at a light push: 10 N and 10 N m, 20 while the arm accelerates
    Careful,
    /// Lets you push a compliant arm: stops at 60 N and 60 N m
    Compliant,
    /// Stops at 100 N and 100 N m
    Insensitive,
}

impl Collision {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let behavior = match self.preset {
            Preset::Careful => CollisionBehavior::careful(),
            Preset::Compliant => CollisionBehavior::compliant(),
            Preset::Insensitive => CollisionBehavior::insensitive(),
        };
        let (robot, place) = self.which.connect().await?;
        let outcome = async {
            check_ready(&robot.state(), &place)?;
            robot.set_collision_behavior(behavior).await?;
            anyhow::Ok(())
        };
        let outcome = outcome.await;
        robot.shutdown().await;
        outcome?;
        let torques = behavior.upper_torque_thresholds_nominal;
        let forces = behavior.upper_force_thresholds_nominal;
        let value = json!({ "upper_torques": torques, "upper_forces": forces });
        self.output.print(&value, || {
            format!(
                "the robot at {place} stops itself at {:.0} N and {:.0} N m",
                forces[0], torques[0]
            )
        })
    }
}
