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
//! each with one write, cuts what it receives into messages
//! ([`framing::next_message`](crate::framing::next_message)), gives each to [`Session::on_message`]
//! and acts on the [`Event`]. There is no clock in here: a driver that loses patience with a reply
//! calls [`Session::abandon`].

mod session;

pub use session::{Event, Session};
