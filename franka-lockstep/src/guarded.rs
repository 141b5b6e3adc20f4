//! Endless target control with every guard enabled, for several workloads. Missing updates, deadman
//! timeouts, pushes, conditions, regions in the way and distant targets make each guard intervene
//! from time to time.

use std::collections::HashSet;
use std::time::Duration;

use franka_model::collision::Obstacle;
use franka_model::limits::JointLimits;
use franka_model::{JointVector, Model, READY, Wrench};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::driver::{Activity, Program};
use franka_rt::law::{Gains, Law};
use franka_rt::session::condition::{Quantity, elapsed, force};
use franka_rt::session::{
    Backend, Chunk, ChunkWriter, Deadman, Fate, ForceCap, Free, Goal, GoalId, Guard, KeepOut, Lead,
    OnArrival, OnTimeout, Reaction, Target, TargetSession, Watchdog, chunk_ring,
};
use franka_rt::triple_buffer::{Writer, triple_buffer};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::{Lockstep, Part, set_in_motion};

/// Kind of goals that a session receives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Workload {
    /// Poses, as single goals and as streams.
    Poses,
    /// Joint positions, as single goals and as streams.
    Joints,
    /// Chunks of joints and of poses, most of them replaced before their end.
    Chunks,
    /// Guiding by hand, interrupted by occasional poses.
    Guide,
    /// Joint positions and poses for one of the robot's own controllers. The seed selects the
    /// controller and the kind of setpoints. With Cartesian setpoints, all goals are poses.
    RobotController,
}

impl Workload {
    /// All workloads.
    pub const ALL: [Self; 5] = [
        Self::Poses,
        Self::Joints,
        Self::Chunks,
        Self::Guide,
        Self::RobotController,
    ];

    fn backend(self, seed: u64) -> Backend {
        match self {
            Self::RobotController => {
                let all = Backend::ROBOT_CONTROLLERS;
                all[seed as usize % all.len()]
            }
            _ => Backend::Torques,
        }
    }
}

/// A session with every guard enabled. A seed determines its goals and disturbances.
pub struct Guarded {
    /// The system in which the session runs.
    pub lockstep: Lockstep,
    /// Guards that have intervened so far.
    pub bound: HashSet<Guard>,
    /// Outcome of each chunk so far.
    pub fates: Vec<Fate>,
    /// Number of times that the robot itself has stopped the arm. A hard push can drive the arm to
    /// a limit. After a stop, the arm starts again from the ready pose.
    pub stops: u32,
    workload: Workload,
    backend: Backend,
    random: SmallRng,
    home: Isometry3<f64>,
    goals: Writer<Goal>,
    chunks: ChunkWriter,
    deadman: Deadman,
    goal: Goal,
    turns: usize,
    /// Times of the next change of the goal, and of the next keep-alive of the deadman, `[ms]`.
    next: u64,
    beat: u64,
}

impl Guarded {
    /// Returns an arm in the ready pose with a running session.
    ///
    /// # Panics
    /// Panics if the motion does not begin.
    pub fn new(workload: Workload, seed: u64) -> Self {
        Self::begin(
            workload,
            workload.backend(seed),
            SmallRng::seed_from_u64(seed),
        )
    }

    /// Returns an arm whose session uses the given back end, with the goals of
    /// [`Workload::RobotController`].
    ///
    /// # Panics
    /// Panics if the motion does not begin.
    pub fn with_backend(backend: Backend, seed: u64) -> Self {
        let random = SmallRng::seed_from_u64(seed);
        Self::begin(Workload::RobotController, backend, random)
    }

    fn begin(workload: Workload, backend: Backend, random: SmallRng) -> Self {
        let mut lockstep = Lockstep::ready();
        let most = CollisionBehavior::uniform([1000.0; 7], [1000.0; 7], [1000.0; 6], [1000.0; 6]);
        lockstep.request(&Request::SetCollisionBehavior(most));
        lockstep.run(5);

        let version = lockstep.client.version();
        let home = lockstep.arm_pose();
        let (mut goals, reader) = triple_buffer();
        let (chunks, taken) = chunk_ring();
        let (deadman, monitor) = Deadman::new(SILENCE);
        let goal = Goal::new(GoalId(1), Target::Rest, OnArrival::Hold, limits());
        goals.write(goal);
        let session = TargetSession::new(Model::fr3().clone().into(), version, reader)
            .going_on()
            .out_of(regions(&home))
            .with_backend(backend)
            .bound_to(monitor)
            .with_chunks(taken);
        let request = backend.request(version);
        lockstep
            .control(Program::Target(Box::new(session)), request)
            .expect("nothing else moves");
        lockstep.run(20);
        let mut this = Self {
            lockstep,
            bound: HashSet::new(),
            fates: Vec::new(),
            stops: 0,
            workload,
            backend,
            random,
            home,
            goals,
            chunks,
            deadman,
            goal,
            turns: 0,
            next: 0,
            beat: 0,
        };
        assert!(this.is_running(), "the motion begins");
        this.submit(Target::Pose(home));
        this
    }

    /// Advances by one millisecond, like [`Lockstep::tick_around`].
    ///
    /// # Panics
    /// Panics if the session does not begin again after the robot has stopped the arm.
    pub fn tick_around(&mut self, around: impl FnMut(Part, &mut dyn FnMut())) {
        let now = self.lockstep.now();
        if now >= self.beat {
            self.deadman.keep_alive();
            let most = if self.random.random_bool(0.01) { 8 } else { 1 };
            self.beat = now + most * 20;
        }
        if now >= self.next {
            let pause = self.random.random_bool(0.08);
            let wait = if pause { 350..700 } else { 5..250 };
            self.next = now + self.random.random_range(wait);
            self.disturb();
            self.change_course();
        }
        self.lockstep.tick_around(around);
        while let Some(returned) = self.chunks.collect() {
            self.fates.push(returned.fate);
        }
        for guard in self.lockstep.client.record.bindings.iter() {
            assert!(
                self.backend.has(guard),
                "{:?} has no {guard:?}",
                self.backend
            );
            self.bound.insert(guard);
        }
        if !self.is_running() {
            let again = Self::begin(self.workload, self.backend, self.random.clone());
            let before = std::mem::replace(self, again);
            self.bound = before.bound;
            self.fates = before.fates;
            self.stops = before.stops + 1;
        }
    }

    fn is_running(&self) -> bool {
        self.lockstep.client.record.activity == Activity::Running
    }

    /// Pushes the arm at random.
    fn disturb(&mut self) {
        let (often, most) = match self.workload {
            Workload::Guide => (0.5, 8.0),
            _ => (0.1, 25.0),
        };
        if self.random.random_bool(often) {
            let force = self.vector(most);
            let push = Wrench::new(force.x, force.y, force.z, 0.0, 0.0, 0.0);
            let lasting = self.random.random_range(20..200);
            self.lockstep.robot.push_end_effector(push, lasting);
        }
    }

    fn change_course(&mut self) {
        match self.workload {
            Workload::Poses => {
                let pose = self.pose();
                self.go_to(Target::Pose(pose));
            }
            Workload::Joints => {
                let q = self.joints();
                self.go_to(Target::Joints(q));
            }
            Workload::Chunks => self.send_chunk(),
            Workload::Guide if self.random.random_bool(0.2) => self.submit(Target::Pose(self.home)),
            Workload::Guide => {
                let free = Free {
                    axes: core::array::from_fn(|_| self.random.random_bool(0.7)),
                    elbow: self.random.random_bool(0.3),
                };
                self.submit(Target::Guide(free));
            }
            Workload::RobotController => {
                let target = if self.backend.is_cartesian() || self.random.random_bool(0.5) {
                    Target::Pose(self.pose())
                } else {
                    Target::Joints(self.joints())
                };
                self.go_to(target);
            }
        }
    }

    /// Submits the target as a new goal, or as an update of the previous goal.
    fn go_to(&mut self, target: Target) {
        let alike = core::mem::discriminant(&target) == core::mem::discriminant(&self.goal.target);
        if alike && self.random.random_bool(0.5) {
            self.goal.target = target;
            self.goal.revision += 1;
            self.goals.write(self.goal);
        } else {
            self.submit(target);
        }
    }

    fn submit(&mut self, target: Target) {
        let id = GoalId(self.goal.id.0 + 1);
        self.turns += 1;
        let on_timeout = if self.turns.is_multiple_of(2) {
            OnTimeout::Hold
        } else {
            OnTimeout::Brake
        };
        let goal = Goal {
            force_cap: match self.backend {
                Backend::Torques => ForceCap::Newtons(FORCE_CAP),
                _ => ForceCap::Default,
            },
            lead: Some(LEAD),
            watchdog: Some(Watchdog {
                silence: SILENT_STREAM,
                on_timeout,
            }),
            ..Goal::new(id, target, OnArrival::Hold, limits())
        };
        let goal = match self.random.random_bool(0.3) {
            true => Goal {
                target: set_in_motion(target, &mut self.random),
                ..goal
            },
            false => goal,
        };
        let goal = Goal {
            reaction: self.reaction(),
            ..goal
        };
        self.goal = match (self.turns % 3, target) {
            (0, _) | (_, Target::Guide(_)) => goal,
            (1, _) => Goal {
                gains: Gains {
                    law: Law::OperationalSpace,
                    ..Gains::cartesian()
                },
                ..goal
            },
            _ => Goal {
                gains: Gains {
                    project_joint_gains: true,
                    feedforward_cutoff: 50.0,
                    ..Gains::cartesian()
                },
                on_arrival: OnArrival::ReportAndHold,
                target,
                paused: self.random.random_bool(0.2),
                ..goal
            },
        };
        self.goals.write(self.goal);
    }

    /// Sometimes returns a reaction: a condition that soon becomes true, and a stop or another
    /// target.
    fn reaction(&mut self) -> Option<Reaction> {
        if self.random.random_bool(0.75) {
            return None;
        }
        let time = Duration::from_millis(self.random.random_range(0..300));
        let pushed = force(15.0).relative().held_for(Duration::from_millis(20));
        let condition = pushed | (Quantity::Speed.above(0.1) & elapsed(time));
        Some(match self.random.random_range(0..3) {
            0 => condition.into(),
            1 if !self.backend.is_cartesian() => condition.then(self.joints()),
            _ => condition.then(self.pose()),
        })
    }

    /// Sends a chunk of many points from the arm's position to a random target.
    fn send_chunk(&mut self) {
        if self.random.random_bool(0.15) {
            self.submit(Target::Rest);
        }
        let count = self.random.random_range(2..40_u32);
        let apart = Duration::from_millis(self.random.random_range(20..60));
        let share = |k: u32| f64::from(k) / f64::from(count - 1);
        let chunk = if self.random.random_bool(0.5) {
            let start = JointVector::from(self.lockstep.client.record.q_ref);
            let way = JointVector::from(self.joints()) - start;
            Chunk::joints((0..count).map(|k| (apart * k, (start + way * share(k)).into())))
        } else {
            let (start, end) = (self.lockstep.reference_pose(), self.pose());
            Chunk::poses((0..count).map(|k| (apart * k, start.lerp_slerp(&end, share(k)))))
        };
        let mut chunk = chunk.expect("finite points in the order of their times");
        if self.random.random_bool(0.5) {
            let seen = self.random.random_range(0..60);
            chunk = chunk.observed_at(self.lockstep.client.state.message_id - seen);
        }
        if self.random.random_bool(0.25) {
            chunk = chunk.replace();
        }
        // Sometimes sends two chunks at once, of which the second replaces the first. The queue has
        // room for them, because unused chunks return in the next cycle.
        let times = if self.random.random_bool(0.1) { 2 } else { 1 };
        for chunk in std::iter::repeat_n(chunk, times) {
            let sent = self.chunks.send(self.goal.id, chunk);
            sent.expect("there is room");
        }
    }

    fn pose(&mut self) -> Isometry3<f64> {
        let (way, turn) = (self.vector(0.08), self.vector(0.2));
        Isometry3::from_parts(
            Translation3::from(self.home.translation.vector + way),
            UnitQuaternion::from_scaled_axis(turn) * self.home.rotation,
        )
    }

    fn joints(&mut self) -> [f64; 7] {
        core::array::from_fn(|i| READY[i] + self.random.random_range(-0.2..0.2))
    }

    fn vector(&mut self, most: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.random.random_range(-most..most))
    }
}

fn limits() -> &'static JointLimits {
    Model::fr3().joint_limits()
}

/// A floor, a wall, a table and a shelf. The arm can reach the wall, the table and the shelf.
fn regions(home: &Isometry3<f64>) -> KeepOut {
    let at = home.translation;
    let (x, y, z) = (at.x, at.y, at.z);
    let block = |x, y, z, half| Obstacle::Box {
        pose: Isometry3::translation(x, y, z),
        half,
    };
    [
        Some(Obstacle::floor(-0.05)),
        Some(Obstacle::Plane {
            normal: UnitVector3::new_normalize(-Vector3::y()),
            offset: -(y + 0.25),
        }),
        Some(block(x, y, z - 0.14, Vector3::new(0.1, 0.1, 0.05))),
        Some(block(x + 0.4, y, z, Vector3::new(0.25, 0.4, 0.2))),
    ]
}

/// Timeouts of the deadman and of a stream.
const SILENCE: Duration = Duration::from_millis(100);
const SILENT_STREAM: Duration = Duration::from_millis(300);

/// Force limit, `[N]`, so low that the guard intervenes.
const FORCE_CAP: f64 = 20.0;

/// Limit on the distance between reference and arm, so small that the guard intervenes.
const LEAD: Lead = Lead {
    translation: 0.05,
    rotation: 0.2,
    joints: 0.1,
};
