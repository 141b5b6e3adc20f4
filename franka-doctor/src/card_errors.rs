//! Error counts of the network card on the route to the robot.

use crate::finding::{About, Finding, Group, Judged, Matters, Purpose};
use crate::host::Unread;
use crate::readings::{NET, Readings};

/// The count for each of the statistics in [`NAMES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CardErrors([u64; NAMES.len()]);

impl CardErrors {
    /// Reads the counts since the network card was set up.
    pub(crate) fn read(readings: &Readings<'_>) -> Result<Self, Unread> {
        let card = readings.interface()?;
        let mut counts = [0; NAMES.len()];
        for (count, name) in counts.iter_mut().zip(NAMES) {
            *count = readings.number(&format!("{NET}/{card}/statistics/{name}"))?;
        }
        Ok(Self(counts))
    }

    /// Returns how much the counts have increased since `before`.
    fn since(self, before: Self) -> Self {
        let mut counts = self.0;
        for (count, before) in counts.iter_mut().zip(before.0) {
            *count = count.saturating_sub(before);
        }
        Self(counts)
    }

    pub(crate) fn judged(self) -> Judged {
        let seen = || NAMES.iter().zip(self.0).filter(|(_, count)| *count > 0);
        let texts: Vec<String> = seen()
            .map(|(name, count)| format!("{name} {count}"))
            .collect();
        // Packets of protocols without a listener also count as dropped.
        let bad = seen().any(|(name, _)| *name != "rx_dropped");
        match (texts.is_empty(), bad) {
            (true, _) => Judged::good("none"),
            (false, false) => Judged::info(texts.join(", ")),
            (false, true) => Judged::warning(texts.join(", ")),
        }
    }
}

/// Returns the finding about the counts before and after the measurements. This function performs
/// no I/O.
pub(crate) fn meanwhile(
    before: Result<CardErrors, Unread>,
    after: Result<CardErrors, Unread>,
    purpose: Purpose,
) -> Finding {
    let judged = before.and_then(|before| Ok(after?.since(before).judged()));
    let about = About {
        id: "nic.errors_now",
        group: Group::NetworkCard,
        matters: Matters::Reading,
        wanted: "none while wake-ups and round trips are measured",
        why: "Earlier errors may come from another cable; errors during the measurement do not.",
        source: "general knowledge of network cards",
    };
    about.finding(judged, purpose)
}

/// Names of the files with the card's statistics.
const NAMES: [&str; 5] = [
    "rx_errors",
    "rx_dropped",
    "rx_crc_errors",
    "rx_missed_errors",
    "collisions",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Verdict;

    #[test]
    fn only_what_came_meanwhile_counts() {
        let old = CardErrors([12, 3, 0, 0, 0]);
        for (after, verdict, read) in [
            (old, Verdict::Good, "none"),
            (CardErrors([12, 5, 0, 0, 0]), Verdict::Info, "rx_dropped 2"),
            (
                CardErrors([13, 3, 1, 0, 0]),
                Verdict::Warning,
                "rx_errors 1, rx_crc_errors 1",
            ),
            // The card was set up again between the two readings, so its counts start from zero.
            (CardErrors([0; 5]), Verdict::Good, "none"),
        ] {
            let finding = meanwhile(Ok(old), Ok(after), Purpose::Move);
            assert_eq!((finding.verdict, finding.read.as_str()), (verdict, read));
        }
        let absent = Err(Unread::Absent("statistics".into()));
        let finding = meanwhile(Ok(old), absent, Purpose::Move);
        assert_eq!(finding.verdict, Verdict::Unknown);
    }
}
