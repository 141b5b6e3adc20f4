//! The link between client and robot: the simulator's network, and additional faults for tests.

use std::time::Duration;

use franka_sim::Network;
use franka_sim::network::{Conditions, Loss};

/// The link between client and robot. Datagrams pass a [`Network`], and messages can be lost.
#[derive(Clone, Debug)]
pub struct Link {
    /// The network for states and commands.
    pub network: Network,
    /// Number of finishing commands (last commands of a motion) that the link still loses.
    drop_finishing: u64,
    /// True if requests reach the robot, false if they are lost.
    pub requests: bool,
    /// True if the robot's replies reach the client, false if they are lost.
    pub replies: bool,
    /// True if requests and replies are delayed until the network is back, because the command
    /// connection repeats them.
    pub delayed: bool,
}

/// A state that the client receives.
pub(super) struct Reception {
    pub(super) at: Duration,
    pub(super) datagram: Vec<u8>,
    /// Number of older states that had also arrived, and that the client skips.
    pub(super) skipped: u64,
}

impl Link {
    /// Returns a link without losses.
    pub fn perfect() -> Self {
        Self::over(Network::perfect())
    }

    /// Returns a link that loses states and commands with these probabilities.
    pub fn lossy(seed: u64, state_loss: f64, command_loss: f64) -> Self {
        let [states, commands] = [state_loss, command_loss]
            .map(|loss| Conditions::default().with_loss(Loss::Independent(loss)));
        Self::over(Network::new(seed, states, commands))
    }

    /// Returns a link over this network. [`Lockstep::now`](super::Lockstep::now) is the network's
    /// time.
    pub fn over(network: Network) -> Self {
        Self {
            network,
            drop_finishing: 0,
            requests: true,
            replies: true,
            delayed: false,
        }
    }

    /// Loses the next `count` states.
    pub fn drop_states(&mut self, count: u64) {
        self.network.to_client.drop_next(count);
    }

    /// Loses the next `count` commands.
    pub fn drop_commands(&mut self, count: u64) {
        self.network.to_robot.drop_next(count);
    }

    /// Loses the next `count` commands that end a motion.
    pub fn drop_finishing(&mut self, count: u64) {
        self.drop_finishing = count;
    }

    /// Returns the state that a client reads if it is ready at `free` or later, but before `end`.
    /// The client reads the newest state that has arrived, if this state is newer than `last`.
    pub(super) fn receive(
        &mut self,
        free: Duration,
        end: Duration,
        last: u64,
    ) -> Option<Reception> {
        let states = &mut self.network.to_client;
        while let Some(arrival) = states.next_arrival() {
            let at = arrival.max(free);
            if at >= end {
                return None;
            }
            let mut newest = (last, None);
            let mut fresh = 0;
            while let Some(delivery) = states.take(at) {
                let id = message_id(&delivery.datagram);
                fresh += u64::from(id > last);
                if id > newest.0 {
                    newest = (id, Some(delivery.datagram));
                }
            }
            if let (_, Some(datagram)) = newest {
                return Some(Reception {
                    at,
                    datagram,
                    skipped: fresh - 1,
                });
            }
        }
        None
    }

    pub(super) fn send(&mut self, now: Duration, command: &[u8], finishing: bool) {
        if finishing && self.drop_finishing > 0 {
            self.drop_finishing -= 1;
        } else {
            self.network.to_robot.send(now, command);
        }
    }

    /// Returns the next command that has arrived before `end`.
    pub(super) fn command(&mut self, end: Duration) -> Option<Vec<u8>> {
        let commands = &mut self.network.to_robot;
        let is_there = commands.next_arrival().is_some_and(|at| at < end);
        is_there.then(|| commands.take(end))?.map(|it| it.datagram)
    }
}

/// The `message_id`, which is the first field of a state in both versions.
fn message_id(state: &[u8]) -> u64 {
    u64::from_le_bytes(*state.first_chunk().expect("a state has a number"))
}
