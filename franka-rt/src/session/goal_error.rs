//! Reasons for refusing a goal.

use core::time::Duration;

use crate::law::GainError;
use crate::session::condition::ConditionError;
use crate::session::{Backend, Budget, Chunk, Goal};

/// Reason for refusing a goal. Nothing has moved.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GoalError {
    /// The target contains a number that is not finite.
    #[error("got a number that is not finite in the target's {what}")]
    NotFinite {
        /// The part of the target that contains the number.
        what: &'static str,
    },
    /// The stream of targets ended before its first target.
    #[error("the stream of targets ended before its first target")]
    NoTarget,
    /// Commands for an external controller contained no torques. An external controller needs them.
    #[error(
        "got commands without torques, expected torques too for an external controller: use \
         `with_torques`"
    )]
    NoTorques,
    /// The target moves, so the motion cannot wait for an arrival.
    #[error(
        "got a target with a velocity, expected a target at rest, where the motion can end: use \
         `set` or `follow` for moving targets"
    )]
    Moves,
    /// A joint position is outside the joint's range.
    #[error(
        "the target of joint {joint} is {got} rad, expected between {lower:.4} and {upper:.4} rad{}",
        degrees(*.got)
    )]
    OutOfRange {
        /// The joint, from 1.
        joint: usize,
        /// The requested position, `[rad]`.
        got: f64,
        /// Lower end of the range, `[rad]`.
        lower: f64,
        /// Upper end of the range, `[rad]`.
        upper: f64,
    },
    /// No joint positions inside the joints' ranges reach the position.
    #[error("the pose at {} is out of reach: no joint positions within their ranges reach \
        this position and orientation", place([*x, *y, *z]))]
    Unreachable {
        /// Coordinate x of the requested position, base frame, `[m]`.
        x: f64,
        /// Coordinate y of the requested position.
        y: f64,
        /// Coordinate z of the requested position.
        z: f64,
    },
    /// The arm can reach the pose, but not on a straight line from its present place. On the way,
    /// some joint reaches the end of its range, with every posture that was tried.
    #[error(
        "the arm cannot move to {} in a straight line{hindrance}: {}",
        place([*x, *y, *z]),
        way_on(posture.as_ref())
    )]
    NoLine {
        /// Coordinate x of the requested position, base frame, `[m]`.
        x: f64,
        /// Coordinate y of the requested position.
        y: f64,
        /// Coordinate z of the requested position.
        z: f64,
        /// Reason why the straight line is not possible with the elbow in its present place.
        hindrance: Hindrance,
        /// Joint positions that reach the pose, and to which the joints can move, `[rad]`. The
        /// search ignores keep-out regions. `None` if the search found none.
        posture: Option<[f64; 7]>,
    },
    /// A limit of the budget is below [`Budget::LIMITS_MIN`], or above the robot's own limit.
    #[error("the limit of the {what} is {got}, expected between {least} and {most}")]
    Budget {
        /// Name of the limit.
        what: &'static str,
        /// The given value.
        got: f64,
        /// The lowest accepted value.
        least: f64,
        /// The robot's own limit.
        most: f64,
    },
    /// A speed is not positive, or raises a limit above the robot's limit.
    #[error(
        "speed is {got}, expected between {least} and {most:.3}, as a factor of the motion's \
         limits",
        least = Budget::SPEED_MIN
    )]
    Speed {
        /// The given factor.
        got: f64,
        /// The greatest factor with which all limits stay within the robot's limits.
        most: f64,
    },
    /// A stiffness or damping is out of bounds.
    #[error(transparent)]
    Gains(#[from] GainError),
    /// The joint springs act only in the null space of the end effector, and there is no spring at
    /// the end effector. Nothing would pull the arm to its target.
    #[error(
        "got no end-effector stiffness, and joint stiffness only in the null space, so nothing holds \
         the end effector: set an end-effector stiffness, or turn off `project_joint_gains`"
    )]
    Unheld,
    /// A number of the goal is out of bounds.
    #[error("{what} is {got} {unit}, expected {} {unit}", between(*.least, *.most))]
    Number {
        /// Name of the number.
        what: &'static str,
        /// The given value.
        got: f64,
        /// Unit of the number.
        unit: &'static str,
        /// The lowest accepted value.
        least: f64,
        /// The highest accepted value.
        most: f64,
    },
    /// The quaternion of the target does not have length one.
    #[error("the quaternion of the target has the length {length}, expected 1")]
    NotRotation {
        /// Length of the quaternion.
        length: f64,
    },
    /// The last point of a chunk is in the past, so the arm has nothing to follow.
    #[error("the last point of the chunk was due {} ms ago by the robot's clock, expected a point in the future: send chunks earlier", .by.as_millis())]
    Late {
        /// Time since the last point, by the robot's clock.
        by: Duration,
    },
    /// The time origin of a chunk is too far in the robot's future. Probably it was taken from a
    /// different clock.
    #[error("the chunk's time origin is {} ms after the robot's newest state, expected {} ms at \
        most: pass times of the robot's clock", .by.as_millis(), Chunk::OFFSET_MAX.as_millis())]
    Ahead {
        /// Time from the robot's newest state to the time origin.
        by: Duration,
    },
    /// The observation of a chunk is older than the observation of the chunk that the arm follows.
    #[error("the chunk's observation is {} ms older than the observation of the active chunk, \
        expected a newer observation", .by.as_millis())]
    Outdated {
        /// Time between the two observations.
        by: Duration,
    },
    /// Too many chunks arrived within a few cycles of the control thread.
    #[error(transparent)]
    Chunks(#[from] TooManyChunks),
    /// The session's backend does not support the goal.
    #[error("{backend} does not support {got}: use {expected}")]
    Backend {
        /// Backend of the session.
        backend: Backend,
        /// Unsupported request.
        got: &'static str,
        /// A backend that supports the request, or the requests that this backend supports.
        expected: &'static str,
    },
    /// A keep-out region is invalid, or there are too many regions.
    #[error("keep-out region {region} {why}")]
    KeepOut {
        /// The region, from 1.
        region: usize,
        /// Reason why the region is invalid.
        why: &'static str,
    },
    /// The condition of a reaction, or the target after it, is not accepted.
    #[error(transparent)]
    Condition(#[from] ConditionError),
    /// The timeout of a watchdog or a deadman is too short: packet loss alone could exceed it.
    #[error("the timeout of a watchdog or deadman is {} ms, expected at least {} ms", .got.as_millis(), Goal::SILENCE_MIN.as_millis())]
    Silence {
        /// The given timeout.
        got: Duration,
    },
    /// The target for a held object is not a pose.
    #[error("got a target that is not a pose, expected a pose for an object that the arms hold")]
    Grasp,
    /// The robot's state contains an end effector that is not a rigid transformation, or a load
    /// that is not finite.
    #[error(
        "the robot reports an end effector or load with an unphysical mass or inertia: correct it \
         with `set_ee` or `set_load`, or in Desk"
    )]
    Tool,
}

impl GoalError {
    /// Returns the name of this error's row in the book's chapter of errors, `errors.md`.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::NoTarget => "goal-no-target",
            Self::NoTorques => "goal-no-torques",
            Self::NotFinite { .. } => "goal-not-finite",
            Self::NotRotation { .. } => "goal-not-rotation",
            Self::Moves => "goal-moves",
            Self::OutOfRange { .. } => "goal-out-of-range",
            Self::Unreachable { .. } => "goal-unreachable",
            Self::NoLine { .. } => "goal-no-line",
            Self::Budget { .. } => "goal-budget",
            Self::Speed { .. } => "goal-speed",
            Self::Gains(_) => "goal-gains",
            Self::Unheld => "goal-unheld",
            Self::Number { .. } => "goal-number",
            Self::Late { .. } => "goal-late",
            Self::Ahead { .. } => "goal-ahead",
            Self::Outdated { .. } => "goal-outdated",
            Self::Chunks(_) => "goal-chunks",
            Self::Backend { .. } => "goal-backend",
            Self::KeepOut { .. } => "goal-keep-out",
            Self::Condition(_) => "goal-condition",
            Self::Silence { .. } => "goal-silence",
            Self::Grasp => "goal-grasp",
            Self::Tool => "goal-tool",
        }
    }
}

fn place(position: [f64; 3]) -> String {
    let [x, y, z] = position;
    if position.iter().any(|x| x.abs() > 10.0) {
        return format!("({x:?}, {y:?}, {z:?}) m (expected metres)");
    }
    format!("({x:.4}, {y:.4}, {z:.4}) m")
}

/// Returns a hint for a joint position that no joint reaches in radians.
fn degrees(position: f64) -> &'static str {
    if position.abs() > 2.0 * core::f64::consts::PI {
        " (are these degrees?)"
    } else {
        ""
    }
}

/// Reason why the arm cannot follow a straight line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Hindrance {
    /// The arm leaves the line. If a joint is at the end of its range, the value is the number of
    /// that joint, from 1.
    Range(Option<u8>),
    /// The arm comes too near to itself.
    Itself,
}

/// Prints nothing, or a comma and the end of a sentence.
impl core::fmt::Display for Hindrance {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Range(Some(joint)) => {
                write!(f, " (joint {joint} would reach the end of its range)")
            }
            Self::Range(None) => Ok(()),
            Self::Itself => write!(f, " (the arm would come too close to itself)"),
        }
    }
}

fn way_on(posture: Option<&[f64; 7]>) -> String {
    match posture {
        Some(q) => format!("use `move_joints` to {q:.4?} rad, which reaches the pose"),
        None => "move through other poses (`move_through`), or choose another pose".to_owned(),
    }
}

/// Chunks arrived faster than the control thread accepts them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "got more chunks at once than the control thread accepts, expected {} at most: send fewer",
    Chunk::UNDER_WAY_MAX
)]
pub struct TooManyChunks;

fn between(least: f64, most: f64) -> String {
    if most.is_infinite() {
        format!("at least {least}")
    } else {
        format!("between {least} and {most}")
    }
}
