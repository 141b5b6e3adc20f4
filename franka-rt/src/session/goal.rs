//! What target control is asked for, and its form in the slot that crosses into the thread.

use core::time::Duration;

use franka_model::limits::JointLimits;
use franka_model::{JointVector, Twist, rotation};
use franka_otg::AxisLimits;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use crate::law::Gains;
use crate::session::{
    Budget, Deviation, ForceCap, Lead, Leash, OnTimeout, Reaction, Settling, Tolerance, Watchdog,
};
use crate::slot::Words;
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

    /// Whether it moves.
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
    /// Whether the arm is to stop on its way, within the budget, and to stay there until this is
    /// taken back.
    pub paused: bool,
    /// Until what it is pursued, if not only until the arrival. A goal keeps the one that it began
    /// with.
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

    /// Returns the goal with rest as its target, without a reaction or a team. Gains for guiding
    /// are replaced by gains that hold.
    pub(crate) fn at_rest(&self, on_arrival: OnArrival) -> Self {
        let gains = match self.target {
            Target::Guide(_) => Gains::cartesian(),
            _ => self.gains,
        };
        Self {
            target: Target::Rest,
            on_arrival,
            gains,
            paused: false,
            reaction: None,
            round: None,
            ..*self
        }
    }
}

fn numbers_of(pose: &Isometry3<f64>) -> [f64; 7] {
    let (p, r) = (pose.translation.vector, pose.rotation.coords);
    [p.x, p.y, p.z, r.x, r.y, r.z, r.w]
}

fn pose_of([x, y, z, i, j, k, w]: [f64; 7]) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
    )
}

/// The kind of target, 7 numbers, and 7 of its velocity.
impl Words for Target {
    const WORDS: usize = 1 + 7 + 7;

    fn store(&self, words: &mut [u64]) {
        let (kind, place, velocity) = match self {
            Self::Rest => (0, [0.0; 7], [0.0; 7]),
            Self::Joints(q) => (1, *q, [0.0; 7]),
            Self::Pose(pose) => (2, numbers_of(pose), [0.0; 7]),
            Self::Guide(free) => (3 | free.to_word() << 3, [0.0; 7], [0.0; 7]),
            Self::MovingJoints { q, dq } => (4, *q, *dq),
            Self::MovingPose { pose, twist } => {
                let velocity = core::array::from_fn(|i| if i < 6 { twist[i] } else { 0.0 });
                (5, numbers_of(pose), velocity)
            }
        };
        words[0] = kind;
        place.store(&mut words[1..8]);
        velocity.store(&mut words[8..]);
    }

    fn load(words: &[u64]) -> Self {
        let place = <[f64; 7]>::load(&words[1..8]);
        let velocity = <[f64; 7]>::load(&words[8..]);
        let pose = || pose_of(place);
        match words[0] & 7 {
            1 => Self::Joints(place),
            2 => Self::Pose(pose()),
            3 => Self::Guide(Free::from_word(words[0] >> 3)),
            4 => Self::MovingJoints {
                q: place,
                dq: velocity,
            },
            5 => Self::MovingPose {
                pose: pose(),
                twist: Twist::from_column_slice(&velocity[..6]),
            },
            _ => Self::Rest,
        }
    }
}

/// Name, revision, what follows and whether it is paused, the round, 2 of the watchdog; then 27
/// numbers of budget, the gains, 2 of tolerance, the force cap, 3 of the lead, 7 of the grasp and 7
/// of the posture, which are zero or no numbers without one, 3 of the leash, 3 of the deviation and
/// 2 of the settling; then the target and the reaction.
///
/// Written by hand: generated code needs an implementation for the type of each field, which comes
/// to as many lines. The test below fails if a field is left out.
impl Words for Goal {
    const WORDS: usize = NUMBERS + Target::WORDS + Option::<Reaction>::WORDS;

    fn store(&self, words: &mut [u64]) {
        let (watched, silence) = match self.watchdog {
            None => (0, 0),
            Some(Watchdog {
                silence,
                on_timeout,
            }) => {
                let on_timeout = u64::from(on_timeout == OnTimeout::Brake);
                let silence = u64::try_from(silence.as_millis()).unwrap_or(u64::MAX);
                (1 | on_timeout << 1, silence)
            }
        };
        let Budget {
            joints,
            translation,
            rotation,
        } = self.budget;
        let axes = joints.into_iter().chain([translation, rotation]);
        let numbers = axes
            .flat_map(|l| [l.velocity, l.acceleration, l.jerk])
            .chain(self.gains.to_array())
            .chain(self.tolerance.map_or([0.0; 2], |tolerance| {
                [tolerance.translation, tolerance.rotation]
            }))
            .chain([self.force_cap.to_number()])
            .chain(self.lead.map_or([0.0; 3], |lead| {
                [lead.translation, lead.rotation, lead.joints]
            }))
            .chain(self.grasp.as_ref().map_or([0.0; 7], numbers_of))
            .chain(self.posture.unwrap_or([f64::NAN; 7]))
            .chain([
                self.leash.translation,
                self.leash.rotation,
                self.leash.joints,
            ])
            .chain([
                self.deviation.translation,
                self.deviation.rotation,
                self.deviation.joints,
            ])
            .chain([self.settling.hold, self.settling.timeout].map(|time| time.as_millis() as f64));
        let on_arrival = self.on_arrival.to_word() | u64::from(self.paused) << 2;
        let round = Round::to_word(self.round);
        let all = [
            self.id.0,
            self.revision,
            on_arrival,
            round,
            watched,
            silence,
        ]
        .into_iter()
        .chain(numbers.map(f64::to_bits));
        for (word, value) in words.iter_mut().zip(all) {
            *word = value;
        }
        let (target, reaction) = words[NUMBERS..].split_at_mut(Target::WORDS);
        self.target.store(target);
        self.reaction.store(reaction);
    }

    fn load(words: &[u64]) -> Self {
        let (numbers, others) = words.split_at(NUMBERS);
        let (target, reaction) = others.split_at(Target::WORDS);
        let mut words = numbers.iter().copied();
        let mut next = || words.next().unwrap_or_default();
        let [id, revision, on_arrival, round, watched, silence] = core::array::from_fn(|_| next());
        let mut number = || f64::from_bits(next());
        let mut axis = || AxisLimits {
            velocity: number(),
            acceleration: number(),
            jerk: number(),
        };
        let budget = Budget {
            joints: core::array::from_fn(|_| axis()),
            translation: axis(),
            rotation: axis(),
        };
        Self {
            id: GoalId(id),
            target: Target::load(target),
            paused: on_arrival >> 2 & 1 == 1,
            on_arrival: OnArrival::from_word(on_arrival & 3),
            watchdog: (watched & 1 == 1).then(|| Watchdog {
                silence: Duration::from_millis(silence),
                on_timeout: if watched >> 1 & 1 == 1 {
                    OnTimeout::Brake
                } else {
                    OnTimeout::Hold
                },
            }),
            budget,
            gains: Gains::from_array(core::array::from_fn(|_| number())),
            tolerance: Some(Tolerance {
                translation: number(),
                rotation: number(),
            })
            .filter(|tolerance| tolerance.translation > 0.0),
            force_cap: ForceCap::from_number(number()),
            lead: Some(Lead {
                translation: number(),
                rotation: number(),
                joints: number(),
            })
            .filter(|lead| lead.translation > 0.0),
            grasp: Some(pose_of(core::array::from_fn(|_| number())))
                .filter(|grasp| grasp.rotation.coords.norm() > 0.0),
            posture: Some(core::array::from_fn(|_| number())).filter(|q: &[f64; 7]| !q[0].is_nan()),
            leash: Leash {
                translation: number(),
                rotation: number(),
                joints: number(),
            },
            deviation: Deviation {
                translation: number(),
                rotation: number(),
                joints: number(),
            },
            settling: Settling {
                hold: Duration::from_millis(number() as u64),
                timeout: Duration::from_millis(number() as u64),
            },
            reaction: Words::load(reaction),
            round: Round::from_word(round),
            revision,
        }
    }
}

/// Words of a goal before those of its target.
const NUMBERS: usize = 6 + 27 + Gains::NUMBERS + 2 + 1 + 3 + 7 + 7 + 3 + 3 + 2;

impl OnArrival {
    fn to_word(self) -> u64 {
        match self {
            Self::Hold => 0,
            Self::ReportAndHold => 1,
            Self::ReportAndFinish => 2,
        }
    }

    fn from_word(word: u64) -> Self {
        match word {
            0 => Self::Hold,
            1 => Self::ReportAndHold,
            _ => Self::ReportAndFinish,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::condition::{Axis, Quantity, elapsed, force_z};
    use franka_model::Model;

    #[test]
    fn every_field_of_a_goal_survives_its_words() {
        let pose = Isometry3::from_parts(
            Translation3::new(0.4, -0.1, 0.3),
            UnitQuaternion::from_euler_angles(3.0, 0.2, -0.7),
        );
        let free = Free {
            axes: [true, false, false, true, true, false],
            elbow: true,
        };
        let watchdog = Watchdog {
            silence: Duration::from_millis(250),
            on_timeout: OnTimeout::Brake,
        };
        let lead = Lead {
            translation: 0.05,
            rotation: 0.2,
            joints: 0.1,
        };
        let low = Quantity::Position(Axis::Z).below(0.1);
        let touched = force_z(8.0).relative().held_for(Duration::from_millis(20)) | low;
        let brake = Reaction::from(!touched & elapsed(Duration::from_millis(300)));
        for (target, on_arrival, watchdog, force_cap, lead, reaction) in [
            (
                Target::Rest,
                OnArrival::ReportAndFinish,
                None,
                ForceCap::Off,
                None,
                Some(touched.then(pose)),
            ),
            (
                Target::Joints([0.1, -0.2, 0.3, -2.0, 0.5, 1.6, 0.7]),
                OnArrival::Hold,
                Some(watchdog),
                ForceCap::Newtons(25.0),
                None,
                Some(brake),
            ),
            (
                Target::Pose(pose),
                OnArrival::ReportAndHold,
                None,
                ForceCap::Newtons(5.0),
                Some(lead),
                Some(touched.then([0.1, -0.2, 0.3, -2.0, 0.5, 1.6, 0.7])),
            ),
            (
                Target::Guide(free),
                OnArrival::Hold,
                Some(watchdog),
                ForceCap::Default,
                None,
                None,
            ),
            (
                Target::MovingJoints {
                    q: [0.1, -0.2, 0.3, -2.0, 0.5, 1.6, 0.7],
                    dq: [0.1, 0.2, -0.3, 0.4, -0.5, 0.6, 0.7],
                },
                OnArrival::Hold,
                None,
                ForceCap::Default,
                Some(lead),
                Some(brake),
            ),
            (
                Target::MovingPose {
                    pose,
                    twist: Twist::new(0.1, -0.2, 0.3, 0.4, 0.5, -0.6),
                },
                OnArrival::Hold,
                Some(watchdog),
                ForceCap::Off,
                None,
                None,
            ),
        ] {
            let goal = Goal {
                id: GoalId(77),
                target,
                on_arrival,
                budget: Budget::of(Model::fr3().joint_limits()).scaled(0.37),
                gains: Gains::MOST,
                tolerance: lead.map(|_| Tolerance {
                    translation: 2e-3,
                    rotation: 3e-3,
                }),
                watchdog,
                force_cap,
                lead,
                paused: lead.is_some(),
                reaction,
                round: Round::from_word(if lead.is_some() { 7 } else { 0 }),
                grasp: lead.map(|_| pose),
                leash: Leash::MOST,
                deviation: Deviation {
                    joints: f64::INFINITY,
                    ..Deviation::default()
                },
                settling: Settling {
                    hold: Duration::from_millis(1),
                    timeout: Duration::from_millis(4321),
                },
                posture: lead.map(|_| [0.1, -0.2, 0.3, -2.0, 0.5, 1.6, 0.7]),
                revision: 5,
            };
            let mut words = [u64::MAX; Goal::WORDS];
            goal.store(&mut words);
            assert_eq!(Goal::load(&words), goal);
        }
    }
}
