//! Checks of this computer. If a motion ended because packets were missing, these checks find the
//! likely causes on this computer.
//!
//! ```no_run
//! # use franka_async::{Robot, doctor};
//! # async fn run(robot: Robot) {
//! if let Err(error) = robot.move_joints([0.0; 7]).await
//!     && let Some(diagnosis) = doctor::diagnose(&error, robot.address().ip()).await
//! {
//!     println!("{diagnosis}");
//! }
//! # }
//! ```
//!
//! With this feature, a `tracing` warning also reports such an end, and lists the causes in its
//! field `causes`.

use std::fmt;
use std::net::{IpAddr, Ipv4Addr};

use franka_proto::{Errors, RobotError};
use franka_rt::lifecycle::MotionError;

use crate::diagnosis::{Diagnose, Diagnosis};
use crate::world;

pub use franka_doctor::{
    Answer, Doctor, DryRun, Ethtool, Evidence, Finding, Fix, Group, Host, Latencies, Needs,
    Purpose, Readings, Received, Report, RoundTrips, Selection, System, Tree, Unread, Verdict,
    answers, arrivals, at_rest, dry_run, firewall, handshake, likely_causes, ports,
};
#[cfg(feature = "doctor-desk")]
pub use franka_doctor::{DeskState, SelfTest, ask_desk, web};

/// Explains why a motion ended because packets were missing.
///
/// `Display` prints the diagnosis from the log, if there is one, and one line for each cause on
/// this host.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct HostDiagnosis {
    /// Evidence from the motion that packets were missing.
    pub evidence: Evidence,
    /// Diagnosis from the log of the motion, if the robot stopped itself.
    pub diagnosis: Option<Diagnosis>,
    /// The two likeliest causes on this host, or fewer if fewer are found.
    pub causes: Vec<Finding>,
}

impl fmt::Display for HostDiagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(diagnosis) = &self.diagnosis {
            writeln!(f, "{diagnosis}")?;
        }
        if self.causes.is_empty() {
            return write!(f, "on this computer: no likely cause found");
        }
        for (index, cause) in self.causes.iter().enumerate() {
            let lead = match index {
                0 => "likely on this computer:",
                _ => "\nor:",
            };
            write!(
                f,
                "{lead} {}: {}; expected: {}",
                cause.id, cause.read, cause.wanted
            )?;
            if let Some(fix) = &cause.fix {
                write!(f, "; to change it: {}", fix.command)?;
            }
        }
        Ok(())
    }
}

/// Explains why packets were missing in a motion of the robot at this address, with the two
/// likeliest causes on this host. Returns `None` if the motion ended for any other reason.
///
/// The checks read files and query the driver of the network card, on a thread for blocking work.
/// They take some milliseconds.
///
/// # Panics
/// Panics outside of a Tokio runtime.
///
/// # Cancel safety
/// Dropping the future discards the answer and changes nothing.
pub async fn diagnose(error: &MotionError, robot: IpAddr) -> Option<HostDiagnosis> {
    let evidence = evidence(error)?;
    let error = error.clone();
    let looked = world::spawn_blocking(move || HostDiagnosis {
        evidence,
        diagnosis: diagnosis(&error),
        causes: causes(&System::default(), robot, evidence),
    });
    looked.await.ok()
}

/// Emits a `tracing` warning with the two likeliest causes on this host, if packets were missing in
/// a motion of the robot at this address. The warning comes some milliseconds later, and only if a
/// subscriber is interested in warnings.
pub(crate) fn warn(error: &MotionError, robot: IpAddr) {
    let Some(evidence) = evidence(error).filter(|_| tracing::enabled!(tracing::Level::WARN)) else {
        return;
    };
    let span = tracing::Span::current();
    let look = move || {
        let found = HostDiagnosis {
            evidence,
            diagnosis: None,
            causes: causes(&System::default(), robot, evidence),
        };
        span.in_scope(|| {
            tracing::warn!(causes = %found, "the motion ended because packets were \
            missing or late")
        });
    };
    // Without a runtime, there are no threads for blocking work.
    if world::has_runtime() {
        world::spawn_blocking(look);
    }
}

fn causes(host: &dyn Host, robot: IpAddr, evidence: Evidence) -> Vec<Finding> {
    let robot: Option<Ipv4Addr> = match robot {
        IpAddr::V4(address) => Some(address),
        IpAddr::V6(address) => address.to_ipv4_mapped(),
    };
    likely_causes(&Readings::new(host, robot), evidence)
}

#[expect(
    clippy::disallowed_methods,
    reason = "this is a thread for blocking work, and no task"
)]
fn diagnosis(error: &MotionError) -> Option<Diagnosis> {
    error.diagnose()
}

/// Returns the evidence in an error that packets did not come in time; `None` without evidence.
fn evidence(error: &MotionError) -> Option<Evidence> {
    match error {
        MotionError::LinkLost { .. } => Some(Evidence::LinkLost),
        MotionError::AfterReaction { error, .. } => evidence(error),
        MotionError::Control(error) => {
            let errors = error.errors.union(error.failure.reflex_reason);
            of_errors(errors, error.statistics.overruns)
        }
        _ => None,
    }
}

/// Returns the evidence in the robot's errors, after a motion in which `overruns` commands were
/// sent too late.
fn of_errors(errors: Errors, overruns: u64) -> Option<Evidence> {
    if !errors.contains(RobotError::CommunicationConstraintsViolation) {
        return None;
    }
    Some(match overruns {
        0 => Evidence::Lost,
        _ => Evidence::Late,
    })
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    const LINK_LOST: MotionError = MotionError::LinkLost {
        silence: Duration::from_secs(1),
    };

    #[test]
    fn only_motions_that_end_for_want_of_packets_have_evidence() {
        assert_eq!(evidence(&LINK_LOST), Some(Evidence::LinkLost));
        assert_eq!(evidence(&MotionError::Stopped), None);
        let starved = Errors::from(RobotError::CommunicationConstraintsViolation);
        assert_eq!(of_errors(starved, 0), Some(Evidence::Lost));
        assert_eq!(of_errors(starved, 3), Some(Evidence::Late));
        assert_eq!(of_errors(RobotError::CartesianReflex.into(), 3), None);
    }

    #[test]
    fn the_text_names_the_causes_of_a_host_with_a_slow_card() {
        let fixture = include_str!("../../franka-doctor/tests/fixtures/usb_card.txt");
        let robot = Ipv4Addr::new(172, 16, 0, 2);
        let found = HostDiagnosis {
            evidence: Evidence::Lost,
            diagnosis: None,
            causes: causes(&Tree::new(fixture), robot.into(), Evidence::Lost),
        };
        let text = found.to_string();
        let [first, second] = text.lines().collect::<Vec<_>>()[..] else {
            panic!("two causes: {text}")
        };
        assert!(
            first.starts_with("likely on this computer: nic.coalesce: 15000 us"),
            "{text}"
        );
        assert!(first.ends_with("rx-usecs 0 rx-frames 1"), "{text}");
        assert!(second.starts_with("or: nic.kind: "), "{text}");
        let nothing = HostDiagnosis {
            causes: Vec::new(),
            ..found
        };
        let expected = "on this computer: no likely cause found";
        assert_eq!(nothing.to_string(), expected);
    }

    #[tokio::test]
    async fn a_lost_link_is_diagnosed_on_this_host() {
        let robot = IpAddr::from(Ipv4Addr::LOCALHOST);
        let found = diagnose(&LINK_LOST, robot).await.expect("a lost link");
        assert_eq!(
            (found.evidence, found.diagnosis.as_ref()),
            (Evidence::LinkLost, None)
        );
        // Packets to this computer itself do not pass a network card.
        assert_eq!(found.causes, []);
        assert_eq!(diagnose(&MotionError::Busy, robot).await, None);
    }
}
