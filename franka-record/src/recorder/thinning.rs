//! Keeps all cycles near notable events, and every tenth cycle elsewhere. Elsewhere it also halves
//! the rate of the messages for viewers.

use core::time::Duration;
use std::collections::VecDeque;

use super::encoder::Message;
use crate::HostTime;
use crate::schema::Topic;

/// Delays messages until a notable event has followed them, or can no longer follow soon.
#[derive(Debug, Default)]
pub(super) struct Thinning {
    waiting: VecDeque<(Message, bool)>,
    /// End of the time in which all messages are kept.
    notable_until: HostTime,
    /// Number of messages so far, by robot and by topic.
    counts: Vec<[u64; Topic::ALL.len()]>,
}

impl Thinning {
    /// Processes a message. `pass` receives the messages whose delay has ended.
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
        let is_next = self.is_next(message.robot, message.topic);
        let kept = is_next || now <= self.notable_until;
        self.waiting.push_back((message, kept));
    }

    /// Counts a message. Returns true if the message must be kept even without a notable event.
    fn is_next(&mut self, robot: usize, topic: Topic) -> bool {
        if self.counts.len() <= robot {
            self.counts.resize(robot + 1, Default::default());
        }
        let count = &mut self.counts[robot][topic as usize];
        let is_next = count.is_multiple_of(one_in(topic));
        *count += 1;
        is_next
    }

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

/// Returns the n for which every n-th message of a topic is kept without a notable event.
fn one_in(topic: Topic) -> u64 {
    match topic {
        Topic::Cycle => 10,
        Topic::Tf | Topic::Target | Topic::Joints | Topic::Scene => 2,
        Topic::Tool | Topic::Event | Topic::Log | Topic::Gripper => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the milliseconds of the kept messages, for two robots with one message each.
    fn kept(topic: Topic, notable: impl Fn(u64) -> bool) -> Vec<u64> {
        let mut thinning = Thinning::default();
        let mut kept = Vec::new();
        let start = HostTime::from_nanos(1_700_000_000_000_000_000);
        let mut note = |message: Message| {
            if message.robot == 1 {
                kept.push(message.time.since(start).as_millis() as u64);
            }
        };
        for ms in 0..5000 {
            for robot in 0..2 {
                let message = Message {
                    robot,
                    topic,
                    time: start + Duration::from_millis(ms),
                    data: Box::default(),
                    notable: notable(ms),
                };
                thinning.push(message, &mut note);
            }
        }
        thinning.finish(note);
        kept
    }

    const RATES: [(Topic, usize); 4] = [
        (Topic::Cycle, 10),
        (Topic::Tf, 2),
        (Topic::Scene, 2),
        (Topic::Event, 1),
    ];

    #[test]
    fn thinning_keeps_one_message_in_n_of_each_robot() {
        for (topic, rate) in RATES {
            let expected: Vec<_> = (0..5000).step_by(rate).collect();
            assert!(kept(topic, |_| false) == expected, "{topic:?}");
        }
    }

    #[test]
    fn every_message_is_kept_around_what_is_notable() {
        let around = |ms: u64| (1500..=3000).contains(&ms);
        for (topic, rate) in RATES {
            let is_kept = |ms: &u64| ms.is_multiple_of(rate as u64) || around(*ms);
            let expected: Vec<_> = (0..5000).filter(is_kept).collect();
            assert!(kept(topic, |ms| ms == 2000) == expected, "{topic:?}");
        }
    }
}
