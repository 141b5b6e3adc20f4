//! Motions through several places.

use std::time::Duration;

use franka_lockstep::{Lockstep, for_each_robot};
use franka_model::collision::Obstacle;
use franka_model::{Model, READY, RobotKind, Wrench, rotation};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::lifecycle::{MotionError, NewMotion};
use franka_rt::session::{
    Chunk, GoalError, GoalId, KeepOut, Lapse, OnArrival, PathError, Preview, Target, Waypoint,
};
use franka_rt::together::StartBarrier;
use franka_sim::{Arm, Config};
use franka_tests::follow::realistic;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

/// Along three sides of a box, with turns, from `start`.
fn corners(start: &Isometry3<f64>) -> [Isometry3<f64>; 3] {
    let turn = |angle: f64| UnitQuaternion::from_euler_angles(0.0, 0.2 * angle, angle);
    let place = |x: f64, y: f64, z: f64, angle: f64| {
        let moved = Translation3::new(x, y, z) * start;
        Isometry3::from_parts(moved.translation, turn(angle) * start.rotation)
    };
    [
        place(0.0, 0.2, 0.0, 0.3),
        place(0.0, 0.2, -0.15, 0.3),
        place(0.1, 0.0, -0.15, 0.0),
    ]
}

fn rounded(poses: &[Isometry3<f64>], blend: f64) -> Vec<Waypoint> {
    let waypoint = |pose: &Isometry3<f64>| Waypoint::new(*pose).blend(blend);
    poses.iter().map(waypoint).collect()
}

/// Course of a motion.
#[derive(Debug)]
struct Way {
    /// Its duration, or why it has none.
    outcome: Result<Duration, String>,
    /// Greatest distance of the reference from the straight lines, `[m]`.
    aside: f64,
    /// Least distance of the reference from each place, `[m]`.
    from_places: Vec<f64>,
    /// Greatest speed and acceleration of the reference, `[m/s]`, `[m/s^2]`.
    fastest: (f64, f64),
    /// Cycles in which the reference rests between the first and the last in which it moves.
    rests: u64,
}

/// Watches the motion `id` through these poses; `act` is called in each of its cycles.
fn watch(
    lockstep: &mut Lockstep,
    id: GoalId,
    poses: &[Isometry3<f64>],
    mut act: impl FnMut(&mut Lockstep, u64),
) -> Way {
    let mut places = vec![lockstep.arm_pose().translation.vector];
    places.extend(poses.iter().map(|pose| pose.translation.vector));
    let mut way = Way {
        outcome: Err(String::new()),
        aside: 0.0,
        from_places: vec![f64::INFINITY; places.len()],
        fastest: (0.0, 0.0),
        rests: 0,
    };
    let (mut last, mut resting): (Vec<Vector3<f64>>, u64) = (Vec::new(), 0);
    for cycle in 0..40_000 {
        if let Some(outcome) = lockstep.client.outcome(id) {
            let duration = outcome.as_ref().map(|report| report.duration);
            way.outcome = duration.map_err(ToString::to_string);
            return way;
        }
        lockstep.tick();
        act(lockstep, cycle);
        let record = &lockstep.client.record;
        if record.goal != id.0 || record.remaining.is_zero() {
            continue;
        }
        let at = lockstep.reference_pose().translation.vector;
        for (place, least) in places.iter().zip(&mut way.from_places) {
            *least = least.min((at - place).norm());
        }
        let beside = places.windows(2).map(|ends| {
            let line = ends[1] - ends[0];
            let along = (at - ends[0]).dot(&line) / line.norm_squared();
            (at - ends[0] - line * along.clamp(0.0, 1.0)).norm()
        });
        way.aside = way.aside.max(beside.fold(f64::INFINITY, f64::min));
        last.push(at);
        if let [.., a, b, c] = &last[..] {
            let (v, before) = ((c - b) * 1e3, (b - a) * 1e3);
            let (speed, acceleration) = &mut way.fastest;
            *speed = speed.max(v.norm());
            *acceleration = acceleration.max((v - before).norm() * 1e3);
            if v.norm() < 1e-6 {
                resting += 1;
            } else {
                way.rests += if *speed > 0.01 { resting } else { 0 };
                resting = 0;
            }
        }
    }
    panic!("the path has no end: {way:?}");
}

fn through(blend: f64) -> Way {
    let mut lockstep = realistic();
    let poses = corners(&lockstep.arm_pose());
    let id = lockstep
        .through(None, &rounded(&poses, blend))
        .expect("within reach");
    watch(&mut lockstep, id, &poses, |_, _| {})
}

#[test]
fn corners_are_stopped_at_or_rounded_within_their_distance() {
    let [stopping, rounding] = [0.0, 0.05].map(through);
    let durations = [&stopping, &rounding].map(|way| {
        // The limits of the default budget, plus the effect of a millimetre at the start.
        let (speed, acceleration) = way.fastest;
        assert!(speed < 0.301, "{way:?}");
        assert!(acceleration < 0.6, "{way:?}");
        way.outcome.as_ref().expect("it arrives").as_secs_f64()
    });
    println!("{durations:?} s");
    assert!(stopping.aside < 5e-4, "{stopping:?}");
    assert!(
        stopping.from_places.iter().all(|off| *off < 5e-4),
        "{stopping:?}"
    );
    // Each corner is cut, within the permitted distance.
    assert!(rounding.aside < 0.05, "{rounding:?}");
    for off in &rounding.from_places[1..3] {
        assert!((0.003..0.05).contains(off), "{rounding:?}");
    }
    assert_eq!(rounding.rests, 0, "{rounding:?}");
    assert!(durations[1] < durations[0] - 0.3, "{durations:?}");
}

/// The reference does what the preview shows: along a path, and on the way of a plain goal.
#[test]
fn a_motion_does_what_its_preview_says() {
    for along in [true, false] {
        let mut lockstep = realistic();
        let there = corners(&lockstep.arm_pose())[2];
        let (model, state) = (Model::fr3(), *lockstep.robot.state());
        let goal = lockstep.goal(Target::Pose(there), OnArrival::ReportAndFinish);
        let way = [Waypoint::new(there)];
        let preview = Preview::of(&way, &state.q, &goal, model, &state).expect("within reach");
        let id = match along {
            true => lockstep.through(None, &way),
            false => lockstep.submit(goal),
        };
        let id = id.expect("within reach");
        let (mut farthest, mut took) = (0.0_f64, Duration::ZERO);
        while lockstep.client.outcome(id).is_none() {
            lockstep.tick();
            let record = &lockstep.client.record;
            if record.goal != id.0 || record.remaining.is_zero() {
                continue;
            }
            took = record.elapsed;
            let next = preview.postures.iter().find(|(time, _)| *time >= took);
            let next = next.map_or(preview.end(), |(_, q)| *q);
            let off = (0..7).map(|i| (record.q_ref[i] - next[i]).abs());
            farthest = farthest.max(off.fold(0.0, f64::max));
        }
        let said = preview.duration();
        println!("along a path: {along}; {said:?} said, {took:?} taken, {farthest:.4} rad off");
        assert!(
            said.abs_diff(took) < Duration::from_millis(50),
            "{said:?}, {took:?}"
        );
        // Up to 5 mm of the way lie between two postures.
        assert!(farthest < 0.02, "{farthest} rad off");
    }
}

#[test]
fn joints_go_through_positions() {
    let mut lockstep = realistic();
    let position = |i: usize, by: f64| {
        let mut q: [f64; 7] = READY.into();
        q[i] += by;
        q
    };
    let places = [position(0, 0.4), position(3, 0.3), position(5, -0.3)];
    let waypoints = places.map(|q| Waypoint::new(q).blend(0.1));
    let session = lockstep.engage();
    let id = lockstep
        .through(Some(session), &waypoints)
        .expect("in range");
    let mut least = [f64::INFINITY; 3];
    let outcome = loop {
        if let Some(outcome) = lockstep.client.outcome(id) {
            break outcome.clone();
        }
        lockstep.tick();
        let q = lockstep.client.record.q_ref;
        for (least, place) in least.iter_mut().zip(&places) {
            let off = (0..7).map(|i| (q[i] - place[i]).powi(2)).sum::<f64>();
            *least = least.min(off.sqrt());
        }
    };
    outcome.expect("it arrives");
    for off in &least[..2] {
        assert!((0.005..0.1).contains(off), "{least:?}");
    }
    assert!(least[2] < 1e-9, "{least:?}");
}

#[test]
fn a_path_pauses_on_its_way_and_goes_on() {
    let mut lockstep = realistic();
    let poses = corners(&lockstep.arm_pose());
    let id = lockstep
        .through(None, &rounded(&poses, 0.04))
        .expect("within reach");
    let mut at = Vec::new();
    let way = watch(&mut lockstep, id, &poses, |lockstep, cycle| match cycle {
        // In the first corner.
        700 => lockstep.client.lifecycle.pause(id, true),
        2400 | 2699 => at.push(lockstep.reference_pose()),
        2700 => lockstep.client.lifecycle.pause(id, false),
        _ => {}
    });
    let duration = way.outcome.as_ref().expect("it arrives");
    assert!(*duration > Duration::from_secs(5), "{way:?}");
    let moved = (at[0].translation.vector - at[1].translation.vector).norm();
    assert!(moved < 1e-5, "{moved} m while it is paused");
    assert!(way.aside < 0.04, "{way:?}");
    assert!(way.fastest.1 < 0.8, "{way:?}");
}

#[test]
fn an_arm_that_is_held_back_leaves_no_waypoint_out() {
    let mut lockstep = realistic();
    let tolerant = CollisionBehavior::insensitive();
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    let poses = corners(&lockstep.arm_pose());
    let id = lockstep
        .through(None, &rounded(&poses, 0.02))
        .expect("within reach");
    let way = watch(&mut lockstep, id, &poses, |lockstep, cycle| {
        // More than the arm pushes with, against its way.
        if cycle == 600 {
            let hand = Wrench::new(0.0, -33.0, 0.0, 0.0, 0.0, 0.0);
            lockstep.robot.push_end_effector(hand, 1200);
        }
    });
    assert!(way.outcome.is_ok(), "{way:?}");
    assert!(way.from_places[1] < 0.025, "{way:?}");
    assert!(way.from_places[2] < 0.025, "{way:?}");
}

#[test]
fn a_path_that_comes_while_the_arm_moves_goes_on_from_there() {
    let mut lockstep = realistic();
    let session = lockstep.engage();
    let poses = corners(&lockstep.arm_pose());
    let ahead = Translation3::new(0.0, -0.2, 0.0) * lockstep.arm_pose();
    lockstep
        .within(session, ahead.into(), franka_rt::session::OnArrival::Hold)
        .expect("within reach");
    lockstep.run(600);
    let id = lockstep
        .through(Some(session), &rounded(&poses, 0.03))
        .expect("within reach");
    let way = watch(&mut lockstep, id, &poses, |_, _| {});
    assert!(way.outcome.is_ok(), "{way:?}");
    assert!(way.fastest.1 < 3.0, "{way:?}");
    assert!(way.from_places[2] < 0.03, "{way:?}");
}

#[test]
fn path_waiting_for_the_end_of_a_motion_is_still_followed() {
    let mut lockstep = realistic();
    let poses = corners(&lockstep.arm_pose());
    let before = Translation3::new(0.0, 0.03, 0.0) * lockstep.arm_pose();
    let before = lockstep.begin(before.into());
    lockstep.run(400);
    lockstep.cancel(before);
    let id = lockstep
        .through(None, &rounded(&poses, 0.03))
        .expect("it waits");
    let way = watch(&mut lockstep, id, &poses, |_, _| {});
    assert!(way.outcome.is_ok(), "{way:?}");
    assert!(
        way.from_places[1] < 0.03 && way.from_places[2] < 0.03,
        "{way:?}"
    );
}

#[test]
fn a_path_that_cannot_be_gone_is_refused_before_anything_moves() {
    let mut lockstep = realistic();
    let here = lockstep.arm_pose();
    let near = Translation3::new(0.0, 0.05, 0.0) * here;
    let far = Translation3::new(2.0, 0.0, 0.0) * here;
    let over = here * UnitQuaternion::from_euler_angles(0.0, 0.0, 3.1);
    let q: [f64; 7] = READY.into();
    let refused = |lockstep: &mut Lockstep, waypoints: &[Waypoint]| match lockstep
        .through(None, waypoints)
        .expect_err("it is refused")
    {
        MotionError::Path(error) => error,
        other => panic!("{other:?}"),
    };
    let lockstep = &mut lockstep;
    assert_eq!(refused(lockstep, &[]), PathError::Empty);
    assert_eq!(refused(lockstep, &[near.into(); 101]), PathError::TooMany);
    assert!(matches!(
        refused(lockstep, &[near.into(), far.into()]),
        PathError::Waypoint {
            waypoint: 2,
            error: GoalError::Unreachable { .. }
        }
    ));
    assert_eq!(
        refused(lockstep, &[near.into(), q.into()]),
        PathError::Kind { waypoint: 2 }
    );
    assert_eq!(
        refused(lockstep, &[Target::Rest.into()]),
        PathError::Kind { waypoint: 1 }
    );
    let blend = refused(lockstep, &[Waypoint::new(near).blend(-0.1)]);
    assert_eq!(
        blend.to_string(),
        "the blend of waypoint 1 is -0.1, expected 0 or more"
    );
    assert!(matches!(
        refused(lockstep, &[over.into()]),
        PathError::Turn { waypoint: 1, .. } | PathError::Waypoint { .. }
    ));
    lockstep.run(500);
    assert!(lockstep.client.driver.is_watching());
}

#[test]
fn the_place_where_the_arm_is_already_is_reached_at_once() {
    let mut lockstep = realistic();
    let here = lockstep.arm_pose();
    let id = lockstep
        .through(None, &[here.into(), here.into()])
        .expect("it is there");
    let outcome = lockstep.until_resolved(id, 3000);
    outcome.expect("it arrives");
}

#[test]
fn a_chunk_supersedes_a_path_that_is_under_way() {
    let mut lockstep = realistic();
    let engaged = lockstep.engage();
    let places = corners(&lockstep.arm_pose());
    let path = lockstep.through(Some(engaged), &rounded(&places, 0.02));
    let path = path.expect("within reach");
    lockstep.run(500);
    assert_eq!(lockstep.client.outcome(path), None);
    let q = lockstep.client.record.q_ref;
    let points = (1..=5).map(|k| (Duration::from_millis(100) * k, q));
    let chunk = Chunk::joints(points).expect("finite points");
    lockstep.chunk(engaged, chunk).expect("within the limits");
    let superseded = Some(&Err(MotionError::Superseded));
    assert_eq!(lockstep.client.outcome(path), superseded);
    lockstep.run(1500);
    let away = franka_model::JointVector::from(q) - lockstep.robot.q();
    assert!(away.amax() < 0.05, "{away}");
}

/// Robots of both kinds, with an ideal and with a realistic arm.
fn robots() -> Vec<(String, Lockstep)> {
    let mut robots = Vec::new();
    for kind in [RobotKind::Fr3, RobotKind::Fer] {
        robots.push((format!("{kind:?}, ideal"), Lockstep::ready_of(kind)));
        let arm = Some(Arm::realistic(kind));
        let config = Lockstep::config_of(kind);
        let realistic = Lockstep::new(Config { arm, ..config });
        robots.push((format!("{kind:?}, realistic"), realistic));
    }
    robots
}

/// Tries a path that must be refused for the way between two waypoints, and returns the reason.
fn refused_on_the_way(name: &str, lockstep: &mut Lockstep, waypoints: &[Waypoint]) -> String {
    let before = *lockstep.robot.q();
    let resolved = lockstep.client.resolved();
    let error = lockstep
        .through(None, waypoints)
        .expect_err("it is refused");
    let MotionError::Path(PathError::Way { from, to, .. }) = error else {
        panic!("{name}: {error:?}");
    };
    assert_eq!(to, from + 1, "{name}");
    lockstep.run(50);
    assert!(lockstep.client.driver.is_watching(), "{name}");
    assert_eq!(lockstep.client.resolved(), resolved, "{name}");
    assert!((before - lockstep.robot.q()).amax() < 1e-3, "{name}");
    error.to_string()
}

#[test]
fn path_leaving_the_reach_between_poses_is_refused() {
    for (name, mut lockstep) in robots() {
        let low = Translation3::new(0.0, 0.0, -0.25) * lockstep.arm_pose();
        let down = lockstep.through(None, &[low.into()]).expect("within reach");
        let outcome = lockstep.until_resolved(down, 20_000);
        outcome.unwrap_or_else(|error| panic!("{name}: {error}"));
        let near = Translation3::new(0.0, 0.05, 0.0) * low;
        // On the other side of the base: joint 1 gets there, a straight line does not.
        let turn = rotation::exp(&Vector3::new(0.0, 0.0, 2.4));
        let across = Isometry3::from_parts(Translation3::identity(), turn) * low;
        for (waypoints, from) in [
            (vec![across], "the start"),
            (vec![near, across], "waypoint 1"),
        ] {
            let waypoints: Vec<_> = waypoints.into_iter().map(Waypoint::new).collect();
            let text = refused_on_the_way(&name, &mut lockstep, &waypoints);
            println!("{name}: {text}");
            assert!(
                text.contains(&format!("between {from} and")),
                "{name}: {text}"
            );
        }
        // Over the joints there is a way.
        let mut q: [f64; 7] = READY.into();
        q[0] += 2.4;
        let id = lockstep.through(None, &[q.into()]).expect("in range");
        let outcome = lockstep.until_resolved(id, 20_000);
        outcome.unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[test]
fn random_paths_mostly_arrive_or_are_refused_before_motion() {
    let (seed, cases) = (29, if franka_tests::thorough() { 200 } else { 10 });
    for (name, mut lockstep) in robots() {
        let mut random = SmallRng::seed_from_u64(seed);
        let down = UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
        let (mut arrived, mut refused, mut blocked, mut reflexes) = (0, 0, 0, 0);
        for case in 0..cases {
            let mut vector = || Vector3::from_fn(|_, _| random.random_range(-1.0..1.0_f64));
            let poses: Vec<_> = (0..3)
                .map(|_| {
                    let size = Vector3::new(0.2, 0.5, 0.25);
                    let at = Vector3::new(0.4, 0.0, 0.4) + size.component_mul(&vector());
                    let turn = rotation::exp(&(vector() * 0.4));
                    Isometry3::from_parts(at.into(), turn * down)
                })
                .collect();
            let case = format!("{name}, seed {seed}, case {case}");
            let before = lockstep.client.resolved();
            match lockstep.through(None, &rounded(&poses, random.random_range(0.0..0.08))) {
                Ok(id) => match lockstep.until_resolved(id, 60_000) {
                    Ok(_) => arrived += 1,
                    // The path comes too near to the arm itself.
                    Err(MotionError::Braked(Lapse::Blocked { .. })) => blocked += 1,
                    // Near a singular posture joints move at thrice their budget, which the robot
                    // may take for a contact of an arm that sticks.
                    Err(MotionError::Control(error)) if error.is_reflex() => {
                        println!("{case}: {error}");
                        reflexes += 1;
                        lockstep.request(&Request::AutomaticErrorRecovery);
                        lockstep.run(500);
                    }
                    Err(error) => panic!("{case}: {error}"),
                },
                Err(MotionError::Path(PathError::Way { .. } | PathError::Waypoint { .. })) => {
                    refused += 1;
                    lockstep.run(20);
                    assert!(lockstep.client.driver.is_watching(), "{case}");
                    assert_eq!(lockstep.client.resolved(), before, "{case}");
                }
                Err(error) => panic!("{case}: {error}"),
            }
        }
        println!(
            "{name}: {arrived} arrived, {refused} refused, {blocked} blocked, {reflexes} reflexes"
        );
        let most = if name.ends_with("ideal") {
            0
        } else {
            cases / 20
        };
        assert!(reflexes <= most, "{name}: {reflexes} reflexes");
        assert!(arrived > cases / 4 && blocked <= cases / 10, "{name}");
    }
}

/// A path aside and back to the height of its start: its last place is straight ahead, its first
/// one is not on the way there.
fn detour(start: &Isometry3<f64>) -> [Isometry3<f64>; 2] {
    [(0.05, 0.15), (0.1, 0.0)].map(|(x, y)| Translation3::new(x, y, 0.0) * start)
}

/// Runs until the goal is resolved; returns how near the reference came to `place`, `[m]`.
fn nearest(lockstep: &mut Lockstep, id: GoalId, place: &Isometry3<f64>) -> f64 {
    let mut least = f64::INFINITY;
    while lockstep.client.outcome(id).is_none() {
        lockstep.tick();
        assert!(lockstep.now() < 60_000, "it is resolved");
        if lockstep.client.record.goal == id.0 {
            let at = lockstep.reference_pose().translation.vector;
            least = least.min((at - place.translation.vector).norm());
        }
    }
    least
}

/// The previous motion may end at any moment: the path that comes then begins as a separate motion.
#[test]
fn path_sent_as_the_previous_motion_ends_is_followed() {
    for_each_robot(|ready| {
        let mut before = ready();
        let up = Translation3::new(0.0, 0.0, 0.05) * before.arm_pose();
        let id = before.begin(Target::Pose(up));
        before.until_resolved(id, 20_000).expect("it arrives");
        let end = before.now();
        for early in 0..15 {
            let mut lockstep = ready();
            let first = lockstep.begin(Target::Pose(up));
            while lockstep.now() + early < end {
                lockstep.tick();
            }
            let places = detour(&up);
            let id = lockstep
                .through(None, &rounded(&places, 0.0))
                .expect("within reach");
            let least = nearest(&mut lockstep, id, &places[0]);
            println!("{early} ms before the end: {:.2} mm", least * 1e3);
            assert!(lockstep.client.outcome(first).is_some());
            assert!(matches!(lockstep.client.outcome(id), Some(Ok(_))));
            assert!(least < 1e-3, "{early} ms before the end: {least} m");
        }
    });
}

#[test]
fn a_path_that_is_taken_back_before_it_begins_moves_nothing() {
    for_each_robot(|ready| {
        for within in [false, true] {
            let mut lockstep = ready();
            let start = lockstep.arm_pose();
            let engaged = within.then(|| lockstep.engage());
            let begun = lockstep.through(engaged, &rounded(&detour(&start), 0.0));
            let id = begun.expect("within reach");
            lockstep.cancel(id);
            let outcome = lockstep.until_resolved(id, 20_000);
            assert_eq!(outcome.map(drop), Err(MotionError::Stopped));
            let moved = (lockstep.arm_pose().translation.vector - start.translation.vector).norm();
            assert!(
                moved < 1e-3,
                "within a session: {within}, moved by {moved} m"
            );
        }
    });
}

#[test]
fn a_path_whose_common_start_does_not_come_moves_nothing() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.arm_pose();
        let [here, there] = StartBarrier::new().tickets();
        let places = detour(&start);
        let goal = lockstep.goal(Target::Pose(places[1]), OnArrival::ReportAndFinish);
        let id = goal.id;
        let motion = NewMotion::Goal {
            goal: Box::new(goal),
            path: None,
            ticket: Some(here),
            session: None,
        };
        let begun = lockstep.client.begin_along(&rounded(&places, 0.0), motion);
        begun.expect("nothing else moves");
        lockstep.run(100);
        drop(there);
        let outcome = lockstep.until_resolved(id, 20_000);
        assert!(matches!(outcome, Err(MotionError::Start(_))), "{outcome:?}");
        let moved = (lockstep.arm_pose().translation.vector - start.translation.vector).norm();
        assert!(moved < 1e-3, "moved by {moved} m");
    });
}

/// The last place of a path may be behind the region around which the path leads.
#[test]
fn a_path_that_is_braked_before_a_region_goes_nowhere_else() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.arm_pose();
        let places = detour(&start);
        // On the way to the first place.
        let mut regions = KeepOut::default();
        regions[0] = Some(Obstacle::Box {
            pose: Translation3::new(0.1, 0.3, 0.0) * Isometry3::from(start.translation),
            half: Vector3::new(0.1, 0.1, 0.3),
        });
        lockstep.client.lifecycle.keep_out_of(regions);
        let id = lockstep
            .through(None, &rounded(&places, 0.0))
            .expect("within reach");
        let outcome = lockstep.until_resolved(id, 40_000);
        let blocked = Err(MotionError::Braked(Lapse::Blocked { region: Some(1) }));
        assert_eq!(outcome.map(drop), blocked);
        let end = lockstep.arm_pose().translation.vector;
        let line = places[0].translation.vector - start.translation.vector;
        let along = (end - start.translation.vector).dot(&line) / line.norm_squared();
        let aside = (end - start.translation.vector - line * along).norm();
        assert!((0.05..1.0).contains(&along), "{along} of the first line");
        assert!(aside < 0.01, "{aside} m beside it");
    });
}
