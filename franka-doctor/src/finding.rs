//! Result of a check, and its meaning for a purpose.

use core::fmt;

use crate::host::Unread;

/// Purpose of the host. It determines which findings are failures.
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

/// Meaning of a value for the purpose. [`Verdict::Unknown`] is neither good nor bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Verdict {
    /// The value is as expected.
    Good,
    /// The value is useful to know, and not an obstacle.
    Info,
    /// The value may cost cycles.
    Warning,
    /// The purpose cannot be achieved with this value.
    Failure,
    /// The value could not be read. The finding names the missing part.
    Unknown,
}

/// Part of the host or its surroundings to which a finding belongs. A report has one line for each
/// group.
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

/// Step after which a fix takes effect.
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
    /// Step after the command.
    pub needs: Needs,
}

/// The result of one check.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Finding {
    /// Stable name, such as `cpu.governor`.
    pub id: &'static str,
    /// Group to which the finding belongs.
    pub group: Group,
    /// Meaning of the value for the purpose.
    pub verdict: Verdict,
    /// The value; for [`Verdict::Unknown`], the missing part.
    pub read: String,
    /// Expected value, with thresholds.
    pub wanted: &'static str,
    /// Consequence of a different value.
    pub why: &'static str,
    /// Source of the threshold.
    pub source: &'static str,
    /// Command that fixes the value, if one exists.
    pub fix: Option<Fix>,
}

/// Result of a check's function. Its verdict is for a host that moves a robot.
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

    /// Adds a fix, unless the finding is good or unknown.
    pub(crate) fn fix(mut self, needs: Needs, command: impl Into<String>) -> Self {
        if !matches!(self.verdict, Verdict::Good | Verdict::Unknown) {
            let command = command.into();
            self.fix = Some(Fix { command, needs });
        }
        self
    }
}

/// Parts of a finding that do not depend on the value.
pub(crate) struct About {
    pub(crate) id: &'static str,
    pub(crate) group: Group,
    pub(crate) matters: Matters,
    pub(crate) wanted: &'static str,
    pub(crate) why: &'static str,
    pub(crate) source: &'static str,
}

impl About {
    /// Returns the parts of a finding about the robot. Such findings also matter for reading
    /// states.
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

    /// Returns the finding for this purpose. A value that cannot be read gives
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

/// The least demanding purpose for which a check matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Matters {
    /// The check warns and fails for moving. For reading, its verdicts are one level lower.
    Moving,
    /// The check warns and fails for moving and for reading.
    Reading,
}

/// Converts `verdict`, which applies to a host that moves a robot, to `purpose`.
fn for_purpose(verdict: Verdict, matters: Matters, purpose: Purpose) -> Verdict {
    match (purpose, matters, verdict) {
        (Purpose::Sim, _, Verdict::Warning | Verdict::Failure) => Verdict::Info,
        (Purpose::Read, Matters::Moving, Verdict::Warning) => Verdict::Info,
        (Purpose::Read, Matters::Moving, Verdict::Failure) => Verdict::Warning,
        _ => verdict,
    }
}
