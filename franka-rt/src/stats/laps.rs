//! A stopwatch for the phases of a cycle. It does nothing without the feature `cycle-phases`.

use std::time::Instant;

use super::{Phase, Phases};

/// Measures the phases of one cycle, each from the end of the previous phase. Without the feature
/// it has no fields and reads no clock.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Laps {
    #[cfg(feature = "cycle-phases")]
    last: Instant,
    #[cfg(feature = "cycle-phases")]
    phases: Phases,
}

#[cfg(feature = "cycle-phases")]
impl Laps {
    pub(crate) fn start(at: Instant) -> Self {
        Self {
            last: at,
            phases: Phases::default(),
        }
    }

    /// Ends a phase now. If a phase occurs twice, its times are added.
    pub(crate) fn end(&mut self, phase: Phase) {
        self.end_at(phase, Instant::now());
    }

    /// Ends a phase at `at`, a time that was already read.
    pub(crate) fn end_at(&mut self, phase: Phase, at: Instant) {
        let taken = at.saturating_duration_since(self.last);
        self.last = at;
        if let Some(sum) = self.phases.part_mut(phase) {
            *sum += taken;
        }
    }

    /// Returns the times of the phases so far.
    pub(crate) fn phases(&self) -> Option<Phases> {
        Some(self.phases)
    }
}

#[cfg(not(feature = "cycle-phases"))]
impl Laps {
    pub(crate) fn start(_: Instant) -> Self {
        Self {}
    }

    pub(crate) fn end(&mut self, _: Phase) {}

    pub(crate) fn end_at(&mut self, _: Phase, _: Instant) {}

    pub(crate) fn phases(&self) -> Option<Phases> {
        None
    }
}

#[cfg(test)]
mod tests {
    #[cfg(feature = "cycle-phases")]
    #[test]
    fn a_phase_counts_from_the_end_of_the_one_before_and_adds_up() {
        use core::time::Duration;

        use super::*;

        const US: fn(u64) -> Duration = Duration::from_micros;
        let start = Instant::now();
        let mut laps = Laps::start(start);
        for (phase, at) in [
            (Phase::Orders, 1),
            (Phase::Decode, 3),
            (Phase::Program, 10),
            (Phase::Publish, 14),
            (Phase::Program, 30),
            (Phase::Send, 35),
            (Phase::Prepare, 41),
        ] {
            laps.end_at(phase, start + US(at));
        }
        let expected = Phases {
            orders: US(1),
            decode: US(2),
            program: US(7 + 16),
            send: US(5),
            publish: US(4),
            prepare: US(6),
        };
        assert_eq!(laps.phases(), Some(expected));
    }

    #[cfg(not(feature = "cycle-phases"))]
    #[test]
    fn laps_are_neither_timed_nor_kept_without_the_feature() {
        use super::*;

        let mut laps = Laps::start(Instant::now());
        laps.end(Phase::Program);
        laps.end_at(Phase::Send, Instant::now());
        assert_eq!(laps.phases(), None);
        assert_eq!(size_of::<Laps>(), 0);
    }
}
