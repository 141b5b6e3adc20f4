//! The robot's side of a connection as a state machine, for simulators and tests.
//!
//! ```text
//!              Connect, same version
//!   Listening ----------------------> Open: on_message() ... reply(), model_header()
//!     |    ^
//!     +----+ Connect, other version: refused
//! ```
//!
//! The driver owns the sockets and the robot. It splits the received bytes into messages
//! ([`framing::next_message_within`](crate::framing::next_message_within)) and passes each message
//! to [`Session::on_message`]. It sends the messages that the events contain and that
//! [`Session::reply`] returns, each with one write.

mod session;

pub use session::{Event, Session};
