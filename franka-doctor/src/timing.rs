//! The punctuality of the host and of a robot's states.

use core::time::Duration;

use crate::finding::{About, Finding, Group, Judged, Matters, Needs, Purpose};
use crate::host::Unread;
use crate::latencies::Latencies;

/// Returns the finding about a measurement of wake-ups (`timing.wake_up`).
pub(crate) fn wake_up(measured: Result<Latencies, Unread>, purpose: Purpose) -> Finding {
    let about = About {
        id: "timing.wake_up",
        group: Group::Timing,
        matters: Matters::Moving,
        wanted: "every wake-up within 100 us; usable up to 300 us, a warning above, a failure \
            above 500 us",
        why: "The control thread starts late by this time, out of the 1 ms of a cycle.",
        source: "100 us: RMP requires 125 us at 1 kHz; the others: this project's, from the 1 ms \
            of a cycle",
    };
    let judge = |latencies| judge(&latencies, "wake-ups", [100, 300, 500]);
    about.finding(measured.map(judge), purpose)
}

/// Returns the finding about round trips of datagrams to another thread of this host
/// (`timing.loopback`).
pub(crate) fn loopback(measured: Result<Latencies, Unread>, purpose: Purpose) -> Finding {
    let about = About {
        id: "timing.loopback",
        group: Group::Timing,
        matters: Matters::Moving,
        wanted: "every echo within 200 us; usable up to 500 us, a warning above, a failure above \
            1 ms",
        why: "Time for sockets and thread wake-up is missing for the work of a cycle.",
        source: "200 us: two wake-ups of 100 us; 500 us: vendor: FCI documentation, from a state \
            to its command; 1 ms: the time of a cycle",
    };
    let judge = |latencies| judge(&latencies, "echoes of datagrams", [200, 500, 1000]);
    about.finding(measured.map(judge), purpose)
}

/// Judges `what` by the largest latency. The latency is good below the first of `limits_us`, usable
/// below the second, and a failure above the last.
fn judge(latencies: &Latencies, what: &str, limits_us: [u128; 3]) -> Judged {
    let quantile = |part| latencies.quantile(part).unwrap_or_default();
    let (Some(min), Some(max)) = (latencies.min(), latencies.max()) else {
        return Judged::unknown("unknown: nothing was measured");
    };
    let scheduling = match latencies.priority {
        Some(priority) => format!("SCHED_FIFO {priority}"),
        None => "normal scheduling".into(),
    };
    let read = format!(
        "{} {what} under {scheduling}: min {}, p50 {}, p99 {}, p99.9 {}, max {} us; {} of 100 us and more, {} of 200, {} of 500",
        latencies.count(),
        min.as_micros(),
        quantile(0.5),
        quantile(0.99),
        quantile(0.999),
        max.as_micros(),
        latencies.at_least(100),
        latencies.at_least(200),
        latencies.at_least(500),
    );
    let max = max.as_micros();
    let [good, usable, tolerable] = limits_us;
    if max > tolerable {
        Judged::failure(read)
    } else if max >= usable {
        Judged::warning(read)
    } else if max >= good {
        Judged::info(read)
    } else if latencies.priority.is_none() {
        Judged::info(format!(
            "{read}; not conclusive, since other programs may delay the thread"
        ))
    } else if latencies.count() < LATENCIES_MIN {
        Judged::info(format!("{read}; too few for a verdict"))
    } else {
        Judged::good(read)
    }
}

/// A state of a robot at rest: its `message_id`, and its time of arrival since a fixed moment.
pub type Received = (u64, Duration);

/// Returns the findings about the number of missing states and the regularity of arrivals. `states`
/// must be consecutive and in the order of arrival. This function performs no I/O.
pub fn arrivals(states: &[Received], purpose: Purpose) -> Vec<Finding> {
    let mut lost = 0;
    let mut longest = 0;
    let mut intervals: Vec<Duration> = Vec::with_capacity(states.len());
    for pair in states.windows(2) {
        let missing = pair[1].0.saturating_sub(pair[0].0).saturating_sub(1);
        lost += missing;
        longest = longest.max(missing);
        if missing == 0 {
            intervals.push(pair[1].1.saturating_sub(pair[0].1));
        }
    }
    intervals.sort_unstable();
    let sent = lost + states.len() as u64;
    let few = states.len() < STATES_MIN;
    let losses = match (lost, few) {
        _ if states.is_empty() => Judged::unknown("unknown: no states"),
        (0, true) => Judged::info(format!("0 of {sent} lost; too few for a verdict")),
        (0, false) => Judged::good(format!("0 of {sent} lost")),
        _ => {
            let read = format!("{lost} of {sent} lost, at most {longest} in a row");
            match longest > 20 || lost * 100 > sent {
                true => Judged::failure(read),
                false => Judged::warning(read),
            }
        }
    };
    let quantile = |part| quantile(&intervals, part).as_secs_f64() * 1e3;
    let punctuality = match intervals.last() {
        None => Judged::unknown("unknown: no consecutive states"),
        Some(max) => {
            let (p99, max) = (quantile(0.99), max.as_secs_f64() * 1e3);
            let read = format!("p50 {:.3}, p99 {p99:.3}, max {max:.3} ms", quantile(0.5));
            match p99 < 1.1 && max < 1.5 {
                true if few => Judged::info(format!("{read}; too few for a verdict")),
                true => Judged::good(read),
                false => Judged::warning(read),
            }
        }
    };
    let lost = About::robot(
        "robot.lost",
        "0 of 10000 lost; a failure above 20 in a row, or above 1 %",
        "The robot ends a motion after 20 missing packets in a row.",
        "vendor: FCI documentation, communication_constraints_violation; 1 %: this project's",
    );
    let interval = About::robot(
        "robot.interval",
        "p99 below 1.1 ms, max below 1.5 ms",
        "The round trip, the work of this computer and the robot's own step must fit into 1 ms.",
        "vendor: FCI documentation, network; thresholds: this project's",
    );
    vec![
        lost.finding(Ok(losses), purpose),
        interval.finding(Ok(punctuality), purpose),
    ]
}

/// Returns the finding `net.firewall`, which reports whether the states of a robot arrive after it
/// has opened a session. `states_arrive` is `None` without a session. This function performs no
/// I/O.
pub fn firewall(states_arrive: Option<bool>, purpose: Purpose) -> Finding {
    let about = About {
        id: "net.firewall",
        group: Group::NetworkCard,
        matters: Matters::Reading,
        wanted: "states of the robot arrive (UDP)",
        why: "The robot sends its states to a port that this computer chooses. A firewall may \
            block them.",
        source: "vendor: FCI documentation, troubleshooting: `UDP receive: Timeout` means a firewall",
    };
    let judged = match states_arrive {
        Some(true) => Judged::good("states arrive"),
        Some(false) => Judged::failure(
            "the robot opened a session, but its states do not arrive: `UDP receive: Timeout`",
        )
        .fix(Needs::Nothing, "sudo nft list ruleset || sudo iptables -L"),
        None => Judged::unknown("unknown: no session with a robot"),
    };
    about.finding(Ok(judged), purpose)
}

/// Returns the quantile `part`, in `[0, 1]`, of a sorted list. The quantile is the smallest element
/// that at least this share of the elements does not exceed.
///
/// # Panics
/// Panics if the list is empty.
pub(crate) fn quantile(sorted: &[Duration], part: f64) -> Duration {
    let wanted = (part * sorted.len() as f64).ceil().max(1.0) as usize;
    sorted[wanted - 1]
}

/// Smallest number of latencies for a conclusive result: ten seconds of latencies.
const LATENCIES_MIN: u64 = 10_000;

/// Smallest number of consecutive states for a conclusive result: ten seconds of states, minus a
/// few lost states.
const STATES_MIN: usize = 9_900;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Verdict;

    /// Returns `count` latencies: all are `us`, except for one of `worst`.
    fn measured(us: u64, count: usize, worst: u64) -> Latencies {
        let mut latencies = Latencies::new(Some(99));
        for _ in 1..count {
            latencies.note(Duration::from_micros(us));
        }
        latencies.note(Duration::from_micros(worst));
        latencies
    }

    #[test]
    fn timing_is_judged_by_worst_latency_if_long_enough() {
        for (count, worst, woken, echoed) in [
            (10_000, 99, Verdict::Good, Verdict::Good),
            (9_999, 99, Verdict::Info, Verdict::Info),
            (10_000, 100, Verdict::Info, Verdict::Good),
            (10_000, 299, Verdict::Info, Verdict::Info),
            (10_000, 300, Verdict::Warning, Verdict::Info),
            (10_000, 500, Verdict::Warning, Verdict::Warning),
            (10_000, 501, Verdict::Failure, Verdict::Warning),
            (10_000, 1000, Verdict::Failure, Verdict::Warning),
            (10_000, 1001, Verdict::Failure, Verdict::Failure),
            (10_000, 90_000, Verdict::Failure, Verdict::Failure),
        ] {
            for (check, expected) in [(wake_up as Check, woken), (loopback, echoed)] {
                let finding = check(Ok(measured(20, count, worst)), Purpose::Move);
                assert_eq!(finding.verdict, expected, "{}", finding.read);
                let sim = check(Ok(measured(20, count, worst)), Purpose::Sim);
                assert!(matches!(sim.verdict, Verdict::Good | Verdict::Info));
                let nothing = check(Ok(Latencies::new(None)), Purpose::Move);
                assert_eq!(nothing.verdict, Verdict::Unknown);
            }
        }
    }

    type Check = fn(Result<Latencies, Unread>, Purpose) -> Finding;

    #[test]
    fn quantiles_are_those_of_sorted_latencies() {
        let mut latencies = Latencies::new(None);
        for us in (1..=1000).rev() {
            latencies.note(Duration::from_micros(us));
        }
        latencies.note(Duration::from_millis(7));
        assert_eq!(latencies.quantile(0.5), Some(501));
        assert_eq!(latencies.quantile(0.99), Some(991));
        assert_eq!(latencies.quantile(1.0), Some(2000), "stands for more");
        assert_eq!(latencies.max(), Some(Duration::from_millis(7)));
        assert_eq!((latencies.at_least(1000), latencies.count()), (2, 1001));
    }

    /// Returns the verdicts on states with these numbers, at intervals of one millisecond.
    fn verdicts(numbers: impl Iterator<Item = u64>, late: u64) -> [Verdict; 2] {
        let at =
            |number| Duration::from_millis(number) + Duration::from_micros((number % 7) * late);
        let states: Vec<Received> = numbers.map(|number| (number, at(number))).collect();
        let findings = arrivals(&states, Purpose::Move);
        [findings[0].verdict, findings[1].verdict]
    }

    #[test]
    fn lost_states_and_irregular_ones_are_told_apart() {
        use Verdict::{Failure, Good, Info, Unknown, Warning};
        assert_eq!(verdicts(0..10_000, 10), [Good, Good]);
        assert_eq!(verdicts(0..100, 10), [Info, Info]);
        assert_eq!(verdicts(0..10_000, 200), [Good, Warning]);
        assert_eq!(
            verdicts((0..10_000).filter(|n| n % 500 != 3), 10),
            [Warning, Good]
        );
        assert_eq!(
            verdicts((0..10_000).filter(|n| n % 50 != 3), 10)[0],
            Failure
        );
        let gap = |n: &u64| !(100..121).contains(n);
        assert_eq!(verdicts((0..10_000).filter(gap), 10)[0], Failure);
        assert_eq!(verdicts(0..0, 10), [Unknown, Unknown]);
        for (arrive, expected) in [(Some(true), Good), (Some(false), Failure), (None, Unknown)] {
            assert_eq!(firewall(arrive, Purpose::Read).verdict, expected);
        }
    }
}
