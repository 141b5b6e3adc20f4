//! The link between client and robot: the simulator's network, and faults for tests only.

use std::time::Duration;

use franka_sim::Network;
use franka_sim::network::{Conditions, Loss};

/// The link between client and robot: datagrams pass a [`Network`], and messages can be lost.
#[derive(Clone, Debug)]
pub struct Link {
    /// The network for states and commands.
    pub network: Network,
    /// The number of finishing commands to lose next.
    drop_finishing: u64,
    /// True if requests reach the robot; they are lost otherwise.
    pub requests: bool,
    /// True if the robot's replies arrive.
    pub replies: bool,
    /// True if requests and replies wait: the command connection repeats them when the network is
    /// back.
    pub delayed: bool,
}

/// A state that the client receives.
pub(super) struct Reception {
    /// The time of reception.
    pub(super) at: Duration,
    pub(super) datagram: Vec<u8>,
    /// The number of older states that were there too, and are skipped.
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

    /// Returns a link over this network, whose time is [`Lockstep::now`](super::Lockstep::now).
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

    /// Returns the state for a client that is ready from `free` on, before `end`: the newest
    /// arrived state, if it is newer than `last`.
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

    /// Sends a command.
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

/// The `message_id`, which is the first field of a state in either version.
fn message_id(state: &[u8]) -> u64 {
    u64::from_le_bytes(*state.first_chunk().expect("a state has a number"))
}
