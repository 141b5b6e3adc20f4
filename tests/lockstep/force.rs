//! The force of the arm on an obstacle in its way, and on a hand that pushes it.
//!
//! The forces come from the simulated contact, in the millisecond in which it acts on the arm, and
//! not from estimates of the driver. The part of a push that accelerates the arm does not come from
//! the law. The contact supplies it for any torques: `Lambda J ddq`, with the simulated arm's whole
//! inertia, rotors included. It is subtracted. By the equations of motion, the rest is the
//! resistance of the joints' torques and friction. The hand holds the end effector at a point, so
//! `J` is only the Jacobian of the position:
//!
//! ```text
//! M ddq + c = tau - friction + J' f    =>    f - Lambda (J ddq) = -Lambda J M^-1 (tau - friction - c)
//! ```

use franka_lockstep::{Lockstep, Outcome, for_each_robot};
use franka_model::Load;
use franka_proto::{CollisionBehavior, Request, RobotMode};
use franka_rt::law::{Gains, Law};
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{ForceCap, Goal, GoalId, Guard, Lapse, OnArrival, Target, Tolerance};
use franka_sim::{Touch, TouchId};
use franka_tests::push::{ArmInertia, PUSH, STIFFNESS, hand};
use franka_tests::thorough;
use nalgebra::{Translation3, Vector3};

/// A robot whose collision thresholds tolerate pushes.
fn tolerant(ready: &dyn Fn() -> Lockstep) -> Lockstep {
    let mut lockstep = ready();
    let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    lockstep.run(5);
    lockstep
}

fn force(lockstep: &Lockstep, touch: TouchId) -> Vector3<f64> {
    let felt = lockstep.robot.felt(touch).expect("it has not ended");
    felt.fixed_rows::<3>(0).into_owned()
}

fn directions() -> [Vector3<f64>; 3] {
    [Vector3::x(), Vector3::y(), -Vector3::z()]
}

/// Twice the default stiffness: the spring alone reaches 37.5 N at the leash.
fn stiff() -> Gains {
    Gains::cartesian().with_cartesian_stiffness([1500.0, 1500.0, 1500.0, 15.0, 15.0, 15.0])
}

/// The gains of each law, and stiff ones.
fn each_gains() -> [(&'static str, Gains); 4] {
    let operational = Gains {
        law: Law::OperationalSpace,
        ..stiff()
    };
    [
        ("default", Gains::cartesian()),
        ("1500 N/m", stiff()),
        ("joints", Gains::joint()),
        ("operational", operational),
    ]
}

fn head_for(
    lockstep: &mut Lockstep,
    engaged: GoalId,
    target: Target,
    gains: Gains,
    force_cap: ForceCap,
) {
    let goal = Goal {
        gains,
        force_cap,
        ..lockstep.goal(target, OnArrival::Hold)
    };
    lockstep.submit_within(engaged, goal).expect("within reach");
}

/// The caps that a suite tries, `[N]`.
fn caps() -> &'static [f64] {
    match thorough() {
        true => &[15.0, 25.0, ForceCap::DEFAULT_NEWTONS],
        false => &[15.0, ForceCap::DEFAULT_NEWTONS],
    }
}

/// Returns the mean and the greatest force on a wall in the last of three seconds. The wall is 3 cm
/// from the arm, and the goal 5 cm beyond it.
///
/// The wall has no friction. Stiffness that is coupled across axes makes the arm slide on it, the
/// further the deeper the goal is.
fn on_a_wall(
    ready: &dyn Fn() -> Lockstep,
    way: Vector3<f64>,
    gains: Gains,
    force_cap: ForceCap,
) -> (f64, f64) {
    let mut lockstep = tolerant(ready);
    let start = lockstep.arm_pose();
    let engaged = lockstep.engage();
    let at = start.translation.vector + way * 0.03;
    let wall = lockstep
        .robot
        .touch(Touch::wall(at, -way).stiffness(5000.0));
    let beyond = Translation3::from(way * 0.08) * start;
    head_for(&mut lockstep, engaged, beyond.into(), gains, force_cap);
    lockstep.run(2000);
    let (mut mean, mut most) = (0.0, 0.0_f64);
    for _ in 0..1000 {
        lockstep.tick();
        let force = force(&lockstep, wall).norm();
        mean += force / 1000.0;
        most = most.max(force);
    }
    assert_eq!(lockstep.client.outcome(engaged), None);
    assert_eq!(lockstep.client.state.robot_mode, RobotMode::Move);
    (mean, most)
}

#[test]
fn an_arm_held_at_its_leash_pulls_with_no_more_than_the_cap() {
    for_each_robot(|ready| {
        for way in directions() {
            for (name, gains) in each_gains() {
                let (free, _) = on_a_wall(ready, way, gains, ForceCap::Off);
                for &cap in caps() {
                    let (mean, most) = on_a_wall(ready, way, gains, ForceCap::Newtons(cap));
                    println!("{name}: {free:.1} N, {mean:.2} N ({most:.2} N) under {cap} N");
                    // Joint friction opposes the spring a little.
                    assert!(most <= 1.05 * cap, "{way}, {name}: {most} N under {cap} N");
                    assert!(mean >= 0.95 * cap.min(free), "{way}, {name}: {mean} N");
                }
            }
        }
    });
}

/// Forces of a push, `[N]`.
#[derive(Debug, Default)]
struct ContactForces {
    /// The greatest contact force.
    whole: f64,
    /// The greatest contact force without the part that accelerates the arm.
    pressed: f64,
    /// The mean over the last 100 ms, when the hand moves at constant velocity.
    steady: f64,
    /// The number of milliseconds in which the cap bound.
    capped: u32,
}

/// A hand pushes the end effector of an arm that holds its pose.
fn pushed(
    ready: &dyn Fn() -> Lockstep,
    way: Vector3<f64>,
    gains: Gains,
    force_cap: ForceCap,
) -> ContactForces {
    let mut lockstep = tolerant(ready);
    let body = ArmInertia::of(&lockstep);
    let engaged = lockstep.engage();
    let start = lockstep.arm_pose();
    head_for(&mut lockstep, engaged, start.into(), gains, force_cap);
    lockstep.run(500);
    let from = lockstep.arm_pose().translation.vector;
    let push = Touch::carry(move |t| from + way * hand(t), STIFFNESS);
    let push = lockstep.robot.touch(push);
    let mut felt = ContactForces::default();
    for cycle in 0..PUSH {
        let (q, dq) = (*lockstep.robot.q(), *lockstep.robot.dq());
        lockstep.tick();
        let ddq = (lockstep.robot.dq() - dq) / 1e-3;
        let force = force(&lockstep, push);
        let pressed = force - body.inertial(&q, &dq, &ddq);
        felt.whole = felt.whole.max(force.norm());
        felt.pressed = felt.pressed.max(pressed.norm());
        if cycle + 100 >= PUSH {
            felt.steady += force.norm() / 100.0;
        }
        let bindings = lockstep.client.record.bindings;
        felt.capped += u32::from(bindings.contains(Guard::ForceCap));
    }
    assert_eq!(lockstep.client.state.robot_mode, RobotMode::Move);
    felt
}

#[test]
fn a_pushing_hand_meets_at_most_the_cap_and_more_without_one() {
    for_each_robot(|ready| {
        for way in directions() {
            for (name, gains) in each_gains() {
                let free = pushed(ready, way, gains, ForceCap::Off);
                println!("{name}: {free:.1?}");
                assert_eq!(free.capped, 0);
                assert!(
                    free.pressed > 1.1 * ForceCap::DEFAULT_NEWTONS,
                    "{way}, {name}: {free:?}"
                );
                for &cap in caps() {
                    let felt = pushed(ready, way, gains, ForceCap::Newtons(cap));
                    println!("  {cap} N: {felt:.1?}");
                    assert!(felt.capped > 20, "{way}, {name}: {felt:?}");
                    assert!(
                        felt.pressed <= 1.1 * cap,
                        "{way}, {name}, {cap} N: {felt:?}"
                    );
                }
            }
        }
    });
}

/// A load on the flange, 5 cm in front of it, `[kg]`.
fn load(mass: f64) -> Load {
    Load {
        mass,
        com: Vector3::new(0.0, 0.0, 0.05),
        inertia: nalgebra::Matrix3::identity() * (mass * 2e-3),
    }
}

fn declare(lockstep: &mut Lockstep, load: &Load) {
    let mut inertia = [0.0; 9];
    inertia.copy_from_slice(load.inertia.as_slice());
    lockstep.request(&Request::SetLoad(franka_proto::Load {
        m_load: load.mass,
        F_x_Cload: load.com.into(),
        I_load: inertia,
    }));
    lockstep.run(1000);
}

/// Settle tolerances that an arm sagging under an undeclared load still meets.
const SAG: Tolerance = Tolerance {
    translation: 0.01,
    rotation: 0.05,
};

/// Runs until the goal has arrived. Returns the number of milliseconds in which the cap bound.
fn capped_until_it_arrives(lockstep: &mut Lockstep, engaged: GoalId, target: Target) -> u32 {
    let goal = Goal {
        tolerance: Some(SAG),
        ..lockstep.goal(target, OnArrival::ReportAndHold)
    };
    let goal = Goal {
        force_cap: ForceCap::Default,
        ..goal
    };
    let goal = lockstep.submit_within(engaged, goal).expect("within reach");
    let mut capped = 0;
    while lockstep.client.outcome(goal).is_none() {
        lockstep.tick();
        let bindings = lockstep.client.record.bindings;
        capped += u32::from(bindings.contains(Guard::ForceCap));
    }
    lockstep.until_resolved(goal, 1).expect("an arrival");
    capped
}

#[test]
fn unobstructed_motions_do_not_reach_the_default_cap() {
    for_each_robot(|ready| {
        for (mass, declared) in [(0.0, false), (3.0, true), (0.5, false)] {
            let mut lockstep = tolerant(ready);
            if mass > 0.0 {
                lockstep.robot.attach(load(mass));
            }
            if declared {
                declare(&mut lockstep, &load(mass));
            }
            let engaged = lockstep.engage();
            let mut capped = 0;
            for way in directions() {
                for sign in [1.0, -1.0] {
                    let step = Translation3::from(way * 0.05 * sign);
                    let target = (step * lockstep.reference_pose()).into();
                    capped += capped_until_it_arrives(&mut lockstep, engaged, target);
                }
            }
            for joint in 0..7 {
                let mut q = lockstep.client.record.q_ref;
                q[joint] += 0.4;
                let target = Target::Joints(q);
                capped += capped_until_it_arrives(&mut lockstep, engaged, target);
            }
            // A stop at full speed.
            let far = Translation3::new(0.0, 0.2, 0.0) * lockstep.reference_pose();
            lockstep
                .within(engaged, far.into(), OnArrival::Hold)
                .expect("within reach");
            lockstep.run(700);
            capped += capped_until_it_arrives(&mut lockstep, engaged, Target::Rest);
            assert_eq!(capped, 0, "{mass} kg, declared: {declared}");
        }
    });
}

#[test]
fn an_undeclared_load_is_held_up_to_the_cap_and_always_reported() {
    for_each_robot(|ready| {
        for (mass, force_cap) in [
            (2.0, ForceCap::Off),
            (2.0, ForceCap::Default),
            (4.0, ForceCap::Off),
            (4.0, ForceCap::Default),
        ] {
            let mut lockstep = tolerant(ready);
            let engaged = lockstep.engage();
            let mut q: [f64; 7] = (*lockstep.robot.q()).into();
            q[0] += 0.2;
            let goal = Goal {
                force_cap,
                ..lockstep.goal(Target::Joints(q), OnArrival::ReportAndHold)
            };
            lockstep.robot.attach(load(mass));
            let id = lockstep.submit_within(engaged, goal).expect("in range");
            let outcome = lockstep.until_resolved(id, 30_000);
            println!("{mass} kg, {force_cap:?}: {}", described(&outcome));
            let error = outcome.expect_err("it is not within a millimetre");
            let borne = force_cap.newtons().is_none_or(|cap| mass * 9.81 < cap);
            let short = matches!(error, MotionError::TargetNotReached(_));
            assert_eq!(short, borne, "{mass} kg: {error}");
        }
    });
}

/// The undeclared load exceeds the cap, and the goal itself has no end. The cap bounds the dampers
/// as well, so the load displaces the arm like a hand and the arm keeps sinking. It may reach a
/// limit of the robot before it rests.
#[test]
fn the_sinking_of_a_held_arm_is_reported() {
    for_each_robot(|ready| {
        for mass in [3.3, 5.0] {
            for stiff in [false, true] {
                let mut lockstep = tolerant(ready);
                let start = lockstep.arm_pose();
                let engaged = lockstep.engage();
                let target = if stiff {
                    Target::Joints((*lockstep.robot.q()).into())
                } else {
                    start.into()
                };
                let goal = lockstep.goal(target, OnArrival::Hold);
                let id = lockstep
                    .submit_within(engaged, goal)
                    .expect("it is there already");
                lockstep.run(500);
                assert_eq!(lockstep.client.outcome(id), None);
                lockstep.robot.attach(load(mass));
                let outcome = lockstep.until_resolved(id, 10_000);
                println!("{mass} kg, stiff joints: {stiff}: {}", described(&outcome));
                let given_up = Err(MotionError::Braked(Lapse::Displaced));
                let fell = matches!(outcome, Err(MotionError::Control(_)));
                assert!(outcome == given_up || fell, "{outcome:?}");
            }
        }
    });
}

fn described(outcome: &Outcome) -> String {
    outcome.as_ref().map_or_else(
        |error| error.to_string(),
        |report| format!("{:?}", report.final_error),
    )
}
