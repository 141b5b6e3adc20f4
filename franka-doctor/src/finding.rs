//! What a check found, and what it means for a purpose.

use core::fmt;

use crate::host::Unread;

/// What the host is to do. Decides which findings are failures.
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

/// What a finding means. [`Verdict::Unknown`] is neither good nor bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Verdict {
    /// As wanted.
    Good,
    /// Worth knowing, no obstacle.
    Info,
    /// May cost cycles.
    Warning,
    /// The purpose is not reached with this.
    Failure,
    /// Could not be read; the finding says what is missing.
    Unknown,
}

/// The part of the host that a finding is about. Reports have a line for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Group {
    /// Kernel, memory, power, virtual machines.
    Host,
    /// What the control thread may ask of the kernel.
    Scheduling,
    /// Frequency, sleep states, load, interrupts.
    Processor,
    /// The way to the robot.
    NetworkCard,
    /// What answers at the robot's address.
    Robot,
    /// How punctual the host is.
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

/// What has to follow a fix for it to take effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Needs {
    /// Nothing.
    Nothing,
    /// A new login.
    Login,
    /// A restart of the computer.
    Reboot,
}

/// A command for a shell that changes what was found.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Fix {
    /// One line.
    pub command: String,
    /// What has to follow it.
    pub needs: Needs,
}

/// What one check found.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Finding {
    /// Stable name, such as `cpu.governor`.
    pub id: &'static str,
    /// The part of the host.
    pub group: Group,
    /// What it means for the purpose.
    pub verdict: Verdict,
    /// What was read; of an unknown one, what is missing.
    pub read: String,
    /// What is wanted, thresholds included.
    pub wanted: &'static str,
    /// What goes wrong otherwise.
    pub why: &'static str,
    /// Where the threshold comes from.
    pub source: &'static str,
    /// What to do about it.
    pub fix: Option<Fix>,
}

/// What the function of a check returns: the verdict for a host that is to move a robot.
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

/// The parts of a finding that do not depend on what was read.
pub(crate) struct About {
    pub(crate) id: &'static str,
    pub(crate) group: Group,
    pub(crate) matters: Matters,
    pub(crate) wanted: &'static str,
    pub(crate) why: &'static str,
    pub(crate) source: &'static str,
}

impl About {
    /// Of a finding on the robot, which matters for reading its states, too.
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

    /// The finding for this purpose. What could not be read is unknown.
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

/// The least purpose that a check decides about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Matters {
    /// Warns and fails for moving; for reading one step less.
    Moving,
    /// Warns and fails for moving and reading.
    Reading,
}

/// What `verdict`, for a host that is to move a robot, is for `purpose`.
fn for_purpose(verdict: Verdict, matters: Matters, purpose: Purpose) -> Verdict {
    match (purpose, matters, verdict) {
        (Purpose::Sim, _, Verdict::Warning | Verdict::Failure) => Verdict::Info,
        (Purpose::Read, Matters::Moving, Verdict::Warning) => Verdict::Info,
        (Purpose::Read, Matters::Moving, Verdict::Failure) => Verdict::Warning,
        _ => verdict,
    }
}
