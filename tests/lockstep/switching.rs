//! Switching between goals of all kinds in mid-motion: the commanded acceleration never jumps.

use std::time::Duration;

use franka_lockstep::Lockstep;
use franka_model::{Model, READY, RobotKind, Wrench};
use franka_rt::session::{Chunk, Free, GoalId, OnArrival, Target};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

/// Repetitions of every pair of kinds.
const ROUNDS: usize = 3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Pose,
    Joints,
    /// A target that moves.
    Stream,
    /// A hand that moves the arm.
    Guide,
    Rest,
    Chunk,
}

const KINDS: [Kind; 6] = [
    Kind::Pose,
    Kind::Joints,
    Kind::Stream,
    Kind::Guide,
    Kind::Rest,
    Kind::Chunk,
];

struct Switching {
    lockstep: Lockstep,
    random: SmallRng,
    engaged: GoalId,
    home: Isometry3<f64>,
    jerk: [f64; 7],
    /// The acceleration in the previous cycle, and the time of that cycle.
    last: (u64, [f64; 7]),
    /// The largest jump of the acceleration so far, as a share of the jerk limit per cycle.
    worst: f64,
    /// The number of cycles in which the arm moved.
    moving: u64,
}

impl Switching {
    fn new(kind: RobotKind, seed: u64) -> Self {
        let mut lockstep = Lockstep::ready_of(kind);
        let engaged = lockstep.engage();
        let record = &lockstep.client.record;
        Self {
            random: SmallRng::seed_from_u64(seed),
            engaged,
            home: lockstep.arm_pose(),
            jerk: Model::of(kind).joint_limits().jerk.into(),
            last: (record.time, record.ddq_ref),
            worst: 0.0,
            moving: 0,
            lockstep,
        }
    }

    fn switch_to(&mut self, kind: Kind) {
        self.lockstep.robot.let_go();
        let (target, on_arrival) = match kind {
            Kind::Pose | Kind::Stream => (Target::Pose(self.pose(0.1)), OnArrival::Hold),
            Kind::Joints => {
                let q = READY.map(|q| q + self.random.random_range(-0.3..0.3));
                (Target::Joints(q.into()), OnArrival::ReportAndHold)
            }
            Kind::Guide => {
                let axes = core::array::from_fn(|_| self.random.random_bool(0.7));
                let force = Vector3::from_fn(|_, _| self.random.random_range(-4.0..4.0));
                let push = Wrench::new(force.x, force.y, force.z, 0.0, 0.0, 0.0);
                self.lockstep.robot.push_end_effector(push, 500);
                (Target::Guide(Free { axes, elbow: true }), OnArrival::Hold)
            }
            Kind::Rest => (Target::Rest, OnArrival::ReportAndHold),
            Kind::Chunk => {
                let goal = self.lockstep.goal(Target::Rest, OnArrival::Hold);
                let chunk = self.chunk();
                self.lockstep
                    .submit_chunk(self.engaged, goal, chunk)
                    .expect("near the ready pose");
                return self.run(kind, None);
            }
        };
        let mut goal = self.lockstep.goal(target, on_arrival);
        goal.budget = goal.budget.scaled(self.random.random_range(0.4..1.6));
        match self.lockstep.submit_within(self.engaged, goal) {
            Ok(id) => self.run(kind, Some(id)),
            Err(error) => panic!("{kind:?}: {error:?}"),
        }
    }

    /// Runs until a random instant, mostly in mid-motion.
    fn run(&mut self, kind: Kind, goal: Option<GoalId>) {
        let mut next = 0;
        for time in 0..self.random.random_range(20..500) {
            if kind == Kind::Stream && time == next {
                next += self.random.random_range(5..60);
                let target = Target::Pose(self.pose(0.08));
                let goal = goal.expect("streams have one");
                assert_eq!(self.lockstep.update(goal, target), Ok(true));
            }
            self.lockstep.tick();
            self.measure(kind);
        }
    }

    fn measure(&mut self, kind: Kind) {
        let record = &self.lockstep.client.record;
        let (time, before) = self.last;
        assert_eq!(record.time, time + 1, "no state is lost");
        for (i, (now, before)) in record.ddq_ref.iter().zip(before).enumerate() {
            let share = (now - before).abs() / (self.jerk[i] * 1e-3);
            self.worst = self.worst.max(share);
            assert!(
                share <= 1.0 + 1e-6,
                "{time}, {kind:?}: joint {} jumps by {share} of the limit",
                i + 1
            );
        }
        self.moving += u64::from(record.dq_ref.iter().any(|dq| dq.abs() > 1e-3));
        self.last = (record.time, record.ddq_ref);
    }

    fn pose(&mut self, most: f64) -> Isometry3<f64> {
        let way = Vector3::from_fn(|_, _| self.random.random_range(-most..most));
        let turn = Vector3::from_fn(|_, _| self.random.random_range(-0.2..0.2));
        Isometry3::from_parts(
            Translation3::from(self.home.translation.vector + way),
            UnitQuaternion::from_scaled_axis(turn) * self.home.rotation,
        )
    }

    fn chunk(&mut self) -> Chunk {
        let time = |k: u32| Duration::from_millis(40) * k;
        let chunk = if self.random.random_bool(0.5) {
            let ends: [f64; 7] = core::array::from_fn(|_| self.random.random_range(-0.2..0.2));
            Chunk::joints((0..12).map(|k| {
                let way = ends.map(|end| end * f64::from(k) / 11.0);
                (time(k), core::array::from_fn(|i| READY[i] + way[i]))
            }))
        } else {
            let (from, to) = (self.home, self.pose(0.08));
            Chunk::poses((0..12).map(|k| (time(k), from.lerp_slerp(&to, f64::from(k) / 11.0))))
        };
        let chunk = chunk.expect("points 40 ms apart");
        if self.random.random_bool(0.5) {
            chunk.replace()
        } else {
            chunk
        }
    }
}

#[test]
fn no_switch_between_any_two_kinds_jumps_the_acceleration() {
    for robot in RobotKind::ALL {
        let mut switching = Switching::new(robot, 1);
        for from in KINDS.repeat(ROUNDS) {
            for to in KINDS {
                switching.switch_to(from);
                switching.switch_to(to);
            }
        }
        let Switching {
            worst,
            moving,
            lockstep,
            ..
        } = &switching;
        println!(
            "{robot:?}: {} switches, {:.1} s of {:.1} s in motion, the largest jump of the acceleration is {worst:.4} of \
             the jerk limit times 1 ms",
            2 * ROUNDS * KINDS.len() * KINDS.len(),
            *moving as f64 * 1e-3,
            lockstep.now() as f64 * 1e-3,
        );
        assert!(2 * moving > lockstep.now(), "mostly in motion");
    }
}
