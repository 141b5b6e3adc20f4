//! Identification of arms: estimates against an arm's true parameters, and the benefit for a later
//! connection.

use franka_lockstep::Lockstep;
use franka_model::{JointVector, Load, Model, RobotKind};
use franka_proto::Request;
use franka_rt::identify::{Estimate, Fit, FitError, Identified, Plan};
use franka_rt::lifecycle::Lifecycle;
use franka_rt::session::{Goal, OnArrival};
use franka_sim::Config;
use franka_sim::arm::{Arm, Family, Friction};
use franka_tests::thorough;
use nalgebra::{Translation3, Vector3, Vector6};

/// Load on the flange besides the hand: mass and centre.
const CARRIED: (f64, [f64; 3]) = (0.5, [0.0, 0.02, 0.1]);

/// A realistic arm of a kind that its seed decides, which carries a load or not.
fn realistic(seed: u64, carries: bool) -> (Lockstep, Arm) {
    sample(&Family::realistic(), seed, carries)
}

fn sample(family: &Family, seed: u64, carries: bool) -> (Lockstep, Arm) {
    let kind = RobotKind::ALL[seed as usize % 2];
    let arm = Arm::sample(kind, seed, family);
    let mut lockstep = Lockstep::new(Config {
        arm: Some(arm.clone()),
        seed,
        ..Lockstep::config_of(kind)
    });
    println!("{kind:?}, seed {seed}");
    if carries {
        let (mass, com) = CARRIED;
        lockstep.robot.attach(Load {
            mass,
            com: com.into(),
            ..Load::NONE
        });
        lockstep.run(500);
    }
    (lockstep, arm)
}

fn model(lockstep: &Lockstep) -> &'static Model {
    Model::of(lockstep.robot.config().kind)
}

/// Declares the load that is carried.
#[allow(non_snake_case)] // the vendor's names
fn declare(lockstep: &mut Lockstep) {
    let (m_load, F_x_Cload) = CARRIED;
    lockstep.request(&Request::SetLoad(franka_proto::Load {
        m_load,
        F_x_Cload,
        I_load: [0.0; 9],
    }));
    lockstep.run(100);
}

/// Does the same as `Identify::run` of the async API, and calls `meanwhile` in every cycle.
fn identify(
    lockstep: &mut Lockstep,
    mut meanwhile: impl FnMut(&mut Lockstep),
) -> Result<Identified, FitError> {
    let plan = Plan::new(model(lockstep), &lockstep.client.state);
    let mut fit = Fit::new(model(lockstep), &lockstep.client.state);
    let engaged = lockstep.engage();
    let begun = lockstep.now();
    for motion in plan.motions() {
        let goal = Goal {
            budget: plan.budget(),
            tolerance: Some(Plan::TOLERANCE),
            ..lockstep.goal(motion.to.into(), OnArrival::ReportAndHold)
        };
        let goal = lockstep.submit_within(engaged, goal).expect("within reach");
        while lockstep.client.outcome(goal).is_none() {
            lockstep.tick();
            fit.on_record(&lockstep.client.record);
            meanwhile(lockstep);
        }
        lockstep.until_resolved(goal, 1).expect("it arrives");
    }
    let (took, planned) = ((lockstep.now() - begun) as f64 * 1e-3, plan.duration());
    let planned = planned.as_secs_f64();
    println!("{} motions, {took:.1} s", plan.motions().len());
    assert!((took - planned).abs() < 0.3 * planned, "{planned} s");
    lockstep.disengage(engaged);
    lockstep.until_idle(2000);
    fit.finish()
}

/// Distance of the end effector behind its reference in the first motions of a new connection, 5 cm
/// up, down and up again, `[m]`.
fn lags(lockstep: &mut Lockstep, known: Option<Identified>, declared: bool) -> [f64; 3] {
    lockstep.reconnect();
    if let Some(known) = known {
        let version = lockstep.client.version();
        let lifecycle = Lifecycle::new(model(lockstep).clone().into(), version);
        lockstep.client.lifecycle = lifecycle.knowing(known);
    }
    if declared {
        declare(lockstep);
    }
    let low = lockstep.arm_pose();
    let lags = [0.05, 0.0, 0.05].map(|height| {
        let target = Translation3::new(0.0, 0.0, height) * low;
        lockstep.lag_to(target)
    });
    println!("lag {:.2?} mm", lags.map(|lag| lag * 1e3));
    lags
}

/// Friction of each joint at the speed of the plan, `[N·m]`. At this speed the Stribeck curve of
/// joint 7 has not always fallen to the kinetic torque.
fn moving(friction: &Friction) -> JointVector {
    JointVector::from_fn(|i, _| {
        let (least, most) = (friction.kinetic_torque[i], friction.static_torque[i]);
        let ratio = Plan::SPEED / friction.stribeck_speed[i];
        let sliding = least + (most - least) * (-ratio * ratio).exp();
        sliding + friction.viscous[i] * Plan::SPEED
    })
}

/// True if an estimate is within this many of its deviations.
fn agrees(found: &Estimate, truth: f64, deviations: f64) -> bool {
    (found.value - truth).abs() < deviations * found.deviation
}

#[test]
fn identification_finds_realistic_arms_and_reduces_lag() {
    for seed in 0..if thorough() { 12 } else { 4 } {
        let carries = seed % 4 > 1;
        let (mut lockstep, arm) = realistic(seed, carries);
        let found = identify(&mut lockstep, |_| {}).expect("nothing disturbs it");
        println!("{found}");
        let moving = moving(&arm.friction);
        for (joint, truth) in found.joints.iter().zip(moving.iter()) {
            let off = joint.friction.value - truth;
            assert!(off.abs() < 0.05, "{off} N m");
            assert!(agrees(&joint.friction, *truth, 4.0), "{joint:?}, {truth}");
        }
        let mass = arm.body.undeclared_mass + if carries { CARRIED.0 } else { 0.0 };
        println!("{mass:.3} kg, found {:.3}", found.load.mass);
        assert!((found.load.mass.value - mass).abs() < 0.15, "{mass} kg");
        assert!(agrees(&found.load.mass, mass, 3.0), "{mass} kg");
        let [unknown, _, later] = lags(&mut lockstep, None, false);
        let [known, ..] = lags(&mut lockstep, Some(found), false);
        assert!(known < 0.6 * unknown, "{known} m, {unknown} m");
        assert!(known < 1.3 * later, "{known} m, {later} m");
        if carries {
            // A declared load is no longer a bias.
            let [declared, ..] = lags(&mut lockstep, Some(found), true);
            assert!(declared < 0.6 * unknown, "{declared} m");
        }
    }
}

/// The errors of the arms' masses exceed the estimated deviations.
#[test]
fn bad_arms_are_found_roughly() {
    let (mut friction_off, mut mass_off) = (0.0_f64, 0.0_f64);
    for seed in 0..if thorough() { 6 } else { 3 } {
        let (mut lockstep, arm) = sample(&Family::bad(), seed, false);
        let found = identify(&mut lockstep, |_| {}).expect("nothing disturbs it");
        let moving = moving(&arm.friction);
        for (joint, truth) in found.joints.iter().zip(moving.iter()) {
            friction_off = friction_off.max((joint.friction.value - truth).abs());
        }
        mass_off = mass_off.max((found.load.mass.value - arm.body.undeclared_mass).abs());
    }
    println!("{friction_off:.3} N m, {mass_off:.3} kg");
    assert!(friction_off < 0.1, "{friction_off} N m");
    assert!(mass_off < 0.3, "{mass_off} kg");
}

/// The estimate of the load is the same, declared or not.
#[test]
fn a_load_is_found_whether_it_is_declared_or_not() {
    let [hidden, declared] = [false, true].map(|declared| {
        let (mut lockstep, _) = realistic(3, true);
        if declared {
            declare(&mut lockstep);
        }
        let found = identify(&mut lockstep, |_| {}).expect("nothing disturbs it");
        println!("{found}");
        found.load
    });
    let off = hidden.mass.value - declared.mass.value;
    assert!(off.abs() < 0.02, "{off} kg");
    let centers = [hidden, declared].map(|load| {
        let center = load.center().expect("more than three deviations");
        Vector3::from(center.map(|of| of.value))
    });
    let off = (centers[0] - centers[1]).norm();
    assert!(off < 0.01, "{centers:?}");
    let off = (centers[0] - Vector3::from(CARRIED.1)).norm();
    assert!(off < 0.04, "{centers:?}");
}

#[test]
fn an_arm_that_is_pushed_meanwhile_is_not_identified() {
    let (mut lockstep, _) = realistic(4, false);
    let begun = lockstep.now();
    let found = identify(&mut lockstep, |lockstep| {
        if lockstep.now() == begun + 20_000 {
            let up = Vector6::new(0.0, 0.0, 10.0, 0.0, 0.0, 0.0);
            lockstep.robot.push_end_effector(up, 15_000);
        }
    });
    println!("{found:?}");
    assert!(
        matches!(found, Err(FitError::Disturbed { .. })),
        "{found:?}"
    );
}
