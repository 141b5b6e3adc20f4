//! A custom Cartesian impedance law: springs hold the hand in place, and it can be pushed aside.
//! The same law runs as a control function, or on a thread of this program that reads states and
//! writes commands itself.
//!
//! `cargo run --release --example cartesian_impedance -- callback [ADDRESS] [--seconds 10]`,
//! likewise `active`

use clap::{Parser, ValueEnum};
use franka_async::control::{Finish, Torques};
use franka_async::model::{JointVector, StateModel, Twist, Wrench};
use franka_async::pose;
use franka_async::pose::rotation;
use franka_async::realtime::Scheduling;
use franka_async::state::RobotState;
use franka_async::{MotionError, MotionReport, Pose, Robot};
use franka_examples::{Connection, Summary, push_simulated, report_hand};
use tokio::runtime::Handle;
use tokio::sync::oneshot;

#[derive(Parser)]
struct Arguments {
    way: Way,
    #[command(flatten)]
    connection: Connection,
    /// Duration of the hold, `[s]`.
    #[arg(long, default_value_t = 10.0)]
    seconds: f64,
}

#[derive(ValueEnum, Clone, Copy)]
enum Way {
    /// A function that the real-time thread calls with every state
    Callback,
    /// A thread of this program
    Active,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let connection = &arguments.connection;
    let what = "holds its hand softly, to be pushed at";
    let (robot, sim) = connection.open_ready(what).await?;
    let start = robot.pose();
    let springs = Springs {
        model: robot.state_model(),
        place: start,
    };
    if let Some(sim) = &sim {
        push_simulated(sim, [0.0, 10.0, 0.0]).await?;
    }
    let reporter = report_hand(&robot);
    let report = match arguments.way {
        Way::Callback => callback(&robot, springs, arguments.seconds).await?,
        Way::Active => {
            let scheduling = connection.scheduling();
            active(&robot, springs, arguments.seconds, scheduling).await?
        }
    };
    reporter.abort();
    let moved = robot.pose().translation.vector - start.translation.vector;
    robot.shutdown().await;
    println!("{}", Summary(&report));
    println!("the hand is back within {:.2} mm", moved.norm() * 1e3);
    Ok(())
}

/// Springs and dampers between the hand and a fixed pose.
struct Springs {
    model: StateModel,
    place: Pose,
}

/// Stiffness of the springs, `[N/m]` and `[N m/rad]`, along and about the axes of the base.
const STIFFNESS: [f64; 6] = [300.0, 300.0, 300.0, 20.0, 20.0, 20.0];
/// Damping of the hand, `[N s/m]` and `[N m s/rad]`: close to critical for its effective mass of 3
/// to 8 kg.
const DAMPING: [f64; 6] = [60.0, 60.0, 80.0, 3.0, 3.0, 3.0];
/// Damping of the joints, `[N m s/rad]`, which also stops the elbow, because no spring holds it.
const JOINT_DAMPING: f64 = 1.0;

impl Springs {
    /// Returns the torques for a state: `J' (K e - D J dq)`, a damper at each joint, and the
    /// Coriolis torques.
    fn torques(&self, state: &RobotState) -> Torques {
        let dynamics = self.model.dynamics(state);
        let pose = pose::from_matrix(&dynamics.pose).unwrap_or(self.place);
        let dq = JointVector::from(state.dq);
        let twist = dynamics.jacobian * dq;
        let mut error = Twist::zeros();
        let away = self.place.translation.vector - pose.translation.vector;
        let turned = rotation::error(&self.place.rotation, &pose.rotation);
        error.fixed_rows_mut::<3>(0).copy_from(&away);
        error.fixed_rows_mut::<3>(3).copy_from(&turned);
        let wrench = Wrench::from_fn(|i, _| STIFFNESS[i] * error[i] - DAMPING[i] * twist[i]);
        let torques = dynamics.jacobian.tr_mul(&wrench) - dq * JOINT_DAMPING + dynamics.coriolis;
        Torques(torques.into())
    }
}

/// Runs the law as a control function: it moves to the real-time thread, and its end is a future.
async fn callback(
    robot: &Robot,
    springs: Springs,
    seconds: f64,
) -> Result<MotionReport, MotionError> {
    let mut time = 0.0;
    let holding = robot.control_torques(move |state, step| {
        time += step.as_secs_f64();
        springs.torques(state).finish_if(time >= seconds)
    });
    // After lost commands the torques might have changed by more than the robot accepts in a
    // millisecond: the limiter spreads the change over several cycles.
    holding.limit_rate(true).await
}

/// Runs the law on a thread of this program, which reads and answers each state and therefore is
/// the control cycle. This program also chooses the scheduling of the thread. Commands pass no
/// filter and no limiter.
async fn active(
    robot: &Robot,
    springs: Springs,
    seconds: f64,
    scheduling: Scheduling,
) -> anyhow::Result<MotionReport> {
    let (robot, runtime) = (robot.clone(), Handle::current());
    let (done, ended) = oneshot::channel();
    std::thread::spawn(move || {
        // Fails only if the receiver was dropped.
        let _ = done.send(hold(&robot, &springs, seconds, &scheduling, &runtime));
    });
    ended.await?
}

fn hold(
    robot: &Robot,
    springs: &Springs,
    seconds: f64,
    scheduling: &Scheduling,
    runtime: &Handle,
) -> anyhow::Result<MotionReport> {
    scheduling.enter()?;
    // A running motion waits for its first command, so it is started on the thread that writes it.
    let mut control = runtime.block_on(robot.active_torques())?;
    let mut time = 0.0;
    loop {
        let (state, step) = control.read_once()?;
        time += step.as_secs_f64();
        let torques = springs.torques(&state);
        if let Some(report) = control.write_once(torques.finish_if(time >= seconds))? {
            return Ok(report);
        }
    }
}
