//! Robots that compute their poses with other lengths, or other joint frames, than the client.

use franka_lockstep::Lockstep;
use franka_model::RobotKind;
use franka_rt::lifecycle::Engagement;
use franka_rt::session::{Backend, GoalId, OnArrival, Target};
use franka_sim::Config;
use franka_sim::arm::{Arm, StateGeometry};
use nalgebra::{Translation3, Vector3};

/// Largest drift that counts as holding still, `[m/s]`: 0.05 mm in ten minutes.
const CREEP_MAX: f64 = 0.05e-3 / 600.0;

/// Seconds that an arm is held, the first two of which are left to it to settle.
const HOLD: u64 = 20;

/// Runs `test` with a session on each robot whose states have each geometry, for each kind of
/// Cartesian setpoint under each controller; for one in `every` of these cases.
fn for_each_geometry(every: usize, test: impl Fn(&str, &mut Lockstep, GoalId)) {
    let backends = Backend::ROBOT_CONTROLLERS.into_iter();
    let backends = backends.filter(|backend| backend.is_cartesian());
    for (k, kind) in RobotKind::ALL.into_iter().enumerate() {
        for (g, (name, geometry)) in [
            ("described", StateGeometry::DESCRIBED),
            ("recorded", StateGeometry::RECORDED_FR3),
            ("random", StateGeometry::random(5)),
        ]
        .into_iter()
        .enumerate()
        {
            for (b, backend) in backends.clone().enumerate() {
                if (k + g + b) % every != 0 {
                    continue;
                }
                let mut arm = Arm::ideal(kind);
                arm.body.state_geometry = geometry;
                let mut lockstep = Lockstep::new(Config {
                    arm: Some(arm),
                    ..Lockstep::config_of(kind)
                });
                let engaged = lockstep.engage_with(Engagement {
                    backend,
                    ..Engagement::default()
                });
                test(
                    &format!("{kind:?}, {name}, {backend}"),
                    &mut lockstep,
                    engaged,
                );
                let errors = &lockstep.client.state.errors;
                assert!(errors.is_empty(), "{kind:?}, {name}, {backend}: {errors}");
            }
        }
    }
}

/// Where the robot reports its end effector, `[m]`.
fn reported(lockstep: &Lockstep) -> Vector3<f64> {
    let [.., x, y, z, _] = lockstep.client.state.O_T_EE;
    Vector3::new(x, y, z)
}

/// The mean of the reported place over the next second, `[m]`.
fn mean(lockstep: &mut Lockstep) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for _ in 0..1000 {
        lockstep.tick();
        sum += reported(lockstep);
    }
    sum / 1000.0
}

#[test]
fn an_arm_holds_still_whatever_its_states_are_computed_with() {
    let every = if franka_tests::thorough() { 1 } else { 3 };
    for_each_geometry(every, |case, lockstep, _| {
        let before = reported(lockstep);
        lockstep.run(2000);
        let first = mean(lockstep);
        lockstep.run(1000 * (HOLD - 4));
        let last = mean(lockstep);
        let rate = (last - first).norm() / (HOLD - 3) as f64;
        assert!(rate < CREEP_MAX, "{case}: {rate:e} m/s");
        let moved = (last - before).norm();
        assert!(moved < 1e-5, "{case}: {moved:e} m since the start");
    });
}

#[test]
fn an_arm_moves_as_far_as_asked_whatever_its_states_are_computed_with() {
    for_each_geometry(1, |case, lockstep, engaged| {
        let before = reported(lockstep);
        for metres in [0.05, -0.05] {
            let target = Translation3::new(0.0, 0.0, metres) * lockstep.reference_pose();
            let goal = lockstep
                .within(engaged, Target::Pose(target), OnArrival::ReportAndHold)
                .unwrap();
            let report = lockstep.until_resolved(goal, 6000);
            assert!(report.is_ok(), "{case}: {report:?}");
            let way = reported(lockstep) - before;
            let expected = Vector3::new(0.0, 0.0, metres.max(0.0));
            let off = (way - expected).norm();
            // Cartesian controllers rest some hundredths of a millimetre off.
            assert!(off < 3e-5, "{case}: {off:e} m");
        }
        lockstep.disengage(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
    });
}
