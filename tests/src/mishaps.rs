//! Networks under which one thing happens to datagrams, for the suites in virtual time and over
//! sockets: what is seen in one is to be seen in the other.
//!
//! Unless a function says otherwise, it happens in both directions.

use std::ops::Range;
use std::time::Duration;

use franka_sim::Network;
use franka_sim::network::{BurstLoss, Conditions, Loss, Reordering};

/// Share of packets that get lost in [`loss`] and [`bursts`].
pub const LOST: f64 = 0.03;

/// Share of packets that get lost on their way to the client in [`halves`].
pub const LOST_TO_CLIENT: f64 = 0.06;

/// How many packets are lost in a row in [`bursts`], in the mean.
pub const ROW: f64 = 4.0;

/// Share of datagrams that others overtake in [`reordering`].
pub const OVERTAKEN: f64 = 0.1;

/// Share of datagrams that come twice in [`duplication`].
pub const DOUBLED: f64 = 0.5;

/// Packets are lost, independently of each other.
pub fn loss(seed: u64) -> Network {
    both(seed, losing(Loss::Independent(LOST)))
}

/// As many are lost, in bursts.
pub fn bursts(seed: u64) -> Network {
    both(seed, losing(Loss::Bursts(BurstLoss::of(LOST, ROW))))
}

/// Either way takes so long.
pub fn delay(time: Duration) -> Network {
    both(
        0,
        Conditions {
            delay: time,
            ..Conditions::default()
        },
    )
}

/// Datagrams are up to 0.8 ms late. If state and command are late by more than a millisecond
/// together, the command misses its cycle, which is so for 28 of 100.
pub fn jitter(seed: u64) -> Network {
    both(
        seed,
        Conditions {
            jitter: Duration::from_micros(800),
            ..Conditions::default()
        },
    )
}

/// Some datagrams take a way that is 2.5 ms longer: two or three others overtake them.
pub fn reordering(seed: u64) -> Network {
    both(
        seed,
        Conditions {
            reordering: Reordering {
                probability: OVERTAKEN,
                delay: Duration::from_micros(2500),
            },
            ..Conditions::default()
        },
    )
}

/// Some datagrams come twice.
pub fn duplication(seed: u64) -> Network {
    both(
        seed,
        Conditions {
            duplication: DOUBLED,
            ..Conditions::default()
        },
    )
}

/// Nothing passes within that time.
pub fn cut(time: Range<Duration>) -> Network {
    let mut network = Network::perfect();
    network.to_client.cut(time.clone());
    network.to_robot.cut(time);
    network
}

/// Packets to the client are lost. A state of protocol 5 takes two, so that there mostly half of a
/// state is lost, and almost twice as many states as packets; a state of protocol 10 takes one.
pub fn halves(seed: u64) -> Network {
    let losing = losing(Loss::Independent(LOST_TO_CLIENT));
    Network::new(seed, losing, Conditions::default())
}

fn losing(loss: Loss) -> Conditions {
    Conditions::default().with_loss(loss)
}

fn both(seed: u64, conditions: Conditions) -> Network {
    Network::new(seed, conditions, conditions)
}
