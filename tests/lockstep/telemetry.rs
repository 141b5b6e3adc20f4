//! The link statistics of a report match the link's events.

use std::collections::VecDeque;
use std::time::Duration;

use franka_lockstep::{Link, Lockstep, Outcome};
use franka_proto::Version;
use franka_rt::control::{Callback, Finish, Torques};
use franka_rt::session::Target;
use nalgebra::Translation3;

/// Runs until `goal` resolves, for at most `most` milliseconds. Returns the outcome, and the
/// success rates of the states that arrived while the motion ran.
fn watch(
    lockstep: &mut Lockstep,
    goal: franka_rt::session::GoalId,
    most: u64,
) -> (Outcome, Vec<f64>) {
    let mut rates = Vec::new();
    for _ in 0..most {
        if let Some(outcome) = lockstep.client.outcome(goal) {
            return (outcome.clone(), rates);
        }
        let before = lockstep.client.state.message_id;
        let ran = lockstep.client.driver.statistics().is_some();
        lockstep.tick();
        let runs = lockstep.client.driver.statistics().is_some();
        if (ran || runs) && lockstep.client.state.message_id > before {
            rates.push(lockstep.client.state.control_command_success_rate);
        }
    }
    panic!("goal {goal:?} is unresolved after {most} ms");
}

/// A program that commands zero torques for this many milliseconds of the robot's time.
fn nothing_for(milliseconds: u64) -> Callback {
    let mut time = Duration::ZERO;
    Callback::torques(Version::V10, move |_, step| {
        time += step;
        Torques([0.0; 7]).finish_if(time >= Duration::from_millis(milliseconds))
    })
}

#[test]
fn the_report_counts_the_states_that_the_link_drops() {
    let mut lockstep = Lockstep::ready();
    let id = lockstep.control_function(nothing_for(800));
    let id = id.expect("nothing else runs");
    lockstep.run(100);
    let mut dropped = 0;
    for (burst, pause) in [(1, 30), (3, 50), (7, 40), (2, 200)] {
        lockstep.link.drop_states(burst);
        dropped += burst;
        lockstep.run(burst + pause);
    }
    lockstep.link.drop_commands(4);
    let (outcome, _) = watch(&mut lockstep, id, 2000);
    let report = outcome.expect("the robot bridges such gaps");
    assert_eq!((report.lost_states, report.skipped_states), (dropped, 0));
    assert!(report.success_rate_min < 1.0, "{report:?}");
    // In virtual time, work has no duration.
    assert_eq!(report.overruns, 0);
    let interval = report.interval.expect("states came");
    assert_eq!(interval.max, Duration::from_millis(8));
    assert!(interval.p50 >= Duration::from_millis(1) && interval.p50 < Duration::from_micros(1063));
    let worst = report.worst_cycle.expect("commands left");
    assert_eq!(worst.total(), Duration::ZERO);
    assert_eq!(report.slack_min, Some(worst.slack));
    assert_eq!(worst.slack.left(), Some(Duration::from_millis(1)));
}

#[test]
fn the_success_rate_of_the_report_is_that_of_the_states() {
    for seed in 0..4 {
        let mut lockstep = Lockstep::ready();
        lockstep.link = Link::lossy(seed, 0.02, 0.02);
        let target = Translation3::new(0.04, 0.0, 0.02) * lockstep.arm_pose();
        let goal = lockstep.begin(Target::Pose(target));
        let (outcome, rates) = watch(&mut lockstep, goal, 8000);
        let report = outcome.unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let counted: Vec<f64> = rates.into_iter().filter(|&rate| rate > 0.0).collect();
        let least = counted.iter().copied().fold(1.0, f64::min);
        let mean = counted.iter().sum::<f64>() / counted.len() as f64;
        assert_eq!(report.success_rate_min, least, "seed {seed}");
        assert!(
            (report.success_rate_avg - mean).abs() < 1e-12,
            "seed {seed}: {mean}, {report:?}"
        );
        assert!(least < 1.0, "seed {seed}: nothing was lost");
    }
}

#[test]
fn states_superseded_by_a_newer_one_count_as_skipped() {
    let mut lockstep = Lockstep::ready();
    let id = lockstep.control_function(nothing_for(400));
    let id = id.expect("nothing else runs");
    lockstep.run(100);
    // As if the control thread found three states and answered the newest. Of five missing states,
    // two never arrived.
    let mut told = VecDeque::from([(5, 3), (2, 2), (1, 0)]);
    let (mut lost, mut skipped) = (0, 0);
    while let Some((missing, came)) = told.pop_front() {
        lockstep.link.drop_states(missing);
        lockstep.run(missing);
        lockstep.client.driver.on_skipped(came);
        lockstep.run(20);
        skipped += came;
        lost += missing - came;
    }
    let (outcome, _) = watch(&mut lockstep, id, 2000);
    let report = outcome.expect("the robot bridges such gaps");
    assert_eq!((report.lost_states, report.skipped_states), (lost, skipped));
}
