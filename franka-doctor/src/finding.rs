//! The result of a check, and its meaning for a purpose.

use core::fmt;

use crate::host::Unread;

/// The purpose of the host. It determines which findings are failures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Purpose {
    /// Run simulated robots.
    Sim,
    /// Read states of a robot.
    Read,
    /// Move a robot.
    Move,
}

/// The meaning of a finding. [`Verdict::Unknown`] is neither good nor bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Verdict {
    /// The value is as expected.
    Good,
    /// Useful to know, not an obstacle.
    Info,
    /// May cost cycles.
    Warning,
    /// The purpose cannot be achieved with this value.
    Failure,
    /// The value could not be read; the finding names the missing part.
    Unknown,
}

/// The part of the host that a finding is about. Each has its own line in a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Group {
    /// Kernel, memory, power, virtual machines.
    Host,
    /// The control thread's rights in the kernel.
    Scheduling,
    /// Frequency, sleep states, load, interrupts.
    Processor,
    /// The route to the robot.
    NetworkCard,
    /// The services at the robot's address.
    Robot,
    /// The punctuality of the host.
    Timing,
}

impl Group {
    /// Every group, in the order of reports.
    pub const ALL: [Self; 6] = [
        Self::Host,
        Self::Scheduling,
        Self::Processor,
        Self::NetworkCard,
        Self::Robot,
        Self::Timing,
    ];
}

impl fmt::Display for Group {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Host => "Host",
            Self::Scheduling => "Scheduling",
            Self::Processor => "Processor",
            Self::NetworkCard => "Network card",
            Self::Robot => "Robot",
            Self::Timing => "Timing",
        })
    }
}

/// The step that makes a fix effective.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Needs {
    /// No further step.
    Nothing,
    /// A new login.
    Login,
    /// A restart of the computer.
    Reboot,
}

/// A shell command that changes the value.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Fix {
    /// The command, on one line.
    pub command: String,
    /// The step after it.
    pub needs: Needs,
}

/// The result of one check.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Finding {
    /// Stable name, such as `cpu.governor`.
    pub id: &'static str,
    /// The part of the host.
    pub group: Group,
    /// The meaning for the purpose.
    pub verdict: Verdict,
    /// The value; if unknown, the missing part.
    pub read: String,
    /// The expected value, with thresholds.
    pub wanted: &'static str,
    /// The consequence of another value.
    pub why: &'static str,
    /// The source of the threshold.
    pub source: &'static str,
    /// A fix, if one exists.
    pub fix: Option<Fix>,
}

/// The result of a check's function: the verdict for a host that moves a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Judged {
    pub(crate) verdict: Verdict,
    pub(crate) read: String,
    pub(crate) fix: Option<Fix>,
}

impl Judged {
    pub(crate) fn new(verdict: Verdict, read: impl Into<String>) -> Self {
        Self {
            verdict,
            read: read.into(),
            fix: None,
        }
    }

    pub(crate) fn good(read: impl Into<String>) -> Self {
        Self::new(Verdict::Good, read)
    }

    pub(crate) fn info(read: impl Into<String>) -> Self {
        Self::new(Verdict::Info, read)
    }

    pub(crate) fn warning(read: impl Into<String>) -> Self {
        Self::new(Verdict::Warning, read)
    }

    pub(crate) fn failure(read: impl Into<String>) -> Self {
        Self::new(Verdict::Failure, read)
    }

    pub(crate) fn unknown(read: impl Into<String>) -> Self {
        Self::new(Verdict::Unknown, read)
    }

    /// Adds a command, unless the finding is good or unknown.
    pub(crate) fn fix(mut self, needs: Needs, command: impl Into<String>) -> Self {
        if !matches!(self.verdict, Verdict::Good | Verdict::Unknown) {
            let command = command.into();
            self.fix = Some(Fix { command, needs });
        }
        self
    }
}

/// The parts of a finding that do not depend on the value.
pub(crate) struct About {
    pub(crate) id: &'static str,
    pub(crate) group: Group,
    pub(crate) matters: Matters,
    pub(crate) wanted: &'static str,
    pub(crate) why: &'static str,
    pub(crate) source: &'static str,
}

impl About {
    /// Returns the parts for a finding on the robot, which also matters for reading its states.
    pub(crate) fn robot(
        id: &'static str,
        wanted: &'static str,
        why: &'static str,
        source: &'static str,
    ) -> Self {
        Self {
            id,
            group: Group::Robot,
            matters: Matters::Reading,
            wanted,
            why,
            source,
        }
    }

    /// Returns the finding for this purpose. An unreadable value is unknown.
    pub(crate) fn finding(self, judged: Result<Judged, Unread>, purpose: Purpose) -> Finding {
        let judged = judged.unwrap_or_else(|unread| Judged::unknown(format!("unknown: {unread}")));
        Finding {
            id: self.id,
            group: self.group,
            verdict: for_purpose(judged.verdict, self.matters, purpose),
            read: judged.read,
            wanted: self.wanted,
            why: self.why,
            source: self.source,
            fix: judged.fix,
        }
    }
}

/// The least demanding purpose that a check applies to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Matters {
    /// Warns and fails for moving; one level less for reading.
    Moving,
    /// Warns and fails for moving and reading.
    Reading,
}

/// Converts `verdict`, which is for a host that moves a robot, to `purpose`.
fn for_purpose(verdict: Verdict, matters: Matters, purpose: Purpose) -> Verdict {
    match (purpose, matters, verdict) {
        (Purpose::Sim, _, Verdict::Warning | Verdict::Failure) => Verdict::Info,
        (Purpose::Read, Matters::Moving, Verdict::Warning) => Verdict::Info,
        (Purpose::Read, Matters::Moving, Verdict::Failure) => Verdict::Warning,
        _ => verdict,
    }
}
