//! `franka stop`: whatever this computer can stop.

use clap::Args;
use franka_async::state::RobotMode;
use serde_json::json;

use crate::connection::Which;
use crate::ending::{Ending, Failure};
use crate::output::Output;

/// Stop the robot, as far as this computer can
///
/// A robot takes one client at a time: one that another program moves is stopped by that program
/// (Ctrl-C), or by the user stop.
#[derive(Debug, Args)]
pub(crate) struct Stop {
    #[command(flatten)]
    which: Which,
    #[command(flatten)]
    output: Output,
}

impl Stop {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let (robot, place) = self.which.connect().await?;
        // The motion of a client that has gone ended with its connection.
        let stopped = robot.stop().await;
        let state = robot.state();
        robot.shutdown().await;
        stopped?;
        if matches!(state.robot_mode, RobotMode::Move | RobotMode::Guiding) {
            let message = format!("the robot at {place} goes on: mode {}", state.robot_mode);
            let failure = Failure::new(Ending::Taken, message);
            return Err(failure
                .advice("What moves it is not a client: press the user stop.")
                .into());
        }
        let mode = state.robot_mode.to_string();
        let value = json!({ "mode": mode, "at_rest": true });
        self.output.print(&value, || {
            format!("nothing moves the robot at {place}: mode {mode}")
        })
    }
}
