//! The robot's side of a connection as a state machine, for simulators and tests.
//!
//! ```text
//!              Connect, same version
//!   Listening ----------------------> Open: on_message() ... reply(), model_header()
//!     |    ^
//!     +----+ Connect, other version: refused
//! ```
//!
//! The driver owns the sockets and the robot. It cuts what it receives into messages
//! ([`framing::next_message_within`](crate::framing::next_message_within)), gives each to
//! [`Session::on_message`], and sends what the events carry and what [`Session::reply`] returns,
//! each with one write.

mod session;

pub use session::{Event, Session};
