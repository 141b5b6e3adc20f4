//! Random schedules of goals, stops and faults, each replayable from its seed.
//!
//! At least every fourth schedule is calm: it has no faults, so no error may be reported. The
//! others lose datagrams, push the arm, trip the robot and press its user stop. In all of them
//! every goal resolves once, with an outcome that its events explain, the arm stops, and the next
//! motion works. The harness checks every command and its reference against the limits meanwhile.
//!
//! Ten thousand schedules take minutes with an optimised build, and some four times as long with
//! the MuJoCo plant. Each test is one thread. `FRANKA_SCHEDULE_SEED` is the first seed and
//! `FRANKA_SCHEDULES` the number of schedules:
//!
//! ```text
//! FRANKA_SCHEDULE_SEED=1 FRANKA_SCHEDULES=10000 cargo test --release --package franka-tests --test lockstep \
//!     session_schedules -- --nocapture
//! FRANKA_SCHEDULE_SEED=1 FRANKA_SCHEDULES=1000 cargo test --release --package franka-tests --features mujoco \
//!     --test lockstep mujoco_plant -- --nocapture
//! ```
//!
//! `motion_schedules` are the motions. A schedule that fails prints its seed, which replays it
//! with the same build.
//!
//! * `motions`: motions that supersede one another, each with a separate end.
//! * `sessions`: sessions that go from goal to goal, of all kinds, with both backends.
//!   `submission`: the permitted outcomes of each goal.
//! * `causes`: external events, and the robot's necessary reactions.
//! * `draw`: random goals.

mod causes;
mod draw;
mod motions;
mod sessions;
mod submission;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use franka_lockstep::{Lockstep, Outcome};
use franka_model::RobotKind;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::Lapse;
use franka_sim::Config;
use franka_sim::arm::{Arm, Family};

use motions::Motions;
use sessions::Sessions;

/// Schedules of motions in one run; each takes some five seconds of the robot's time.
const MOTIONS: u64 = 60;

/// Schedules of sessions in one run; each takes some two seconds of the robot's time.
const SESSIONS: u64 = 100;

/// The number of goals with each outcome, and the robot's time.
#[derive(Debug, Default)]
struct OutcomeCounts {
    outcomes: BTreeMap<&'static str, u64>,
    /// `[ms]`
    robot_time: u64,
    /// From a stop until it resolved, `[ms]`.
    longest_stop: u64,
}

impl OutcomeCounts {
    fn count(&mut self, outcome: &Outcome) {
        *self.outcomes.entry(kind(outcome)).or_default() += 1;
    }
}

#[test]
fn motion_schedules_resolve_all_goals_and_rest_the_arm() {
    run(MOTIONS, |seed, counts| {
        let mut schedule = Motions::new(seed);
        schedule.play();
        schedule.finish(counts);
    });
}

#[test]
fn session_schedules_resolve_all_goals_and_rest_the_arm() {
    run(SESSIONS, |seed, counts| {
        Sessions::play(seed, Lockstep::ready_of, counts);
    });
}

#[test]
fn schedules_of_sessions_also_end_on_arms_that_stick() {
    run(SESSIONS / 2, |seed, counts| {
        Sessions::play(seed, |kind| sticking(kind, seed), counts);
    });
}

#[test]
fn an_arm_that_was_stopped_rests_until_the_next_request() {
    run(SESSIONS / 2, |seed, counts| {
        Sessions::play_with_stops(seed, |kind| sticking(kind, seed), counts);
    });
}

#[cfg(feature = "mujoco")]
#[test]
fn schedules_of_sessions_also_end_with_the_mujoco_plant() {
    use franka_sim::Robot;
    use franka_sim::plant::{MujocoArm, Scene};

    run(SESSIONS / 2, |seed, counts| {
        let arm = |kind: RobotKind| {
            let plant = MujocoArm::new(kind, Scene::table()).expect("a scene");
            let robot = Robot::with_plant(Lockstep::config_of(kind), Box::new(plant));
            Lockstep::with_robot(robot)
        };
        Sessions::play(seed, arm, counts);
    });
}

/// A robot whose arm sticks, drawn by this seed.
fn sticking(kind: RobotKind, seed: u64) -> Lockstep {
    Lockstep::new(Config {
        arm: Some(Arm::sample(kind, seed, &Family::realistic())),
        seed,
        ..Lockstep::config_of(kind)
    })
}

/// Runs `count` schedules, or `FRANKA_SCHEDULES` of them from seed `FRANKA_SCHEDULE_SEED` on.
fn run(count: u64, mut play: impl FnMut(u64, &mut OutcomeCounts)) {
    let number = |name| std::env::var(name).ok().and_then(|text| text.parse().ok());
    let first: u64 = number("FRANKA_SCHEDULE_SEED").unwrap_or(1);
    let count: u64 = number("FRANKA_SCHEDULES").unwrap_or(count);
    let mut counts = OutcomeCounts::default();
    let mut failed = Vec::new();
    for seed in first..first + count {
        // A panic cannot leave the counts inconsistent, so they may be used after one.
        let played = catch_unwind(AssertUnwindSafe(|| play(seed, &mut counts)));
        if played.is_err() {
            eprintln!("replay with FRANKA_SCHEDULE_SEED={seed} FRANKA_SCHEDULES=1");
            failed.push(seed);
        }
        let played = seed + 1 - first;
        if played == count || played.is_multiple_of(500) {
            let OutcomeCounts {
                outcomes,
                robot_time,
                longest_stop,
            } = &counts;
            let seconds = robot_time / 1000;
            println!(
                "seeds {first} to {seed}: {seconds} s of robot time, {outcomes:?}, \
                 longest stop {longest_stop} ms"
            );
        }
    }
    assert!(
        failed.is_empty(),
        "of {count} schedules these failed: {failed:?}"
    );
}

fn kind(outcome: &Outcome) -> &'static str {
    match outcome {
        Ok(report) if report.reacted.is_some() => "reacted",
        Ok(_) => "ok",
        Err(MotionError::AfterReaction { .. }) => "failed after a reaction",
        Err(MotionError::Superseded) => "superseded",
        Err(MotionError::Stopped) => "stopped",
        Err(MotionError::TargetNotReached(_)) => "short",
        Err(MotionError::Disengaged) => "disengaged",
        Err(MotionError::Held(Lapse::Silent { .. })) => "silent, held",
        Err(MotionError::Braked(Lapse::Silent { .. })) => "silent, braked",
        Err(MotionError::Held(Lapse::Deadman)) => "deadman",
        Err(MotionError::Braked(Lapse::Displaced)) => "displaced",
        Err(MotionError::Braked(Lapse::Blocked { .. })) => "blocked",
        Err(MotionError::Control(error)) if error.is_reflex() => "reflex",
        Err(MotionError::Rejected(_)) => "rejected",
        Err(MotionError::Control(_)) => "aborted",
        Err(error) => panic!("nothing in here causes {error:?}"),
    }
}
