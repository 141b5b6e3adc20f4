//! Ends of goals, in the form in which a session reports them to the lifecycle.

use core::time::Duration;

use super::{GoalId, PoseError, Reacted, Shortfall};
use crate::team::TeamStop;
use crate::together::StartFault;

/// Report of a session to the lifecycle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "made on the thread, where a box would allocate"
)]
#[non_exhaustive]
pub enum SessionEvent {
    /// A goal has ended and must be reported. With [`OnArrival::ReportAndFinish`](super::OnArrival)
    /// the session then releases the arm, unless a newer goal arrives.
    Settled {
        /// The goal.
        goal: GoalId,
        /// Outcome of the goal.
        settlement: Settlement,
        /// Time from the first cycle that saw the goal to the goal's end, `[ms]` of the robot's
        /// clock.
        duration_ms: u64,
        /// Torques that compensate friction and bias at the end, `[N m]`; `None` if the robot's
        /// controller turns setpoints into torques.
        compensation: Option<[f64; 7]>,
        /// Greatest distance of the arm from the goal's straight line, `[m]`, if the goal has a
        /// line.
        line_deviation: Option<f64>,
        /// The reaction that caused this end, if any.
        reacted: Option<Reacted>,
    },
    /// The robot's state contains an end effector that is not a rigid transformation, or a load
    /// that is not finite. The session ends without sending a torque.
    BadTool,
    /// The arm was released and does not stop, so the motion cannot finish. The lifecycle must
    /// command the robot to stop. Until the robot stops, the session still answers states but
    /// accepts no more goals.
    Restless,
}

/// Outcome of a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Settlement {
    /// The arm is within the tolerance of the target, at rest, and held there.
    Arrived(PoseError),
    /// The arm rests where it braked, or only the reference rests and something outside moves the
    /// arm.
    AtRest,
    /// The reference reached the target but the arm did not, or does not stop there.
    /// Something holds or moves the arm, its load differs from the declared load, or its posture is
    /// nearly singular.
    TargetNotReached(Shortfall),
    /// The goal was given up. The arm is held at the last target, or, if the deadman failed, where
    /// it stopped.
    Held(Lapse),
    /// The goal was given up and the arm braked. The arm is held at the place where it stopped.
    Braked(Lapse),
    /// The common start failed, so the arm rests where it was held.
    Unstarted(StartFault),
}

/// Reason for giving up a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Lapse {
    /// The goal's targets stopped arriving: see [`Watchdog`](super::Watchdog).
    Silent {
        /// Time without a target, by the robot's clock.
        silence: Duration,
    },
    /// The [`Deadman`](super::Deadman) of the session fell silent or was dropped.
    Deadman,
    /// Something pushed the arm further from its path than [`Deviation`](super::Deviation) allows.
    /// From such a distance, the arm must not return automatically.
    Displaced,
    /// The path comes too near to the arm itself or to a keep-out region: see
    /// [`SELF_STOP`](super::SELF_STOP) and [`KEEP_OUT_STOP`](super::KEEP_OUT_STOP).
    Blocked {
        /// Number of the region, from 1, in the order in which the session received the regions.
        /// `None` for the arm itself.
        region: Option<usize>,
    },
    /// The joints cannot continue to the target from the place where the arm stopped: a joint is at
    /// the end of its range, or the arm is stretched.
    OutOfReach {
        /// The joint at the end of its range, from 1, if any.
        joint: Option<usize>,
    },
    /// The arm's team has stopped.
    Team(TeamStop),
    /// The arm moved faster than the speed cap of its session.
    TooFast,
    /// The arm stood still under commands that should have moved it, and the robot reported no
    /// error. Either its brakes are closed or its controller has stopped.
    Unresponsive,
}

impl Lapse {
    /// True if no later update can resume the goal.
    pub(super) fn is_final(self) -> bool {
        match self {
            Self::Silent { .. } => false,
            Self::Deadman
            | Self::Displaced
            | Self::Blocked { .. }
            | Self::OutOfReach { .. }
            | Self::Team(_)
            | Self::TooFast
            | Self::Unresponsive => true,
        }
    }
}

impl Lapse {
    /// Returns the name of this reason's row in the book's chapter of errors, `errors.md`.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::Silent { .. } => "lapse-silent",
            Self::Deadman => "lapse-deadman",
            Self::Displaced => "lapse-displaced",
            Self::Blocked { .. } => "lapse-blocked",
            Self::OutOfReach { .. } => "lapse-out-of-reach",
            Self::Team(_) => "lapse-team",
            Self::TooFast => "lapse-too-fast",
            Self::Unresponsive => "lapse-unresponsive",
        }
    }
}

impl core::fmt::Display for Lapse {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Silent { silence } => {
                write!(f, "no new target arrived for {} ms", silence.as_millis())
            }
            Self::Deadman => write!(
                f,
                "the deadman expired without a `keep_alive`, or was dropped"
            ),
            Self::Displaced => write!(f, "the arm was pushed too far from its path"),
            Self::Blocked { region: None } => {
                write!(f, "the path leads too close to the arm itself")
            }
            Self::Blocked {
                region: Some(region),
            } => write!(f, "the path leads too close to keep-out region {region}"),
            Self::OutOfReach { joint: Some(joint) } => {
                write!(f, "joint {joint} reached the end of its range on the path")
            }
            Self::OutOfReach { joint: None } => {
                write!(
                    f,
                    "the joints cannot reach the target from where the arm stopped"
                )
            }
            Self::Team(stop) => stop.fmt(f),
            Self::TooFast => write!(f, "the arm exceeded its speed cap"),
            Self::Unresponsive => write!(
                f,
                "the arm did not move although it received commands, and the robot reported no error"
            ),
        }
    }
}
