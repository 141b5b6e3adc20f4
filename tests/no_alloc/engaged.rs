//! Sessions that go from goal to goal: every kind of goal under every guard, and every order of
//! their owners. A panic of an observer is not included: the runtime allocates for a panic before
//! it can be caught.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use franka_lockstep::{Guarded, Lockstep, Part, Workload};
use franka_model::{READY, Wrench};
use franka_proto::RobotMode;
use franka_rt::driver::Observer;
use franka_rt::law::{Gains, Law};
use franka_rt::lifecycle::{Engagement, Tuning};
use franka_rt::session::{
    Backend, Chunk, Deadman, Deviation, Fate, Free, Goal, GoalId, Guard, Leash, OnArrival,
    OnTimeout, Target, Watchdog, Waypoint,
};
use nalgebra::Translation3;

use crate::calls_during;

/// Milliseconds of each kind of goal.
const CYCLES: u64 = 30_000;

#[test]
fn goals_under_every_guard_never_call_the_allocator() {
    for (workload, seed) in Workload::ALL
        .map(|workload| (workload, 0))
        .into_iter()
        .chain((1..8).map(|seed| (Workload::RobotController, seed)))
    {
        let mut arm = Guarded::new(workload, seed);
        let (mut cycles, mut calls) = (0, 0);
        while cycles < CYCLES {
            arm.tick_around(|part, work| {
                calls += calls_during(work);
                cycles += u64::from(part == Part::Answer);
            });
        }
        let bound = &arm.bound;
        println!("{workload:?}: {bound:?}");
        for guard in [
            Guard::Watchdog,
            Guard::Deadman,
            Guard::Clearance,
            Guard::Reaction,
        ] {
            let watched = workload != Workload::Guide || guard != Guard::Clearance;
            assert!(
                !watched || bound.contains(&guard),
                "{workload:?}: {bound:?}"
            );
        }
        if matches!(workload, Workload::Poses | Workload::Joints) {
            for guard in [Guard::ForceCap, Guard::Lead, Guard::Leash] {
                assert!(bound.contains(&guard), "{workload:?}: {bound:?}");
            }
        }
        if workload == Workload::Chunks {
            for fate in [
                Fate::Replaced,
                Fate::Ended,
                Fate::Obsolete,
                Fate::Superseded,
            ] {
                assert!(arm.fates.contains(&fate), "no chunk is {fate:?}");
            }
        }
        assert!(arm.stops <= 3, "{workload:?}: {} reflexes", arm.stops);
        assert_eq!(calls, 0, "{workload:?}, seed {seed}");
    }
}

/// A session, and the number of calls of the allocator in the thread's work.
struct Engaged {
    lockstep: Lockstep,
    id: GoalId,
    calls: u64,
    /// The number of cycles that the observer has seen.
    seen: Arc<AtomicU64>,
    token: Option<Deadman>,
}

impl Engaged {
    fn with(backend: Backend) -> Self {
        let seen = Arc::new(AtomicU64::new(0));
        let count = seen.clone();
        let observer = move |_: &_, _: &_| {
            count.fetch_add(1, Ordering::Relaxed);
        };
        let (token, monitor) = Deadman::new(Duration::from_millis(100));
        let mut lockstep = Lockstep::ready();
        let id = lockstep.engage_with(Engagement {
            deadman: Some(monitor),
            backend,
            observer: Some(Observer::new(observer)),
            ..Engagement::default()
        });
        Self {
            lockstep,
            id,
            calls: 0,
            seen,
            token: Some(token),
        }
    }

    /// Runs for this many milliseconds, in which the deadman is kept alive.
    fn run(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            if let Some(token) = &self.token {
                token.keep_alive();
            }
            self.tick();
        }
    }

    fn tick(&mut self) {
        let Self {
            lockstep, calls, ..
        } = self;
        lockstep.tick_around(|_, work| *calls += calls_during(work));
    }

    fn go(&mut self, target: Target, on_arrival: OnArrival) -> GoalId {
        let goal = self.lockstep.within(self.id, target, on_arrival);
        goal.expect("the session accepts it")
    }

    fn binds(&self, guard: Guard) -> bool {
        self.lockstep.client.record.bindings.contains(guard)
    }
}

fn turned(by: f64) -> Target {
    let mut q = READY;
    q[0] += by;
    Target::Joints(q.into())
}

#[test]
fn sessions_under_any_order_never_call_the_allocator() {
    for backend in [Backend::Torques]
        .into_iter()
        .chain(Backend::ROBOT_CONTROLLERS)
    {
        let mut engaged = Engaged::with(backend);
        let home = engaged.lockstep.arm_pose();
        let up = Target::Pose(Translation3::new(0.0, 0.0, 0.05) * home);
        let poses = backend.is_cartesian();
        let there = if poses { up } else { turned(0.2) };

        // Superseded in mid-motion, then reached.
        for target in [up, there, Target::Pose(home)] {
            engaged.go(target, OnArrival::Hold);
            engaged.run(300);
        }
        let goal = engaged.go(there, OnArrival::ReportAndHold);
        engaged.run(4000);
        assert!(matches!(engaged.lockstep.client.outcome(goal), Some(Ok(_))));

        if backend == Backend::Torques {
            engaged.go(Target::Guide(Free::ALL), OnArrival::Hold);
            engaged.run(400);
            let push = Wrench::new(4.0, 4.0, 0.0, 0.0, 0.0, 0.0);
            engaged.lockstep.robot.push_end_effector(push, 300);
            engaged.run(500);
        }
        // Chunks of poses through the robot's own inverse kinematics are left out: they may reach a
        // jerk limit of the joints.
        if !poses {
            let q = engaged.lockstep.client.record.q_ref;
            for way in [0.05, -0.05] {
                let points = (0..10).map(|k| {
                    let share = f64::from(k) / 9.0;
                    (Duration::from_millis(50) * k, q.map(|q| q + way * share))
                });
                let chunk = Chunk::joints(points).expect("finite points");
                let taken = engaged.lockstep.chunk(engaged.id, chunk);
                taken.expect("the session accepts it");
                engaged.run(300);
            }
            engaged.run(1500);
            let waypoint = |way: f64| Waypoint::new(q.map(|q| q + way)).blend(0.02);
            let through = [0.03, -0.03, 0.0].map(waypoint);
            let path = engaged.lockstep.through(Some(engaged.id), &through);
            let path = path.expect("in range");
            for paused in [true, false] {
                engaged.run(200);
                engaged.lockstep.client.lifecycle.pause(path, paused);
            }
            engaged.run(2500);
            assert!(matches!(engaged.lockstep.client.outcome(path), Some(Ok(_))));
        }
        // Tuned in mid-motion.
        let mut elbow_out = engaged.lockstep.client.record.q;
        elbow_out[2] -= 0.2;
        engaged.go(up, OnArrival::Hold);
        engaged.run(100);
        let tuning = Tuning {
            gains: Some(Gains {
                law: Law::OperationalSpace,
                torque_cutoff: 1000.0,
                ..Gains::cartesian()
            }),
            budget: None,
            leash: Some(Leash::LEAST),
            deviation: Some(Deviation::default()),
            posture: Some(elbow_out),
            ..Tuning::default()
        };
        let tuned = engaged.lockstep.tune(engaged.id, tuning);
        tuned.expect("gains within their bounds");
        engaged.run(500);

        // A stream that times out, with both reactions.
        for on_timeout in [OnTimeout::Hold, OnTimeout::Brake] {
            let goal = Goal {
                watchdog: Some(Watchdog {
                    silence: Duration::from_millis(100),
                    on_timeout,
                }),
                ..engaged.lockstep.goal(Target::Pose(home), OnArrival::Hold)
            };
            let id = engaged.id;
            let goal = engaged.lockstep.submit_within(id, goal);
            goal.expect("the session accepts it");
            engaged.run(400);
            assert!(engaged.binds(Guard::Watchdog));
        }

        // A deadman that times out, is kept alive again, and is dropped.
        engaged.go(up, OnArrival::Hold);
        for _ in 0..300 {
            engaged.tick();
        }
        assert!(engaged.binds(Guard::Deadman));
        engaged.run(1);
        engaged.go(up, OnArrival::Hold);
        engaged.run(200);
        assert!(!engaged.binds(Guard::Deadman));
        engaged.token = None;
        engaged.run(400);
        assert!(engaged.binds(Guard::Deadman));

        let seen = engaged.seen.load(Ordering::Relaxed);
        engaged.run(100);
        assert_eq!(engaged.seen.load(Ordering::Relaxed) - seen, 100);
        engaged.lockstep.disengage(engaged.id);
        engaged.run(1500);
        assert!(engaged.lockstep.client.outcome(engaged.id).is_some());
        assert_eq!(engaged.lockstep.client.state.robot_mode, RobotMode::Idle);
        assert_eq!(engaged.calls, 0, "{backend:?}");
    }
}
