//! Two robots whose motions begin together, both in one thread, millisecond by millisecond.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use franka_lockstep::{Lockstep, outcomes_of, turned};
use franka_model::{READY, RobotKind};
use franka_proto::{MoveControllerMode, Request, RobotMode, Version};
use franka_rt::control::{
    Callback, CartesianPose, Finish, JointPositions, JointVelocities, Torques,
};
use franka_rt::driver::Activity;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{Goal, GoalId, OnArrival, OnTimeout, Target, Watchdog};
use franka_rt::together::{StartBarrier, StartFault, StartTicket};
use nalgebra::Translation3;

/// An FR3 and an FER, in the order of their tickets. Their milliseconds alternate.
struct Two {
    left: Lockstep,
    right: Lockstep,
}

impl Two {
    fn new() -> Self {
        let left = Lockstep::ready_of(RobotKind::Fr3);
        let right = Lockstep::ready_of(RobotKind::Fer);
        Self { left, right }
    }

    fn tick(&mut self) {
        self.left.tick();
        self.right.tick();
    }

    fn run(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.tick();
        }
    }

    /// Runs until both goals are resolved.
    fn until_resolved(
        &mut self,
        (left, right): (GoalId, GoalId),
        most: u64,
    ) -> [Result<(), MotionError>; 2] {
        for _ in 0..most {
            let ended = outcomes_of([&self.left, &self.right], [left, right]);
            if let Some(outcomes) = ended {
                return outcomes;
            }
            self.tick();
        }
        panic!("unresolved after {most} ms");
    }
}

fn submit(robot: &mut Lockstep, target: Target, ticket: StartTicket) -> GoalId {
    let goal = robot.goal(target, OnArrival::ReportAndFinish);
    robot.submit_together(goal, ticket).expect("it is free")
}

/// The distance of the joints from where they began, `[rad]`.
fn moved(robot: &Lockstep) -> f64 {
    (robot.robot.q() - READY).amax()
}

#[test]
fn goals_begin_in_the_same_millisecond_after_any_delay() {
    for late in [0, 1, 137, 4000] {
        let mut two = Two::new();
        let [left, right] = StartBarrier::new().tickets();
        let up = Translation3::new(0.0, 0.0, 0.05) * two.left.arm_pose();
        let first = submit(&mut two.left, Target::Pose(up), left);
        two.run(late);
        assert!(
            moved(&two.left) < 1e-6,
            "the arm is held: {}",
            moved(&two.left)
        );
        if late > 20 {
            assert_eq!(two.left.client.record.activity, Activity::Waiting);
            assert_eq!(two.left.robot.state().robot_mode, RobotMode::Move);
        }
        let second = submit(&mut two.right, turned(0.1), right);
        let mut began = [None; 2];
        for ms in 0..100 {
            two.tick();
            for (robot, began) in [&two.left, &two.right].into_iter().zip(&mut began) {
                if robot.client.record.dq_ref != [0.0; 7] {
                    began.get_or_insert(ms);
                }
            }
        }
        let [Some(left), Some(right)] = began else {
            panic!("both have begun: {began:?}")
        };
        assert!(u32::abs_diff(left, right) <= 1, "{late} ms late: {began:?}");
        let outcomes = two.until_resolved((first, second), 10_000);
        assert_eq!(outcomes, [Ok(()), Ok(())]);
        let report = two.left.client.outcome(first).expect("resolved");
        let duration = report.as_ref().expect("it arrived").duration;
        assert!(
            duration < Duration::from_secs(4),
            "the wait does not count: {duration:?}"
        );
        assert!(moved(&two.right) > 0.09);
    }
}

#[test]
fn robot_that_never_begins_ends_the_other_and_is_named() {
    type Taking = fn(&mut Two, StartTicket);
    let ways: [(&str, Taking, StartFault); 3] = [
        (
            "dropped",
            |_, right| drop(right),
            StartFault::Dropped { member: 1 },
        ),
        (
            "refused",
            |two, right| {
                let goal = two.right.goal(turned(9.0), OnArrival::ReportAndFinish);
                let refused = two.right.submit_together(goal, right);
                assert!(matches!(refused, Err(MotionError::Goal(_))), "{refused:?}");
            },
            StartFault::Dropped { member: 1 },
        ),
        (
            "rejected by the robot",
            |two, right| {
                two.right.robot.press_user_stop(true);
                two.right.run(5);
                let goal = submit(&mut two.right, turned(0.1), right);
                let outcome = two.right.until_resolved(goal, 1000);
                assert!(
                    matches!(outcome, Err(MotionError::Rejected(_))),
                    "{outcome:?}"
                );
            },
            StartFault::Ended { member: 1 },
        ),
    ];
    for (way, take, fault) in ways {
        let mut two = Two::new();
        let [left, right] = StartBarrier::new().tickets();
        let goal = submit(&mut two.left, turned(0.1), left);
        two.run(200);
        take(&mut two, right);
        let outcome = two.left.until_resolved(goal, 2000);
        assert_eq!(outcome.map(drop), Err(MotionError::Start(fault)), "{way}");
        assert!(moved(&two.left) < 1e-6, "{way}: {}", moved(&two.left));
        // The robot is ready for the next motion.
        let again = two.left.begin(turned(0.1));
        let outcome = two.left.until_resolved(again, 10_000);
        outcome.unwrap_or_else(|error| panic!("{way}: {error}"));
    }
}

#[test]
fn a_robot_that_leaves_while_waiting_ends_the_others_motion() {
    let member = 0;
    type Leaving = fn(&mut Lockstep, GoalId);
    let ways: [(&str, Leaving, StartFault); 5] = [
        (
            "taken back",
            |left, goal| left.cancel(goal),
            StartFault::Withdrawn { member },
        ),
        (
            "stopped",
            |left, _| {
                let stopping = left.stop();
                stopping.expect("a motion runs");
            },
            StartFault::Withdrawn { member },
        ),
        (
            "superseded",
            |left, _| {
                left.begin(turned(-0.1));
            },
            StartFault::Withdrawn { member },
        ),
        (
            "a user stop",
            |left, _| {
                left.robot.press_user_stop(true);
            },
            StartFault::Ended { member },
        ),
        (
            "silence",
            |left, _| left.link.drop_states(1500),
            StartFault::Ended { member },
        ),
    ];
    for (way, leave, fault) in ways {
        let mut two = Two::new();
        let [left, right, third] = StartBarrier::new().tickets();
        let first = submit(&mut two.left, turned(0.1), left);
        let second = submit(&mut two.right, turned(0.1), right);
        two.run(100);
        leave(&mut two.left, first);
        let [left, right] = two.until_resolved((first, second), 5000);
        assert_eq!(right, Err(MotionError::Start(fault)), "{way}");
        assert!(
            left.is_err() && left != right,
            "its own error names the cause: {left:?}"
        );
        assert!(moved(&two.right) < 1e-6, "{way}: {}", moved(&two.right));
        // A robot that joins after that is refused at once.
        two.right.until_idle(2000);
        let goal = two.right.goal(turned(0.1), OnArrival::ReportAndFinish);
        let refused = two.right.submit_together(goal, third);
        assert_eq!(refused, Err(MotionError::Start(fault)), "{way}");
        if way == "superseded" {
            two.left.until_idle(10_000);
            assert!(moved(&two.left) > 0.09, "the goal in its place is reached");
        }
    }
}

#[test]
fn waiting_ends_at_the_timeout() {
    let mut two = Two::new();
    let waited = Duration::from_millis(700);
    let [left, right] = StartBarrier::new().timeout(waited).tickets();
    let goal = submit(&mut two.left, turned(0.1), left);
    let outcome = two.left.until_resolved(goal, 1500);
    let fault = StartFault::TimedOut {
        present: 1,
        members: 2,
        waited,
    };
    assert_eq!(outcome.map(drop), Err(MotionError::Start(fault)));
    assert_eq!(right.fault(), Some(fault));
    assert!(moved(&two.left) < 1e-6);
}

#[test]
fn a_motion_with_a_ticket_supersedes_nothing() {
    let mut two = Two::new();
    let [left, right] = StartBarrier::new().tickets();
    let running = two.left.begin(turned(0.2));
    two.run(100);
    let goal = two.left.goal(turned(0.1), OnArrival::ReportAndFinish);
    let refused = two.left.submit_together(goal, left);
    assert_eq!(refused, Err(MotionError::Busy));
    assert_eq!(right.fault(), Some(StartFault::Dropped { member: 0 }));
    two.left
        .until_resolved(running, 10_000)
        .expect("it goes on");
}

#[test]
fn target_that_moves_during_the_wait_is_followed() {
    let mut two = Two::new();
    let [left, mut right] = StartBarrier::new().tickets();
    let goal = two.left.goal(turned(0.1), OnArrival::Hold);
    let goal = two.left.submit_together(goal, left).expect("it is free");
    two.run(100);
    assert_eq!(two.left.update(goal, turned(-0.1)), Ok(true));
    two.run(300);
    assert!(moved(&two.left) < 1e-6, "{}", moved(&two.left));
    right.pass(0);
    two.run(3000);
    let turn = two.left.robot.q()[0] - READY[0];
    assert!((turn + 0.1).abs() < 2e-3, "{turn}");
    two.left.client.lifecycle.close(goal);
    two.left.until_resolved(goal, 3000).expect("it settles");
}

#[test]
fn waiting_for_the_others_does_not_time_out_a_stream() {
    let mut two = Two::new();
    let [left, mut right] = StartBarrier::new().tickets();
    let goal = Goal {
        watchdog: Some(Watchdog {
            silence: Duration::from_millis(100),
            on_timeout: OnTimeout::Brake,
        }),
        ..two.left.goal(turned(0.1), OnArrival::Hold)
    };
    let goal = two.left.submit_together(goal, left).expect("it is free");
    two.run(2000);
    assert_eq!(two.left.client.outcome(goal), None, "it waits");
    right.pass(0);
    two.run(20);
    assert_eq!(two.left.client.record.goal, goal.0, "it has begun");
}

/// A control function of each kind that swings a little for half a second, and records when it was
/// first called.
fn functions(version: Version, called: &Arc<AtomicU64>) -> Vec<(&'static str, Callback)> {
    let swing = |time: f64| {
        let there_and_back = 0.5 * (1.0 - (std::f64::consts::TAU * 2.0 * time).cos());
        0.02 * there_and_back.powi(2) // neither velocity nor acceleration at either end
    };
    let clock = || {
        let (called, time) = (called.clone(), Cell::new(0.0));
        move |state: u64, step: Duration| {
            if called.load(Ordering::Relaxed) == 0 {
                assert_eq!(step, Duration::ZERO, "the first call");
                called.store(state, Ordering::Relaxed);
            }
            time.set(time.get() + step.as_secs_f64());
            time.get()
        }
    };
    let (positions, velocities, poses, torques) = (clock(), clock(), clock(), clock());
    let (mut q, mut pose) = (None, None);
    vec![
        (
            "joint positions",
            Callback::motion::<JointPositions, _>(version, move |state, step| {
                let time = positions(state.message_id, step);
                let mut q = *q.get_or_insert(state.q_d);
                q[0] += swing(time);
                JointPositions(q).finish_if(time >= 0.5)
            }),
        ),
        (
            "joint velocities",
            Callback::motion::<JointVelocities, _>(version, move |state, step| {
                let time = velocities(state.message_id, step);
                let mut dq = [0.0; 7];
                dq[6] = swing(time);
                JointVelocities(dq).finish_if(time >= 0.5)
            }),
        ),
        (
            "poses",
            Callback::motion::<CartesianPose, _>(version, move |state, step| {
                let time = poses(state.message_id, step);
                let mut pose = *pose.get_or_insert(state.O_T_EE_c);
                pose[14] += swing(time);
                let elbow = None;
                CartesianPose {
                    O_T_EE: pose,
                    elbow,
                }
                .finish_if(time >= 0.5)
            }),
        ),
        (
            "torques",
            Callback::torques(version, move |state, step| {
                let time = torques(state.message_id, step);
                let mut tau = state.dq.map(|dq| -2.0 * dq);
                tau[6] += 20.0 * swing(time);
                Torques(tau).finish_if(time >= 0.5)
            }),
        ),
    ]
}

#[test]
fn control_function_is_not_called_before_the_others_join() {
    for kind in RobotKind::ALL {
        for nth in 0..4 {
            let called = Arc::new(AtomicU64::new(0));
            let mut lockstep = Lockstep::ready_of(kind);
            let version = lockstep.client.version();
            let (name, callback) = functions(version, &called).swap_remove(nth);
            let [own, mut other] = StartBarrier::new().tickets();
            let request = callback.request(version, MoveControllerMode::JointImpedance);
            let work = lockstep
                .control_together(callback, request, own)
                .unwrap_or_else(|error| panic!("{name}: {error}"));
            lockstep.run(500);
            assert_eq!(lockstep.client.record.activity, Activity::Waiting, "{name}");
            assert_eq!(called.load(Ordering::Relaxed), 0, "{name} was not called");
            assert!(moved(&lockstep) < 1e-3, "{name}: {}", moved(&lockstep));
            let rate = lockstep.robot.state().control_command_success_rate;
            assert!(rate > 0.99, "every state is answered: {rate}");
            other.pass(0);
            let opened = lockstep.client.state.message_id;
            let report = lockstep.until_resolved(work, 3000);
            report.unwrap_or_else(|error| panic!("{kind:?}, {name}: {error}"));
            assert_eq!(
                called.load(Ordering::Relaxed),
                opened + 1,
                "{name}: with the next state"
            );
        }
    }
}

#[test]
fn a_control_function_is_never_called_if_the_others_do_not_join() {
    for kind in RobotKind::ALL {
        for nth in 0..4 {
            let called = Arc::new(AtomicU64::new(0));
            let mut lockstep = Lockstep::ready_of(kind);
            let version = lockstep.client.version();
            let (name, callback) = functions(version, &called).swap_remove(nth);
            let [own, other] = StartBarrier::new().tickets();
            let request = callback.request(version, MoveControllerMode::CartesianImpedance);
            let work = lockstep
                .control_together(callback, request, own)
                .unwrap_or_else(|error| panic!("{name}: {error}"));
            lockstep.run(300);
            drop(other);
            let outcome = lockstep.until_resolved(work, 3000);
            let fault = StartFault::Dropped { member: 1 };
            assert_eq!(
                outcome.map(drop),
                Err(MotionError::Start(fault)),
                "{kind:?}, {name}"
            );
            assert_eq!(called.load(Ordering::Relaxed), 0, "{name} was not called");
            // A robot with an error would refuse this request.
            lockstep.request(&Request::AutomaticErrorRecovery);
            lockstep.run(50);
            assert_eq!(lockstep.robot.state().robot_mode, RobotMode::Idle, "{name}");
        }
    }
}
