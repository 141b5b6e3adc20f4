//! The speed cap of a session.

use franka_lockstep::{Lockstep, for_each_robot};
use franka_model::{EndEffector, JointVector, Model, RobotKind, Wrench, rotation, transform};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{Budget, GoalError, GoalId, Guard, Lapse, OnArrival, Target};
use franka_sim::{Arm, Tool};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::turned;

/// The speed of manual reduced speed, `[m/s]`.
const CAP: f64 = 0.25;

fn capped(lockstep: &mut Lockstep, cap: f64) -> GoalId {
    lockstep.engage_with(Engagement {
        speed_cap: Some(cap),
        ..Engagement::default()
    })
}

/// The speeds of the fastest points of the reference and of the arm, `[m/s]`.
fn fastest(lockstep: &Lockstep) -> [f64; 2] {
    let tool = transform::isometry_from_array(&lockstep.robot.state().F_T_EE);
    let ee = EndEffector {
        f_t_ee: transform::matrix(&tool.expect("a rigid frame")),
        ..EndEffector::default()
    };
    let record = &lockstep.client.record;
    let reference = [record.q_ref, record.dq_ref].map(JointVector::from);
    let speed = |q, dq| Model::fr3().fastest_point(q, dq, &ee);
    [
        speed(&reference[0], &reference[1]),
        speed(lockstep.robot.q(), lockstep.robot.dq()),
    ]
}

/// Moves to a goal at 1.5 times the default pace. Returns its outcome, the greatest value of
/// [`fastest`], and true if the cap bound during the motion.
fn go(
    lockstep: &mut Lockstep,
    engaged: GoalId,
    target: Target,
) -> (Result<(), MotionError>, [f64; 2], bool) {
    let mut goal = lockstep.goal(target, OnArrival::ReportAndHold);
    goal.budget = Budget::of(Model::fr3().joint_limits()).scaled(1.5);
    let id = lockstep
        .submit_within(engaged, goal)
        .expect("a goal in reach");
    let (mut most, mut bound) = ([0.0_f64; 2], false);
    for _ in 0..30_000 {
        if let Some(outcome) = lockstep.client.outcome(id) {
            return (outcome.clone().map(drop), most, bound);
        }
        lockstep.tick();
        let now = fastest(lockstep);
        most = [most[0].max(now[0]), most[1].max(now[1])];
        bound |= lockstep.client.record.bindings.contains(Guard::SpeedCap);
    }
    panic!("not resolved in 30 s");
}

#[test]
fn speed_cap_holds_for_every_point_on_the_way_to_a_pose() {
    let (seed, cases) = (7, if franka_tests::thorough() { 200 } else { 8 });
    println!("seed {seed}");
    let down = UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
    for kind in [RobotKind::Fr3, RobotKind::Fer] {
        let (ideal, realistic) = (Arm::ideal(kind), Arm::realistic(kind));
        for (arm, cap) in [(ideal, CAP), (realistic.clone(), CAP), (realistic, 0.1)] {
            let mut random = SmallRng::seed_from_u64(seed);
            let mut lockstep = Lockstep::new(franka_sim::Config {
                arm: Some(arm),
                ..Lockstep::config_of(kind)
            });
            let mut engaged = capped(&mut lockstep, cap);
            let (mut too_fast, mut slowed) = (0, 0);
            for case in 0..cases {
                let mut vector = || Vector3::from_fn(|_, _| random.random_range(-1.0..1.0_f64));
                let size = Vector3::new(0.13, 0.3, 0.2);
                let at = Vector3::new(0.45, 0.0, 0.4) + size.component_mul(&vector());
                let turn = rotation::exp(&(vector() * 0.3));
                let pose = Isometry3::from_parts(at.into(), turn * down);
                let (outcome, [reference, arm], bound) =
                    go(&mut lockstep, engaged, Target::Pose(pose));
                let case =
                    format!("{kind:?}, {cap} m/s, {case}: {reference} and {arm} m/s, {outcome:?}");
                let given_up = match outcome {
                    Ok(()) => false,
                    Err(MotionError::Braked(Lapse::TooFast)) => true,
                    // An arm that sticks may take its own jolt for a contact.
                    Err(MotionError::Control(error)) if error.is_reflex() => {
                        lockstep.request(&Request::AutomaticErrorRecovery);
                        lockstep.run(500);
                        engaged = capped(&mut lockstep, cap);
                        true
                    }
                    Err(_) => panic!("{case}"),
                };
                if given_up {
                    println!("{case}");
                }
                too_fast += u32::from(given_up);
                // The joints brake, so the hand may get faster before it rests.
                let most = if given_up { cap + 0.1 } else { cap };
                assert!(arm <= most, "{case}");
                slowed += u32::from(bound);
            }
            assert!(2 * slowed > cases, "{slowed} of {cases} slowed");
            // Joints at their bounds cannot always be slowed in time, nor an arm that comes loose.
            assert!(too_fast <= 1 + cases / 20, "{too_fast} of {cases} given up");
        }
    }
}

#[test]
fn a_hand_that_is_slowed_stays_on_its_straight_line() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = capped(&mut lockstep, 0.1);
        let home = lockstep.reference_pose();
        for (way, turn) in [([0.1, 0.3, -0.2], 0.4), ([-0.1, -0.3, 0.1], -0.5)] {
            let moved = Translation3::from(Vector3::from(way)) * home;
            let turn = UnitQuaternion::from_euler_angles(0.3 * turn, -0.5 * turn, turn);
            let there = Isometry3::from_parts(moved.translation, turn * home.rotation);
            let from = lockstep.reference_pose().translation.vector;
            let line = there.translation.vector - from;
            let mut goal = lockstep.goal(Target::Pose(there), OnArrival::ReportAndHold);
            goal.budget = goal.budget.scaled(1.5);
            let id = lockstep.submit_within(engaged, goal).expect("in reach");
            let (mut aside, mut slowed) = (0.0_f64, 0);
            while lockstep.client.outcome(id).is_none() {
                lockstep.tick();
                assert!(lockstep.now() < 60_000, "it never arrives");
                let gone = lockstep.reference_pose().translation.vector - from;
                aside = aside.max(gone.cross(&line).norm() / line.norm());
                slowed += u32::from(lockstep.client.record.bindings.contains(Guard::SpeedCap));
            }
            lockstep.until_resolved(id, 1).expect("it arrives");
            println!("{aside:.6} m aside, slowed for {slowed} ms");
            assert!(slowed > 2000 && aside < 1e-4, "{aside} m, {slowed} ms");
        }
    });
}

/// The object's frame rests at the flange, about which a long tool swings.
#[test]
fn the_hand_keeps_to_the_cap_where_an_object_in_it_leads() {
    let mut tool = Tool::hand();
    tool.f_t_ne[(2, 3)] = 0.3;
    let mut lockstep = Lockstep::new(franka_sim::Config {
        tool,
        ..franka_sim::Config::default()
    });
    let engaged = capped(&mut lockstep, CAP);
    let object = Isometry3::translation(0.0, 0.0, -0.3);
    let there = lockstep.arm_pose() * object;
    let turn = UnitQuaternion::from_euler_angles(0.5, 0.0, 0.4);
    let there = Isometry3::from_parts(there.translation, turn * there.rotation);
    let mut goal = lockstep.goal(Target::Pose(there), OnArrival::ReportAndHold);
    goal.grasp = Some(object);
    goal.budget.rotation.velocity = 1.5;
    goal.budget.rotation.acceleration = 5.0;
    let id = lockstep.submit_within(engaged, goal).expect("in reach");
    let (mut most, mut bound) = (0.0_f64, false);
    while lockstep.client.outcome(id).is_none() {
        lockstep.tick();
        assert!(lockstep.now() < 20_000, "it never arrives");
        most = most.max(fastest(&lockstep)[1]);
        bound |= lockstep.client.record.bindings.contains(Guard::SpeedCap);
    }
    lockstep.until_resolved(id, 1).expect("it arrives");
    assert!(bound && most < CAP, "{most} m/s");
}

/// A goal that cannot be slowed is given up, and the session continues.
#[test]
fn a_goal_over_joints_that_is_too_fast_is_given_up() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let cap = 0.15;
        let engaged = capped(&mut lockstep, cap);
        let (outcome, [_, fastest], bound) = go(&mut lockstep, engaged, turned(0.8));
        assert_eq!(outcome, Err(MotionError::Braked(Lapse::TooFast)));
        assert!(bound && (cap..1.1 * cap).contains(&fastest), "{fastest}");
        assert!(lockstep.robot.dq().amax() < 0.02, "it rests");
        let mut slower = lockstep.goal(turned(0.8), OnArrival::ReportAndHold);
        slower.budget = slower.budget.scaled(0.5);
        let id = lockstep.submit_within(engaged, slower).unwrap();
        lockstep.until_resolved(id, 20_000).expect("below the cap");
    });
}

#[test]
fn an_arm_that_is_thrown_gives_up_its_goal() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let most = CollisionBehavior::uniform([1000.0; 7], [1000.0; 7], [1000.0; 6], [1000.0; 6]);
        lockstep.request(&Request::SetCollisionBehavior(most));
        lockstep.run(5);
        let engaged = capped(&mut lockstep, CAP);
        let there = Target::Pose(lockstep.arm_pose());
        let held = lockstep.within(engaged, there, OnArrival::Hold).unwrap();
        lockstep.run(100);
        let push = Wrench::new(0.0, 40.0, 0.0, 0.0, 0.0, 0.0);
        lockstep.robot.push_end_effector(push, 300);
        let outcome = lockstep.until_resolved(held, 3000);
        assert_eq!(outcome, Err(MotionError::Braked(Lapse::TooFast)));
    });
}

#[test]
fn a_cap_that_no_arm_could_keep_or_would_reach_is_refused() {
    for cap in [0.099, 3.1, 0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = Lockstep::ready().try_engage(Engagement {
            speed_cap: Some(cap),
            ..Engagement::default()
        });
        match refused {
            Err(MotionError::Goal(GoalError::Number { what, least, .. })) => {
                assert_eq!((what, least), ("speed cap", 0.1));
            }
            other => panic!("{cap}: {other:?}"),
        }
    }
}
