//! `franka model`: computes kinematics and dynamics of the arm.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand};
use franka_async::model::{
    EndEffector, Frame, JointVector, Load, Model as ArmModel, inverse_kinematics,
};
use franka_async::nalgebra::{Matrix, Storage, U1, U7};
use franka_async::{Pose, READY, pose};
use franka_sim::command_line::numbers;
use serde_json::json;

use super::limits::Kind;
use crate::connection::Which;
use crate::ending::{Ending, Failure};
use crate::output::{Output, numbers as columns};
use crate::values::{PartialPose, partial_pose};

/// Query the model of the arm: kinematics and dynamics
#[derive(Debug, Subcommand)]
pub(crate) enum Model {
    /// Print the pose of a frame of the arm in the base frame
    #[command(after_help = "Example: franka model pose --kind fr3 --frame flange")]
    Pose {
        #[command(flatten)]
        arm: Arm,
        /// Frame of the arm
        #[arg(long, value_parser = frame(), default_value = "end-effector")]
        frame: Frame,
    },
    /// Print joint positions for a pose of the end effector
    #[command(after_help = "Example: franka model ik left --pose 0.4,0.1,0.5")]
    Ik {
        #[command(flatten)]
        arm: Arm,
        /// x,y,z (m, same orientation), x,y,z,roll,pitch,yaw (degrees), or x,y,z,qx,qy,qz,qw
        #[arg(long, value_parser = partial_pose, allow_hyphen_values = true)]
        pose: PartialPose,
    },
    /// Print the Jacobian of a frame in the base frame: m/rad, then rad/rad
    #[command(after_help = "Example: franka model jacobian --kind fer")]
    Jacobian {
        #[command(flatten)]
        arm: Arm,
        /// Frame of the arm
        #[arg(long, value_parser = frame(), default_value = "end-effector")]
        frame: Frame,
    },
    /// Print the mass matrix in kg m2, with end effector and load
    #[command(after_help = "Example: franka model mass left")]
    Mass {
        #[command(flatten)]
        arm: Arm,
    },
}

/// An arm and its joint positions.
#[derive(Debug, Args)]
pub(crate) struct Arm {
    #[command(flatten)]
    which: Which,
    /// Use an arm of this kind with an empty flange, without a connection
    #[arg(long, value_enum, conflicts_with = "robot")]
    kind: Option<Kind>,
    /// Joint positions in radians [default: the robot's, or the ready pose]
    #[arg(long, value_name = "Q1,...,Q7", value_parser = numbers::<7>, allow_hyphen_values = true)]
    q: Option<[f64; 7]>,
    #[command(flatten)]
    output: Output,
}

/// The names of an arm's frames, in the order of [`Frame::ALL`].
const FRAMES: [&str; 10] = [
    "joint1",
    "joint2",
    "joint3",
    "joint4",
    "joint5",
    "joint6",
    "joint7",
    "flange",
    "end-effector",
    "stiffness",
];

fn frame() -> impl TypedValueParser<Value = Frame> {
    PossibleValuesParser::new(FRAMES).map(|name| {
        let found = FRAMES
            .iter()
            .zip(Frame::ALL)
            .find(|(known, _)| **known == name);
        found.expect("a possible value").1
    })
}

/// Inputs of a computation.
struct Known {
    model: ArmModel,
    q: JointVector,
    ee: EndEffector,
    load: Load,
}

impl Arm {
    async fn known(&self) -> anyhow::Result<Known> {
        if let Some(kind) = self.kind {
            return Ok(Known {
                model: kind.model().clone(),
                q: self.q.map_or(READY, JointVector::from),
                ee: EndEffector::default(),
                load: Load::NONE,
            });
        }
        let (robot, _) = self.which.connect().await?;
        let state = robot.state();
        let model = robot.state_model();
        robot.shutdown().await;
        Ok(Known {
            q: self.q.unwrap_or(state.q).into(),
            ee: model.end_effector(&state),
            load: model.load(&state),
            model: model.model().clone(),
        })
    }
}

impl Model {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        match self {
            Self::Pose { arm, frame } => {
                let Known { model, q, ee, .. } = arm.known().await?;
                let matrix = model.pose(frame, &q, &ee);
                let pose = pose::from_matrix(&matrix).map_err(|error| {
                    Failure::new(
                        Ending::Failed,
                        format!(
                            "cannot use the robot's end effector: \
                        {error}"
                        ),
                    )
                })?;
                print_pose(&pose, arm.output)
            }
            Self::Ik { arm, pose } => {
                let Known { model, q, ee, .. } = arm.known().await?;
                let now = pose::from_matrix(&model.pose(Frame::EndEffector, &q, &ee));
                let target = pose.complete(&now.unwrap_or_default());
                let q = inverse_kinematics::solve(&model, &target, &ee, &q)
                    .map_err(|error| Failure::new(Ending::Failed, error.to_string()))?;
                let q = <[f64; 7]>::from(q);
                arm.output.print(&json!({ "q": q }), || {
                    let degrees = columns(&q.map(f64::to_degrees), 2);
                    format!("rad {}\ndeg {degrees}", columns(&q, 4))
                })
            }
            Self::Jacobian { arm, frame } => {
                let Known { model, q, ee, .. } = arm.known().await?;
                let rows = model.zero_jacobian(frame, &q, &ee);
                let names = ["x", "y", "z", "rx", "ry", "rz"];
                let unit = |row| if row < 3 { "m/rad" } else { "rad/rad" };
                print_rows("jacobian", &names, unit, rows.row_iter(), arm.output)
            }
            Self::Mass { arm } => {
                let Known { model, q, load, .. } = arm.known().await?;
                let rows = model.mass(&q, &load);
                let names = ["1", "2", "3", "4", "5", "6", "7"];
                print_rows("mass", &names, |_| "kg m2", rows.row_iter(), arm.output)
            }
        }
    }
}

fn print_pose(pose: &Pose, output: Output) -> anyhow::Result<Ending> {
    let (position, quaternion) = pose::to_xyzw(pose);
    let (roll, pitch, yaw) = pose.rotation.euler_angles();
    let angles = [roll, pitch, yaw];
    let value = json!({
        "position": position,
        "quaternion": quaternion,
        "roll_pitch_yaw": angles,
        "matrix": pose.to_homogeneous().as_slice(),
    });
    output.print(&value, || {
        format!(
            "position    {}  m\nangles      {}  deg (roll, pitch, yaw)\nquaternion  {}  (x, y, z, w)",
            columns(&position, 4),
            columns(&angles.map(f64::to_degrees), 2),
            columns(&quaternion, 5),
        )
    })
}

/// Prints a matrix with one column per joint. `names` are the names of the rows. The index of a row
/// determines its unit.
fn print_rows<'a, S: Storage<f64, U1, U7> + 'a>(
    what: &str,
    names: &[&str],
    unit: impl Fn(usize) -> &'static str,
    rows: impl Iterator<Item = Matrix<f64, U1, U7, S>>,
    output: Output,
) -> anyhow::Result<Ending> {
    let rows: Vec<[f64; 7]> = rows.map(|row| std::array::from_fn(|i| row[i])).collect();
    output.print(&json!({ what: &rows }), || {
        let joints = (1..=7).map(|joint| format!("{joint:>10}"));
        let mut text = format!("  {}  joint\n", joints.collect::<String>());
        for (i, (name, row)) in names.iter().zip(&rows).enumerate() {
            text += &format!("{name:2}{} {}\n", columns(row, 4), unit(i));
        }
        text
    })
}
