//! The robot's side of a connection as a state machine, for simulators and tests.
//!
//! ```text
//!              Connect, same version
//!   Listening ----------------------> Open: on_message() ... reply(), model_header()
//!     |    ^
//!     +----+ Connect, other version: refused
//! ```
//!
//! The driver owns the sockets and the robot. It cuts the received bytes into messages
//! ([`framing::next_message_within`](crate::framing::next_message_within)) and passes each to
//! [`Session::on_message`]. It sends the messages in the events and the results of
//! [`Session::reply`], each with one write.

mod session;

pub use session::{Event, Session};
