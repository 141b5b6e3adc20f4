//! Fading from the values of one goal to the values of the next goal.

/// Duration of the fade, in cycles.
pub(crate) const CROSS_FADE: u32 = 300;

/// Numbers that can be interpolated between the values of two goals.
pub(crate) trait Blend: Copy + PartialEq {
    /// Interpolates linearly toward `other`, by `share` of the difference. Each number stays
    /// between its start and its end.
    fn blend(&self, other: &Self, share: f64) -> Self;
}

pub(crate) fn mix(from: f64, to: f64, share: f64) -> f64 {
    from + share * (to - from)
}

/// Numbers that fade from one goal's values to the values of the next goal.
#[derive(Debug)]
pub(crate) struct Fade<T> {
    from: T,
    to: T,
    cycle: u32,
}

impl<T: Blend> Fade<T> {
    /// Returns a fade that has already ended, at this value.
    pub(crate) fn at(value: T) -> Self {
        Self {
            from: value,
            to: value,
            cycle: CROSS_FADE,
        }
    }

    /// Fades to `to` from the present value.
    pub(crate) fn towards(&mut self, to: T) {
        if to != self.to {
            *self = Self {
                from: self.now(),
                to,
                cycle: 0,
            };
        }
    }

    pub(crate) fn step(&mut self) -> T {
        self.cycle = self.cycle.saturating_add(1);
        self.now()
    }

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
