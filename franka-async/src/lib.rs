//! Async driver for Franka robots: motions are futures, states are a `watch`, control stays on a
//! real-time thread.
//!
//! A program sets goals at its own rate. A separate thread, one per robot, answers the robot every
//! millisecond. This thread does not depend on the runtime, so a busy or blocked program only
//! delays new goals. This page is all that a first program needs. The book (`docs/src` in the
//! repository) begins with whole programs: a service with a job queue, a policy at 10 Hz, a guarded
//! move, and a script.
//!
//! # Connect
//!
//! ```toml
//! [dependencies] # our crates are not published yet: use the path of a clone
//! anyhow = "1"
//! franka-async = { path = "../franka-async/franka-async" }
//! tokio = { version = "1", features = ["full"] }
//!
//! [dev-dependencies] # a simulated robot, for tests
//! franka-sim = { path = "../franka-async/franka-sim" }
//! ```
//!
//! ```no_run
//! use franka_async::prelude::*;
//!
//! #[tokio::main]
//! async fn main() -> anyhow::Result<()> {
//!     let robot = Robot::connect("172.16.0.2").await?;
//!     println!("hand at {}", robot.pose().translation);
//!     robot.shutdown().await; // brakes the arm, and closes the connection
//!     Ok(())
//! }
//! ```
//!
//! The address is a host name or an IP address. A [`Robot`] is a handle that is cheap to clone:
//! give each task or request its own clone. Dropping the last handle brakes the arm and closes the
//! connection. [`Robot::shutdown`] does the same and waits until the connection is closed. If the
//! program is killed, the robot stops on its own. By default, connecting fails on a host without a
//! real-time kernel. A real robot needs such a kernel; a simulated robot does not.
//! `Robot::builder(address).realtime(Realtime::Ignore).connect()` connects without such a kernel.
//! Every error of this crate converts into [`Error`]; if `main` returns one through `anyhow`, the
//! program prints its text.
//!
//! # Move
//!
//! ```no_run
//! # use franka_async::prelude::*;
//! # async fn run(robot: Robot) -> Result<(), MotionError> {
//! robot.move_to(READY).speed(0.5).await?; // joint positions, rad
//! let start = robot.pose();
//! robot.move_by(Offset::base([0.0, 0.0, 0.05])).await?; // 5 cm up
//! robot.move_by(Offset::tool([0.0, 0.0, 0.05])).await?; // 5 cm along the hand
//! let report = robot.move_to(Pose::translation(0.0, 0.1, 0.0) * start).await?;
//! println!("arrived after {:?}", report.duration);
//! # Ok(())
//! # }
//! ```
//!
//! Options set the speed and the compliance. A motion can pass through several places without
//! stopping:
//!
//! ```no_run
//! # use franka_async::prelude::*;
//! use franka_async::goal::{Leash, Waypoint};
//!
//! # async fn run(robot: Robot) -> Result<(), MotionError> {
//! let (start, aside) = (robot.pose(), Pose::translation(0.0, 0.2, 0.0));
//! let way = [Waypoint::new(aside * start).blend(0.05), Waypoint::new(start)];
//! robot.move_through(way).speed(0.5).await?; // rounds the corner from 5 cm before it
//! let gentle = Leash { translation: 0.01, ..Leash::default() };
//! robot.move_to(start).force_cap(10.0).leash(gentle).await?;
//! # Ok(())
//! # }
//! ```
//!
//! Units are metres, radians, seconds and newtons. A [`Pose`] is the pose of the end effector in
//! the base frame, as an isometry of [`nalgebra`] with `f64`. [`Robot::pose`] returns the measured
//! pose. The module [`mod@pose`] converts quaternions and arrays into poses.
//!
//! To reach a pose, the end effector moves in a straight line. To reach joint positions, all joints
//! move at the same time. An [`Offset`] is added to the target of the current motion, or to the
//! pose of the arm if no motion is under way. A target out of reach is refused before anything
//! moves. By default, a motion uses 20 % of the robot's limits; `speed(0.5)` halves that.
//!
//! # What a motion is
//!
//! `move_to` returns a [`Motion`]. Its methods set options, and **nothing is sent before it is
//! awaited**. After that:
//!
//! * it resolves as `Ok` when the arm has arrived and rests, held by the robot's own controller, or
//!   as a [`MotionError`] with the reason;
//! * **dropping the future brakes the arm** within the robot's limits: the arm still moves when
//!   `drop` returns, and rests about a quarter of a second later. This stops the arm when a time
//!   limit expires, when another branch wins a `select!`, and when the client of a request
//!   disconnects;
//! * a newer motion of the same robot takes over without stopping the arm, and the older motion
//!   resolves as [`MotionError::Superseded`].
//!
//! If a motion should outlive its caller, spawn it as a task or [detach](Motion::detach) it. A
//! detached motion only logs its outcome. A handle of the motion reports progress, and pauses or
//! cancels the motion:
//!
//! ```no_run
//! use std::time::Duration;
//!
//! # use franka_async::prelude::*;
//! # async fn run(robot: Robot, pose: Pose) {
//! let motion = robot.move_to(pose);
//! let handle = motion.handle();
//! let job = tokio::spawn(motion.into_future());
//! tokio::time::sleep(Duration::from_secs(1)).await;
//! if let Some(progress) = handle.progress() {
//!     println!("{:.0} %, {:.1?} left", 100.0 * progress.fraction(), progress.remaining);
//! }
//! handle.cancel(); // brakes; the job resolves as stopped
//! let outcome = job.await.expect("no panic");
//! # drop(outcome);
//! # }
//! ```
//!
//! For a queue of jobs, let one task await one motion after another. Any task may send jobs to it:
//!
//! ```no_run
//! # use franka_async::prelude::*;
//! # async fn run(robot: Robot) {
//! let (queue, mut jobs) = tokio::sync::mpsc::unbounded_channel::<Pose>();
//! tokio::spawn(async move {
//!     while let Some(pose) = jobs.recv().await {
//!         match robot.move_to(pose).await {
//!             Ok(report) => println!("arrived after {:?}", report.duration),
//!             Err(error) => {
//!                 println!("{error}");
//!                 break; // a person looks before the next job
//!             }
//!         }
//!     }
//! });
//! # drop(queue);
//! # }
//! ```
//!
//! Between two motions the robot holds the arm with its own controller. An [`Arm`] stays under this
//! crate's control instead, and moves from goal to goal without stopping:
//!
//! ```no_run
//! # use franka_async::prelude::*;
//! # async fn run(robot: Robot, pose: Pose) -> Result<(), MotionError> {
//! let arm = robot.engage(Engage::default()).await?;
//! arm.move_to(READY).await?; // arrives, and is held there
//! arm.set(pose).await?; // heads for the pose; returns at once
//! arm.at_rest().await?;
//! arm.disengage().await?;
//! # Ok(())
//! # }
//! ```
//!
//! # States
//!
//! [`Robot::state`] returns the newest state, whether the arm moves or not. [`Robot::states`] waits
//! for changes, and [`Robot::state_stream`] yields each of the thousand states per second.
//!
//! ```no_run
//! # use franka_async::prelude::*;
//! # async fn run(robot: Robot) -> Result<(), franka_async::Error> {
//! let mut states = robot.states();
//! let pushed = states.wait_for(|state| state.O_F_ext_hat_K[2].abs() > 15.0).await?;
//! println!("{:?} N m at {} ms", pushed.tau_ext_hat_filtered, pushed.message_id);
//! # Ok(())
//! # }
//! ```
//!
//! # Follow a policy
//!
//! The program sends targets at any rate, through a `watch` channel. The arm follows the newest
//! target smoothly, at 1 kHz:
//!
//! ```no_run
//! use std::time::Duration;
//!
//! # use franka_async::prelude::*;
//! use tokio::sync::watch;
//!
//! # fn policy(state: &RobotState) -> Option<Pose> { None }
//! # async fn run(robot: Robot) -> Result<(), MotionError> {
//! let (sender, targets) = watch::channel(robot.pose());
//! let silence = Duration::from_millis(500);
//! let following = robot.follow(targets).watchdog(silence, OnTimeout::Brake);
//! let sending = async {
//!     let mut clock = tokio::time::interval(Duration::from_millis(100));
//!     loop {
//!         clock.tick().await;
//!         let Some(target) = policy(&robot.state()) else { break };
//!         if sender.send(target).is_err() {
//!             break; // the motion has ended
//!         }
//!     }
//!     drop(sender); // the motion then ends at the last target
//! };
//! let (outcome, ()) = tokio::join!(following.into_future(), sending);
//! outcome?;
//! # Ok(())
//! # }
//! ```
//!
//! When the sender is dropped, the motion ends at the last target and resolves as `Ok`. The
//! watchdog runs on the control thread: it brakes the arm even if the program hangs, and the motion
//! resolves as [`MotionError::Braked`]. A target is a [`Pose`] or joint positions. A pair
//! `(pose, twist)` or `(q, dq)` adds the velocity of the target. With a velocity, the arm does not
//! lag behind the target. For policies that predict several steps at once, use [`Arm::chunk`].
//!
//! # Move until contact
//!
//! ```no_run
//! use std::time::Duration;
//!
//! use franka_async::condition::{elapsed, force_z};
//! use franka_async::goal::Budget;
//! # use franka_async::prelude::*;
//!
//! # async fn run(robot: Robot) -> Result<(), MotionError> {
//! let mut slow = Budget::of(robot.model().joint_limits());
//! slow.translation.velocity = 0.05; // m/s
//! let touched = force_z(8.0).relative() & elapsed(Duration::from_millis(200));
//! let down = robot.move_by(Offset::base([0.0, 0.0, -0.2]));
//! match down.limits(slow).until(touched).await?.reacted {
//!     Some(contact) => println!("contact at {:.3} m", contact.pose.translation.z),
//!     None => println!("nothing there"),
//! }
//! # Ok(())
//! # }
//! ```
//!
//! The control thread checks the condition in every cycle. `force_z` compares the external force
//! along z of the base, in either direction. `relative` subtracts the force at the start of the
//! motion. `elapsed` ignores the first 200 ms, because starting the motion causes torques.
//! `contact` contains the time and the place of the contact. Without a contact, the arm arrives and
//! `reacted` is `None`. `touched.then(pose)` moves the arm elsewhere at once instead of stopping
//! it. See [`condition`] for other conditions.
//!
//! # Errors and recovery
//!
//! A robot that has stopped itself (a *reflex*, for example because of a collision) accepts no
//! motion until it has been recovered. The error contains a log of the last cycles, and its
//! diagnosis suggests what to change. [`MotionError::party`] returns where to act: in this program,
//! on its computer, in the network, at the robot, or in the code of either side.
//!
//! ```no_run
//! # use franka_async::prelude::*;
//! # async fn run(robot: Robot, pose: Pose) -> Result<(), franka_async::Error> {
//! if let Err(error) = robot.move_to(pose).await {
//!     println!("{error}");
//!     if let Some(diagnosis) = error.diagnose() {
//!         println!("{diagnosis}");
//!     }
//!     robot.recover().await?; // once its cause is gone; moves nothing
//! }
//! # Ok(())
//! # }
//! ```
//!
//! A supervised robot reconnects after the link was lost, and recovers from reflexes as its policy
//! states. A motion under way still ends, and the program decides what to do next:
//!
//! ```no_run
//! use std::time::Duration;
//!
//! use franka_async::prelude::*;
//! use franka_async::supervision::Policy;
//!
//! # async fn run() -> Result<(), franka_async::Error> {
//! let policy = Policy::default().recover(3, Duration::from_secs(60));
//! let robot = Robot::builder("172.16.0.2").supervise(policy).connect().await?;
//! let mut events = robot.events();
//! while let Some(notification) = events.next().await {
//!     println!("{notification:?}");
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Without async
//!
//! With the feature `blocking`, call `.wait()` instead of `.await`, on any thread and without a
//! runtime:
//!
//! ```no_run
//! # #[cfg(feature = "blocking")]
//! # fn run() -> Result<(), franka_async::Error> {
//! use franka_async::blocking::Wait;
//! use franka_async::prelude::*;
//!
//! let robot = Robot::connect("172.16.0.2").wait()?;
//! robot.move_to(READY).wait()?;
//! let arm = robot.engage(Engage::default()).wait()?;
//! let up = Pose::translation(0.0, 0.0, 0.05) * robot.pose();
//! arm.try_set(up)?; // never waits: for loops at a rate of their own
//! arm.at_rest().wait()?;
//! arm.disengage().wait()?;
//! robot.shutdown().wait();
//! # Ok(())
//! # }
//! ```
//!
//! # Test without a robot
//!
//! The crate `franka-sim` simulates a robot, with real sockets, inside the process of the test. The
//! simulated arm has friction, flexibility and delays like those published for real arms.
//!
//! ```
//! use std::time::Duration;
//!
//! use franka_async::prelude::*;
//! use franka_sim::Sim;
//!
//! #[tokio::main] // in a test: #[tokio::test]
//! async fn main() -> anyhow::Result<()> {
//!     // The robot's next millisecond begins with the command: a busy machine changes nothing,
//!     // unless it keeps either end waiting for longer than this.
//!     let sim = Sim::fr3().virtual_time(Duration::from_secs(5)).start().await?;
//!     let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
//!     let robot = builder.link_timeout(Duration::from_secs(10)).connect().await?;
//!     let height = robot.pose().translation.z;
//!     robot.move_by(Offset::base([0.0, 0.0, 0.05])).await?;
//!     assert!((robot.pose().translation.z - height - 0.05).abs() < 2e-3);
//!     robot.shutdown().await;
//!     Ok(())
//! }
//! ```
//!
//! Outside of tests, start the program `franka-sim`, which is the same simulator. Connect to
//! `127.0.0.1`, with `Realtime::Ignore` as above.
//!
//! # Where to go next
//!
//! | module | content |
//! |---|---|
//! | [`prelude`] | names for a first program |
//! | [`pose`] | poses from quaternions, arrays and matrices, and back |
//! | [`goal`], [`condition`] | targets, limits, gains, chunks, guards; conditions that end a motion |
//! | [`motion`] | futures, handles and progress of motions; several robots that begin together |
//! | [`team`] | motions of several arms, with one stop for all |
//! | [`state`] | every state, or the newest state as it changes; external wrenches after a tare |
//! | [`error`], [`diagnosis`] | errors, grouped by who can act on them; why the robot ended a motion |
//! | [`supervision`] | automatic reconnects, recovery by a policy, events and health |
//! | [`control`] | control at 1 kHz by code of the program |
//! | [`gripper`], [`vacuum`] | the end effectors, each with its own connection |
//! | [`settings`], [`identify`] | load, thresholds and other settings; measured friction, bias and load |
//! | [`model`] | kinematics, dynamics, limits, inverse kinematics |
//! | [`connection`], [`realtime`] | options of a connection; scheduling, and how punctual control is |
//! | [`record`] | records of every cycle |
//! | `recording` | states, cycles and requests to the robot, in files; logs of libfranka (feature `record`) |
//! | `explain` | why a motion ended, and where the arm was touched (feature `record`) |
//! | `replay`, `export` | replays of recorded motions; recordings as tables and datasets (features `record`, `export`) |
//! | `cassette` | sessions recorded byte for byte, and played back as the robot (features `record`, `pcap`) |
//! | `doctor` | checks of this computer (features `doctor`, `doctor-desk`) |
//! | `metrics` | statistics as OpenMetrics text (feature `metrics`) |
//! | [`connection::lease`] | the right to move the arm, which one client of a service has at a time |
//! | `connection::admission` | checks of the clients of a service (feature `admission`) |
//! | `blocking` | calls for programs without async (feature `blocking`) |
//!
//! # How it works
//!
//! ```text
//! Robot --goals--> bridge task --orders, goals--> control thread --UDP, 1 kHz--> robot
//!   |  ^              |   ^                              |                         ^
//!   |  +----states----+   +--------states, events--------+                         |
//!   +----settings, recovery----> channel task <------TCP, replies matched by id----+
//! ```
//!
//! # Cancel safety
//!
//! Every future of this crate may be dropped at any point. The robot still carries out a request
//! that was sent; its answer is discarded. Dropping a motion brakes the arm. Methods with other
//! rules state them in their own section.
//!
//! # What it does not do
//!
//! Without [`Builder::supervise`](connection::Builder::supervise), the crate neither reconnects nor
//! recovers. It moves nothing unless the program asks for it. It is no safety function. It has not
//! been run against a real arm yet.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(
        clippy::disallowed_methods,
        clippy::disallowed_types,
        reason = "tests have listeners and clocks of their own"
    )
)]

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
#[cfg(feature = "doctor")]
pub mod doctor;
mod end_effector_pose;
mod endpoint;
pub mod error;
#[cfg(feature = "record")]
pub use franka_record::{cassette, explain, export};
mod follow;
mod franka_hand;
mod geometry_check;
pub mod goal;
pub mod gripper;
mod handshake;
pub mod identify;
mod input;
#[cfg(feature = "record")]
mod journal;
mod kept_tuning;
mod lease;
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
#[cfg(feature = "record")]
pub mod recording;
#[cfg(feature = "record")]
pub mod replay;
mod robot;
mod session;
pub mod settings;
pub mod state;
mod state_model;
mod state_stream;
mod states;
pub mod supervision;
mod supervisor;
#[cfg(feature = "metrics")]
mod tally;
mod tare;
pub mod team;
mod telemetry;
mod thresholds;
mod user_value;
pub mod vacuum;
mod vacuum_gripper;
mod world;

pub use arm::{Arm, Engage};
pub use destination::Offset;
pub use error::any::Error;
pub use move_to::Motion;
pub use robot::{Pose, Robot};

pub use franka_model::READY;
pub use franka_rt::lifecycle::{MotionError, MotionReport};
pub use franka_rt::sched::Realtime;
/// The library that defines [`Pose`] and [`model::JointVector`].
pub use nalgebra;

// The program in the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// Checks that handles may move to any thread, and futures to any worker, because programs rely on
/// it.
const _: () = {
    const fn shared<T: Clone + Send + Sync + 'static>() {}
    const fn spawned<T: Send + 'static>() {}
    shared::<Robot>();
    spawned::<state::StateStream>();
    spawned::<state::TaredStates>();
    spawned::<supervision::Events>();
    shared::<supervision::Policy>();
    shared::<gripper::Gripper>();
    shared::<vacuum::VacuumGripper>();
    shared::<motion::Canceller>();
    shared::<Motion>();
    shared::<Arm>();
    shared::<team::Stopper>();
    #[cfg(feature = "record")]
    spawned::<std::sync::Arc<recording::Recorder>>();
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
        // This is compiled but never called, because there is no robot.
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
