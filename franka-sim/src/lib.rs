//! A simulated Franka robot that speaks the wire protocol.
//!
//! ```text
//!            bytes                  requests            torques
//!  client <──────────> robot::Robot <────────> motion ───────────> plant::Plant
//!          datagrams      session              generator, law        rigid body,
//!                                              checks, reflexes      MuJoCo
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`serve`] | the robot on sockets: [`Sim::fr3`]`().start().await`, [`Sim::fer`] |
//! | [`robot`] | the robot as a value without a clock and sockets, for tests in virtual time |
//! | [`end_effector`] | the Franka Hand and the vacuum gripper as values, with separate servers |
//! | [`arm`] | friction, drives, sensors and errors of one arm, and families of arms |
//! | [`plant`] | the physics of the arm |
//! | [`network`] | the network between a robot and its client: loss, delay, stalls |
//! | [`config`] | configuration of a robot: arm, pose, tool, load, strictness |
//!
//! The binary `franka-sim` runs the module `command_line`. It serves clients in any language.
//!
//! # Example
//!
//! The robot advances by one millisecond at a time, without sockets:
//!
//! ```
//! use franka_sim::{Config, Robot};
//! use franka_model::Wrench;
//!
//! let mut robot = Robot::new(Config::default());
//! robot.push_end_effector(Wrench::new(0.0, 0.0, -20.0, 0.0, 0.0, 0.0), 500);
//! for _ in 0..500 {
//!     robot.tick();
//! }
//! // The estimate is the force on the hand that pushes: upwards, 20 N.
//! assert!((robot.state().O_F_ext_hat_K[2] - 20.0).abs() < 1.0);
//! ```
//!
//! On Unix, a robot on sockets follows the wall clock. With [`Sim::virtual_time`], the robot's time
//! advances with the answers of the client.
//!
//! # Features
//!
//! - `command-line`, on by default: the binary `franka-sim`, and the parser of its options for
//!   other programs.
//! - `mujoco`: the physics in MuJoCo, `plant::MujocoArm`. This feature requires Rust 1.95 and
//!   MuJoCo's library, which `cargo xtask mujoco` fetches in this workspace.
//! - `serde`: families of arms in JSON, `arm::Family::from_json`. `command-line` includes this
//!   feature.
//!
//! # Disturbances
//!
//! The methods of [`Robot`] disturb the robot; [`Running::with`] calls these methods from any task.
//! They press the user stop, close the brakes, guide the arm, activate a safety function, change
//! the payload, raise any error, or perform the recovery that requires a person.
//! [`touch`](Robot::touch) acts on the arm at any point ([`Touch`]). It pushes the arm, pulls it by
//! a spring, holds it, blocks a joint, or puts a wall in its path.
//!
//! # What it does not do
//!
//! - The robot: the user must provide the robot's model library (protocol 5). The self-collision
//!   check knows the shape of the Franka Hand, but not of other tools.
//! - Errors: errors of the force controller, of Desk's own motions, and of the base's acceleration
//!   never occur automatically. [`Robot::trip`] raises any error.
//! - Physics: links do not bend, and joints bend only if the [`Arm`] has elasticity. The rigid-body
//!   plant models no surroundings except a [`Touch`], and no contact of the arm with itself. The
//!   MuJoCo plant (feature `mujoco`) contains a scene.
//! - End effectors: they have only kinematics, unless the plant (the physics) has fingers. Without
//!   fingers in the plant, the end effectors do not affect the arm, and held objects have neither
//!   mass nor pose.
//! - Unpublished values: the simulator chooses them, and [`Unpublished`] contains them as options:
//!   tolerances, default thresholds and gains, the gain of the force estimate, and the criterion
//!   for instability. None of them has been measured on a robot.

#![cfg_attr(docsrs, feature(doc_cfg))]
// Some items are used only by the robot on sockets.
#![cfg_attr(not(unix), allow(dead_code, unused_imports))]

pub mod arm;
mod brake;
#[cfg(all(unix, feature = "command-line"))]
pub mod command_line;
pub mod config;
mod connection;
pub mod end_effector;
mod estimate;
mod filter;
mod generator;
mod kind;
mod law;
pub mod network;
mod noise;
mod observer;
pub mod plant;
pub mod robot;
#[cfg(unix)]
pub mod serve;
mod settings;
mod signal;
mod success_rate;
mod urdf;

pub use arm::Arm;
pub use config::{Config, Tool, Unpublished};
pub use end_effector::{Fingers, Hand, Suction, VacuumGripper};
pub use network::Network;
pub use robot::{Datagram, Freeze, Robot, SessionError, Touch, TouchId};
#[cfg(unix)]
pub use serve::{Pace, Running, Service, Sim, SpeedError, Stopped};

// The program in the README must compile.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
