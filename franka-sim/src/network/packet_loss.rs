//! Random loss of packets. `path` applies it to datagrams of several packets.

use super::conditions::Loss;
use crate::noise::Random;

/// Decides which packets are lost, from a [`Loss`] and a seed.
#[derive(Debug, Clone)]
pub(super) struct Losses {
    loss: Loss,
    random: Random,
    bad: bool,
}

impl Losses {
    pub(super) fn new(loss: Loss, seed: u64) -> Self {
        Self {
            loss,
            random: Random::new(seed),
            bad: false,
        }
    }

    /// Returns true if the next packet is lost.
    pub(super) fn lose(&mut self) -> bool {
        match self.loss {
            Loss::Never => false,
            Loss::Independent(probability) => self.random.uniform() < probability,
            Loss::Bursts(bursts) => {
                let change = if self.bad { bursts.end } else { bursts.begin };
                self.bad ^= self.random.uniform() < change;
                let probability = if self.bad { bursts.bad } else { bursts.good };
                self.random.uniform() < probability
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::BurstLoss;

    /// Returns the fraction of lost packets and the mean length of a run of losses.
    fn measure(loss: Loss) -> (f64, f64) {
        let mut losses = Losses::new(loss, 5);
        let (mut lost, mut runs, mut before) = (0, 0, false);
        let count = 200_000;
        for _ in 0..count {
            let now = losses.lose();
            lost += i32::from(now);
            runs += i32::from(now && !before);
            before = now;
        }
        let share = f64::from(lost) / f64::from(count);
        (share, f64::from(lost) / f64::from(runs.max(1)))
    }

    #[test]
    fn losses_have_the_rate_and_the_length_asked_for() {
        assert_eq!(measure(Loss::Never), (0.0, 0.0));
        // With independent losses, a run continues with the probability of another loss.
        let (share, length) = measure(Loss::Independent(0.05));
        assert!((share - 0.05).abs() < 0.002, "{share}");
        assert!((length - 1.0 / 0.95).abs() < 0.02, "{length}");
        let (share, length) = measure(Loss::Bursts(BurstLoss::of(0.05, 6.0)));
        assert!((share - 0.05).abs() < 0.005, "{share}");
        assert!((length - 6.0).abs() < 0.4, "{length}");
    }
}
