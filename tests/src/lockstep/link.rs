//! What the network loses: from a seed, or what it is told to.

use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

/// A link that loses datagrams in either direction.
#[derive(Clone, Debug)]
pub struct Link {
    random: SmallRng,
    /// Probability that a state is lost.
    pub state_loss: f64,
    /// Probability that a command is lost.
    pub command_loss: f64,
    /// Datagrams that are lost next, whatever the probabilities say: states, commands.
    drop_next: (u64, u64),
    /// Finishing commands that are lost next.
    drop_finishing: u64,
    /// Whether requests reach the robot. While they do not, they are lost.
    pub requests: bool,
    /// Whether the robot's replies arrive.
    pub replies: bool,
}

impl Link {
    /// Loses nothing.
    pub fn perfect() -> Self {
        Self::lossy(0, 0.0, 0.0)
    }

    /// Loses states and commands with these probabilities.
    pub fn lossy(seed: u64, state_loss: f64, command_loss: f64) -> Self {
        Self {
            random: SmallRng::seed_from_u64(seed),
            state_loss,
            command_loss,
            drop_next: (0, 0),
            drop_finishing: 0,
            requests: true,
            replies: true,
        }
    }

    /// Loses the next `count` states.
    pub fn drop_states(&mut self, count: u64) {
        self.drop_next.0 = count;
    }

    /// Loses the next `count` commands.
    pub fn drop_commands(&mut self, count: u64) {
        self.drop_next.1 = count;
    }

    /// Loses the next `count` commands that end a motion.
    pub fn drop_finishing(&mut self, count: u64) {
        self.drop_finishing = count;
    }

    pub(super) fn passes_state(&mut self) -> bool {
        let lost = self.random.random_bool(self.state_loss);
        let dropped = take_one(&mut self.drop_next.0);
        !(lost || dropped)
    }

    pub(super) fn passes_command(&mut self, finishing: bool) -> bool {
        let lost = self.random.random_bool(self.command_loss);
        let dropped = take_one(&mut self.drop_next.1);
        let last = finishing && take_one(&mut self.drop_finishing);
        !(lost || dropped || last)
    }
}

fn take_one(count: &mut u64) -> bool {
    let some = *count > 0;
    *count = count.saturating_sub(1);
    some
}
