//! The fade from what one goal asks for to what the next one does.

/// Cycles that it takes.
pub(crate) const CROSS_FADE: u32 = 300;

/// Numbers that may stand between two goals'.
pub(crate) trait Blend: Copy + PartialEq {
    /// At `share` of the way to `other`, linearly: each number stays between its two ends.
    fn blend(&self, other: &Self, share: f64) -> Self;
}

/// The number at `share` of the way.
pub(crate) fn mix(from: f64, to: f64, share: f64) -> f64 {
    from + share * (to - from)
}

/// Numbers on their way from one goal's to the next.
#[derive(Debug)]
pub(crate) struct Fade<T> {
    from: T,
    to: T,
    cycle: u32,
}

impl<T: Blend> Fade<T> {
    /// A fade that is over from the start.
    pub(crate) fn at(value: T) -> Self {
        Self {
            from: value,
            to: value,
            cycle: CROSS_FADE,
        }
    }

    /// Heads for `to` from where it stands.
    pub(crate) fn towards(&mut self, to: T) {
        if to != self.to {
            *self = Self {
                from: self.now(),
                to,
                cycle: 0,
            };
        }
    }

    /// Advances by one cycle.
    pub(crate) fn step(&mut self) -> T {
        self.cycle = self.cycle.saturating_add(1);
        self.now()
    }

    /// As of the last step.
    pub(crate) fn now(&self) -> T {
        if self.cycle >= CROSS_FADE {
            self.to
        } else {
            let share = f64::from(self.cycle) / f64::from(CROSS_FADE);
            self.from.blend(&self.to, share)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Blend for f64 {
        fn blend(&self, other: &Self, share: f64) -> Self {
            mix(*self, *other, share)
        }
    }

    #[test]
    fn a_fade_that_is_turned_round_goes_on_from_where_it_stands() {
        let mut fade = Fade::at(2.0);
        fade.towards(5.0);
        let half = (0..CROSS_FADE / 2).map(|_| fade.step()).last();
        assert_eq!(half, Some(3.5));
        fade.towards(2.0);
        assert_eq!(fade.now(), 3.5);
        assert!((fade.step() - 3.495).abs() < 1e-12);
        for _ in 1..CROSS_FADE {
            fade.step();
        }
        assert_eq!(fade.now(), 2.0);
    }
}
