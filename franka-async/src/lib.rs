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
//!   it.
//! * [`Motion`]: `move_to`, `move_joints`: built, then awaited. [`Follow`]: targets from a `watch`
//!   at their own rate.
//! * [`Robot::engage`], [`Arm`]: one session, many goals of any kind; [`Chunk`], [`Deadman`],
//!   [`Tuning`] for it.
//! * [`Diagnosis`]: why the robot ended a motion, and what to change. [`Robot::records`],
//!   [`Engage::observer`]: every cycle.
//! * [`Control`]: the user's own control functions at 1 kHz, on the real-time thread. [`Active`]:
//!   the same from a thread of the user's, which reads states and writes commands.
//!   [`AsynchronousControl`]: sparse joint targets between which the robot plans.
//! * [`StartBarrier`]: motions of several robots that begin within the same millisecond.
//! * [`Robot::read`], [`StateStream`]: every state, whatever moves. [`Robot::stats`]: how punctual
//!   control is.
//! * [`Gripper`], [`VacuumGripper`]: the end effectors, each with a connection of its own.
//! * [`Robot::model`]: the model of the connected arm, from its own description (feature `urdf`, on
//!   by default). `Robot::model_library` (feature `model-library`, off by default): the code that a
//!   Franka Emika Robot hands out.
//! * [`error`]: what can go wrong, grouped by who can act on it.
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
//! the robot's limits: the arm is still moving when `drop` returns, and rests soon after. What else
//! a method has to say stands in its own section.
//!
//! # What it does not do
//!
//! It holds no control loop: no task of the runtime is on the path from a state to its command, so
//! a blocked worker delays new goals and nothing else. It does not reconnect by itself. It has not
//! been run against a real arm yet.

mod active;
mod arm;
mod asynchronous;
mod bridge;
mod builder;
mod channel;
mod codec;
mod connect;
mod control;
mod end_effector;
mod endpoint;
pub mod error;
mod follow;
mod gripper;
mod input;
mod model;
mod motion;
mod newest;
mod parameters;
mod publish;
mod reading;
mod robot;
mod telemetry;
mod vacuum;

pub use active::{Active, ActiveError};
pub use arm::{Arm, Engage};
pub use asynchronous::{AsynchronousControl, AsynchronousOptions};
pub use builder::{Builder, VersionPolicy};
pub use control::Control;
pub use endpoint::{Endpoint, EndpointError};
pub use error::{
    ActionError, Attempt, CommandError, ConnectError, ControlError, Error, MotionError, Party,
};
pub use follow::Follow;
pub use gripper::{Gripper, GripperError};
#[cfg(feature = "urdf")]
pub use model::ModelError;
#[cfg(all(feature = "model-library", target_os = "linux"))]
pub use model::ModelLibraryError;
pub use motion::{Canceller, Motion, Moving};
pub use reading::{ReadError, Reading, StateStream};
pub use robot::Robot;
pub use vacuum::{VacuumGripper, VacuumGripperError};

pub use franka_diagnosis::{self as diagnosis, Diagnose, Diagnosis};
pub use franka_model::collision::Obstacle;
#[cfg(all(feature = "model-library", target_os = "linux"))]
pub use franka_model::model_library::{LibraryError, ModelLibrary};
#[cfg(feature = "urdf")]
pub use franka_model::urdf::UrdfError;
pub use franka_model::{JointVector, Model};
pub use franka_otg::AxisLimits;
pub use franka_proto::gripper::{Grasp, State as GripperState};
pub use franka_proto::vacuum::{Profile, State as VacuumGripperState, Vacuum};
pub use franka_proto::{
    Architecture, CollisionBehavior, Errors, Filters, Load, MoveControllerMode, RobotError,
    RobotMode, RobotState, System, Version, VirtualWall,
};
pub use franka_rt::control::{
    AbortReason, CartesianPose, CartesianVelocities, Finish, JointPositions, JointVelocities, Next,
    TargetStatus, Torques,
};
pub use franka_rt::driver::{Activity, ControlLog, LogEntry, Record};
pub use franka_rt::law::{GainError, Gains, Law};
pub use franka_rt::lifecycle::{MotionReport, Stage, Tuning};
pub use franka_rt::sched::{Granted, Realtime, SchedError};
pub use franka_rt::session::{
    BLEND, Backend, Bindings, Budget, CHUNKS_MAX, Chunk, ChunkError, DEFAULT_FORCE_CAP, Deadman,
    DeadmanMonitor, FORCE_CAP, ForceCap, Free, GoalError, Guard, JOINT_DEVIATION, JOINT_LEASH,
    KEEP_OUT_MAX, KEEP_OUT_STOP, LEAD_FRESH_MS, Lapse, Lead, OFFSET_MAX, OnTimeout, POINTS_MAX,
    PoseError, ROTATION_DEVIATION, ROTATION_LEASH, SELF_STOP, SLOW_ZONE, STALL_TIMEOUT, Setpoints,
    TRANSLATION_DEVIATION, TRANSLATION_LEASH, Target, Tolerance, TooManyChunks,
    VELOCITY_BARRIER_ONSET,
};
pub use franka_rt::stats::{CycleTimes, Phase, Phases, Quantiles, Slack, Stats};
pub use franka_rt::together::{StartBarrier, StartFault, StartTicket};

pub use tokio_util::sync::CancellationToken;

/// Pose of a frame in another, `[m]`. Unless said otherwise: of the end effector in the base frame,
/// `O_T_EE`.
pub type Pose = nalgebra::Isometry3<f64>;

/// What programs build on: handles go anywhere, futures go to any worker.
const _: () = {
    const fn shared<T: Clone + Send + Sync + 'static>() {}
    const fn spawned<T: Send + 'static>() {}
    shared::<Robot>();
    spawned::<StateStream>();
    shared::<Gripper>();
    shared::<VacuumGripper>();
    shared::<Canceller>();
    shared::<Motion>();
    shared::<Arm>();
    spawned::<Follow>();
    spawned::<Deadman>();
    shared::<std::sync::Arc<AsynchronousControl>>();
    spawned::<Active<Torques>>();
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
            sent(robot.set_joint_impedance([0.0; 7]));
            sent(robot.urdf());
            sent(robot.load_model_library(Architecture::X64, System::Linux));
            sent(robot.shutdown());
        };
    }
}
