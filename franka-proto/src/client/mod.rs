//! The client's side of a connection as a state machine.
//!
//! ```text
//!            connect()              Connected
//!   Closed -----------> Connecting -----------> Open: request() ... on_message()
//!     ^                     |
//!     +---- Incompatible ---+
//! ```
//!
//! The driver owns the sockets. It sends each message that [`Session::connect`] and
//! [`Session::request`] return with one write. It splits the received bytes into messages
//! ([`framing::next_message`](crate::framing::next_message)), passes each message to
//! [`Session::on_message`] and acts on the [`Event`]. The session has no clock. If no reply arrives
//! in time, the driver calls [`Session::abandon`].

mod session;

pub use session::{Event, Session};
