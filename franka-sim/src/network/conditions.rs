//! Conditions of a network: loss, delay, jitter, rate, reordering, duplication, stalls.

use std::time::Duration;

/// What happens to the datagrams of one direction. By default nothing: they arrive when they are
/// sent.
///
/// Probabilities are those of a comparison: 0 or less is never, 1 or more always, and what is not a
/// number is never.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Which packets are lost. A datagram that does not fit into one packet is lost with any of
    /// them.
    pub loss: Loss,
    /// How long the way takes.
    pub delay: Duration,
    /// Up to this much later than sent, evenly distributed, a datagram gets to the line. The order
    /// stays.
    pub jitter: Duration,
    /// What the line takes, `[bit/s]`: datagrams that are sent together arrive one after the other.
    /// Infinite for a line that takes no time.
    pub rate: f64,
    /// When the sender's interface keeps what it should send.
    pub stalls: Option<Stalls>,
    /// Which datagrams are overtaken.
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
    /// Delay and jitter are half of what pings of 1200 bytes took to three FERs and back, 0.114 ms
    /// with a deviation of 0.009 ms (libfranka, issue 120). The rate is that of gigabit Ethernet,
    /// at which the 2497 bytes that a protocol 5 state is on the wire take 0.02 ms: control loops
    /// have been called again after as little (franka_ros, issue 322: 0.023 ms).
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

    /// These conditions, and this loss.
    #[must_use]
    pub const fn with_loss(mut self, loss: Loss) -> Self {
        self.loss = loss;
        self
    }
}

/// Which packets are lost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// None.
    Never,
    /// Each with this probability, `[1]`, whatever happened to the others.
    Independent(f64),
    /// Many at a time.
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
    /// The same while bad.
    pub bad: f64,
}

impl BurstLoss {
    /// Bursts of `length` packets in the mean, at least 1, in which all are lost, and between which
    /// none is, so that `fraction` of all packets is lost, less than 1.
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

/// Datagrams that others overtake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reordering {
    /// Probability that a datagram takes the longer way, `[1]`.
    pub probability: f64,
    /// How much longer that way takes. Those sent later overtake if they are sent within this.
    pub delay: Duration,
}

/// Times in which an interface sends nothing, and after which it sends what was to be sent
/// meanwhile, in order.
///
/// A stall takes the shortest time and an exponentially distributed excess, up to the longest. Some
/// delay a single datagram only. Three of four come near a multiple of the period, as far as there
/// are enough of these; between the others, pauses are exponentially distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stalls {
    /// How many begin in a second, in the mean, `[1/s]`.
    pub per_second: f64,
    /// The least time one takes.
    pub shortest: Duration,
    /// The most.
    pub longest: Duration,
    /// Mean of what it takes beyond the shortest, if there were no longest.
    pub excess: Duration,
    /// Share that delays one datagram by half a millisecond to a millisecond, and no other, 0 to 1.
    pub single: f64,
    /// Period of the times near which they come; zero if all come independently.
    pub period: Duration,
}

impl Stalls {
    /// Those of the FER's network interface.
    ///
    /// Measured on robots: seven a second, of 2 to 7 ms, no state lost; the longest silence between
    /// two states was 4.8 to 6.9 ms. That bounds the rest. Of `n` stalls, the longest takes 2 ms +
    /// `excess` (ln `n` + 0.577) in the mean, and the silence half a millisecond more, since the
    /// last state was before. In the middle between 4.8 and 6.9 ms, the excess is 0.57 ms if a
    /// measurement took 30 s, and 0.69 ms if it took 10 s. The value is one between them that also
    /// leads to the loss measured in clients.
    ///
    /// One capture of 10.4 s on a robot, 72 silences: they come on a grid of 101.0 ms (Rayleigh
    /// 0.70), to which the share on the grid and the spread around it are fitted. In that capture
    /// 40 % are of single late states, which [`single`](Self::single) makes. With them, clients
    /// would lose 16 states of 30 000 and not the 28 that were measured on other robots: this has
    /// none. That lengths fall off exponentially is a choice.
    pub const FER: Self = Self {
        per_second: 7.0,
        shortest: Duration::from_millis(2),
        longest: Duration::from_millis(7),
        excess: Duration::from_micros(650),
        single: 0.0,
        period: Duration::from_millis(101),
    };

    /// How long one takes in the mean.
    pub fn mean(&self) -> Duration {
        let (range, excess) = (self.range(), self.excess.as_secs_f64());
        if range == 0.0 || excess == 0.0 {
            return self.shortest;
        }
        let cut_off = range / (range / excess).exp_m1();
        self.shortest + Duration::from_secs_f64(excess - cut_off)
    }

    /// What takes longer than this share of all stalls, `0 <= share < 1`.
    pub(super) fn quantile(&self, share: f64) -> Duration {
        let (range, excess) = (self.range(), self.excess.as_secs_f64());
        if range == 0.0 || excess == 0.0 {
            return self.shortest;
        }
        let covered = -(-range / excess).exp_m1();
        let beyond = -excess * (-share * covered).ln_1p();
        self.shortest + Duration::from_secs_f64(beyond.clamp(0.0, range))
    }

    /// Probability that one comes near a given multiple of the period.
    pub(super) fn on_grid(&self) -> f64 {
        match self.period {
            Duration::ZERO => 0.0,
            period => (ON_GRID * self.per_second * period.as_secs_f64()).clamp(0.0, 1.0),
        }
    }

    /// Mean time from the end of one that comes independently to the beginning of the next; zero if
    /// they leave none.
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

/// Share of stalls that come on the grid, where it has room.
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
