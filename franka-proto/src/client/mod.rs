//! The client's side of a connection as a state machine.
//!
//! ```text
//!            connect()              Connected
//!   Closed -----------> Connecting -----------> Open: request() ... on_message()
//!     ^                     |
//!     +---- Incompatible ---+
//! ```
//!
//! The driver owns the sockets. It sends what [`Session::connect`] and [`Session::request`] return,
//! each with one write. It cuts the received bytes into messages
//! ([`framing::next_message`](crate::framing::next_message)), passes each to
//! [`Session::on_message`] and acts on the [`Event`]. The session has no clock: a driver whose wait
//! for a reply times out calls [`Session::abandon`].

mod session;

pub use session::{Event, Session};
