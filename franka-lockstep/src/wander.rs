//! Endless target control: single and streamed joint and pose targets at irregular times, with each
//! control law in turn.

use franka_model::READY;
use franka_rt::law::{Gains, Law};
use franka_rt::session::{ForceCap, Goal, GoalId, OnArrival, Target};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::{Lockstep, Part};

/// Moves an arm to random targets, determined by a seed.
pub struct Wander {
    /// The system with the arm.
    pub lockstep: Lockstep,
    random: SmallRng,
    home: Isometry3<f64>,
    goal: GoalId,
    next: u64,
    turns: usize,
}

impl Wander {
    /// Returns an arm in the ready pose with its first goal.
    pub fn new(seed: u64) -> Self {
        Self::of(Lockstep::ready(), seed)
    }

    /// Returns the arm of this system with its first goal. The arm starts at its current position.
    pub fn of(mut lockstep: Lockstep, seed: u64) -> Self {
        let home = lockstep.arm_pose();
        let goal = lockstep.goal(Target::Pose(home), OnArrival::Hold);
        let id = lockstep.submit(goal).expect("the arm is there already");
        let mut this = Self {
            lockstep,
            random: SmallRng::seed_from_u64(seed),
            home,
            goal: id,
            next: 0,
            turns: 0,
        };
        this.lockstep.run(20);
        this
    }

    /// Advances by one millisecond, like [`Lockstep::tick_around`].
    pub fn tick_around(&mut self, around: impl FnMut(Part, &mut dyn FnMut())) {
        if self.lockstep.now() >= self.next {
            self.next = self.lockstep.now() + self.random.random_range(5..400);
            self.change_course();
        }
        self.lockstep.tick_around(around);
    }

    fn change_course(&mut self) {
        if self.random.random_bool(0.25) {
            let offset: [f64; 7] = core::array::from_fn(|_| self.random.random_range(-0.2..0.2));
            let goal = Target::Joints(core::array::from_fn(|i| READY[i] + offset[i]));
            self.submit(goal);
        } else {
            let mut vector =
                |most: f64| Vector3::from_fn(|_, _| self.random.random_range(-most..most));
            let (way, turn) = (vector(0.08), vector(0.2));
            let pose = Isometry3::from_parts(
                Translation3::from(self.home.translation.vector + way),
                UnitQuaternion::from_scaled_axis(turn) * self.home.rotation,
            );
            if self.random.random_bool(0.5) {
                self.submit(Target::Pose(pose));
            } else {
                let updated = self.lockstep.update(self.goal, Target::Pose(pose));
                assert_eq!(updated, Ok(true), "the goal is being followed");
            }
        }
    }

    fn submit(&mut self, target: Target) {
        let goal = in_turn(self.turns, self.lockstep.goal(target, OnArrival::Hold));
        self.turns += 1;
        self.goal = self
            .lockstep
            .submit(goal)
            .expect("targets near the ready pose are reachable");
    }
}

/// Returns the goal with the control law of this turn. Two of three laws have a force limit.
fn in_turn(turn: usize, goal: Goal) -> Goal {
    let gains = match turn % 3 {
        0 => return goal,
        1 => Gains {
            law: Law::OperationalSpace,
            ..Gains::cartesian()
        },
        _ => Gains {
            project_joint_gains: true,
            feedforward_cutoff: 50.0,
            ..Gains::cartesian()
        },
    };
    Goal {
        gains,
        force_cap: ForceCap::Newtons(30.0),
        ..goal
    }
}
