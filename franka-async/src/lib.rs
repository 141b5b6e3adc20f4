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
//! * [`Robot`]: a cheap, cloneable handle, fit for the state of a web service. [`Builder`] connects
//!   it. [`Robot::closed`]: why the connection has ended.
//! * [`Motion`]: `move_to`, `move_joints`: built, then awaited. [`Follow`]: targets from a `watch`
//!   at their own rate.
//! * [`Robot::engage`], [`Arm`]: one session, many goals of any kind. [`goal`]: targets, limits,
//!   gains, chunks, deadman, guards.
//! * [`condition`], [`Motion::until`]: motions that react to forces, positions and time on the
//!   control thread: move until contact.
//! * [`Diagnosis`]: why the robot ended a motion, and what to change. [`Robot::records`],
//!   [`Engage::observer`] and [`record`]: every cycle.
//! * [`Control`]: the user's own control functions at 1 kHz, on the real-time thread. [`Active`]:
//!   the same from a thread of the user's, which reads states and writes commands.
//!   [`AsynchronousControl`]: sparse joint targets between which the robot plans.
//!   [`control`]: their commands.
//! * [`StartBarrier`]: motions of several robots that begin within the same millisecond. [`team`]:
//!   several arms as one, with one stop.
//! * [`Robot::states`]: the newest state as it changes. [`Robot::read`], [`StateStream`]: every
//!   state. Both whatever moves. [`Robot::stats`], [`stats`]: how punctual control is.
//! * `Robot::metrics`, `metrics` (feature `metrics`, off by default): the same as OpenMetrics text.
//! * [`Robot::set_load`] and its siblings, [`settings`]; [`Robot::recover`].
//! * [`Builder::supervise`], [`Robot::events`], [`Robot::health`], [`supervision`]: connections
//!   that are made again, recovery by a policy, and what happened.
//! * [`Robot::identify`], [`Builder::known`], [`identify`]: friction, bias and load of an arm.
//! * [`Gripper`], [`VacuumGripper`]: the end effectors, each with a connection of its own.
//! * [`Robot::model`], [`model`]: the model of the connected arm, from its own description (feature
//!   `urdf`, on by default). `Robot::model_library` (feature `model-library`, off by default): the
//!   code that a Franka Emika Robot hands out.
//! * [`error`]: what can go wrong, grouped by the party that can act on it.
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
mod connect;
mod connected_model;
mod control_function;
mod destination;
mod device_connection;
mod dial;
mod endpoint;
pub mod error;
mod follow;
mod franka_hand;
mod handshake;
pub mod identify;
mod input;
mod link;
#[cfg(feature = "metrics")]
pub mod metrics;
mod motion;
mod newest_state;
mod open;
mod options;
mod parameters;
mod program;
mod progress;
mod publish;
mod reconnect;
mod robot;
mod session;
mod state_stream;
mod states;
mod supervisor;
#[cfg(feature = "metrics")]
mod tally;
pub mod team;
mod telemetry;
mod thresholds;
mod vacuum_gripper;

pub use active_control::Active;
pub use arm::{Arm, Engage};
pub use asynchronous_control::{AsynchronousControl, AsynchronousOptions};
pub use builder::{Builder, VersionPolicy};
pub use cancel::Canceller;
pub use control_function::Control;
pub use endpoint::Endpoint;
pub use error::{Error, MotionError};
pub use follow::Follow;
pub use franka_hand::Gripper;
pub use motion::{Motion, MotionHandle, Moving};
pub use progress::{Progress, Reference};
pub use robot::{Pose, Robot};
pub use state_stream::{Reading, StateStream};
pub use states::States;
pub use vacuum_gripper::VacuumGripper;

pub use franka_diagnosis::{self as diagnosis, Diagnose, Diagnosis};
pub use franka_proto::{Errors, RobotError, RobotMode, RobotState, Version};
pub use franka_rt::lifecycle::MotionReport;
pub use franka_rt::sched::{Granted, Realtime};
pub use franka_rt::together::{StartBarrier, StartTicket};
/// The library that [`Pose`] and [`model::JointVector`] come from.
pub use nalgebra;
pub use tokio_util::sync::CancellationToken;

/// Goals of target control: targets, limits, gains, guards.
pub mod goal {
    pub use crate::destination::{Destination, Offset};
    pub use franka_model::collision::Obstacle;
    pub use franka_otg::AxisLimits;
    pub use franka_rt::law::{Gains, Law};
    pub use franka_rt::lifecycle::Tuning;
    pub use franka_rt::session::{
        Backend, Budget, Chunk, Deadman, DeadmanMonitor, ForceCap, Free, JOINT_DEVIATION,
        JOINT_LEASH, KEEP_OUT_MAX, KEEP_OUT_STOP, Lead, Margin, OnTimeout, ROTATION_DEVIATION,
        ROTATION_LEASH, SELF_STOP, SLOW_ZONE, STALL_TIMEOUT, Setpoints, TRANSLATION_DEVIATION,
        TRANSLATION_LEASH, Target, Tolerance, VELOCITY_BARRIER_ONSET,
    };
}

/// Conditions that a motion goes on [until](Motion::until), and what was seen when one became true.
pub mod condition {
    pub use franka_rt::session::condition::{
        Axis, Condition, Quantity, cartesian_contact, collision, contact, elapsed, force, force_x,
        force_y, force_z, joint_contact, joint_torques, torque,
    };
    pub use franka_rt::session::{Reacted, Reaction};
}

/// Commands at 1 kHz: what control functions return and [`Active`] writes.
pub mod control {
    pub use franka_proto::MoveControllerMode;
    pub use franka_rt::control::{
        AbortReason, CartesianPose, CartesianVelocities, Finish, JointPositions, JointVelocities,
        Next, TargetStatus, Torques,
    };
}

/// Settings of the robot: see [`Robot::set_load`] and its siblings.
pub mod settings {
    pub use franka_proto::{CollisionBehavior, Filters, Load, VirtualWall};
}

/// The model of an arm.
pub mod model {
    #[cfg(all(feature = "model-library", target_os = "linux"))]
    pub use franka_model::model_library::ModelLibrary;
    pub use franka_model::{JointVector, Model};
    pub use franka_proto::{Architecture, System};
}

/// What every cycle saw and did, and the log that an error carries.
pub mod record {
    pub use franka_rt::driver::{Activity, ControlLog, LogEntry, Record};
    pub use franka_rt::session::{Bindings, Guard};
}

/// How punctual control is.
pub mod stats {
    pub use franka_rt::stats::{CycleTimes, Phase, Phases, Quantiles, Slack, Stats};
}

/// Supervised robots: connections that are made again, recovery, events and health.
pub mod supervision {
    pub use crate::supervisor::{Events, Notification};
    pub use franka_rt::supervision::{
        Backoff, Condition, Event, EventKind, Health, NotRecovered, Policy, Reflex,
    };
}

/// The Franka Hand's grasps and states.
pub mod gripper {
    pub use franka_proto::gripper::{Grasp, State};
}

/// The vacuum gripper's requests and states.
pub mod vacuum {
    pub use franka_proto::vacuum::{Profile, State, Vacuum};
}

/// What programs build on: handles go anywhere, futures go to any worker.
const _: () = {
    const fn shared<T: Clone + Send + Sync + 'static>() {}
    const fn spawned<T: Send + 'static>() {}
    shared::<Robot>();
    spawned::<StateStream>();
    spawned::<supervision::Events>();
    shared::<supervision::Policy>();
    shared::<Gripper>();
    shared::<VacuumGripper>();
    shared::<Canceller>();
    shared::<Motion>();
    shared::<Arm>();
    shared::<team::Stopper>();
    spawned::<team::Team<2>>();
    spawned::<team::TeamMotion<2>>();
    spawned::<Follow>();
    spawned::<goal::Deadman>();
    shared::<std::sync::Arc<AsynchronousControl>>();
    spawned::<Active<control::Torques>>();
    spawned::<Control>();
    spawned::<Moving>();
    spawned::<<Follow as IntoFuture>::IntoFuture>();
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn futures_may_run_on_any_worker() {
        fn sent<T: Send>(_: T) {}
        // Compiled, not called: there is no robot.
        let _: fn(&Robot, Builder) = |robot, builder| {
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
