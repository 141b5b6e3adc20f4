//! The most likely causes, on this host, of packets that did not arrive in time.

use crate::checks::{Check, all};
use crate::finding::{Finding, Purpose, Verdict};
use crate::readings::Readings;

/// Observation when a motion ended because of missing packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// States stopped arriving.
    LinkLost,
    /// States or commands were lost, or the robot's success rate was low.
    Lost,
    /// This computer answered too late.
    Late,
}

impl Evidence {
    /// Returns the ids of the checks that can explain this observation, the most likely cause
    /// first.
    fn suspects(self) -> &'static [&'static str] {
        match self {
            Self::LinkLost => &[
                "nic.link",
                "nic.two_robots",
                "nic.kind",
                "nic.route",
                "nic.eee",
                "nic.power",
                "nic.errors",
                "nic.driver",
            ],
            Self::Lost => &[
                "nic.kind",
                "nic.errors",
                "nic.coalesce",
                "nic.link",
                "kernel.rt",
                "rt.limit",
                "nic.route",
                "nic.eee",
                "nic.power",
                "virt",
                "cpu.cstates",
                "cpu.governor",
                "cpu.load",
                "power",
            ],
            Self::Late => &[
                "kernel.rt",
                "rt.limit",
                "rt.throttle",
                "rt.cgroup",
                "virt",
                "cpu.load",
                "cpu.cstates",
                "cpu.governor",
                "cpu.epp",
                "irq.balance",
                "mem.swap",
                "mem.thp",
                "power",
            ],
        }
    }
}

/// Returns the two most likely causes on this host, or fewer if the checks find fewer. Failures
/// come before warnings, and causes of the same verdict are sorted by likelihood. This function
/// only reads files and queries the driver of the network card.
pub fn likely_causes(readings: &Readings<'_>, evidence: Evidence) -> Vec<Finding> {
    let named = |id: &&str| all().find(|check| check.id == *id && check.reads_only);
    let suspects = evidence.suspects().iter().filter_map(named);
    let found: Vec<Finding> = suspects
        .map(|check: &Check| check.run(readings, Purpose::Move))
        .collect();
    let of = |verdict| {
        found
            .iter()
            .filter(move |finding| finding.verdict == verdict)
    };
    of(Verdict::Failure)
        .chain(of(Verdict::Warning))
        .take(2)
        .cloned()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_suspect_is_a_check_that_only_reads() {
        for evidence in [Evidence::LinkLost, Evidence::Lost, Evidence::Late] {
            for id in evidence.suspects() {
                let check = all().find(|check| check.id == *id);
                assert!(check.is_some_and(|check| check.reads_only), "{id}");
            }
        }
    }
}
