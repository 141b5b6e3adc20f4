//! Gains on their way from those of one goal to those of the next.

use crate::law::Gains;

/// Cycles over which the gains go from those of one goal to those of the next.
const CROSS_FADE: u32 = 300;

/// Gains on their way from one goal's to the next.
#[derive(Debug)]
pub(super) struct Fade {
    from: Gains,
    to: Gains,
    cycle: u32,
}

impl Fade {
    /// Nothing to fade.
    pub(super) fn at(gains: Gains) -> Self {
        Self {
            from: gains,
            to: gains,
            cycle: CROSS_FADE,
        }
    }

    /// Turns towards other gains, from wherever they are.
    pub(super) fn towards(&mut self, to: Gains) {
        if to != self.to {
            *self = Self {
                from: self.now(),
                to,
                cycle: 0,
            };
        }
    }

    /// One cycle on.
    pub(super) fn step(&mut self) -> Gains {
        self.cycle = self.cycle.saturating_add(1);
        self.now()
    }

    fn now(&self) -> Gains {
        if self.cycle >= CROSS_FADE {
            self.to
        } else {
            self.from
                .blend(&self.to, f64::from(self.cycle) / f64::from(CROSS_FADE))
        }
    }
}
