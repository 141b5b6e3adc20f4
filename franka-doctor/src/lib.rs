//! Checks a host, its network card and its route to the robot, before an arm moves. The checks
//! change nothing on the host.
//!
//! ```text
//! Host (files, a few calls) --> Readings --> checks, one function each --> Finding --> Report (text, JSON, script)
//! ```
//!
//! * [`Doctor`]: runs all checks for a [`Purpose`].
//! * [`Host`]: the interface to a host. [`System`] is the running host. [`Tree`] contains the files
//!   of any host as one text, for tests.
//! * [`Finding`]: a value, the expected value with its reason and source, and a command that
//!   corrects the value. For a value that cannot be read, the verdict is [`Verdict::Unknown`],
//!   which is neither good nor bad.
//! * [`likely_causes`]: the most likely causes on this host, after a motion ended because of
//!   missing packets.
//! * [`firewall`], [`arrivals`] and [`at_rest`]: findings from the states of a connected robot.
//!   [`ports`]: the services at the robot's address. [`answers`] and [`handshake`]: the robot's
//!   version and availability.
//! * [`dry_run`]: findings about a control loop with a simulated robot.
//!
//! ```
//! use franka_doctor::{Doctor, Purpose, System, Verdict};
//!
//! let report = Doctor::new(Purpose::Sim).run(&System::default(), &mut |_, _| ());
//! print!("{}", report.to_text(false));
//! assert_eq!(report.exit_code(), 0, "any host can run simulated robots");
//! assert!(report.count(Verdict::Good) > 0);
//! ```
//!
//! With the feature `desk`, [`ask_desk`] and [`web`] read the robot's web interface without a
//! login. This feature requires an HTTPS client, so the diagnosis of a motion does not use it.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod at_rest;
mod card_errors;
mod causes;
mod checks;
#[cfg(feature = "desk")]
mod desk;
mod dry_run;
mod finding;
mod handshake;
mod host;
mod latencies;
#[cfg(all(target_os = "linux", not(franka_portable)))]
mod lease;
mod loopback;
mod ping;
mod ports;
mod readings;
mod redaction;
mod report;
mod round_trip;
mod route;
mod selection;
mod system;
mod timing;

use core::time::Duration;
use std::net::Ipv4Addr;

use card_errors::CardErrors;

pub use at_rest::at_rest;
pub use causes::{Evidence, likely_causes};
#[cfg(feature = "desk")]
pub use desk::{DeskState, SelfTest, ask_desk, web};
pub use dry_run::{DryRun, dry_run};
pub use finding::{Finding, Fix, Group, Needs, Purpose, Verdict};
pub use handshake::{Answer, answers, handshake};
pub use host::{Ethtool, Host, Tree, Unread};
pub use latencies::Latencies;
pub use ports::ports;
pub use readings::Readings;
pub use report::{Report, SCHEMA};
pub use round_trip::RoundTrips;
pub use selection::Selection;
pub use system::System;
pub use timing::{Received, arrivals, firewall};

// Compiles the program in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The checks for one purpose.
#[derive(Clone, Debug)]
pub struct Doctor {
    purpose: Purpose,
    robot: Option<Ipv4Addr>,
    cpu: Option<usize>,
    long: bool,
    timing: bool,
    ping: bool,
    redact: bool,
    selection: Selection,
}

impl Doctor {
    /// Creates the checks for `purpose`. By default, the robot's address is not set, and the report
    /// replaces personal and device names. Wake-ups and loopback are measured for 10 s each, unless
    /// the purpose is only simulation.
    pub fn new(purpose: Purpose) -> Self {
        Self {
            purpose,
            robot: None,
            cpu: None,
            long: false,
            timing: purpose != Purpose::Sim,
            ping: false,
            redact: true,
            selection: Selection::default(),
        }
    }

    /// Sets the address of the robot. The checks use it to find the network card on the route to
    /// the robot, but do not contact the robot. To contact the robot, use [`Self::ping`], [`ports`]
    /// and [`answers`].
    pub fn robot(mut self, address: Ipv4Addr) -> Self {
        self.robot = Some(address);
        self
    }

    /// Sets the processor on which the control thread will run.
    pub fn cpu(mut self, cpu: usize) -> Self {
        self.cpu = Some(cpu);
        self
    }

    /// Selects long measurements. Wake-ups and loopback then take 60 s each instead of 10 s. The
    /// number of round trips is 10 000 instead of 1000.
    pub fn long(mut self, long: bool) -> Self {
        self.long = long;
        self
    }

    /// Enables the measurements: wake-ups, loopback, one second of load on a processor, and (with
    /// [`Self::ping`]) round trips. All other checks take no noticeable time.
    pub fn timing(mut self, timing: bool) -> Self {
        self.timing = timing;
        self
    }

    /// Enables the measurement of round trips to the robot, which sends an echo request of 1200
    /// bytes per millisecond. The requests can delay the packets of a client that controls the
    /// robot.
    pub fn ping(mut self, ping: bool) -> Self {
        self.ping = ping;
        self
    }

    /// Sets whether the report replaces personal names, hardware addresses, UUIDs and serial
    /// numbers.
    pub fn redact(mut self, redact: bool) -> Self {
        self.redact = redact;
        self
    }

    /// Selects the checks to run. By default, all checks run. Measurements that only skipped checks
    /// need are skipped, too.
    pub fn select(mut self, selection: Selection) -> Self {
        self.selection = selection;
        self
    }

    /// Runs the checks on `host`. During a measurement, the function calls `progress` with the name
    /// of the measurement and the completed share, in `[0, 1]`.
    pub fn run(&self, host: &dyn Host, progress: &mut dyn FnMut(&str, f64)) -> Report {
        let readings = Readings::new(host, self.robot)
            .pinned(self.cpu)
            .loading(self.timing);
        let mut findings: Vec<Finding> = checks::all()
            .filter(|check| self.selection.takes(check.id))
            .map(|check| check.run(&readings, self.purpose))
            .collect();
        if self.timing {
            findings.extend(self.measured(host, &readings, progress));
        }
        let mut report = Report {
            schema: SCHEMA,
            purpose: self.purpose,
            findings: Vec::new(),
            readings: readings.raw(),
        };
        report.add(findings);
        if self.redact {
            self.redacted(host, report)
        } else {
            report
        }
    }

    fn measured(
        &self,
        host: &dyn Host,
        readings: &Readings<'_>,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Vec<Finding> {
        let mut findings = Vec::new();
        let before = CardErrors::read(readings);
        let duration = Duration::from_secs(if self.long { 60 } else { 10 });
        if self.selection.takes("timing.wake_up") {
            let measured = host.wake_ups(duration, &mut |part| progress("timing.wake_up", part));
            note(readings, "wake-ups, us: count", &measured);
            findings.push(timing::wake_up(measured, self.purpose));
        }
        if self.selection.takes("timing.loopback") {
            let measured = host.loopback(duration, &mut |part| progress("timing.loopback", part));
            note(readings, "loopback, us: count", &measured);
            findings.push(timing::loopback(measured, self.purpose));
        }
        let robot = self.robot.filter(|_| self.ping);
        if let Some(robot) = robot.filter(|_| self.selection.takes("robot.ping")) {
            let count = if self.long { 10_000 } else { 1000 };
            let mut shown = |part| progress("robot.ping", part);
            let measured = host.round_trips(robot, count, &mut shown);
            findings.push(ping::ping(measured, self.purpose));
        }
        // No card transmits packets from this computer to itself.
        let has_card = readings.interface().is_ok_and(|name| name != "lo");
        if has_card && self.selection.takes("nic.errors_now") {
            let after = CardErrors::read(readings);
            findings.push(card_errors::meanwhile(before, after, self.purpose));
        }
        findings
    }

    /// Returns `report` without the names that identify people or devices of `host`.
    fn redacted(&self, host: &dyn Host, mut report: Report) -> Report {
        let passwd = host.read("/etc/passwd").unwrap_or_default();
        let redaction = redaction::Redaction::new(&passwd);
        for finding in &mut report.findings {
            finding.read = redaction.apply(&finding.read);
        }
        for text in report.readings.values_mut() {
            *text = redaction.apply(text);
        }
        report
    }
}

fn note(readings: &Readings<'_>, what: &str, measured: &Result<Latencies, Unread>) {
    if let Ok(latencies) = measured {
        let bucket = |(us, count)| format!("{us}: {count}");
        let buckets: Vec<String> = latencies.buckets().map(bucket).collect();
        readings.note(what, buckets.join(", "));
    }
}
