//! Conditions of a network: loss, delay, jitter, rate, reordering, duplication, stalls.

use std::time::Duration;

/// Conditions for the datagrams of one direction. By default, datagrams arrive at the time at which
/// they are sent.
///
/// Probabilities are compared with a random number: 0 or less and NaN mean never, 1 or more means
/// always.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Loss of packets. If one packet of a datagram is lost, the whole datagram is lost.
    pub loss: Loss,
    /// Time from the end of the line to the receiver.
    pub delay: Duration,
    /// Largest random delay before a datagram reaches the line. The delays are uniformly
    /// distributed from zero to this value. Datagrams keep their order.
    pub jitter: Duration,
    /// Rate of the line, `[bit/s]`. Datagrams that are sent together arrive one after the other.
    /// Infinity means that transmission takes no time.
    pub rate: f64,
    /// Stalls of the sender's network interface, if any.
    pub stalls: Option<Stalls>,
    /// Reordering: some datagrams take longer, and others overtake them.
    pub reordering: Reordering,
    /// Probability that a datagram arrives twice, `[1]`.
    pub duplication: f64,
}

impl Default for Conditions {
    fn default() -> Self {
        Self {
            loss: Loss::Never,
            delay: Duration::ZERO,
            jitter: Duration::ZERO,
            rate: f64::INFINITY,
            stalls: None,
            reordering: Reordering {
                probability: 0.0,
                delay: Duration::ZERO,
            },
            duplication: 0.0,
        }
    }
}

impl Conditions {
    /// A cable between the robot and a good network card.
    ///
    /// Delay and jitter are half of the round trip of pings of 1200 bytes to three FERs: 0.114 ms
    /// with a deviation of 0.009 ms (libfranka, issue 120). The rate is gigabit Ethernet. A state
    /// of protocol 5 (2497 bytes on the wire) then requires 0.02 ms. Control loops have seen
    /// intervals as short as this between their calls (franka_ros, issue 322: 0.023 ms).
    pub const fn cable() -> Self {
        Self {
            loss: Loss::Never,
            delay: Duration::from_micros(50),
            jitter: Duration::from_micros(20),
            rate: 1e9,
            stalls: None,
            reordering: Reordering {
                probability: 0.0,
                delay: Duration::ZERO,
            },
            duplication: 0.0,
        }
    }

    /// Returns these conditions with the given loss.
    #[must_use]
    pub const fn with_loss(mut self, loss: Loss) -> Self {
        self.loss = loss;
        self
    }
}

/// Model of the loss of packets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// No packet is lost.
    Never,
    /// Each packet is lost with this probability, `[1]`, independently of the others.
    Independent(f64),
    /// Packets are lost in bursts.
    Bursts(BurstLoss),
}

/// Losses that come in bursts: the two states of Gilbert (1960) and Elliott (1963). The network is
/// good or bad, and may change before every packet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BurstLoss {
    /// Probability that a good network becomes bad, `[1/packet]`.
    pub begin: f64,
    /// Probability that a bad network becomes good, `[1/packet]`: the inverse of a burst's mean
    /// length.
    pub end: f64,
    /// Probability of losing a packet while good, `[1]`.
    pub good: f64,
    /// Probability of losing a packet while bad, `[1]`.
    pub bad: f64,
}

impl BurstLoss {
    /// Returns bursts of `length` packets on average, at least 1. All packets in a burst are lost,
    /// and no packets between bursts. `fraction`, less than 1, is the lost fraction of all packets.
    pub fn of(fraction: f64, length: f64) -> Self {
        let end = 1.0 / length;
        Self {
            begin: end * fraction / (1.0 - fraction),
            end,
            good: 0.0,
            bad: 1.0,
        }
    }
}

/// Model of reordering: some datagrams take a longer path, and others overtake them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reordering {
    /// Probability that a datagram takes the longer path, `[1]`.
    pub probability: f64,
    /// Additional delay of the longer path. A datagram that is sent within this time overtakes.
    pub delay: Duration,
}

/// Model of times in which a network interface sends nothing. Afterwards it sends the delayed
/// datagrams in order.
///
/// A stall lasts for the shortest time plus an exponentially distributed excess, up to the longest
/// time. Some stalls delay only a single datagram. Three of four stalls come near a multiple of the
/// period, if there are enough multiples. The pauses between the other stalls are exponentially
/// distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stalls {
    /// Stalls that begin in a second, on average, `[1/s]`.
    pub per_second: f64,
    /// Shortest duration of a stall.
    pub shortest: Duration,
    /// Longest duration of a stall.
    pub longest: Duration,
    /// Mean of the excess over the shortest duration, before the longest duration cuts it off.
    pub excess: Duration,
    /// Fraction of stalls that delay only one datagram, by half a millisecond to a millisecond, 0
    /// to 1.
    pub single: f64,
    /// Period of the moments near which stalls come; zero if all stalls come independently.
    pub period: Duration,
}

impl Stalls {
    /// Stalls of the FER's network interface.
    ///
    /// Measurements on robots show seven stalls a second, of 2 to 7 ms, with no state lost. The
    /// longest silence between two states was 4.8 to 6.9 ms, which bounds the other parameters. Of
    /// `n` stalls, the longest lasts 2 ms + `excess` (ln `n` + 0.577) on average. The silence is
    /// half a millisecond longer, because the last state was sent before the stall. For a silence
    /// in the middle of this range, the excess is 0.57 ms if a measurement took 30 s. It is 0.69 ms
    /// if a measurement took 10 s. The value used is between these two. It also reproduces the loss
    /// that clients measure.
    ///
    /// One capture of 10.4 s on a robot has 72 silences. They come on a grid of 101.0 ms (Rayleigh
    /// 0.70). The share of stalls on the grid and their spread around it are fitted to this
    /// capture. 40 % of its silences are single late states, as [`single`](Self::single) makes
    /// them. With single late states, clients would lose 16 states of 30 000. Other robots lost 28,
    /// so this value has no single late states. The exponential distribution of lengths is a
    /// choice.
    pub const FER: Self = Self {
        per_second: 7.0,
        shortest: Duration::from_millis(2),
        longest: Duration::from_millis(7),
        excess: Duration::from_micros(650),
        single: 0.0,
        period: Duration::from_millis(101),
    };

    /// Mean duration of a stall.
    pub fn mean(&self) -> Duration {
        let (range, excess) = (self.range(), self.excess.as_secs_f64());
        if range == 0.0 || excess == 0.0 {
            return self.shortest;
        }
        let cut_off = range / (range / excess).exp_m1();
        self.shortest + Duration::from_secs_f64(excess - cut_off)
    }

    /// Duration that exceeds the duration of this share of all stalls, `0 <= share < 1`.
    pub(super) fn quantile(&self, share: f64) -> Duration {
        let (range, excess) = (self.range(), self.excess.as_secs_f64());
        if range == 0.0 || excess == 0.0 {
            return self.shortest;
        }
        let covered = -(-range / excess).exp_m1();
        let beyond = -excess * (-share * covered).ln_1p();
        self.shortest + Duration::from_secs_f64(beyond.clamp(0.0, range))
    }

    /// Probability that a stall comes near a given multiple of the period.
    pub(super) fn on_grid(&self) -> f64 {
        match self.period {
            Duration::ZERO => 0.0,
            period => (ON_GRID * self.per_second * period.as_secs_f64()).clamp(0.0, 1.0),
        }
    }

    /// Mean time from the end of an independent stall to the beginning of the next; zero if they
    /// leave no pause.
    pub(super) fn pause(&self) -> Duration {
        let period = self.period.as_secs_f64();
        let on_grid = match period {
            0.0 => 0.0,
            _ => self.on_grid() / period,
        };
        let per_second = (self.per_second - on_grid).max(f64::MIN_POSITIVE);
        let pause = 1.0 / per_second - self.mean().as_secs_f64();
        Duration::try_from_secs_f64(pause.max(0.0)).unwrap_or(Duration::MAX)
    }

    fn range(&self) -> f64 {
        self.longest.saturating_sub(self.shortest).as_secs_f64()
    }
}

/// Share of stalls on the grid, if the grid has room.
const ON_GRID: f64 = 0.75;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stalls_have_the_mean_and_the_ends_that_they_say() {
        for stalls in [
            Stalls::FER,
            Stalls {
                excess: Duration::from_millis(4),
                ..Stalls::FER
            },
        ] {
            let count = 100_000;
            let middle = |n: i32| stalls.quantile((f64::from(n) + 0.5) / f64::from(count));
            let sum: f64 = (0..count).map(|n| middle(n).as_secs_f64()).sum();
            let mean = sum / f64::from(count);
            assert!((mean - stalls.mean().as_secs_f64()).abs() < 1e-7, "{mean}");
            assert_eq!(stalls.quantile(0.0), stalls.shortest);
            let most = stalls.quantile(1.0 - 1e-16);
            assert!(stalls.longest - most < Duration::from_micros(1), "{most:?}");
        }
    }

    #[test]
    fn stalls_of_one_length_are_possible() {
        let always = Stalls {
            longest: Stalls::FER.shortest,
            ..Stalls::FER
        };
        assert_eq!(always.mean(), always.shortest);
        assert_eq!(always.quantile(0.7), always.shortest);
    }
}
