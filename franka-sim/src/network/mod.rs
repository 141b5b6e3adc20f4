//! The network between client and robot, as a value.
//!
//! ```text
//!  send(now, datagram)                                                        take(now)
//!  ──────> jitter ──> line ──────────> loss, cuts ──> duplication ──> delay ──────────>
//!                     (rate, stalls)   (per packet)                   (reordering)
//! ```
//!
//! Datagrams and the time go in, and datagrams come out. A [`Network`] has no clock and no socket,
//! and no randomness except its seed: the same datagrams at the same times always arrive in the
//! same way. Its two directions are separate [`Path`]s with separate [`Conditions`].
//!
//! The caller's time counts from any moment and must not run backwards. The server feeds a network
//! from its sockets ([`Sim::network`](crate::Sim::network)); tests feed it in virtual time.
//!
//! It models datagrams only. The command connection (TCP) repairs its own losses and bypasses the
//! model.

mod conditions;
mod line;
mod packet_loss;
mod path;

pub use conditions::{BurstLoss, Conditions, Loss, Reordering, Stalls};
pub use path::{Delivery, Path, Tally};

/// The path to the client and the path to the robot.
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
    /// States.
    pub to_client: Path,
    /// Commands.
    pub to_robot: Path,
}

impl Network {
    /// A network under these conditions. All its randomness comes from `seed`.
    pub fn new(seed: u64, to_client: Conditions, to_robot: Conditions) -> Self {
        Self {
            to_client: Path::new(to_client, seed),
            to_robot: Path::new(to_robot, !seed),
        }
    }

    /// A network without delay and loss.
    pub fn perfect() -> Self {
        Self::new(0, Conditions::default(), Conditions::default())
    }

    /// An FER on a separate cable. Its states wait for the end of the stalls of its network
    /// interface ([`Stalls::FER`]); commands to it do not.
    pub fn fer(seed: u64) -> Self {
        Self::stalling(seed, Stalls::FER)
    }

    /// [`fer`](Self::fer) with other stalls.
    pub fn stalling(seed: u64, stalls: Stalls) -> Self {
        let cable = Conditions::cable();
        let stalling = Conditions {
            stalls: Some(stalls),
            ..cable
        };
        Self::new(seed, stalling, cable)
    }

    /// Discards the datagrams in transit, as when the client changes.
    pub fn clear(&mut self) {
        self.to_client.clear();
        self.to_robot.clear();
    }
}
