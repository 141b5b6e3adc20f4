//! Every controller of the robot with every kind of setpoint, on arms that stick and over links
//! that lose packets. The robot checks each command, and must find no violation.

use std::time::Duration;

use franka_lockstep::{Link, Lockstep};
use franka_model::{JointVector, Model, READY, RobotKind, Wrench};
use franka_proto::{CollisionBehavior, Errors, Request, RobotError, RobotMode};
use franka_rt::lifecycle::{Engagement, MotionError, MotionReport};
use franka_rt::session::condition::elapsed;
use franka_rt::session::{
    Backend, Chunk, Goal, GoalId, OnArrival, Reaction, Setpoints, Target, Tolerance, Waypoint,
};
use franka_sim::arm::{Arm, Family};
use franka_sim::{Config, Touch};
use franka_tests::push::{PUSH, STIFFNESS, hand};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// A session under each controller with each kind of setpoint, on a realistic arm of each robot.
fn for_each(seed: u64, test: impl Fn(Backend, &mut Lockstep, GoalId)) {
    for kind in RobotKind::ALL {
        for backend in Backend::ROBOT_CONTROLLERS {
            println!("{kind:?}, {backend}");
            let mut lockstep = Lockstep::new(Config {
                arm: Some(match seed {
                    0 => Arm::realistic(kind),
                    _ => Arm::sample(kind, seed, &Family::realistic()),
                }),
                seed,
                ..Lockstep::config_of(kind)
            });
            let engaged = lockstep.engage_with(Engagement {
                backend,
                ..Engagement::default()
            });
            test(backend, &mut lockstep, engaged);
            let errors = &lockstep.client.state.errors;
            assert!(errors.is_empty(), "{errors}");
        }
    }
}

fn tolerance(backend: Backend) -> Tolerance {
    match backend {
        Backend::RobotController { controller, .. } => Tolerance::under(controller),
        other => unreachable!("{other} is none of the robot's"),
    }
}

/// Steps and turns about `home`, and joint positions where they are taken.
fn targets(backend: Backend, home: &Isometry3<f64>) -> Vec<Target> {
    let place = |way: [f64; 3], turn: [f64; 3]| {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
        Isometry3::from_parts(
            Translation3::from(home.translation.vector + Vector3::from(way)),
            turn * home.rotation,
        )
        .into()
    };
    let mut targets = vec![
        place([0.05, 0.1, 0.0], [0.0, 0.0, 0.3]),
        place([0.0, -0.1, -0.1], [0.2, -0.1, 0.0]),
        place([0.0, 0.0, 0.001], [0.0; 3]),
    ];
    if !backend.is_cartesian() {
        let q = |by: [f64; 7]| Target::Joints((JointVector::from(by) + READY).into());
        targets.push(q([0.3, -0.2, 0.1, 0.2, -0.3, 0.2, 0.5]));
        targets.push(q([0.0; 7]));
    }
    targets
}

fn is_near(report: &MotionReport, backend: Backend) {
    let error = report.final_error.expect("a target");
    let most = tolerance(backend);
    assert!(error.translation <= most.translation, "{report:?}");
    assert!(error.rotation <= most.rotation, "{report:?}");
}

/// Distance of the robot's own setpoint from the reference, `[rad]`.
fn off_reference(lockstep: &Lockstep) -> f64 {
    let record = &lockstep.client.record;
    (JointVector::from(lockstep.client.state.q_d) - JointVector::from(record.q_ref)).amax()
}

#[test]
fn controller_arrives_within_tolerance_despite_losses() {
    for (seed, loss) in [(0, 0.0), (3, 0.002), (4, 0.02)] {
        for_each(seed, |backend, lockstep, engaged| {
            if loss > 0.0 {
                lockstep.link = Link::lossy(seed, loss, loss);
            }
            let home = lockstep.arm_pose();
            for target in targets(backend, &home) {
                let goal = lockstep.within(engaged, target, OnArrival::ReportAndHold);
                let goal = goal.expect("within reach");
                let report = lockstep.until_resolved(goal, 8000).expect("it arrives");
                is_near(&report, backend);
                let off = off_reference(lockstep);
                assert!(off < 1e-5, "{backend}: the robot is {off} rad beside");
            }
            lockstep.disengage(engaged);
            lockstep.until_resolved(engaged, 2000).expect("it ends");
        });
    }
}

/// Dropped in any phase of a motion: first the goal alone, whose session holds the arm and
/// continues; then the session.
#[test]
fn controller_brakes_when_goal_or_session_is_dropped() {
    for after in [30, 120, 333, 470] {
        for_each(2, |backend, lockstep, engaged| {
            let home = lockstep.arm_pose();
            let away = Translation3::new(0.05, 0.15, 0.0) * home;
            let goal = lockstep.within(engaged, away.into(), OnArrival::ReportAndHold);
            let goal = goal.expect("within reach");
            lockstep.run(after);
            lockstep.cancel(goal);
            let dropped = lockstep.until_resolved(goal, 3000);
            assert_eq!(dropped, Err(MotionError::Stopped));
            lockstep.run(600);
            assert_eq!(lockstep.client.state.dq_d, [0.0; 7], "{backend}");
            assert!(off_reference(lockstep) < 1e-5, "{backend}");

            let back = lockstep.within(engaged, home.into(), OnArrival::ReportAndHold);
            let back = back.expect("within reach");
            let report = lockstep.until_resolved(back, 8000).expect("it arrives");
            is_near(&report, backend);

            let goal = lockstep.within(engaged, away.into(), OnArrival::Hold);
            goal.expect("within reach");
            lockstep.run(after);
            lockstep.disengage(engaged);
            lockstep.until_resolved(engaged, 3000).expect("it brakes");
            assert_eq!(lockstep.client.state.robot_mode, RobotMode::Idle);
            // The robot then holds the arm more stiffly than its Cartesian impedance does.
            lockstep.run(300);
            let dq = lockstep.robot.dq().amax();
            assert!(dq < 0.01, "{backend}, {after}: {dq}");
        });
    }
}

#[test]
fn controller_passes_waypoints_and_pauses_on_the_way() {
    for_each(1, |backend, lockstep, engaged| {
        let home = lockstep.arm_pose();
        let through = targets(backend, &home)[..3].to_vec();
        let through: Vec<_> = through
            .into_iter()
            .map(|target| Waypoint::new(target).blend(0.02))
            .collect();
        let path = lockstep.through(Some(engaged), &through);
        let path = path.expect("within reach");
        for paused in [true, false] {
            lockstep.run(500);
            lockstep.client.lifecycle.pause(path, paused);
        }
        let report = lockstep.until_resolved(path, 8000).expect("it arrives");
        assert!(report.duration > Duration::from_millis(1500), "{report:?}");
        is_near(&report, backend);
        if backend.is_cartesian() {
            return;
        }
        let way = |by: f64| Waypoint::new(<[f64; 7]>::from(READY.map(|q| q + by))).blend(0.05);
        let path = lockstep.through(Some(engaged), &[0.1, -0.1, 0.0].map(way));
        let path = path.expect("in range");
        let report = lockstep.until_resolved(path, 8000).expect("it arrives");
        is_near(&report, backend);
    });
}

#[test]
fn controller_follows_moving_targets_and_chunks() {
    for_each(1, |backend, lockstep, engaged| {
        let home = lockstep.arm_pose();
        let twist = Vector3::new(0.02, 0.1, -0.05);
        let moving = |ms: u64| {
            let pose = Translation3::from(twist * (ms as f64 * 1e-3)) * home;
            let [x, y, z]: [f64; 3] = twist.into();
            Target::MovingPose {
                pose,
                twist: [x, y, z, 0.0, 0.0, 0.0].into(),
            }
        };
        let goal = lockstep.within(engaged, moving(0), OnArrival::Hold);
        let goal = goal.expect("within reach");
        for ms in 1..1200 {
            lockstep.tick();
            if ms % 20 == 0 {
                assert_eq!(lockstep.update(goal, moving(ms)), Ok(true));
            }
            let Target::MovingPose { pose, .. } = moving(ms) else {
                unreachable!("it moves")
            };
            let behind = lockstep.reference_pose().translation.vector - pose.translation.vector;
            assert!(ms < 900 || behind.norm() < 1e-3, "{backend}: {behind}");
        }
        let start = lockstep.reference_pose();
        let points = (0..12).map(|k| {
            let along = Translation3::new(0.0, -0.008 * f64::from(k), 0.004 * f64::from(k));
            (Duration::from_millis(50) * k, along * start)
        });
        let chunk = Chunk::poses(points).expect("finite points");
        let end = chunk.target();
        lockstep.chunk(engaged, chunk).expect("it is taken");
        lockstep.run(2500);
        let off = lockstep.arm_pose().translation.vector;
        let Target::Pose(end) = end else {
            unreachable!("a chunk of poses ends at one")
        };
        let off = (off - end.translation.vector).norm();
        assert!(off < tolerance(backend).translation, "{backend}: {off}");
    });
}

#[test]
fn controller_reacts_to_a_condition() {
    for_each(1, |backend, lockstep, engaged| {
        let home = lockstep.arm_pose();
        let away = Translation3::new(0.0, 0.2, 0.0) * home;
        let reaction: Reaction = elapsed(Duration::from_millis(400)).then(home);
        let goal = Goal {
            reaction: Some(reaction),
            ..lockstep.goal(away.into(), OnArrival::ReportAndHold)
        };
        let goal = lockstep.submit_within(engaged, goal).expect("within reach");
        let report = lockstep.until_resolved(goal, 8000).expect("it comes back");
        assert!(report.reacted.is_some(), "{report:?}");
        is_near(&report, backend);
    });
}

/// A session under the robot's joint or Cartesian impedance controller, on a realistic arm that has
/// these thresholds.
fn held(kind: RobotKind, backend: Backend, thresholds: CollisionBehavior) -> (Lockstep, GoalId) {
    let mut lockstep = Lockstep::new(Config {
        arm: Some(Arm::realistic(kind)),
        ..Lockstep::config_of(kind)
    });
    lockstep.request(&Request::SetCollisionBehavior(thresholds));
    lockstep.run(10);
    let engaged = lockstep.engage_with(Engagement {
        backend,
        ..Engagement::default()
    });
    lockstep.run(1000);
    (lockstep, engaged)
}

/// A hand moves on over 16 cm against the arm, on a spring of 5000 N/m, until the robot stops
/// itself. Returns why it did, the force of the hand `[N]`, and the torques measured before, `[N
/// m]`.
fn push_on(lockstep: &mut Lockstep, engaged: GoalId, way: Vector3<f64>) -> (Errors, f64, [f64; 7]) {
    let from = lockstep.arm_pose().translation.vector;
    let path = move |t| from + way * hand(t);
    let push = lockstep.robot.touch(Touch::carry(path, STIFFNESS));
    let (mut force, mut torque) = (0.0, [0.0; 7]);
    for _ in 0..PUSH {
        lockstep.tick();
        if lockstep.client.outcome(engaged).is_some() {
            break;
        }
        torque = lockstep.client.state.tau_J;
        let felt = lockstep.robot.felt(push).expect("it goes on");
        force = felt.fixed_rows::<3>(0).norm();
    }
    (lockstep.client.state.reflex_reason, force, torque)
}

/// The robot's controllers yield only like their springs. The force of a hand that continues to
/// push grows until the robot stops. The stop comes from its thresholds or, without thresholds,
/// from a torque sensor of the wrist that is out of its range.
#[test]
fn controller_bears_a_push_and_stops_at_a_lasting_one() {
    let without = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
    for kind in RobotKind::ALL {
        let range = 1.1 * Model::of(kind).joint_limits().torque[5];
        for (backend, most) in [
            (Backend::joint_impedance(Setpoints::JointPositions), 0.004),
            (
                Backend::cartesian_impedance(Setpoints::JointPositions),
                0.015,
            ),
        ] {
            let (mut lockstep, engaged) = held(kind, backend, without);
            let home = lockstep.arm_pose().translation.vector;
            let push = Wrench::new(0.0, 30.0, 0.0, 0.0, 0.0, 0.0);
            lockstep.robot.push_end_effector(push, 3000);
            lockstep.run(2900);
            let yielded = (lockstep.arm_pose().translation.vector - home).norm();
            println!("{kind:?}, {backend}: {:.1} mm at 30 N", yielded * 1e3);
            assert!((0.0005..most).contains(&yielded), "{yielded} m");
            assert_eq!(lockstep.client.outcome(engaged), None);

            for way in [Vector3::x(), Vector3::y()] {
                let compliant = CollisionBehavior::compliant();
                let (mut lockstep, engaged) = held(kind, backend, compliant);
                let (reason, force, _) = push_on(&mut lockstep, engaged, way);
                println!("60 N: {reason} at {force:.0} N");
                assert!(reason.contains(RobotError::CartesianReflex), "{reason}");
                assert!((60.0..80.0).contains(&force), "{force} N");

                let (mut lockstep, engaged) = held(kind, backend, without);
                let (reason, force, torque) = push_on(&mut lockstep, engaged, way);
                println!("without: {reason} at {force:.0} N, {torque:.1?}");
                assert!(reason.contains(RobotError::TauJRangeViolation), "{reason}");
                assert!((60.0..90.0).contains(&force), "{force} N");
                let wrist = torque[4].abs().max(torque[5].abs());
                assert!(wrist > range - 0.3, "{torque:?}");
            }
        }
    }
}
