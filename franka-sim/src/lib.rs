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
//! | [`plant`] | the physics of the arm |
//! | [`config`] | what a robot is like: pose, tool, load, noise, strictness |
//!
//! The binary `franka-sim` is [`serve`] with a command line, for clients in any language.
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
//! // The robot feels what it does to the hand that pushes: upwards, 20 N.
//! assert!((robot.state().O_F_ext_hat_K[2] - 20.0).abs() < 1.0);
//! ```
//!
//! # Features
//!
//! - `mujoco`: the plant in MuJoCo, `plant::MujocoArm`. Needs Rust 1.95, and MuJoCo's library: in this workspace
//!   `cargo xtask mujoco` fetches it.
//!
//! # What it does not do
//!
//! - The robot: no hand guiding, no safety functions. Protocol 5 (FER): filters are accepted and have
//!   no effect, no virtual wall is ever active, and the model library is one that the user has.
//! - Errors that never come: self-collision, virtual walls, power limit, instability, and those of
//!   the force controller, of Desk's own motions and of the base's acceleration.
//! - Physics: rigid links and joints. Around the rigid-body plant there is nothing, itself included; around that of MuJoCo (feature
//!   `mujoco`) is a scene.
//! - The end effectors: kinematics, unless the plant has fingers. Without, they and the arm know nothing of each other, and
//!   what they hold has neither mass nor pose.
//! - What a robot keeps to itself (start tolerances, thresholds by default, gains of its own
//!   controllers, the filter of its force estimate) has values chosen here; each says so where it
//!   stands. None has been measured on a robot.

mod brake;
pub mod config;
pub mod end_effector;
mod estimate;
mod filter;
mod generator;
mod kind;
mod law;
mod noise;
mod observer;
pub mod plant;
pub mod robot;
mod score;
pub mod serve;
mod settings;
mod signal;
mod urdf;

pub use config::{Config, Noise, Tool, Unpublished};
pub use end_effector::{Fingers, Hand, Suction, VacuumGripper};
pub use robot::{Datagram, Robot, SessionError, Touch, TouchId};
pub use serve::{Pace, Running, Service, Sim, Stopped};
