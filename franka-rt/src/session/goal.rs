//! What target control is asked for.

mod words;

use core::time::Duration;

use franka_model::limits::JointLimits;
use franka_model::{JointVector, Twist, rotation};
use nalgebra::{Isometry3, Translation3, Vector3};

use crate::law::Gains;
use crate::session::{
    Budget, Deviation, ForceCap, Lead, Leash, Reaction, Settling, Tolerance, Watchdog,
};
use crate::team::Round;

/// Identifies one goal for the life of a connection. Updates of a followed target keep the id of
/// their goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GoalId(pub u64);

/// Where to go.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Target {
    /// To rest, over the joints, in about a quarter of a second and under the robot's jerk limit,
    /// however gentle the goal's budget is.
    Rest,
    /// To joint positions, `[rad]`.
    Joints([f64; 7]),
    /// To a pose of the end effector in the base frame, `O_T_EE`, metres.
    Pose(Isometry3<f64>),
    /// To joint positions that move: the arm gets there and goes on with them. Only for goals that
    /// are held. The motion counts for [`Self::MOVES_ON_MS`] after the newest target, then the arm
    /// brakes on its path.
    MovingJoints {
        /// Positions when the target is taken up, `[rad]`.
        q: [f64; 7],
        /// Their velocities, `[rad/s]`.
        dq: [f64; 7],
    },
    /// To a pose that moves; otherwise as [`Self::MovingJoints`].
    MovingPose {
        /// `O_T_EE` when the target is taken up, metres.
        pose: Isometry3<f64>,
        /// Velocity of the frame's origin, `[m/s]`, and angular velocity, `[rad/s]`, base axes.
        twist: Twist,
    },
    /// Hand guiding: the reference goes with the arm along the free axes, and stays on the others.
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
    /// Joint positions, `[rad]`, and their velocities, `[rad/s]`.
    fn from((q, dq): ([f64; 7], [f64; 7])) -> Self {
        Self::MovingJoints { q, dq }
    }
}

impl From<(Isometry3<f64>, Twist)> for Target {
    /// A pose in the base frame, and its velocity in base axes: m/s, rad/s.
    fn from((pose, twist): (Isometry3<f64>, Twist)) -> Self {
        Self::MovingPose { pose, twist }
    }
}

impl Target {
    /// How long a target that moves goes on by itself, `[ms]` of the robot's clock. A stream of
    /// 5 Hz is followed without a pause.
    pub const MOVES_ON_MS: u64 = 200;

    /// True if it moves.
    pub fn moves(&self) -> bool {
        matches!(self, Self::MovingJoints { .. } | Self::MovingPose { .. })
    }

    /// The place where it is, without its motion.
    #[must_use]
    pub fn place(self) -> Self {
        match self {
            Self::MovingJoints { q, .. } => Self::Joints(q),
            Self::MovingPose { pose, .. } => Self::Pose(pose),
            Self::Rest | Self::Joints(_) | Self::Pose(_) | Self::Guide(_) => self,
        }
    }

    /// Where it is, and moves on from, `ms` milliseconds later.
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

/// The pose after `t` seconds of the motion `twist`.
pub(crate) fn moved(pose: &Isometry3<f64>, twist: &Twist, t: f64) -> Isometry3<f64> {
    let part = |from: usize| Vector3::new(twist[from], twist[from + 1], twist[from + 2]);
    Isometry3::from_parts(
        Translation3::from(pose.translation.vector + part(0) * t),
        rotation::exp(&(part(3) * t)) * pose.rotation,
    )
}

/// What is free under hand guiding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Free {
    /// Axes of the base frame at the end effector: x y z, about x y z.
    pub axes: [bool; 6],
    /// The elbow, while the end effector stays.
    pub elbow: bool,
}

impl Free {
    /// Everything.
    pub const ALL: Self = Self {
        axes: [true; 6],
        elbow: true,
    };

    fn to_word(self) -> u64 {
        let all = self.axes.into_iter().chain([self.elbow]);
        all.fold(0, |word, free| word << 1 | u64::from(free))
    }

    fn from_word(word: u64) -> Self {
        Self {
            axes: core::array::from_fn(|i| word >> (6 - i) & 1 == 1),
            elbow: word & 1 == 1,
        }
    }
}

/// What the session does once the reference has arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnArrival {
    /// Holds the target until a newer goal comes, and reports nothing.
    Hold,
    /// Reports when the arm has settled, and holds the target until a newer goal comes.
    ReportAndHold,
    /// Reports when the arm has settled, and ends the motion.
    ReportAndFinish,
}

/// One goal, complete: a newer one replaces all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Its name.
    pub id: GoalId,
    /// Where to go.
    pub target: Target,
    /// What the session does once the reference has arrived.
    pub on_arrival: OnArrival,
    /// How fast.
    pub budget: Budget,
    /// How stiff.
    pub gains: Gains,
    /// How near counts as arrived; `None` for what the law keeps on an arm that sticks: see
    /// [`Tolerance::of`] and [`Tolerance::under`]. An arm that holds an object with others of its
    /// team, and comes to rest farther away than that, has arrived within 5 mm and 10 mrad, too.
    pub tolerance: Option<Tolerance>,
    /// What happens if its updates stop coming; only for goals that are held.
    pub watchdog: Option<Watchdog>,
    /// With how much force springs and dampers may press at the end effector.
    pub force_cap: ForceCap,
    /// How far ahead of the arm its target may be.
    pub lead: Option<Lead>,
    /// How far ahead of the arm the reference may be.
    pub leash: Leash,
    /// How far the arm may be pushed off its way.
    pub deviation: Deviation,
    /// How the arm has to settle.
    pub settling: Settling,
    /// Where the arm's free direction goes while the end effector goes to a pose, joint positions
    /// in `[rad]`: as near to them as the pose lets it. With one the elbow also moves while the end
    /// effector rests, and a goal arrives when both rest. `None` keeps the elbow, while the end
    /// effector moves, near where the session began.
    pub posture: Option<[f64; 7]>,
    /// True if it leads along a path to its target. The path is sent beside it, as a chunk: without
    /// one the arm rests.
    pub along_path: bool,
    /// True if the arm is to stop on its way, within the budget, and to stay there until this is
    /// taken back.
    pub paused: bool,
    /// Condition that ends the motion early. A goal keeps the condition that it began with.
    pub reaction: Option<Reaction>,
    /// The joint motion of a team that it is part of: it begins with the goals of the other
    /// members, and is given up for a fault of one. Only for sessions with a [`Member`].
    ///
    /// [`Member`]: crate::team::Member
    pub round: Option<Round>,
    /// The object that the hand holds, in the frame of the end effector: the target is a pose of
    /// the object, which moves on its line. Springs and force cap act at the hand. In a round the
    /// reference waits for the arms of the other members.
    pub grasp: Option<Isometry3<f64>>,
    /// Incremented by each new target and each new end, not by tuning. Only a new revision feeds
    /// the watchdog.
    pub revision: u64,
}

impl Goal {
    /// Shortest silence that a watchdog or a deadman may be set to.
    pub const SILENCE_MIN: Duration = Duration::from_millis(10);

    /// A goal for an arm with these limits, with the defaults: the default budget, joints stiff on
    /// the way to joint positions and the end effector compliant otherwise, the default force cap.
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

    /// The target of the end effector itself.
    pub(crate) fn hand_target(&self) -> Target {
        match (self.target, &self.grasp) {
            (Target::Pose(object), Some(grasp)) => Target::Pose(object * grasp.inverse()),
            (target, _) => target,
        }
    }

    /// Returns the goal with rest as its target, without a path, a reaction or a team. Gains for
    /// guiding are replaced by gains that hold.
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
