//! Goals: the requests of target control.

use core::time::Duration;

use franka_model::limits::JointLimits;
use franka_model::{JointVector, Twist, rotation};
use nalgebra::{Isometry3, Translation3, Vector3};

use crate::law::Gains;
use crate::session::{
    Budget, Deviation, ForceCap, Lead, Leash, Reaction, Settling, Tolerance, Watchdog,
};
use crate::team::Round;

/// Identifies one goal during the life of a connection. Updates of a followed target keep the id of
/// their goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GoalId(pub u64);

/// Target of a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Target {
    /// Rest: the joints brake in about a quarter of a second. Braking may use the robot's full jerk
    /// limit, even if the goal's budget is lower.
    Rest,
    /// Joint positions, `[rad]`.
    Joints([f64; 7]),
    /// Pose of the end effector in the base frame, `O_T_EE`, metres.
    Pose(Isometry3<f64>),
    /// Moving joint positions: the arm catches up with them and then moves with them. Accepted only
    /// for goals that are held. The motion is extrapolated for [`Self::MOVES_ON_MS`] after the
    /// newest target; then the arm brakes on its path.
    MovingJoints {
        /// Positions at the instant when the session accepts the target, `[rad]`.
        q: [f64; 7],
        /// Velocities of the positions, `[rad/s]`.
        dq: [f64; 7],
    },
    /// A moving pose. Apart from the pose, it works like [`Self::MovingJoints`].
    MovingPose {
        /// `O_T_EE` at the instant when the session accepts the target, metres.
        pose: Isometry3<f64>,
        /// Velocity of the frame's origin, `[m/s]`, and angular velocity, `[rad/s]`, base axes.
        twist: Twist,
    },
    /// Hand guiding: the reference follows the arm along the free axes, and stays fixed on the
    /// other axes.
    Guide(Free),
}

impl From<Isometry3<f64>> for Target {
    fn from(pose: Isometry3<f64>) -> Self {
        Self::Pose(pose)
    }
}

impl From<[f64; 7]> for Target {
    fn from(q: [f64; 7]) -> Self {
        Self::Joints(q)
    }
}

impl From<JointVector> for Target {
    fn from(q: JointVector) -> Self {
        Self::Joints(q.into())
    }
}

impl From<([f64; 7], [f64; 7])> for Target {
    /// Combines joint positions, `[rad]`, and their velocities, `[rad/s]`.
    fn from((q, dq): ([f64; 7], [f64; 7])) -> Self {
        Self::MovingJoints { q, dq }
    }
}

impl From<(Isometry3<f64>, Twist)> for Target {
    /// Combines a pose in the base frame and its velocity in base axes: m/s, rad/s.
    fn from((pose, twist): (Isometry3<f64>, Twist)) -> Self {
        Self::MovingPose { pose, twist }
    }
}

impl Target {
    /// Time for which a moving target is extrapolated, `[ms]` of the robot's clock. Therefore the
    /// arm follows a stream of 5 Hz without a pause.
    pub const MOVES_ON_MS: u64 = 200;

    /// True if the target moves.
    pub fn moves(&self) -> bool {
        matches!(self, Self::MovingJoints { .. } | Self::MovingPose { .. })
    }

    /// Returns the present place of the target, as a target at rest.
    #[must_use]
    pub fn place(self) -> Self {
        match self {
            Self::MovingJoints { q, .. } => Self::Joints(q),
            Self::MovingPose { pose, .. } => Self::Pose(pose),
            Self::Rest | Self::Joints(_) | Self::Pose(_) | Self::Guide(_) => self,
        }
    }

    #[must_use]
    pub(crate) fn after(self, ms: u64) -> Self {
        let t = ms as f64 * 1e-3;
        match self {
            Self::MovingJoints { q, dq } => Self::MovingJoints {
                q: core::array::from_fn(|i| q[i] + dq[i] * t),
                dq,
            },
            Self::MovingPose { pose, twist } => Self::MovingPose {
                pose: moved(&pose, &twist, t),
                twist,
            },
            Self::Rest | Self::Joints(_) | Self::Pose(_) | Self::Guide(_) => self,
        }
    }
}

/// Returns the pose after `t` seconds of the motion `twist`.
pub(crate) fn moved(pose: &Isometry3<f64>, twist: &Twist, t: f64) -> Isometry3<f64> {
    let part = |from: usize| Vector3::new(twist[from], twist[from + 1], twist[from + 2]);
    Isometry3::from_parts(
        Translation3::from(pose.translation.vector + part(0) * t),
        rotation::exp(&(part(3) * t)) * pose.rotation,
    )
}

/// Axes that are free under hand guiding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Free {
    /// Axes of the base frame at the end effector: translation along x, y, z, then rotation about
    /// x, y, z.
    pub axes: [bool; 6],
    /// True if the elbow is free while the end effector stays where it is.
    pub elbow: bool,
}

impl Free {
    /// All axes and the elbow.
    pub const ALL: Self = Self {
        axes: [true; 6],
        elbow: true,
    };
}

/// Action of the session when the reference has arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnArrival {
    /// Holds the target until the next goal, and reports nothing.
    Hold,
    /// Reports when the arm has settled, and holds the target until the next goal.
    ReportAndHold,
    /// Reports when the arm has settled, and ends the motion.
    ReportAndFinish,
}

/// One complete goal. A newer goal replaces all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Identifies the goal.
    pub id: GoalId,
    /// Target of the motion.
    pub target: Target,
    /// Action of the session when the reference has arrived.
    pub on_arrival: OnArrival,
    /// Limits of velocity, acceleration and jerk.
    pub budget: Budget,
    /// Stiffness and damping.
    pub gains: Gains,
    /// Tolerance of the arrival. `None` uses the accuracy that the law reaches on an arm with
    /// friction: see [`Tolerance::of`] and [`Tolerance::under`]. If the arm holds an object
    /// together with other arms of its team, stopping within 5 mm and 10 mrad also counts as
    /// arrival.
    pub tolerance: Option<Tolerance>,
    /// Reaction when a stream of updates stops. Accepted only for goals that are held.
    pub watchdog: Option<Watchdog>,
    /// Limit of the force that springs and dampers may exert at the end effector.
    pub force_cap: ForceCap,
    /// Limit of the distance between arm and target.
    pub lead: Option<Lead>,
    /// Limit of the distance between arm and reference.
    pub leash: Leash,
    /// Limit of how far the arm may be pushed off its path.
    pub deviation: Deviation,
    /// Conditions under which the arm counts as settled.
    pub settling: Settling,
    /// Joint positions toward which the elbow moves, `[rad]`, while the end effector moves to a
    /// pose. The joints get as near to these positions as the pose allows. With a posture, the
    /// elbow can also move while the end effector rests, and a goal arrives when the elbow and the
    /// end effector rest. With `None`, the elbow stays near its place at the session's start while
    /// the end effector moves.
    pub posture: Option<[f64; 7]>,
    /// True if the goal follows a path to its target. The path is sent separately, as a chunk.
    /// Until the chunk arrives, the arm rests.
    pub along_path: bool,
    /// True if the arm must stop on its path, within the budget, and stay there until `paused` is
    /// false again.
    pub paused: bool,
    /// Condition that ends the motion early. A goal keeps its first condition: updates do not
    /// change it.
    pub reaction: Option<Reaction>,
    /// The common motion of a team that the goal belongs to. The goal begins together with the
    /// goals of the other members, and a fault of one member aborts all of them. Accepted only for
    /// sessions with a [`Member`].
    ///
    /// [`Member`]: crate::team::Member
    pub round: Option<Round>,
    /// Pose of the held object in the frame of the end effector. With a grasp, the target is a pose
    /// of the object, and the object moves on the straight line. Springs and force cap act at the
    /// hand. In a common motion of a team, the reference waits for the arms of the other members.
    pub grasp: Option<Isometry3<f64>>,
    /// Number of changes of the target or of [`on_arrival`](Self::on_arrival). A change of gains or
    /// limits does not increment it. Only a new revision restarts the watchdog's timer.
    pub revision: u64,
}

impl Goal {
    /// Shortest timeout of a watchdog or a deadman.
    pub const SILENCE_MIN: Duration = Duration::from_millis(10);

    /// Creates a goal for an arm with these limits. The goal has the default budget and the default
    /// force cap. Joint targets get stiff joints; other targets get a compliant end effector.
    pub fn new(id: GoalId, target: Target, on_arrival: OnArrival, limits: &JointLimits) -> Self {
        Self {
            id,
            target,
            on_arrival,
            budget: Budget::of(limits),
            gains: match target {
                Target::Joints(_) | Target::MovingJoints { .. } => Gains::joint(),
                Target::Pose(_) | Target::MovingPose { .. } | Target::Rest => Gains::cartesian(),
                Target::Guide(free) => Gains::guiding(free),
            },
            tolerance: None,
            watchdog: None,
            force_cap: ForceCap::Default,
            lead: None,
            leash: Leash::default(),
            deviation: Deviation::default(),
            settling: Settling::default(),
            posture: None,
            along_path: false,
            paused: false,
            reaction: None,
            round: None,
            grasp: None,
            revision: 0,
        }
    }

    /// Returns the target of the end effector itself.
    pub(crate) fn hand_target(&self) -> Target {
        match (self.target, &self.grasp) {
            (Target::Pose(object), Some(grasp)) => Target::Pose(object * grasp.inverse()),
            (target, _) => target,
        }
    }

    /// Returns the goal with [`Target::Rest`] as its target, and without path, reaction and team.
    /// Gains for guiding are replaced by gains that hold the arm.
    pub(crate) fn at_rest(&self, on_arrival: OnArrival) -> Self {
        let gains = match self.target {
            Target::Guide(_) => Gains::cartesian(),
            _ => self.gains,
        };
        Self {
            target: Target::Rest,
            on_arrival,
            gains,
            along_path: false,
            paused: false,
            reaction: None,
            round: None,
            ..*self
        }
    }
}
