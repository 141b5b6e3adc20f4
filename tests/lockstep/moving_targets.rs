//! Targets that move, and motions that pause on their way.

use franka_lockstep::{Lockstep, Outcome};
use franka_model::{READY, Twist};
use franka_rt::session::{OnArrival, PoseError, Target};
use franka_tests::follow::{self, Lag, moved, realistic, twist};
use nalgebra::{Isometry3, Translation3};

#[test]
fn reference_lags_a_moving_target_by_two_ms_at_most() {
    for period in [1, 10, 100] {
        let Lag { reference, arm } = follow::lag(period, true);
        let unsaid = follow::lag(period, false).reference;
        println!(
            "every {period} ms: reference {reference:.2} ms behind, arm {arm:.1}; {unsaid:.0} without a velocity"
        );
        assert!(reference <= 2.0, "every {period} ms: {reference} ms");
        assert!(unsaid > 50.0, "every {period} ms: {unsaid} ms, too");
    }
}

#[test]
fn joints_follow_a_target_that_moves() {
    let mut lockstep = realistic();
    let session = lockstep.engage();
    let dq = [0.3, -0.2, 0.1, 0.2, -0.4, 0.3, 0.5];
    let q = |ms: u64| core::array::from_fn(|i| READY[i] + dq[i] * ms as f64 * 1e-3);
    let target = |ms| Target::MovingJoints { q: q(ms), dq };
    let goal = lockstep
        .within(session, target(0), OnArrival::Hold)
        .expect("in range");
    for ms in 1..1200 {
        lockstep.tick();
        let record = &lockstep.client.record;
        for i in (0..7).filter(|_| ms > 900) {
            let behind = (q(ms)[i] - record.q_ref[i]) / dq[i] * 1e3;
            assert!(behind.abs() <= 2.0, "joint {}: {behind} ms", i + 1);
        }
        if ms % 20 == 0 {
            assert_eq!(lockstep.update(goal, target(ms)), Ok(true));
        }
    }
}

#[test]
fn arm_without_news_of_a_moving_target_stops_and_resumes() {
    let mut lockstep = realistic();
    let session = lockstep.engage();
    let (start, twist) = (lockstep.reference_pose(), twist());
    let moving = |ms: u64| Target::from((moved(&start, &twist, ms as f64 * 1e-3), twist));
    let goal = lockstep
        .within(session, moving(0), OnArrival::Hold)
        .expect("within reach");
    for ms in 1..=1200 {
        lockstep.tick();
        if ms % 50 == 0 {
            assert_eq!(lockstep.update(goal, moving(ms)), Ok(true));
        }
    }
    // The motion continues while it counts, and then ends within the default accelerations.
    lockstep.run(Target::MOVES_ON_MS);
    let ends = moved(&start, &twist, 1.4);
    let error = PoseError::between(&lockstep.reference_pose(), &ends);
    assert!(error.translation < 3e-4, "{error:?}");
    lockstep.run(700);
    let rest = lockstep.reference_pose();
    let way = rest.translation.vector - ends.translation.vector;
    let direction = twist.fixed_rows::<3>(0).normalize();
    let along = way.dot(&direction);
    let aside = (way - direction * along).norm();
    let dq = lockstep.client.record.dq_ref;
    assert!(dq.iter().all(|dq| dq.abs() < 1e-9), "at rest: {dq:?}");
    let speed = twist.fixed_rows::<3>(0).norm();
    let braking = 0.5 * speed * speed / 0.5 + 0.5 * speed * 0.5 / 20.0;
    assert!(
        (along - braking).abs() < 0.3 * braking,
        "{along} m, {braking} expected"
    );
    assert!(aside < 1e-4, "{aside} m beside the way");

    // News: the arm catches up.
    for ms in 2101..=3600 {
        if ms % 50 == 1 {
            assert_eq!(lockstep.update(goal, moving(ms)), Ok(true));
        }
        lockstep.tick();
    }
    let error = PoseError::between(&lockstep.reference_pose(), &moved(&start, &twist, 3.6));
    assert!(error.translation < 3e-4, "{error:?}");
}

/// The figures of `docs/src/how-to/teleoperate.md`.
#[test]
fn target_that_leaps_into_or_out_of_motion_is_overshot() {
    for (speed, growing, fading, expected, fastest) in [
        (0.05, 0.0, 0.0, 3.0, 0.074),
        (0.1, 0.0, 0.0, 12.0, 0.19),
        (0.2, 0.0, 0.0, 58.0, 0.3),
        (0.1, 0.0, 0.3, 0.4, 0.19),
        (0.1, 0.35, 0.3, 0.4, 0.117),
        (0.2, 0.7, 0.7, 0.7, 0.206),
    ] {
        let mut lockstep = realistic();
        let session = lockstep.engage();
        let start = lockstep.arm_pose();
        let (mut way, mut beyond, mut goal) = (0.0, 0.0_f64, None);
        let (mut top, mut before) = (0.0_f64, start.translation.vector);
        for ms in 0..5000_u64 {
            let since = |begin: f64| ms as f64 * 1e-3 - begin;
            let share = |since: f64, time: f64| match since {
                _ if since < 0.0 => 0.0,
                _ if since >= time => 1.0,
                _ => since / time,
            };
            let velocity =
                speed * (share(since(0.0), growing) - share(since(1.0 + growing), fading));
            way += velocity * 1e-3;
            let pose = Translation3::new(0.0, way, 0.0) * start;
            let target = Target::from((pose, Twist::new(0.0, velocity, 0.0, 0.0, 0.0, 0.0)));
            match goal {
                None => goal = lockstep.within(session, target, OnArrival::Hold).ok(),
                Some(goal) if ms % 16 == 0 => assert_eq!(lockstep.update(goal, target), Ok(true)),
                Some(_) => {}
            }
            lockstep.tick();
            let hand = lockstep.arm_pose().translation;
            let off = hand.y - start.translation.y - way;
            if since(1.0) >= 0.0 && velocity == 0.0 {
                beyond = beyond.max(off * 1e3);
            }
            if ms % 40 == 0 {
                top = top.max((hand.vector - before).norm() / 0.04);
                before = hand.vector;
            }
            assert!(ms < 4990 || off.abs() < 1e-3, "{off} m from the target");
        }
        println!(
            "{speed} m/s, growing in {growing} s, fading in {fading} s: {top:.3} m/s, {beyond:.1} mm beyond"
        );
        assert!(
            (beyond - expected).abs() < 0.3 + 0.1 * expected,
            "{speed} m/s: {beyond} mm"
        );
        assert!((top - fastest).abs() < 0.1 * fastest, "{speed}: {top} m/s");
    }
}

#[test]
fn a_target_that_is_too_fast_is_followed_within_the_budget() {
    let mut lockstep = realistic();
    let session = lockstep.engage();
    let start = lockstep.reference_pose();
    let fast = Twist::new(0.0, 0.6, 0.0, 0.0, 0.0, 0.0);
    let at = |ms: u64| moved(&start, &fast, ms as f64 * 1e-3);
    let goal = lockstep
        .within(session, (at(0), fast).into(), OnArrival::Hold)
        .expect("within reach");
    let mut last = start.translation.vector;
    let mut top = 0.0_f64;
    for ms in 1..=500 {
        lockstep.tick();
        let now = lockstep.reference_pose().translation.vector;
        top = top.max((now - last).norm() * 1e3);
        last = now;
        if ms % 10 == 0 {
            assert_eq!(lockstep.update(goal, (at(ms), fast).into()), Ok(true));
        }
    }
    // The default budget has 0.3 m/s.
    assert!((0.2..0.3003).contains(&top), "{top} m/s");
}

#[test]
fn a_target_that_moves_has_no_arrival() {
    let mut lockstep = Lockstep::ready();
    let pose = lockstep.arm_pose();
    let goal = lockstep.goal((pose, twist()).into(), OnArrival::ReportAndFinish);
    let error = lockstep.submit(goal).expect_err("refused");
    let text = "got a target with a velocity, expected a target at rest, where the motion can \
        end: use `set` or `follow` for moving targets";
    assert_eq!(error.to_string(), text);
}

/// Moves to `target`, and pauses for two seconds after 400 ms. Returns the outcome, the reference's
/// distance from the straight line, and its motion in the last second of the pause, `[m]`.
fn paused(target: Isometry3<f64>) -> (Outcome, f64, f64) {
    let mut lockstep = realistic();
    let start = lockstep.arm_pose().translation.vector;
    let end = target.translation.vector;
    let goal = lockstep.goal(target.into(), OnArrival::ReportAndFinish);
    let id = lockstep.submit(goal).expect("within reach");
    let mut aside = 0.0_f64;
    let mut watch = |lockstep: &Lockstep| {
        if lockstep.client.record.goal == id.0 {
            let at = lockstep.reference_pose().translation.vector - start;
            let line = (end - start).normalize();
            aside = aside.max((at - line * at.dot(&line)).norm());
        }
    };
    for _ in 0..400 {
        lockstep.tick();
        watch(&lockstep);
    }
    lockstep.client.lifecycle.pause(id, true);
    for _ in 0..1000 {
        lockstep.tick();
        watch(&lockstep);
    }
    let before = lockstep.reference_pose().translation.vector;
    lockstep.run(1000);
    let moved = (lockstep.reference_pose().translation.vector - before).norm();
    lockstep.client.lifecycle.pause(id, false);
    for _ in 0..500 {
        lockstep.tick();
        watch(&lockstep);
    }
    (lockstep.until_resolved(id, 10_000), aside, moved)
}

#[test]
fn a_motion_pauses_on_its_way_and_goes_on() {
    let start = realistic().arm_pose();
    let target = Translation3::new(0.05, 0.2, -0.1) * start;
    let (outcome, aside, moved) = paused(target);
    let report = outcome.expect("it arrives");
    assert!(report.duration.as_millis() > 2900, "{:?}", report.duration);
    assert_eq!(moved, 0.0, "it stands while it is paused");
    assert!(aside < 1e-5, "{aside} m beside the line");
}
