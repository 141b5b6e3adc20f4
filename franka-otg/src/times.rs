//! Short sorted lists of durations.

/// Up to `C` times in ascending order. If the list is full, a new time replaces the last time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Times<const C: usize> {
    list: [f64; C],
    len: usize,
}

impl<const C: usize> Times<C> {
    pub(crate) const NONE: Self = Self {
        list: [0.0; C],
        len: 0,
    };

    /// Adds a time, unless the list already contains it.
    pub(crate) fn insert(&mut self, t: f64) {
        if self.iter().any(|other| other == t) {
            return;
        }
        let mut i = self.len.min(C - 1);
        while i > 0 && self.list[i - 1] > t {
            self.list[i] = self.list[i - 1];
            i -= 1;
        }
        self.list[i] = t;
        self.len = (self.len + 1).min(C);
    }

    /// Returns the times in ascending order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        self.list[..self.len].iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_lists_keep_the_last_time() {
        let mut times = Times::<3>::NONE;
        for t in [1.0, 4.0, 2.0, 2.0, 3.0, 5.0] {
            times.insert(t);
        }
        assert!(times.iter().eq([1.0, 2.0, 5.0]));
    }
}
