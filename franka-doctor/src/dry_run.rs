//! Result of a dry run, in which a control loop runs with a simulated robot on this computer.

use core::time::Duration;

use crate::finding::{About, Finding, Group, Judged, Matters, Purpose};
use crate::report::counted;
use crate::timing::quantile;

/// The times that a control loop took to answer the states of a simulated robot.
///
/// Each time starts when the robot's thread has sent the state. Therefore the times contain only
/// the delays of the loop. A delay of the robot's thread makes it send a state later, and does not
/// count.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DryRun {
    /// The `SCHED_FIFO` priority of the loop; `None` if the loop ran under the normal scheduler.
    pub priority: Option<i32>,
    /// Time from each state to the command that answers this state or a newer state. Sorted.
    pub answers: Vec<Duration>,
    /// Number of states that the simulated robot sent more than 2 ms after the previous state.
    pub pauses: usize,
    /// Reason why the run ended early; `None` if it did not.
    pub ended: Option<String>,
}

impl DryRun {
    /// Computes the answer times from `sent`, the times of the states, and `left`, the times of the
    /// commands. Each entry is the `message_id` of a state and a time. Both lists must be sorted by
    /// `message_id` and use the same clock. States before the first command and after the last
    /// command are ignored.
    pub fn new(sent: &[(u64, Duration)], left: &[(u64, Duration)]) -> Self {
        let mut run = Self::default();
        let mut commands = left.iter().peekable();
        let first = left.first().map_or(u64::MAX, |(id, _)| *id);
        let mut before = None;
        for (id, at) in sent.iter().filter(|(id, _)| *id >= first) {
            while commands.next_if(|(answered, _)| answered < id).is_some() {}
            let Some((_, departure)) = commands.peek() else {
                break;
            };
            run.answers.push(departure.saturating_sub(*at));
            let gap = before.map(|before| at.saturating_sub(before));
            run.pauses += usize::from(gap > Some(PAUSE));
            before = Some(*at);
        }
        run.answers.sort_unstable();
        run
    }

    /// Returns the number of answers that took longer than one cycle.
    fn late(&self) -> usize {
        self.answers.len() - self.answers.partition_point(|answer| *answer <= CYCLE)
    }
}

/// Returns the finding about a dry run (`timing.dry_run`). This function performs no I/O.
pub fn dry_run(run: &DryRun, purpose: Purpose) -> Finding {
    let about = About {
        id: "timing.dry_run",
        group: Group::Timing,
        matters: Matters::Moving,
        wanted: "every answer within 1 ms, 99 % within 0.8 ms; a failure if 1 % are late or the \
            run ends early",
        why: "This runs the driver's own loop and sockets, without the network card and the robot.",
        source: "thresholds: this project's, from the millisecond of a cycle",
    };
    about.finding(Ok(judge(run)), purpose)
}

fn judge(run: &DryRun) -> Judged {
    let (count, late) = (run.answers.len(), run.late());
    let Some(max) = run.answers.last() else {
        return Judged::unknown("unknown: no command was sent");
    };
    let scheduling = match run.priority {
        Some(priority) => format!("SCHED_FIFO {priority}"),
        None => "normal scheduling".into(),
    };
    let (p50, p99) = (quantile(&run.answers, 0.5), quantile(&run.answers, 0.99));
    let mut read = format!(
        "{count} states answered under {scheduling}: p50 {}, p99 {}, max {} us; {late} later than 1 ms",
        p50.as_micros(),
        p99.as_micros(),
        max.as_micros(),
    );
    if run.pauses > 0 {
        read += &format!(
            "; the simulated robot was late {}, which does not count",
            counted(run.pauses, "time")
        );
    }
    if let Some(why) = &run.ended {
        Judged::failure(format!("{read}; ended early: {why}"))
    } else if late * 100 >= count {
        Judged::failure(read)
    } else if late > 0 {
        Judged::warning(read)
    } else if p99 >= ANSWER_GOOD {
        Judged::info(read)
    } else if run.priority.is_none() {
        Judged::info(format!(
            "{read}; not conclusive, since other programs may delay the loop"
        ))
    } else if count < ANSWERS_MIN {
        Judged::info(format!("{read}; too few for a verdict"))
    } else {
        Judged::good(read)
    }
}

/// Time that a robot allows for an answer.
const CYCLE: Duration = Duration::from_millis(1);

const ANSWER_GOOD: Duration = Duration::from_micros(800);

/// Interval between two states above which the robot was paused. The nominal interval is 1 ms.
const PAUSE: Duration = Duration::from_millis(2);

/// Smallest number of answers for a conclusive result: ten seconds of answers, minus a few at the
/// beginning and the end.
const ANSWERS_MIN: usize = 9_900;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Verdict;

    const US: fn(u64) -> Duration = Duration::from_micros;

    /// Returns ten states at intervals of one millisecond, from number 5 on, each with the delay
    /// that `delay` returns.
    fn sent(delay: impl Fn(u64) -> u64) -> Vec<(u64, Duration)> {
        (5..15).map(|id| (id, US(id * 1000 + delay(id)))).collect()
    }

    #[test]
    fn answers_count_from_when_the_state_was_sent() {
        let punctual = sent(|_| 0);
        // Two states come before the first command, and two after the last.
        let left = |punctual: &[(u64, Duration)]| -> Vec<_> {
            let commands = punctual[2..8].iter();
            commands.map(|(id, at)| (*id, *at + US(80))).collect()
        };
        let run = DryRun::new(&punctual, &left(&punctual));
        assert_eq!((run.answers, run.pauses), (vec![US(80); 6], 0));
        // The robot pauses for 20 ms, which is not a delay of the loop.
        let paused = sent(|id| if id < 9 { 0 } else { 20_000 });
        let run = DryRun::new(&paused, &left(&paused));
        assert_eq!((run.answers, run.pauses), (vec![US(80); 6], 1));
    }

    #[test]
    fn states_that_were_not_answered_count_until_the_next_command() {
        let sent = sent(|_| 0);
        // The loop is delayed from state 6 until 2.5 ms after it, and skips 7.
        let left = [(5, US(5100)), (6, US(8500)), (8, US(8600)), (9, US(9100))];
        let run = DryRun::new(&sent, &left);
        assert_eq!(run.answers, [US(100), US(100), US(600), US(1600), US(2500)]);
        assert_eq!((run.late(), run.pauses), (2, 0));
        let none = DryRun::new(&sent, &[]);
        assert_eq!(none, DryRun::default());
    }

    #[test]
    fn late_answers_decide_and_then_the_rest() {
        let answers = |count: usize, most: u64, late: usize| {
            [vec![US(most); count - late], vec![US(1001); late]].concat()
        };
        let good = DryRun {
            priority: Some(99),
            answers: answers(10_000, 799, 0),
            ..DryRun::default()
        };
        let with = |answers: Vec<Duration>| DryRun {
            answers,
            ..good.clone()
        };
        let normal = DryRun {
            priority: None,
            ..good.clone()
        };
        let ended = DryRun {
            ended: Some("communication_constraints_violation".into()),
            ..good.clone()
        };
        use Verdict::{Failure, Good, Info, Unknown, Warning};
        for (run, expected) in [
            (good.clone(), Good),
            (ended, Failure),
            (with(answers(10_000, 800, 0)), Info),
            (normal, Info),
            (with(answers(9_899, 100, 0)), Info),
            (with(answers(10_000, 100, 1)), Warning),
            (with(answers(10_000, 100, 99)), Warning),
            (with(answers(10_000, 100, 100)), Failure),
            (DryRun::default(), Unknown),
        ] {
            let finding = dry_run(&run, Purpose::Move);
            assert_eq!(finding.verdict, expected, "{}", finding.read);
        }
        let late = DryRun {
            pauses: 2,
            ..with(answers(10_000, 100, 100))
        };
        let finding = dry_run(&late, Purpose::Read);
        assert_eq!(finding.verdict, Warning);
        assert_eq!(
            finding.read,
            "10000 states answered under SCHED_FIFO 99: p50 100, p99 100, max 1001 us; 100 later \
             than 1 ms; the simulated robot was late 2 times, which does not count"
        );
    }
}
