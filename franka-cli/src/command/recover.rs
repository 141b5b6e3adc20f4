//! `franka recover`: recovers the robot from a reflex.

use std::sync::Arc;
use std::time::Duration;

use anyhow::Context as _;
use clap::Args;
use franka_async::Robot;
use franka_async::diagnosis::{Case, Commander, Diagnosis};
use franka_async::record::ControlLog;
use franka_async::state::{RobotMode, RobotState};
use serde_json::json;

use crate::connection::{Place, Which, check_ready};
use crate::ending::{Ending, Failure};
use crate::interrupt::interrupted;
use crate::output::{Output, say};
use crate::question::{self, title};

/// Recover the robot from a reflex
///
/// Shows why the robot stopped, asks, and runs an automatic error recovery. The arm can move if it
/// presses against something that yields.
#[derive(Debug, Args)]
pub(crate) struct Recover {
    #[command(flatten)]
    which: Which,
    /// Recover without asking, for scripts
    #[arg(short, long)]
    yes: bool,
    #[command(flatten)]
    output: Output,
}

impl Recover {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let (robot, place) = self.which.connect().await?;
        let outcome = self.recover(&robot, &place).await;
        robot.shutdown().await;
        let before = outcome?;
        let recovered = before.robot_mode == RobotMode::Reflex;
        let value = json!({ "recovered": recovered, "errors": before.errors });
        self.output.print(&value, || match recovered {
            true => format!("the robot at {place} is ready"),
            false => format!("the robot at {place} is already ready: no recovery needed"),
        })
    }

    /// Recovers the robot, and returns the state before the recovery.
    async fn recover(&self, robot: &Robot, place: &Place) -> anyhow::Result<RobotState> {
        let state = robot.state();
        if state.robot_mode != RobotMode::Reflex {
            check_ready(&state, place)?;
            return Ok(state);
        }
        say(diagnosis(&state, robot).trim_end());
        let title = title("recover", robot.model().kind(), place);
        let what = "The robot ends the reflex. An arm that presses against an object may move by \
            some millimetres.";
        question::ask(&format!("{title}\n{what}"), self.yes).await?;
        let interrupt = interrupted()?;
        let recovered = tokio::select! {
            recovered = robot.recover() => recovered,
            by = interrupt => {
                let message = "interrupted: the robot may still complete the recovery";
                return Err(by.failure(message).into());
            }
        };
        recovered.map_err(|error| {
            let message = format!("the robot was not recovered: {error}");
            Failure::new(Ending::Failed, message)
                .advice("A manual recovery must be done at the robot or in Desk.")
        })?;
        let mut states = robot.states();
        let idle = states.wait_for(|state| state.robot_mode == RobotMode::Idle);
        let idle = tokio::time::timeout(PATIENCE, idle).await;
        idle.context("the robot did not become ready")??;
        Ok(state)
    }
}

/// Explains why the robot stopped. The explanation uses only the robot's errors, because another
/// program received the cycles before the stop.
fn diagnosis(state: &RobotState, robot: &Robot) -> String {
    let case = Case {
        commander: Commander::Goals,
        errors: state.reflex_reason,
        log: Arc::new(ControlLog::with_capacity(0)),
        statistics: None,
    };
    Diagnosis::of(&case, robot.model()).to_string()
}

/// Time limit for a robot to become ready.
const PATIENCE: Duration = Duration::from_secs(10);
