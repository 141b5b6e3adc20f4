//! `franka limits`: prints the limits of the joints and the hand.

use std::fmt::Write as _;

use clap::{Args, ValueEnum};
use franka_async::model::{Model, RobotKind};
use serde_json::json;

use crate::connection::{Which, kind_name};
use crate::ending::Ending;
use crate::output::{BOLD, Output};

/// Print the limits of the arm
///
/// The robot reports them; with --kind, they are the vendor's published limits.
#[derive(Debug, Args)]
pub(crate) struct Limits {
    #[command(flatten)]
    which: Which,
    /// Print the published limits of this kind of robot, without a connection
    #[arg(long, value_enum, conflicts_with = "robot")]
    kind: Option<Kind>,
    #[command(flatten)]
    output: Output,
}

/// The kinds of robot by their short names.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Kind {
    /// Franka Research 3
    Fr3,
    /// Franka Emika Robot, known as Panda
    Fer,
}

impl Kind {
    /// Returns the constant model of this kind of robot.
    pub(crate) fn model(self) -> &'static Model {
        Model::of(match self {
            Self::Fr3 => RobotKind::Fr3,
            Self::Fer => RobotKind::Fer,
        })
    }
}

impl Limits {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        if let Some(kind) = self.kind {
            return print(kind.model(), self.output);
        }
        let (robot, _) = self.which.connect().await?;
        robot.shutdown().await;
        print(robot.model(), self.output)
    }
}

fn print(model: &Model, output: Output) -> anyhow::Result<Ending> {
    let (joints, hand) = (model.joint_limits(), model.cartesian_limits());
    let array = |vector: &franka_async::model::JointVector| <[f64; 7]>::from(*vector);
    let axis = |limits: &franka_async::model::limits::MotionLimits| {
        json!({
            "velocity": limits.velocity,
            "acceleration": limits.acceleration,
            "jerk": limits.jerk,
        })
    };
    let value = json!({
        "kind": kind_name(model.kind()),
        "joints": {
            "lower": array(&joints.lower),
            "upper": array(&joints.upper),
            "velocity": array(&joints.velocity),
            "acceleration": array(&joints.acceleration),
            "jerk": array(&joints.jerk),
            "torque": array(&joints.torque),
            "torque_rate": array(&joints.torque_rate),
        },
        "translation": axis(&hand.translation),
        "rotation": axis(&hand.rotation),
        "elbow": axis(&hand.elbow),
    });
    output.print(&value, || {
        let mut text = format!(
            "{BOLD}{}{BOLD:#}\n{BOLD}joint  from deg   to deg  from rad   to rad   rad/s  rad/s2   rad/s3    N m{BOLD:#}\n",
            kind_name(model.kind())
        );
        for i in 0..7 {
            let (lower, upper) = (joints.lower[i], joints.upper[i]);
            let _ = writeln!(
                text,
                "{:>5}  {:>8.1} {:>8.1}  {lower:>8.4} {upper:>8.4}  {:>6.3}  {:>6.2}  {:>7.0}  {:>5.0}",
                i + 1,
                lower.to_degrees(),
                upper.to_degrees(),
                joints.velocity[i],
                joints.acceleration[i],
                joints.jerk[i],
                joints.torque[i]
            );
        }
        for (name, unit, limits) in [
            ("hand", "m", &hand.translation),
            ("hand turns", "rad", &hand.rotation),
            ("elbow", "rad", &hand.elbow),
        ] {
            let _ = writeln!(
                text,
                "{name:<10}  {:.2} {unit}/s, {:.1} {unit}/s2, {:.0} {unit}/s3",
                limits.velocity, limits.acceleration, limits.jerk
            );
        }
        text
    })
}
