//! The network between client and robot, as a value without sockets.
//!
//! ```text
//!  send(now, datagram)                                                        take(now)
//!  ──────> jitter ──> line ──────────> loss, cuts ──> duplication ──> delay ──────────>
//!                     (rate, stalls)   (per packet)                   (reordering)
//! ```
//!
//! A [`Network`] takes datagrams and the time, and returns datagrams. It has no clock and no
//! socket, and its seed determines all random numbers. The same datagrams, sent at the same times,
//! always arrive at the same times. The two directions are separate [`Path`]s with separate
//! [`Conditions`].
//!
//! The caller's time may start at any value, but must not decrease. The server passes the datagrams
//! of its sockets to a network ([`Sim::network`](crate::Sim::network)). Tests use a network in
//! virtual time.
//!
//! A network models datagrams only. The command connection (TCP) repairs its own losses and
//! bypasses the network.

mod conditions;
mod line;
mod packet_loss;
mod path;

pub use conditions::{BurstLoss, Conditions, Loss, Reordering, Stalls};
pub use path::{Delivery, Path, Tally};

/// Network between client and robot: one path to the client and one path to the robot.
///
/// ```
/// use std::time::Duration;
/// use franka_sim::network::{Conditions, Network};
///
/// let slow = Conditions {
///     delay: Duration::from_micros(300),
///     ..Conditions::default()
/// };
/// let mut network = Network::new(7, slow, Conditions::default());
/// network.to_client.send(Duration::from_millis(1), b"a state");
/// assert!(network.to_client.take(Duration::from_millis(1)).is_none());
/// let delivery = network.to_client.take(Duration::from_millis(2)).expect("it has arrived");
/// assert_eq!(delivery.at, Duration::from_micros(1300));
/// ```
#[derive(Debug, Clone)]
pub struct Network {
    /// Path of the states.
    pub to_client: Path,
    /// Path of the commands.
    pub to_robot: Path,
}

impl Network {
    /// Returns a network under these conditions. `seed` determines all random numbers.
    pub fn new(seed: u64, to_client: Conditions, to_robot: Conditions) -> Self {
        Self {
            to_client: Path::new(to_client, seed),
            to_robot: Path::new(to_robot, !seed),
        }
    }

    /// Returns a network without delay and loss.
    pub fn perfect() -> Self {
        Self::new(0, Conditions::default(), Conditions::default())
    }

    /// Returns the network of an FER on a separate cable. Stalls of the robot's network interface
    /// ([`Stalls::FER`]) delay states, but not commands.
    pub fn fer(seed: u64) -> Self {
        Self::stalling(seed, Stalls::FER)
    }

    /// Returns the network [`fer`](Self::fer) with these stalls.
    pub fn stalling(seed: u64, stalls: Stalls) -> Self {
        let cable = Conditions::cable();
        let stalling = Conditions {
            stalls: Some(stalls),
            ..cable
        };
        Self::new(seed, stalling, cable)
    }

    /// Discards the datagrams in transit, for example when the client changes.
    pub fn clear(&mut self) {
        self.to_client.clear();
        self.to_robot.clear();
    }
}
