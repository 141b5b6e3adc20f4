//! Networks with one kind of fault each, for the suites in virtual time and over sockets: both must
//! show the same effects. Unless noted otherwise, the fault acts in both directions.

use std::ops::Range;
use std::time::Duration;

use franka_sim::Network;
use franka_sim::network::{BurstLoss, Conditions, Loss, Reordering};

/// Share of packets that are lost in [`loss`] and [`bursts`].
pub const LOST: f64 = 0.03;

/// Share of packets to the client that are lost in [`halves`].
pub const LOST_TO_CLIENT: f64 = 0.06;

/// Mean number of packets that are lost in a row in [`bursts`].
pub const ROW: f64 = 4.0;

/// Share of datagrams that are overtaken in [`reordering`].
pub const OVERTAKEN: f64 = 0.1;

/// Share of datagrams that are duplicated in [`duplication`].
pub const DOUBLED: f64 = 0.5;

/// Packets are lost, independently of each other.
pub fn loss(seed: u64) -> Network {
    both(seed, losing(Loss::Independent(LOST)))
}

/// The same share of packets as in [`loss`] is lost, in bursts.
pub fn bursts(seed: u64) -> Network {
    both(seed, losing(Loss::Bursts(BurstLoss::of(LOST, ROW))))
}

/// Each direction has a delay of `time`.
pub fn delay(time: Duration) -> Network {
    both(
        0,
        Conditions {
            delay: time,
            ..Conditions::default()
        },
    )
}

/// Datagrams are up to 0.8 ms late. If the delays of state and command add up to more than a
/// millisecond, the command misses its cycle; this happens to 28 of 100.
pub fn jitter(seed: u64) -> Network {
    both(
        seed,
        Conditions {
            jitter: Duration::from_micros(800),
            ..Conditions::default()
        },
    )
}

/// Some datagrams take 2.5 ms longer: two or three others overtake them.
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

/// Some datagrams arrive twice.
pub fn duplication(seed: u64) -> Network {
    both(
        seed,
        Conditions {
            duplication: DOUBLED,
            ..Conditions::default()
        },
    )
}

/// No datagram passes within `time`.
pub fn cut(time: Range<Duration>) -> Network {
    let mut network = Network::perfect();
    network.to_client.cut(time.clone());
    network.to_robot.cut(time);
    network
}

/// Packets to the client are lost. A state of protocol 5 takes two packets. There, a loss is mostly
/// half of a state, and the share of lost states is almost twice the share of lost packets. A state
/// of protocol 10 takes one packet.
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
