//! Two sessions of one team: joint motions, stops, and the end of one of them.

use franka_lockstep::Lockstep;
use franka_model::READY;
use franka_rt::lifecycle::Engagement;
use franka_rt::session::{ForceCap, Goal, GoalId, Guard, OnArrival, Target};
use franka_rt::team::{Coordinator, team};
use franka_sim::Touch;
use nalgebra::{Isometry3, Translation3, Vector3};

use crate::calls_during;

/// Number of joint motions, each of which is stopped, is cancelled or ends.
const ROUNDS: u64 = 60;

type Session = (Lockstep, GoalId);

fn two() -> (Coordinator, [Session; 2]) {
    let (coordinator, members) = team::<2>();
    let sessions = members.map(|member| {
        let mut robot = Lockstep::ready();
        let id = robot.engage_with(Engagement {
            team: Some(member),
            ..Engagement::default()
        });
        (robot, id)
    });
    (coordinator, sessions)
}

#[test]
fn joint_motions_and_their_stops_allocate_and_free_nothing() {
    let (coordinator, mut sessions) = two();
    let (mut calls, mut cycles, mut braked) = (0, 0, 0);
    let mut run = |sessions: &mut [Session; 2], milliseconds: u64| {
        for _ in 0..milliseconds {
            for (robot, _) in &mut *sessions {
                robot.tick_around(|_, work| calls += calls_during(work));
                let bindings = robot.client.record.bindings;
                braked += u64::from(bindings.contains(Guard::Team));
                cycles += 1;
            }
        }
    };
    for number in 0..ROUNDS {
        let round = Some(coordinator.begin());
        let mut q = READY;
        q[0] += if number % 2 == 0 { 0.1 } else { -0.1 };
        for (robot, session) in &mut sessions {
            let goal = robot.goal(Target::Joints(q.into()), OnArrival::ReportAndHold);
            let taken = robot.submit_within(*session, Goal { round, ..goal });
            let goal = taken.expect("the session takes it");
            if number % 5 == 3 {
                robot.cancel(goal);
            }
        }
        run(&mut sessions, 200);
        if number % 5 == 2 {
            coordinator.stop();
        }
        run(&mut sessions, 500 + 1500 * u64::from(number % 5 == 1));
    }
    sessions[0].0.robot.press_user_stop(true);
    run(&mut sessions, 500);
    assert!(braked > 1000, "{braked} cycles under the stop of the team");
    assert!(cycles > 50_000, "{cycles}");
    assert_eq!(calls, 0);
}

/// Times that an object is carried up, and down again.
const CARRIED: u64 = 20;

/// Both carry an object, one of them against a wall for a while: it lags, and the other one halts
/// and continues. Some motions are stopped, cancelled, or superseded by the next.
#[test]
fn carrying_an_object_allocates_and_frees_nothing() {
    let (coordinator, mut sessions) = two();
    let (mut calls, mut halted, mut arrived) = (0, 0, 0);
    let grasp = Isometry3::translation(0.05, 0.0, 0.1);
    let start = [0, 1].map(|i: usize| sessions[i].0.arm_pose() * grasp);
    for number in 0..CARRIED {
        let up = if number % 2 == 0 { 0.06 } else { 0.0 };
        let round = Some(coordinator.begin());
        let against = number % 4 == 0;
        let mut wall = against.then(|| {
            let robot = &mut sessions[0].0.robot;
            let hand = robot.true_pose().translation.vector;
            let wall = Touch::wall(hand + Vector3::z() * 0.01, -Vector3::z());
            robot.touch(wall.stiffness(5000.0))
        });
        let goals = [0, 1].map(|i| {
            let (robot, session) = &mut sessions[i];
            let target = Target::Pose(Translation3::new(0.0, 0.0, up) * start[i]);
            let goal = Goal {
                round,
                grasp: Some(grasp),
                force_cap: ForceCap::Newtons(10.0),
                ..robot.goal(target, OnArrival::ReportAndHold)
            };
            let taken = robot.submit_within(*session, goal);
            taken.expect("the session takes it")
        });
        for ms in 0..3500 {
            match (number % 5, ms) {
                (2, 300) => coordinator.stop(),
                (3, 300) => sessions[1].0.cancel(goals[1]),
                // The next motion supersedes this one.
                (4, 300) => break,
                _ => {}
            }
            if let Some(wall) = wall.take_if(|_| ms == 1500) {
                assert!(sessions[0].0.robot.release(wall));
            }
            for (robot, _) in &mut sessions {
                robot.tick_around(|_, work| calls += calls_during(work));
            }
            // The other arm waits for the arm at the wall.
            let waits = &sessions[1].0.client;
            let rests = waits.record.dq_ref.iter().all(|dq| dq.abs() < 1e-3);
            let halts = waits.outcome(goals[1]).is_none() && rests;
            halted += u64::from(wall.is_some() && ms > 900 && halts);
        }
        if let Some(wall) = wall {
            assert!(sessions[0].0.robot.release(wall));
        }
        let outcomes = [0, 1].map(|i: usize| sessions[i].0.client.outcome(goals[i]));
        arrived += u64::from(outcomes.iter().all(|it| matches!(it, Some(Ok(_)))));
    }
    println!("halted for {halted} ms, arrived {arrived} times");
    assert!(halted > 500, "{halted} ms");
    assert!(arrived >= CARRIED / 3, "{arrived} times");
    assert_eq!(calls, 0);
}
