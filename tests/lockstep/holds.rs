//! Holds of arms that stick: how far from its target an arm rests after steps of 5 cm.

use franka_model::RobotKind;
use franka_rt::session::OnArrival;
use franka_sim::Config;
use franka_sim::arm::{Arm, Family};
use franka_tests::lockstep::Lockstep;
use nalgebra::{Translation3, Vector3};

/// The time from the start of a step to the reading, `[ms]`.
const HOLD: u64 = 1200;

/// Distances from the target in the holds of sixteen steps along the axes, in increasing order,
/// `[m]`.
fn holds(arm: Arm, seed: u64) -> Vec<f64> {
    let mut lockstep = Lockstep::new(Config {
        arm: Some(arm),
        seed,
        ..Lockstep::config_of(RobotKind::Fer)
    });
    let engaged = lockstep.engage();
    let home = lockstep.arm_pose();
    let ways = [Vector3::x(), Vector3::y(), -Vector3::z(), -Vector3::x()];
    let mut errors = Vec::new();
    for step in 0..16 {
        let away = match step % 2 {
            0 => ways[step / 2 % 4] * 0.05,
            _ => Vector3::zeros(),
        };
        let target = Translation3::from(away) * home;
        let goal = lockstep.within(engaged, target.into(), OnArrival::Hold);
        goal.expect("within reach");
        lockstep.run(HOLD);
        let off = lockstep.arm_pose().translation.vector - target.translation.vector;
        errors.push(off.norm());
    }
    assert_eq!(lockstep.client.outcome(engaged), None);
    errors.sort_by(f64::total_cmp);
    errors
}

#[test]
fn realistic_arms_rest_millimetres_from_their_targets_and_ideal_ones_do_not() {
    let mut medians: Vec<f64> = (0..10)
        .map(|seed| {
            let errors = holds(
                Arm::sample(RobotKind::Fer, seed, &Family::realistic()),
                seed,
            );
            let (median, most) = (errors[errors.len() / 2], errors[errors.len() - 1]);
            println!(
                "seed {seed}: {:.2} mm, at most {:.2} mm",
                median * 1e3,
                most * 1e3
            );
            median
        })
        .collect();
    medians.sort_by(f64::total_cmp);
    // Two robots under a law of 750 N/m rested 2.8 and 4.6 mm off: these stick somewhat more (the
    // book, real-arm.md).
    let median = (medians[4] + medians[5]) / 2.0;
    assert!((2e-3..5e-3).contains(&median), "{medians:?}");
    let ideal = holds(Arm::ideal(RobotKind::Fer), 1);
    assert!(ideal[15] < 1e-3, "{ideal:?}");
}
