//! One direction of a network. A path cuts datagrams into packets, for example an FER's state into
//! two IP fragments. It loses a datagram as a whole if one fragment is lost.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;
use std::ops::Range;
use std::time::Duration;

use super::conditions::Conditions;
use super::line::Line;
use super::packet_loss::Losses;
use crate::noise::Random;

/// One direction of a network. A path delays, loses or repeats datagrams.
///
/// Pass datagrams to [`send`](Self::send), and receive them from [`take`](Self::take).
/// [`next_arrival`](Self::next_arrival) returns the time at which the next datagram arrives.
/// [`cut`](Self::cut) and [`drop_next`](Self::drop_next) cause a loss that does not depend on
/// chance.
#[derive(Debug, Clone)]
pub struct Path {
    conditions: Conditions,
    line: Line,
    losses: Losses,
    /// Random numbers for jitter, duplication and reordering.
    random: Random,
    cuts: Vec<Range<Duration>>,
    drop_next: u64,
    under_way: BinaryHeap<Reverse<UnderWay>>,
    tally: Tally,
}

/// A datagram that has arrived.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Delivery {
    /// Time of arrival.
    pub at: Duration,
    /// The datagram as it was sent.
    pub datagram: Vec<u8>,
}

/// Counts of the datagrams of a [`Path`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Tally {
    /// Number of datagrams sent.
    pub sent: u64,
    /// Number of datagrams that do not arrive.
    pub lost: u64,
    /// Number of lost datagrams of which some, but not all, packets (IP fragments) arrive. The host
    /// cannot reassemble such a datagram, so programs do not receive it.
    pub fragment_lost: u64,
}

impl Path {
    /// Returns a path under these conditions. `seed` determines all random numbers.
    pub fn new(conditions: Conditions, seed: u64) -> Self {
        // Random numbers are separate, because loss must not change the stalls.
        let mut seeds = Random::new(seed);
        Self {
            line: Line::new(&conditions, seeds.bits()),
            losses: Losses::new(conditions.loss, seeds.bits()),
            random: Random::new(seeds.bits()),
            conditions,
            cuts: Vec::new(),
            drop_next: 0,
            under_way: BinaryHeap::new(),
            tally: Tally::default(),
        }
    }

    /// Returns the conditions of this path.
    pub fn conditions(&self) -> &Conditions {
        &self.conditions
    }

    /// Returns the counts of datagrams so far.
    pub fn tally(&self) -> Tally {
        self.tally
    }

    /// Loses all datagrams that leave the line within `time` (the end is excluded). Several cuts
    /// can be active at the same time.
    pub fn cut(&mut self, time: Range<Duration>) {
        self.cuts.push(time);
    }

    /// Loses the next `count` datagrams. This count replaces the rest of an earlier count.
    pub fn drop_next(&mut self, count: u64) {
        self.drop_next = count;
    }

    /// Sends a datagram at `now`, which must not be before the time of the previous datagram.
    pub fn send(&mut self, now: Duration, datagram: &[u8]) {
        self.tally.sent += 1;
        let ready = match self.conditions.jitter {
            Duration::ZERO => now,
            jitter => now + jitter.mul_f64(self.random.uniform()),
        };
        let packets = packets(datagram.len());
        let left = self.line.carry(ready, on_the_wire(datagram.len()));
        // Draws a number for every packet, even if one is already lost, because bursts continue.
        let lost = (0..packets).filter(|_| self.losses.lose()).count();
        self.cuts.retain(|cut| left < cut.end);
        let cut = self.cuts.iter().any(|cut| cut.contains(&left));
        let dropped = self.drop_next > 0;
        self.drop_next = self.drop_next.saturating_sub(1);
        if cut || dropped || lost > 0 {
            self.tally.lost += 1;
            self.tally.fragment_lost += u64::from(!cut && !dropped && lost < packets);
            return;
        }
        let Conditions {
            delay,
            reordering,
            duplication,
            ..
        } = self.conditions;
        let mut at = left + delay;
        if self.happens(reordering.probability) {
            at += reordering.delay;
        }
        let copies = 1 + usize::from(self.happens(duplication));
        for _ in 0..copies {
            self.under_way.push(Reverse(UnderWay {
                at,
                number: self.tally.sent,
                datagram: datagram.to_vec(),
            }));
        }
    }

    /// Returns the first datagram that has arrived by `now`, and removes it from the path.
    pub fn take(&mut self, now: Duration) -> Option<Delivery> {
        if self.next_arrival()? > now {
            return None;
        }
        let Reverse(UnderWay { at, datagram, .. }) = self.under_way.pop()?;
        Some(Delivery { at, datagram })
    }

    /// Returns the arrival time of the next datagram in transit.
    pub fn next_arrival(&self) -> Option<Duration> {
        self.under_way.peek().map(|Reverse(first)| first.at)
    }

    /// Discards the datagrams in transit.
    pub fn clear(&mut self) {
        self.under_way.clear();
    }

    fn happens(&mut self, probability: f64) -> bool {
        probability > 0.0 && self.random.uniform() < probability
    }
}

/// The order is by time of arrival, and then by order of sending.
#[derive(Debug, Clone)]
struct UnderWay {
    at: Duration,
    number: u64,
    datagram: Vec<u8>,
}

impl UnderWay {
    fn key(&self) -> (Duration, u64) {
        (self.at, self.number)
    }
}

impl Ord for UnderWay {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

impl PartialOrd for UnderWay {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for UnderWay {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for UnderWay {}

/// Returns the number of IPv4 packets for a datagram of this size in bytes. Only a protocol 5 state
/// has two packets.
const fn packets(bytes: usize) -> usize {
    (UDP_HEADER + bytes).div_ceil(MTU - IP_HEADER)
}

/// Returns the size of a datagram on Ethernet, in bytes.
const fn on_the_wire(bytes: usize) -> usize {
    UDP_HEADER + bytes + packets(bytes) * (IP_HEADER + ETHERNET)
}

/// Largest IP packet on Ethernet, `[byte]`.
const MTU: usize = 1500;
/// IP header without options (RFC 791), `[byte]`.
const IP_HEADER: usize = 20;
/// UDP header (RFC 768), `[byte]`.
const UDP_HEADER: usize = 8;
/// Preamble, header, checksum and gap of a frame (IEEE 802.3), `[byte]`.
const ETHERNET: usize = 8 + 14 + 4 + 12;

#[cfg(test)]
mod tests;
