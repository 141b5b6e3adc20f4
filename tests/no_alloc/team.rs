//! Two sessions of one team: joint motions, stops, and the end of one of them.

use franka_model::READY;
use franka_rt::lifecycle::Engagement;
use franka_rt::session::{Goal, Guard, OnArrival, Target};
use franka_rt::team::team;
use franka_tests::lockstep::Lockstep;

use crate::calls_during;

/// Joint motions, each of which is stopped, taken back or comes to its end.
const ROUNDS: u64 = 60;

#[test]
fn joint_motions_and_their_stops_allocate_and_free_nothing() {
    let (coordinator, members) = team::<2>();
    let mut sessions = members.map(|member| {
        let mut robot = Lockstep::ready();
        let id = robot.engage_with(Engagement {
            team: Some(member),
            ..Engagement::default()
        });
        (robot, id)
    });
    let (mut calls, mut cycles, mut braked) = (0, 0, 0);
    let mut run = |sessions: &mut [(Lockstep, _); 2], milliseconds: u64| {
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
