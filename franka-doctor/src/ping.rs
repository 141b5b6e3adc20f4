//! The finding about round trips to the robot.

use core::time::Duration;

use crate::finding::{About, Finding, Judged, Purpose};
use crate::host::Unread;
use crate::round_trip::{PAYLOAD, RoundTrips};
use crate::timing::quantile;

/// Returns the finding about a measurement of round trips. This function performs no I/O.
pub(crate) fn ping(measured: Result<RoundTrips, Unread>, purpose: Purpose) -> Finding {
    let about = About::robot(
        "robot.ping",
        "p50 below 0.3 ms, p99 below 0.4 ms, max below 0.6 ms, none lost; a warning if p50 is \
         above 0.4 ms, a failure if p50 is above 0.8 ms or any is lost",
        "The round trip, the work of this computer and the robot's own step must fit into 1 ms.",
        "vendor: FCI documentation, network test with 1200 bytes each millisecond; libfranka issue 174: 0.3 to 0.4 ms at most",
    );
    about.finding(measured.map(judge), purpose)
}

fn judge(RoundTrips { sent, mut times }: RoundTrips) -> Judged {
    times.sort_unstable();
    let Some(&max) = times.last() else {
        return Judged::unknown(format!(
            "unknown: none of {sent} echo requests was answered: the computer does not exist, or \
             a firewall blocks them"
        ));
    };
    let (p50, p99) = (quantile(&times, 0.5), quantile(&times, 0.99));
    let lost = sent.saturating_sub(times.len() as u64);
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    let read = format!(
        "p50 {:.3}, p99 {:.3}, max {:.3} ms; {lost} of {sent} lost, of {PAYLOAD} bytes each",
        ms(p50),
        ms(p99),
        ms(max)
    );
    let us = Duration::from_micros;
    if lost > 0 || p50 > us(800) {
        Judged::failure(read)
    } else if p50 > us(400) {
        Judged::warning(read)
    } else if p50 >= us(300) || p99 >= us(400) || max >= us(600) {
        Judged::info(read)
    } else if sent < SENT_MIN {
        Judged::info(format!("{read}; too few for a verdict"))
    } else {
        Judged::good(read)
    }
}

/// Smallest number of requests for a conclusive result.
const SENT_MIN: u64 = 1000;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Verdict;

    /// Returns 1000 requests: 500 take `half` microseconds, 490 take `most`, and the rest take
    /// `worst`. Of the rest, `lost` have no answer.
    fn measured(half: u64, most: u64, worst: u64, lost: usize) -> RoundTrips {
        let us = [vec![worst; 10 - lost], vec![half; 500], vec![most; 490]].concat();
        RoundTrips {
            sent: 1000,
            times: us.into_iter().map(Duration::from_micros).collect(),
        }
    }

    #[test]
    fn ping_is_judged_by_median_and_losses_if_long_enough() {
        use Verdict::{Failure, Good, Info, Warning};
        for (round_trips, expected) in [
            // The vendor's example.
            (measured(147, 240, 502, 0), Good),
            (measured(299, 399, 599, 0), Good),
            (measured(300, 399, 599, 0), Info),
            (measured(299, 400, 599, 0), Info),
            // A healthy network, libfranka issue 123.
            (measured(115, 169, 3_754, 0), Info),
            (measured(401, 410, 502, 0), Warning),
            (measured(800, 810, 900, 0), Warning),
            (measured(830, 840, 900, 0), Failure),
            (measured(147, 240, 502, 1), Failure),
        ] {
            let finding = ping(Ok(round_trips), Purpose::Move);
            assert_eq!(finding.verdict, expected, "{}", finding.read);
        }
        let few = RoundTrips {
            sent: 999,
            times: vec![Duration::from_micros(150); 999],
        };
        assert_eq!(ping(Ok(few), Purpose::Move).verdict, Info);
        let text = ping(Ok(measured(147, 240, 502, 1)), Purpose::Read).read;
        let expected = "p50 0.147, p99 0.240, max 0.502 ms; 1 of 1000 lost, of 1200 bytes each";
        assert_eq!(text, expected);
    }

    #[test]
    fn silence_and_sockets_that_are_refused_are_unknown() {
        let silent = RoundTrips {
            sent: 20,
            times: Vec::new(),
        };
        let refused = Unread::Failed("echo requests".into(), "not allowed".into());
        for measured in [Ok(silent), Err(refused)] {
            let finding = ping(measured, Purpose::Move);
            assert_eq!(finding.verdict, Verdict::Unknown);
            assert!(finding.read.starts_with("unknown: "), "{}", finding.read);
        }
    }
}
