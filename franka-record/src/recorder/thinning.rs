//! Cycles at the full rate around what is notable, and at a tenth of it elsewhere.

use core::time::Duration;
use std::collections::VecDeque;

use super::encoder::Message;
use crate::HostTime;
use crate::schema::Topic;

/// Holds messages back until it is known whether something notable follows soon.
#[derive(Debug, Default)]
pub(super) struct Thinning {
    waiting: VecDeque<(Message, bool)>,
    /// Until when cycles are kept.
    notable_until: HostTime,
    /// Cycles so far.
    cycles: u64,
}

impl Thinning {
    /// Takes a message; `pass` gets those that need not wait any longer.
    pub(super) fn push(&mut self, message: Message, mut pass: impl FnMut(Message)) {
        let now = message.time;
        let due = now - BEFORE;
        while self
            .waiting
            .front()
            .is_some_and(|(first, _)| first.time < due)
        {
            if let Some((message, true)) = self.waiting.pop_front() {
                pass(message);
            }
        }
        if message.notable {
            self.notable_until = now + AFTER;
            self.waiting.iter_mut().for_each(|(_, kept)| *kept = true);
        }
        let kept = match message.topic {
            Topic::Cycle => {
                self.cycles += 1;
                self.cycles % ONE_IN == 1 || now <= self.notable_until
            }
            _ => true,
        };
        self.waiting.push_back((message, kept));
    }

    /// Passes on what waits.
    pub(super) fn finish(&mut self, mut pass: impl FnMut(Message)) {
        for (message, kept) in self.waiting.drain(..) {
            if kept {
                pass(message);
            }
        }
    }
}

const BEFORE: Duration = Duration::from_millis(500);
const AFTER: Duration = Duration::from_secs(1);
const ONE_IN: u64 = 10;

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(notable: impl Fn(u64) -> bool) -> Vec<u64> {
        let mut thinning = Thinning::default();
        let mut kept = Vec::new();
        let start = HostTime::from_nanos(1_700_000_000_000_000_000);
        let mut note = |message: Message| kept.push(message.time.since(start).as_millis() as u64);
        for ms in 0..5000 {
            let message = Message {
                robot: 0,
                topic: Topic::Cycle,
                time: start + Duration::from_millis(ms),
                data: Box::default(),
                notable: notable(ms),
            };
            thinning.push(message, &mut note);
        }
        thinning.finish(note);
        kept
    }

    #[test]
    fn one_cycle_in_ten_is_kept_where_nothing_happens() {
        let expected: Vec<_> = (0..5000).step_by(10).collect();
        assert!(kept(|_| false) == expected);
    }

    #[test]
    fn every_cycle_is_kept_around_what_is_notable() {
        let around = |ms: u64| (1500..=3000).contains(&ms);
        let expected: Vec<_> = (0..5000).filter(|ms| ms % 10 == 0 || around(*ms)).collect();
        assert!(kept(|ms| ms == 2000) == expected);
    }
}
