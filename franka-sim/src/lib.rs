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
//! | [`robot`] | the robot as a value, without clock and sockets: what tests in virtual time drive |
//! | [`end_effector`] | the Franka Hand and the vacuum gripper as values, with servers of their own |
//! | [`arm`] | one arm's friction, drives, sensors and errors, and families of arms |
//! | [`plant`] | the physics of the arm |
//! | [`network`] | what is between a robot and its client, as a value: loss, delay, stalls |
//! | [`config`] | what a robot is like: arm, pose, tool, load, strictness |
//!
//! The binary `franka-sim` is `command_line`, for clients in any language.
//!
//! # Example
//!
//! One millisecond at a time, without sockets:
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
//! On Unix a robot over sockets keeps the wall's millisecond, or the client's:
//! [`Sim::virtual_time`].
//!
//! # Features
//!
//! - `command-line`, on by default: the binary `franka-sim`, and its options for other programs.
//! - `mujoco`: the plant in MuJoCo, `plant::MujocoArm`. Needs Rust 1.95, and MuJoCo's library: in
//!   this workspace `cargo xtask mujoco` fetches it.
//! - `serde`: families of arms as JSON, `arm::Family::from_json`. `command-line` includes it.
//!
//! # Disturbances
//!
//! [`Robot`], and from any task through [`Running::with`]: [`touch`](Robot::touch) the arm anywhere
//! ([`Touch`]: push it, also over time, pull it by a spring, hold it, block a joint, put a wall in
//! its way), press the user stop, close the brakes, guide the arm, activate a safety function,
//! change the payload, trip any error, and perform the recovery that takes a person.
//!
//! # What it does not do
//!
//! - The robot: its model library (protocol 5) is one that the user has. It knows the shape of the
//!   Franka Hand and of no other tool when it keeps off itself.
//! - Errors that never come by themselves: those of the force controller, of Desk's own motions and
//!   of the base's acceleration. [`Robot::trip`] raises any.
//! - Physics: links do not bend, and joints only if the [`Arm`] says so. Around the rigid-body
//!   plant there is nothing but what a [`Touch`] puts there, itself included; around that of MuJoCo
//!   (feature `mujoco`) is a scene.
//! - The end effectors: kinematics, unless the plant has fingers. Without, they and the arm know
//!   nothing of each other, and what they hold has neither mass nor pose.
//! - What a robot keeps to itself (tolerances, thresholds and gains by default, the gain of its
//!   force estimate, what counts as unstable) has values chosen here, which are options:
//!   [`Unpublished`]. None has been measured on a robot.

#![cfg_attr(docsrs, feature(doc_cfg))]
// What only the robot on sockets uses.
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

// The program in the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
