//! The result of a check, and what it means for a purpose.

use core::fmt;

use crate::host::Unread;

/// Purpose for which the host is used. It determines which findings are failures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Purpose {
    /// The host runs simulated robots.
    Sim,
    /// The host reads the states of a robot.
    Read,
    /// The host moves a robot.
    Move,
}

/// Meaning of a value for the purpose. [`Verdict::Unknown`] is neither good nor bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Verdict {
    /// The value is as expected.
    Good,
    /// The value is useful to know, but is not an obstacle.
    Info,
    /// With this value, some cycles can be lost.
    Warning,
    /// The host is unsuitable for the purpose with this value.
    Failure,
    /// The value could not be read. The finding states what is missing.
    Unknown,
}

/// Part of the host or its environment that a finding describes. A report contains one line for
/// each group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Group {
    /// Kernel, memory, power and virtual machines.
    Host,
    /// The control thread's rights in the kernel.
    Scheduling,
    /// Frequency, sleep states, load and interrupts.
    Processor,
    /// The route to the robot.
    NetworkCard,
    /// The services at the robot's address, and the state of the robot.
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

/// Step that is necessary before a fix takes effect.
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
    /// Step that must follow the command.
    pub needs: Needs,
}

/// The result of one check.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Finding {
    /// Stable name, such as `cpu.governor`.
    pub id: &'static str,
    /// The group that contains the finding.
    pub group: Group,
    /// Meaning of the value for the purpose.
    pub verdict: Verdict,
    /// The value. For [`Verdict::Unknown`], a description of what is missing.
    pub read: String,
    /// The expected value, with its thresholds.
    pub wanted: &'static str,
    /// Consequence if the value is not as expected.
    pub why: &'static str,
    /// Source of the threshold.
    pub source: &'static str,
    /// Command that corrects the value, if such a command exists.
    pub fix: Option<Fix>,
}

/// Result of a check's function. The verdict applies to a host that moves a robot.
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

    /// Adds a fix unless the finding is good or unknown.
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
    /// Returns the constant parts of a finding about the robot. Such a finding also matters for
    /// reading states.
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

    /// Returns the finding for `purpose`. If the value could not be read, the verdict is
    /// [`Verdict::Unknown`].
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

/// The purposes for which a check matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Matters {
    /// The check matters for moving. For reading, its verdicts are one level lower.
    Moving,
    /// The check matters equally for moving and for reading.
    Reading,
}

fn for_purpose(verdict: Verdict, matters: Matters, purpose: Purpose) -> Verdict {
    match (purpose, matters, verdict) {
        (Purpose::Sim, _, Verdict::Warning | Verdict::Failure) => Verdict::Info,
        (Purpose::Read, Matters::Moving, Verdict::Warning) => Verdict::Info,
        (Purpose::Read, Matters::Moving, Verdict::Failure) => Verdict::Warning,
        _ => verdict,
    }
}
