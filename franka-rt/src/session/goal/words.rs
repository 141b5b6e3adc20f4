//! Encoding of a goal in the slot to the control thread.

use core::time::Duration;

use franka_model::Twist;
use franka_otg::AxisLimits;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

use super::{Free, Goal, GoalId, OnArrival, Target};
use crate::law::Gains;
use crate::session::{
    Budget, Deviation, ForceCap, Lead, Leash, OnTimeout, Reaction, Settling, Tolerance, Watchdog,
};
use crate::slot::Words;
use crate::team::Round;

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

/// The kind of target, 7 numbers, and 7 numbers for its velocity.
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

/// First come name, revision, action on arrival, flags for pause and path, round, and 2 words of
/// the watchdog. Then come the numbers that the test below counts: budget, gains, tolerance, force
/// cap, lead, grasp, posture, leash, deviation and settling. A missing tolerance, lead or grasp is
/// stored as zeros, a missing posture as NaN. Target and reaction follow.
///
/// Written by hand: generated code needs an implementation for the type of each field, which takes
/// as many lines. The test below fails if a field is left out.
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
        let flags = u64::from(self.paused) << 2 | u64::from(self.along_path) << 3;
        let on_arrival = self.on_arrival.to_word() | flags;
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
            along_path: on_arrival >> 3 & 1 == 1,
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

/// Words of a goal before the words of its target.
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
                along_path: watchdog.is_some(),
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
