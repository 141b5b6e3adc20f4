//! How goals end, as a session reports it to the lifecycle.

use core::time::Duration;

use super::{GoalId, PoseError, Reacted, Shortfall};
use crate::team::TeamStop;
use crate::together::StartFault;

/// What a session reports to the lifecycle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "made on the thread, where a box would allocate"
)]
#[non_exhaustive]
pub enum SessionEvent {
    /// A goal that was to finish has come to its end; the session releases the arm unless a newer
    /// goal comes.
    Settled {
        /// The goal.
        goal: GoalId,
        /// How it came to its end.
        settlement: Settlement,
        /// Time from the first cycle that saw the goal to the arrival, `[ms]` of the robot's clock.
        duration_ms: u64,
        /// What friction and bias are compensated by there, `[N m]`; `None` where the robot's
        /// controller turns setpoints into torques.
        compensation: Option<[f64; 7]>,
        /// The reaction that has led it to this end, if one has.
        reacted: Option<Reacted>,
    },
    /// The robot's state names an end effector that is not a rigid transformation, or a load that
    /// is not finite; the session ends without a torque.
    BadTool,
    /// The arm was let go and does not come to rest, so that the motion cannot finish: the robot
    /// has to be told to stop. The session answers states until it does, and takes no more goals.
    Restless,
}

/// How a goal came to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Settlement {
    /// At the target, within the tolerance, at rest and held there.
    Arrived(PoseError),
    /// At rest where it was braked; or its reference is, and the arm is moved from outside.
    AtRest,
    /// The reference reached the target, the arm did not: something holds it, or its load is not
    /// what was declared.
    TargetNotReached(Shortfall),
    /// Given up, and held: at the last target, or where it came to rest without its deadman.
    Held(Lapse),
    /// Given up, and braked: it is held where it came to rest.
    Braked(Lapse),
    /// At rest where it was held: its common start has failed.
    Unstarted(StartFault),
}

/// Why a goal was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Lapse {
    /// Its targets stopped coming: see [`Watchdog`](super::Watchdog).
    Silent {
        /// For how long none had come, by the robot's clock.
        silence: Duration,
    },
    /// The [`Deadman`](super::Deadman) that the session is bound to fell silent, or was dropped.
    Deadman,
    /// Something pushed the arm further from its path than it may swing back by itself:
    /// [`Deviation`](super::Deviation).
    Displaced,
    /// The way leads too near to the arm itself, or to a region to keep out of: see
    /// [`SELF_STOP`](super::SELF_STOP) and [`KEEP_OUT_STOP`](super::KEEP_OUT_STOP).
    Blocked {
        /// The region, from 1, in the order in which the session was given them; `None` for the arm
        /// itself.
        region: Option<usize>,
    },
    /// The joints have no way on to the target from where the arm came to rest: one is at the end
    /// of its range, or the arm is stretched.
    OutOfReach {
        /// The joint at the end of its range, from 1, if one is.
        joint: Option<usize>,
    },
    /// The team that it is a member of has stopped.
    Team(TeamStop),
    /// The arm was faster than the speed cap of its session.
    TooFast,
    /// The arm stood still under commands that should have moved it, and the robot reported no
    /// error: its brakes are closed, or its controller has stopped.
    Unresponsive,
}

impl Lapse {
    /// True if no update brings the goal back.
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
    /// Returns the name of its row in the book's chapter of errors, `errors.md`.
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
            Self::Silent { silence } => write!(f, "no target came for {} ms", silence.as_millis()),
            Self::Deadman => write!(f, "its deadman fell silent, or was dropped"),
            Self::Displaced => write!(f, "the arm was pushed too far from its path"),
            Self::Blocked { region: None } => write!(f, "the way leads too near to the arm itself"),
            Self::Blocked {
                region: Some(region),
            } => write!(
                f,
                "the way leads too near to region {region} to keep out of"
            ),
            Self::OutOfReach { joint: Some(joint) } => {
                write!(f, "joint {joint} came to the end of its range on the way")
            }
            Self::OutOfReach { joint: None } => {
                write!(f, "the joints have no way on to the target from there")
            }
            Self::Team(stop) => stop.fmt(f),
            Self::TooFast => write!(f, "the arm moved faster than its speed cap"),
            Self::Unresponsive => write!(
                f,
                "the arm ignored its commands: it stood still, and the robot reported no error"
            ),
        }
    }
}
