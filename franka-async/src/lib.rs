//! Async driver for Franka robots: motions are futures, states are a `watch`, control stays on a
//! real-time thread.
//!
//! ```text
//!  Robot (Clone) --goals, stop--> bridge task --orders, goal slot--> real-time thread --UDP 1 kHz--> robot
//!      |  ^                         |   ^  ^                              |
//!      |  +------ watch: states ----+   |  +--- newest state, events -----+   (eventfd)
//!      +--- setters, recovery ----> channel task <------- TCP, replies matched by id ------> robot
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`prelude`] | what a first program needs |
//! | [`pose`] | poses from quaternions, arrays and matrices, and back |
//! | [`goal`] | targets, limits, gains, chunks, guards |
//! | [`condition`] | what a motion goes on until: forces, positions, time |
//! | [`motion`] | futures, handles and progress of motions; motions of several robots that begin together |
//! | [`team`] | several arms as one, with one stop |
//! | [`state`] | every state, or the newest as it changes |
//! | [`error`], [`diagnosis`] | what can go wrong, by the party that can act on it; why the robot ended a motion |
//! | [`supervision`] | connections that are made again, recovery by a policy, events and health |
//! | [`control`] | control at 1 kHz by functions of the program |
//! | [`gripper`], [`vacuum`] | the end effectors, each with a connection of its own |
//! | [`settings`], [`identify`] | load, thresholds and the like; friction, bias and load, measured |
//! | [`model`] | kinematics, dynamics, limits, inverse kinematics |
//! | [`connection`], [`realtime`] | options of a connection; scheduling, and how punctual control is |
//! | [`record`], `metrics` | what every cycle saw and did; statistics as OpenMetrics text (feature `metrics`) |
//! | `blocking` | for programs without async (feature `blocking`) |
//!
//! ```no_run
//! use franka_async::{Pose, Robot};
//!
//! # async fn run() -> Result<(), Box<dyn std::error::Error>> {
//! let robot = Robot::connect("172.16.0.2").await?;
//! let up = Pose::translation(0.0, 0.0, 0.05) * robot.pose();
//! let report = robot.move_to(up).speed(0.5).await?;
//! println!("arrived after {:?}", report.duration);
//! robot.shutdown().await;
//! # Ok(())
//! # }
//! ```
//!
//! # Cancel safety
//!
//! Every future of this crate may be dropped at any point. A request that was sent is carried out
//! by the robot all the same; its answer is then discarded. **Dropping a motion brakes it** within
//! the robot's limits: the arm is still moving when `drop` returns, and rests soon after. Methods
//! that differ have a section of their own.
//!
//! # What it does not do
//!
//! It holds no control loop: no task of the runtime is on the path from a state to its command, so
//! a blocked worker delays new goals and nothing else. It neither reconnects nor recovers unless it
//! is told to supervise, and moves nothing by itself. It has not been run against a real arm yet.

mod active_control;
mod arm;
mod asynchronous_control;
#[cfg(feature = "blocking")]
pub mod blocking;
mod bridge;
mod builder;
mod cancel;
mod close;
mod codec;
mod command_channel;
pub mod condition;
mod connect;
mod connected_model;
pub mod connection;
pub mod control;
mod control_function;
mod destination;
mod device_connection;
pub mod diagnosis;
mod dial;
mod endpoint;
pub mod error;
mod follow;
mod franka_hand;
pub mod goal;
pub mod gripper;
mod handshake;
pub mod identify;
mod input;
mod link;
#[cfg(feature = "metrics")]
pub mod metrics;
pub mod model;
pub mod motion;
mod move_to;
mod newest_state;
mod open;
mod options;
mod parameters;
pub mod pose;
pub mod prelude;
mod program;
mod progress;
mod publish;
pub mod realtime;
mod reconnect;
pub mod record;
mod robot;
mod session;
pub mod settings;
pub mod state;
mod state_stream;
mod states;
pub mod supervision;
mod supervisor;
#[cfg(feature = "metrics")]
mod tally;
pub mod team;
mod telemetry;
mod thresholds;
pub mod vacuum;
mod vacuum_gripper;

pub use arm::{Arm, Engage};
pub use destination::Offset;
pub use error::any::Error;
pub use move_to::Motion;
pub use robot::{Pose, Robot};

pub use franka_model::READY;
pub use franka_rt::lifecycle::{MotionError, MotionReport};
pub use franka_rt::sched::Realtime;
/// The library that [`Pose`] and [`model::JointVector`] come from.
pub use nalgebra;

/// What programs build on: handles go anywhere, futures go to any worker.
const _: () = {
    const fn shared<T: Clone + Send + Sync + 'static>() {}
    const fn spawned<T: Send + 'static>() {}
    shared::<Robot>();
    spawned::<state::StateStream>();
    spawned::<supervision::Events>();
    shared::<supervision::Policy>();
    shared::<gripper::Gripper>();
    shared::<vacuum::VacuumGripper>();
    shared::<motion::Canceller>();
    shared::<Motion>();
    shared::<Arm>();
    shared::<team::Stopper>();
    spawned::<team::Team<2>>();
    spawned::<team::TeamMotion<2>>();
    spawned::<motion::Follow>();
    spawned::<goal::Deadman>();
    shared::<std::sync::Arc<control::AsynchronousControl>>();
    spawned::<control::Active<control::Torques>>();
    spawned::<control::Control>();
    spawned::<motion::Moving>();
    spawned::<<motion::Follow as IntoFuture>::IntoFuture>();
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn futures_may_run_on_any_worker() {
        fn sent<T: Send>(_: T) {}
        // Compiled, not called: there is no robot.
        let _: fn(&Robot, connection::Builder) = |robot, builder| {
            sent(builder.connect());
            sent(robot.stop());
            sent(robot.engage(Engage::default()));
            sent(robot.read(|_| std::ops::ControlFlow::Break(())));
            sent(robot.recover());
            sent(robot.closed());
            sent(async move { robot.events().next().await });
            sent(robot.identify().run());
            sent(robot.set_joint_impedance([0.0; 7]));
            sent(robot.urdf());
            sent(robot.load_model_library(model::Architecture::X64, model::System::Linux));
            sent(robot.shutdown());
        };
    }
}
