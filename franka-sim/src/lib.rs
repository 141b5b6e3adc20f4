//! A simulated Franka robot that speaks the wire protocol.
//!
//! ```text
//!            bytes                  requests            torques
//!  client <──────────> robot::Robot <────────> motion ───────────> plant::Plant
//!          datagrams      session              generator, law        rigid body
//!                                              checks, reflexes
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`serve`] | the same robot on sockets: [`Sim::fr3`]`().start().await` |
//! | [`robot`] | the robot as a value, without clock and sockets: what tests in virtual time drive |
//! | [`plant`] | the physics of the arm |
//! | [`config`] | what a robot is like: pose, tool, load, noise, strictness |

mod brake;
pub mod config;
mod estimate;
mod generator;
mod law;
mod noise;
pub mod plant;
pub mod robot;
mod score;
pub mod serve;
mod settings;
mod signal;
mod urdf;

pub use config::{Config, Noise, Tool};
pub use robot::{Datagram, Robot, SessionError};
pub use serve::{Pace, Running, Sim, Stopped};
