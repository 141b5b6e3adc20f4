//! `franka stop`: stops the motions that this computer can stop.

use clap::Args;
use franka_async::state::RobotMode;
use serde_json::json;

use crate::connection::Which;
use crate::ending::{Ending, Failure};
use crate::output::Output;

/// Stop the robot (cannot stop a motion of another client)
///
/// A robot accepts one client at a time. If another program moves the robot, stop that program
/// (Ctrl-C) or press the user stop.
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
        // A motion of an earlier client has ended together with that client's connection.
        let stopped = robot.stop().await;
        let state = robot.state();
        robot.shutdown().await;
        stopped?;
        if matches!(state.robot_mode, RobotMode::Move | RobotMode::Guiding) {
            let message = format!(
                "the robot at {place} still moves: mode {}",
                state.robot_mode
            );
            let failure = Failure::new(Ending::Taken, message);
            return Err(failure
                .advice("No client moves it: press the user stop.")
                .into());
        }
        let mode = state.robot_mode.to_string();
        let value = json!({ "mode": mode, "at_rest": true });
        self.output.print(&value, || {
            format!("no motion runs on the robot at {place}: mode {mode}")
        })
    }
}
