//! The checks, in one table per group. Each check is a function of the readings.

mod card;
mod host;
mod kernel;
mod network;
mod processor;
mod scheduling;

use crate::finding::{About, Finding, Group, Judged, Matters, Purpose};
use crate::host::Unread;
use crate::readings::Readings;

pub(crate) struct Check {
    pub(crate) id: &'static str,
    pub(crate) group: Group,
    pub(crate) matters: Matters,
    pub(crate) wanted: &'static str,
    pub(crate) why: &'static str,
    pub(crate) source: &'static str,
    /// True if the check only reads files and queries drivers, and starts no thread.
    pub(crate) reads_only: bool,
    /// True if the check examines the network card on the route to the robot.
    pub(crate) of_card: bool,
    pub(crate) judge: fn(&Readings<'_>) -> Result<Judged, Unread>,
}

impl Check {
    /// Returns the finding of this check. If a value cannot be read, the verdict is
    /// [`Verdict::Unknown`].
    pub(crate) fn run(&self, readings: &Readings<'_>, purpose: Purpose) -> Finding {
        let about = About {
            id: self.id,
            group: self.group,
            matters: self.matters,
            wanted: self.wanted,
            why: self.why,
            source: self.source,
        };
        let no_card = self.of_card && readings.interface().is_ok_and(|name| name == "lo");
        let judged = match no_card {
            true => Ok(Judged::info("the robot is on this computer: no card")),
            false => (self.judge)(readings),
        };
        about.finding(judged, purpose)
    }
}

/// Returns every check of the host and the network card, in the order of reports.
pub(crate) fn all() -> impl Iterator<Item = &'static Check> {
    [
        host::CHECKS,
        scheduling::CHECKS,
        processor::CHECKS,
        network::CHECKS,
        card::CHECKS,
    ]
    .into_iter()
    .flatten()
}

const VENDOR: &str = "vendor: FCI documentation, real-time kernel set-up";
