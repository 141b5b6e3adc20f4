//! Motions that are recorded from the control thread, and made again.

use std::time::Duration;

use franka_async::record::CycleReader;
use franka_async::recording::{Cycle, Sample};
use franka_async::replay::{ReplayFailure, ReplayOptions, ReplayPlan};
use franka_async::{Engage, MotionError, Robot};

use crate::{alone, robot_time, simulated, under_way};

/// The sideways motion of a session, in every cycle.
async fn recorded(robot: &Robot) -> Vec<Sample> {
    let arm = robot.engage(Engage::default()).await.unwrap();
    let mut cycles = robot.cycles(20_000).unwrap();
    let mut aside = robot.state().q_d;
    (aside[0], aside[5]) = (aside[0] + 0.6, aside[5] - 0.3);
    arm.move_joints(aside).await.unwrap();
    let samples = taken(&mut cycles);
    arm.disengage().await.unwrap();
    assert!(samples.len() > 1000, "{}", samples.len());
    samples
}

fn taken(cycles: &mut CycleReader) -> Vec<Sample> {
    let mut samples = Vec::new();
    while let Some(cycle) = cycles.pop() {
        assert_eq!(cycle.lost, 0, "the ring has room for all");
        samples.push(Sample::of(&Cycle {
            record: cycle.record,
            state: cycle.state,
            ..Cycle::default()
        }));
    }
    // The first of them may be older than the session.
    let controlled = samples
        .into_iter()
        .skip_while(|sample| sample.q_ref.is_none());
    controlled.collect()
}

fn plan(robot: &Robot, samples: &[Sample], speed: f64) -> ReplayPlan {
    let options = ReplayOptions::default().speed(speed);
    ReplayPlan::new(robot.model().kind(), samples, options, robot.model()).unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_replay_moves_to_the_begin_and_says_how_far_off_it_was() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let samples = recorded(&robot).await;
    let last = samples[samples.len() - 1].q;
    let mut cycles = robot.cycles(20_000).unwrap();
    let report = robot.replay(&plan(&robot, &samples, 0.5)).await.unwrap();
    println!("{report:?}");
    // The path to the start is the recorded one in reverse, as slow as the following part.
    let recorded = samples.windows(20).map(|it| it[19].q[0] - it[0].q[0]);
    let recorded = recorded.fold(0.0, |most: f64, it| most.max(it.abs())) / 0.019;
    let mut fastest = 0.0_f64;
    while let Some(cycle) = cycles.pop() {
        fastest = fastest.max(cycle.state.dq[0].abs());
    }
    assert!(
        fastest > 0.3 * recorded && fastest < 0.65 * recorded,
        "{fastest}, {recorded} rad/s"
    );
    let took = Duration::from_millis(2 * samples.len() as u64);
    assert!(report.duration.abs_diff(took) < Duration::from_millis(50));
    // A task on a busy machine misses states.
    assert!(report.states > 0, "{report:?}");
    assert!(
        report.joints.max < 5e-3 && report.position.max < 2e-3,
        "{report:?}"
    );
    let q = robot.state().q;
    let off = q.iter().zip(&last).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 2e-3);
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn dropped_or_superseded_replay_brakes_for_good() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let samples = recorded(&robot).await;
    let end = samples[samples.len() - 1].q[0];
    let plan = plan(&robot, &samples, 0.2);
    let arm = robot.engage(Engage::default()).await.unwrap();
    for dropped in [true, false] {
        arm.move_joints(plan.start()).await.unwrap();
        let replay = tokio::spawn({
            let (arm, plan) = (arm.clone(), plan.clone());
            async move { arm.replay(&plan).await }
        });
        let begin = plan.start()[0];
        crate::until(&robot, |state| state.q[0] > begin + 0.1).await;
        if dropped {
            replay.abort();
            assert!(replay.await.unwrap_err().is_cancelled());
        } else {
            arm.hold().await.unwrap();
            let ended = replay.await.unwrap();
            let superseded = ReplayFailure::Motion(MotionError::Superseded);
            assert_eq!(
                format!("{ended:?}"),
                format!("{:?}", Err::<(), _>(superseded))
            );
        }
        arm.at_rest().await.unwrap();
        let held = robot.state().q[0];
        assert!(held < end - 0.1, "{held} of {end}");
        // Longer than the next part of the replay would have waited.
        robot_time(&robot, 5000).await;
        assert!((robot.state().q[0] - held).abs() < 2e-3);
    }
    // The session continues.
    arm.move_joints(plan.start()).await.unwrap();
    arm.disengage().await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn replay_ends_if_arm_is_elsewhere_or_session_is_stopped() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let mut samples = recorded(&robot).await;
    let arm = robot.engage(Engage::default()).await.unwrap();
    // Stopped from outside, by any handle.
    let whole = plan(&robot, &samples, 1.0);
    arm.move_joints(whole.start()).await.unwrap();
    let replay = tokio::spawn({
        let (arm, whole) = (arm.clone(), whole.clone());
        async move { arm.replay(&whole).await }
    });
    under_way(&robot).await;
    robot.stop().await.unwrap();
    let ended = replay.await.unwrap();
    let Err(ReplayFailure::Motion(MotionError::Stopped | MotionError::Superseded)) = ended else {
        panic!("{ended:?}");
    };
    // The recorded arm went further than its reference, as if this one were held.
    let half = samples.len() / 2;
    for sample in &mut samples[half..] {
        sample.q[2] += 0.3;
    }
    let ended = robot
        .replay(&plan(&robot, &samples, 1.0))
        .await
        .unwrap_err();
    assert!(matches!(ended, ReplayFailure::Off { .. }), "{ended}");
    assert!(
        ended.to_string().contains("expected 0.15 rad at most"),
        "{ended}"
    );
    let begin = whole.start()[0];
    assert!(robot.state().q[0] > begin + 0.1, "it was under way");
    // A target out of range is refused before anything moves.
    for sample in &mut samples {
        sample.q_ref = sample
            .q_ref
            .map(|q| [q[0], q[1], q[2], 0.5, q[4], q[5], q[6]]);
    }
    let ended = robot
        .replay(&plan(&robot, &samples, 1.0))
        .await
        .unwrap_err();
    assert!(matches!(ended, ReplayFailure::Refused(_)), "{ended}");
    robot.shutdown().await;
}
