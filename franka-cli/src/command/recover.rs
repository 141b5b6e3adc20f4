//! `franka recover`: out of a reflex.

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

/// Lead the robot out of a reflex
///
/// An automatic error recovery. Says why the robot stopped, and asks: what the arm presses against
/// may give way.
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
            false => format!("the robot at {place} was ready: nothing to recover from"),
        })
    }

    /// Returns the state before.
    async fn recover(&self, robot: &Robot, place: &Place) -> anyhow::Result<RobotState> {
        let state = robot.state();
        if state.robot_mode != RobotMode::Reflex {
            check_ready(&state, place)?;
            return Ok(state);
        }
        say(diagnosis(&state, robot).trim_end());
        let title = title("recover", robot.model().kind(), place);
        let what = "The robot frees itself. Where the arm presses against something, it may give way by some mm.";
        question::ask(&format!("{title}\n{what}"), self.yes).await?;
        let interrupt = interrupted()?;
        let recovered = tokio::select! {
            recovered = robot.recover() => recovered,
            by = interrupt => {
                let message = "interrupted: the robot may recover all the same";
                return Err(by.failure(message).into());
            }
        };
        recovered.map_err(|error| {
            let message = format!("the robot was not recovered: {error}");
            Failure::new(Ending::Failed, message)
                .advice("If it names a manual recovery, it takes a person at the robot, or Desk.")
        })?;
        let mut states = robot.states();
        let idle = states.wait_for(|state| state.robot_mode == RobotMode::Idle);
        let idle = tokio::time::timeout(PATIENCE, idle).await;
        idle.context("the robot does not become ready")??;
        Ok(state)
    }
}

/// Why the robot stopped. The cycles before went to the program whose motion it was: the errors
/// tell what they can.
fn diagnosis(state: &RobotState, robot: &Robot) -> String {
    let case = Case {
        commander: Commander::Goals,
        errors: state.reflex_reason,
        log: Arc::new(ControlLog::with_capacity(0)),
        statistics: None,
    };
    Diagnosis::of(&case, robot.model()).to_string()
}

/// For a robot to become ready.
const PATIENCE: Duration = Duration::from_secs(10);
