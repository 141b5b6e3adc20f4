//! Recorded motions that arms make again.

use franka_lockstep::{Link, Lockstep};
use franka_model::{Model, RobotKind};
use franka_proto::RobotError;
use franka_record::replay::{
    ReplayCourse, ReplayDeviation, ReplayError, ReplayOptions, ReplayPlan, ReplaySource,
    ReplayTargets,
};
use franka_record::{Cycle, Sample};
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{GoalId, OnArrival, Target};
use franka_sim::Arm;
use nalgebra::Translation3;

fn realistic(kind: RobotKind) -> Lockstep {
    Lockstep::new(franka_sim::Config {
        arm: Some(Arm::realistic(kind)),
        ..Lockstep::config_of(kind)
    })
}

/// A motion with corners: to the side over the joints, then up along a line.
fn recorded(kind: RobotKind) -> Vec<Sample> {
    let mut lockstep = realistic(kind);
    let engaged = lockstep.engage();
    let mut aside = lockstep.client.state.q;
    (aside[0], aside[3], aside[6]) = (aside[0] + 0.5, aside[3] - 0.2, aside[6] - 0.4);
    let up = Translation3::new(0.05, 0.1, 0.12) * lockstep.arm_pose();
    let mut samples = Vec::new();
    for target in [Target::Joints(aside), Target::Pose(up)] {
        let goal = lockstep.within(engaged, target, OnArrival::ReportAndHold);
        let goal = goal.expect("within reach");
        while lockstep.client.outcome(goal).is_none() {
            lockstep.tick();
            samples.push(Sample::of(&Cycle {
                record: lockstep.client.record,
                state: lockstep.client.state,
                ..Cycle::default()
            }));
        }
    }
    samples
}

/// Moves to the first target, and replays until `end` returns true, the last target is due or the
/// session has ended. Returns the session.
fn replay(
    lockstep: &mut Lockstep,
    plan: &ReplayPlan,
    mut end: impl FnMut(&mut Lockstep, u64) -> bool,
) -> (GoalId, ReplayDeviation) {
    let model = Model::of(plan.kind());
    let engaged = lockstep.engage();
    let start = Target::Joints(plan.start());
    let goal = lockstep.within(engaged, start, OnArrival::ReportAndHold);
    let goal = goal.expect("within reach");
    lockstep.until_resolved(goal, 20_000).expect("it arrives");
    plan.check(model, &lockstep.client.state)
        .expect("within reach");
    let mut course = ReplayCourse::new(lockstep.client.state.message_id);
    let mut deviation = ReplayDeviation::default();
    loop {
        let now = lockstep.client.state.message_id;
        if let Some(chunk) = course.due(plan, model, now).expect("targets make a motion") {
            let mut goal = lockstep.goal(chunk.target(), OnArrival::Hold);
            goal.budget = plan.budget();
            if lockstep.submit_chunk(engaged, goal, chunk).is_err() {
                return (engaged, deviation);
            }
        }
        lockstep.tick();
        let state = &lockstep.client.state;
        if (course.begin()..course.end(plan)).contains(&state.message_id) {
            deviation.note(plan, model, state.message_id - course.begin(), state);
        }
        let since = state.message_id.saturating_sub(course.begin());
        if state.message_id >= course.end(plan) || end(lockstep, since) {
            return (engaged, deviation);
        }
    }
}

fn plan(kind: RobotKind, samples: &[Sample], options: ReplayOptions) -> ReplayPlan {
    ReplayPlan::new(kind, samples, options, Model::of(kind)).expect("a motion within the limits")
}

#[test]
fn replay_follows_recording_at_any_speed_and_with_losses() {
    for kind in RobotKind::ALL {
        let samples = recorded(kind);
        let options = ReplayOptions::default();
        for (options, loss) in [
            (options, 0.0),
            (options.speed(0.5), 0.02),
            (options.source(ReplaySource::Measured), 0.0),
            (options.targets(ReplayTargets::Poses).speed(0.5), 0.0),
        ] {
            let plan = plan(kind, &samples, options);
            let mut lockstep = realistic(kind);
            lockstep.link = Link::lossy(11, loss, loss);
            let (engaged, deviation) = replay(&mut lockstep, &plan, |_, _| false);
            let (joints, position) = (deviation.joints(), deviation.position());
            println!("{kind:?} {options:?}, {loss} lost: {joints:.4?} rad, {position:.4?} m");
            assert!(position.p95 < 6e-3 && position.max < 10e-3, "{position:?}");
            let follows_joints = options.targets == ReplayTargets::Joints;
            assert!(!follows_joints || joints.p95 < 0.025, "{joints:?}");
            lockstep.run(1000);
            let last = samples[samples.len() - 1].pose.translation.vector;
            let left = (lockstep.arm_pose().translation.vector - last).norm();
            assert!(left < 3e-3, "{left} m from the end");
            lockstep.disengage(engaged);
            lockstep
                .until_resolved(engaged, 3000)
                .expect("nothing is in the way");
        }
    }
}

#[test]
fn reflex_in_mid_replay_ends_it_for_good() {
    for kind in RobotKind::ALL {
        let samples = recorded(kind);
        let plan = plan(kind, &samples, ReplayOptions::default());
        let mut lockstep = realistic(kind);
        let (engaged, _) = replay(&mut lockstep, &plan, |lockstep, since| {
            if since == 800 {
                lockstep.robot.trip(RobotError::CartesianReflex);
            }
            since > 1000
        });
        let outcome = lockstep.until_resolved(engaged, 10);
        assert!(
            matches!(outcome, Err(MotionError::Control(_))),
            "{outcome:?}"
        );
        let chunk = ReplayCourse::new(0).due(&plan, Model::of(kind), 0);
        let chunk = chunk.expect("a motion").expect("the first one");
        let late = lockstep.chunk(engaged, chunk);
        assert_eq!(
            late.unwrap_err(),
            outcome.unwrap_err(),
            "the session is over"
        );
        let before = lockstep.arm_pose();
        lockstep.run(500);
        let moved = lockstep.arm_pose().translation.vector - before.translation.vector;
        assert!(moved.norm() < 1e-3, "{moved}");
    }
}

#[test]
fn an_arm_whose_host_stops_in_mid_replay_comes_to_rest() {
    let samples = recorded(RobotKind::Fr3);
    let plan = plan(
        RobotKind::Fr3,
        &samples,
        ReplayOptions::default().speed(0.25),
    );
    let mut lockstep = realistic(RobotKind::Fr3);
    let (engaged, _) = replay(&mut lockstep, &plan, |_, since| since > 3000);
    // The chunk under way and its last second are over by then.
    lockstep.run(3000);
    let before = lockstep.arm_pose();
    lockstep.run(500);
    let moved = lockstep.arm_pose().translation.vector - before.translation.vector;
    assert!(moved.norm() < 1e-3, "{moved}");
    assert_eq!(lockstep.client.outcome(engaged), None, "it is held");
}

#[test]
fn replay_omits_cycles_around_the_commanded_ones() {
    let samples = recorded(RobotKind::Fr3);
    let told = 30..samples.len() - 20;
    let mut edged = samples.clone();
    for (i, sample) in edged.iter_mut().enumerate() {
        sample.q_ref = sample.q_ref.filter(|_| told.contains(&i));
    }
    let made = |samples: &[Sample], source| {
        let plan = plan(
            RobotKind::Fr3,
            samples,
            ReplayOptions::default().source(source),
        );
        (plan.start(), plan.duration())
    };
    let inner = made(&samples[told], ReplaySource::Reference);
    assert_eq!(made(&edged, ReplaySource::Reference), inner);
    // All samples have the measured position.
    let whole = made(&samples, ReplaySource::Measured);
    assert_eq!(made(&edged, ReplaySource::Measured), whole);
    assert!(whole.1 > inner.1);
}

#[test]
fn replay_of_an_unfit_recording_is_refused_before_motion() {
    let samples = recorded(RobotKind::Fr3);
    let model = Model::of(RobotKind::Fr3);
    let refused = |recorded, samples: &[Sample], options| {
        ReplayPlan::new(recorded, samples, options, model).unwrap_err()
    };
    let options = ReplayOptions::default();
    let fr3 = RobotKind::Fr3;
    let other = refused(RobotKind::Fer, &samples, options);
    assert!(matches!(
        other,
        ReplayError::Kind {
            got: RobotKind::Fer,
            ..
        }
    ));
    for speed in [0.0, -1.0, 1.01, f64::NAN] {
        let error = refused(fr3, &samples, options.speed(speed));
        assert!(matches!(error, ReplayError::Speed { .. }), "{error}");
    }
    let short = refused(fr3, &samples[..1], options);
    assert_eq!(short, ReplayError::Short { got: 1 });
    let changed = |change: &dyn Fn(usize, &mut Sample)| {
        let mut samples = samples.clone();
        samples
            .iter_mut()
            .enumerate()
            .for_each(|(i, it)| change(i, it));
        samples
    };
    let mut gap = samples.clone();
    gap.drain(500..560);
    assert!(matches!(
        refused(fr3, &gap, options),
        ReplayError::Gap { .. }
    ));
    let free = changed(&|i, it| {
        if i == 700 {
            it.q_ref = None
        }
    });
    assert!(matches!(
        refused(fr3, &free, options),
        ReplayError::Uncontrolled { .. }
    ));
    let untold = changed(&|_, it| it.q_ref = None);
    assert!(matches!(
        refused(fr3, &untold, options),
        ReplayError::Uncontrolled { .. }
    ));
    let wild = changed(&|i, it| {
        if i == 700 {
            it.q[3] = f64::NAN
        }
    });
    assert!(matches!(
        refused(fr3, &wild, options),
        ReplayError::NotFinite { .. }
    ));
    let twice = changed(&|i, it| it.time = 1000 + i as u64 / 16);
    assert!(matches!(
        refused(fr3, &twice, options),
        ReplayError::Gap { .. }
    ));
    // Ten times as fast: the answer includes the effect of the speed.
    let fast: Vec<Sample> = samples.iter().step_by(20).copied().collect();
    let fast: Vec<Sample> = fast
        .iter()
        .zip(0..)
        .map(|(it, time)| Sample {
            time: 2 * time,
            ..*it
        })
        .collect();
    let ReplayError::Fast { joint, speed, .. } = refused(fr3, &fast, options) else {
        panic!("it is faster than the limits");
    };
    let slower = options.speed(0.99 * speed);
    assert!(
        ReplayPlan::new(fr3, &fast, slower, model).is_ok(),
        "joint {joint}"
    );
    // A joint beyond the end of its range.
    let outside = changed(&|i, it| {
        let q = it.q_ref.as_mut().expect("it was controlled");
        q[3] += 2.4 * (i as f64 / samples.len() as f64);
    });
    let outside = plan(fr3, &outside, options);
    let error = outside
        .check(model, &realistic(fr3).client.state)
        .unwrap_err();
    assert!(matches!(error, ReplayError::Target { .. }), "{error}");
}
