//! `franka replay`: repeats a recorded motion.

use clap::{Args, ValueEnum};
use franka_async::recording::{Sample, Samples};
use franka_async::replay::{ReplayOptions, ReplayPlan, ReplayReport, ReplaySource, ReplayTargets};
use serde_json::json;

use super::explain::Recorded;
use crate::connection::Which;
use crate::ending::{Ending, Failure};
use crate::motion::{Length, MoverOptions, Moving};
use crate::question::Target;
use crate::values::positive;

/// Repeat a recorded motion
///
/// Moves to the start of the recorded motion first. Shows how far that is, and asks. Ctrl-C brakes.
#[derive(Debug, Args)]
pub(crate) struct Replay {
    #[command(flatten)]
    recorded: Recorded,
    #[command(flatten)]
    which: Which,
    #[command(flatten)]
    how: MoverOptions,
    /// Speed, as a factor of the recorded speed, 0.01 to 1
    #[arg(long, value_name = "SHARE", value_parser = positive, default_value = "1")]
    speed: f64,
    /// Positions to follow
    #[arg(long, value_enum, default_value_t = Source::Reference)]
    source: Source,
    /// Follow the recorded pose of the hand; the elbow can differ
    #[arg(long)]
    poses: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Source {
    /// Commanded positions
    Reference,
    /// Measured positions, for arms that were guided by hand
    Measured,
}

impl Replay {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let opened = self.recorded.open()?;
        let robot = opened.recording.robot(&opened.name)?;
        let samples = Samples::new(robot.cycles(), robot.gripper_states());
        let samples: Vec<Sample> = samples.collect::<Result<_, _>>()?;
        let mut options = ReplayOptions::default().speed(self.speed);
        if let Source::Measured = self.source {
            options = options.source(ReplaySource::Measured);
        }
        if self.poses {
            options = options.targets(ReplayTargets::Poses);
        }
        let moving = self.how.begin(&self.which).await?;
        let plan = ReplayPlan::new(
            opened.model.model.kind(),
            &samples,
            options,
            moving.robot.model(),
        );
        let outcome = match plan {
            Ok(plan) => self.replay(&moving, &plan).await,
            Err(error) => {
                let failure = Failure::new(Ending::Failed, error.to_string());
                Err(failure.advice("Nothing has moved.").into())
            }
        };
        let report = moving.end(outcome).await?;
        let seconds = report.duration.as_secs_f64();
        let value = json!({
            "duration": seconds,
            "states": report.states,
            "joints": { "median": report.joints.median, "max": report.joints.max },
            "position": { "median": report.position.median, "max": report.position.max },
        });
        self.how.output.print(&value, || {
            format!(
                "replayed in {seconds:.1} s: the hand was off by {:.1} mm at most, {:.1} mm in \
                 the median",
                report.position.max * 1e3,
                report.position.median * 1e3
            )
        })
    }

    async fn replay(&self, moving: &Moving, plan: &ReplayPlan) -> anyhow::Result<ReplayReport> {
        let robot = &moving.robot;
        let checked = plan.check(robot.model(), &robot.state());
        checked.map_err(|error| Failure::new(Ending::Failed, error.to_string()))?;
        let budget = plan.budget();
        let fastest = budget.joints.map(|axis| axis.velocity.to_degrees());
        let fastest = fastest.into_iter().fold(0.0, f64::max);
        let what = format!(
            "First, the motion to the start of the recording:\n{}\nThen the recorded motion, for \
             {:.1} s: joints at {fastest:.0} deg/s at most.",
            Target::Joints(plan.start()).describe(robot, plan.speed())?,
            plan.duration().as_secs_f64(),
        );
        moving.ask("replay", &what).await?;
        let length = Some(Length::About(plan.duration()));
        moving.drive(robot.replay(plan), length).await
    }
}
