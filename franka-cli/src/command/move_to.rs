//! `franka move`: moves the arm to joint positions, to a pose, or by an offset.

use clap::Args;
use franka_async::goal::Destination;
use franka_async::nalgebra::UnitQuaternion;
use franka_async::{MotionReport, Offset, Pose, READY, Robot};
use franka_sim::command_line::numbers;

use crate::ending::Ending;
use crate::motion::{Length, Mover, Moving};
use crate::output::Output;
use crate::question::Target;
use crate::values::{PartialPose, partial_pose, positive};

/// Move the arm
///
/// Uses a fifth of the limits, and at most 300 mm/s at the hand. Shows how far each joint and the
/// hand will move, and asks. Ctrl-C brakes.
#[derive(Debug, Args)]
pub(crate) struct Move {
    #[command(flatten)]
    mover: Mover,
    #[command(flatten)]
    target: Aim,
    /// Interpret --joints as degrees
    #[arg(long, requires = "joints")]
    degrees: bool,
    /// Use the axes of the end effector for --by
    #[arg(long, requires = "by")]
    tool: bool,
    /// Speed, as a factor of the default
    #[arg(long, value_name = "FACTOR", value_parser = positive, default_value = "1")]
    speed: f64,
}

/// The target of the motion.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Aim {
    /// Move the end effector to a pose in a straight line: x,y,z (m, same orientation),
    /// x,y,z,roll,pitch,yaw (degrees), or x,y,z,qx,qy,qz,qw
    #[arg(long, value_parser = partial_pose, allow_hyphen_values = true)]
    pose: Option<PartialPose>,
    /// Move the joints to these positions, in radians
    #[arg(long, value_name = "Q1,...,Q7", value_parser = numbers::<7>, allow_hyphen_values = true)]
    joints: Option<[f64; 7]>,
    /// Move the joints to the ready pose
    #[arg(long)]
    ready: bool,
    /// Move the end effector by an offset: x,y,z (m), or x,y,z,roll,pitch,yaw (degrees)
    #[arg(long, value_name = "X,Y,Z", value_parser = partial_pose, allow_hyphen_values = true)]
    by: Option<PartialPose>,
}

impl Move {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let moving = self.mover.begin().await?;
        let outcome = self.go(&moving).await;
        let report = moving.end(outcome).await?;
        print(&report, self.mover.how.output)
    }

    fn target(&self, robot: &Robot) -> (Target, Destination) {
        let now = robot.pose();
        if let Some(pose) = self.target.pose {
            let pose = pose.complete(&now);
            return (Target::Pose(pose), pose.into());
        }
        if let Some(by) = self.target.by {
            let turn = by.rotation.unwrap_or(UnitQuaternion::identity());
            let way = Pose::from_parts(by.position.into(), turn);
            if self.tool {
                return (Target::Pose(now * way), Offset::tool(way).into());
            }
            let rotation = way.rotation * now.rotation;
            let position = now.translation.vector + way.translation.vector;
            let end = Pose::from_parts(position.into(), rotation);
            return (Target::Pose(end), Offset::base(way).into());
        }
        let q = match self.target.joints {
            Some(q) if self.degrees => q.map(f64::to_radians),
            Some(q) => q,
            None => READY.into(),
        };
        (Target::Joints(q), q.into())
    }

    async fn go(&self, moving: &Moving) -> anyhow::Result<MotionReport> {
        let robot = &moving.robot;
        let (target, destination) = self.target(robot);
        let what = target.describe(robot, self.speed)?;
        moving.ask("move", &what).await?;
        let motion = robot.move_to(destination).speed(self.speed);
        let handle = motion.handle();
        moving
            .drive(motion.into_future(), Some(Length::Of(handle)))
            .await
    }
}

fn print(report: &MotionReport, output: Output) -> anyhow::Result<Ending> {
    output.print(report, || {
        let off = report.final_error.map(|error| {
            format!(
                ", {:.1} mm and {:.1} mrad from the target",
                error.translation * 1e3,
                error.rotation * 1e3
            )
        });
        format!(
            "arrived after {:.1} s{}; {} states lost",
            report.duration.as_secs_f64(),
            off.unwrap_or_default(),
            report.lost_states
        )
    })
}
