//! The stiffest gains that users of libfranka set, on every plant.

use crate::pair::*;
use crate::plants::robots;

/// Calls `test` for every robot with a bare flange, which is the least stable case.
fn for_each_plant(test: impl Fn(&mut Pair, &str)) {
    let config = Config {
        // The test is about gains, so an impact must not cause a reflex.
        enforce_limits: false,
        ..Config::default()
    };
    for (name, mut pair) in robots(&config) {
        test(&mut pair, &name);
    }
}

/// Hits every joint. Returns the largest speed of any joint half a second later, `[rad/s]`.
fn ringing(pair: &mut Pair, mut command: impl FnMut(&Pair) -> RobotCommand) -> f64 {
    let blow = JointVector::from([20.0, -20.0, 20.0, 20.0, -5.0, 5.0, 3.0]);
    pair.robot.push_joints(blow, 20);
    let mut fastest = 0.0_f64;
    for cycle in 0..1000 {
        let command = command(pair);
        pair.tick(Some(command));
        if cycle >= 500 {
            fastest = fastest.max(pair.robot.dq().amax());
        }
    }
    assert_eq!(pair.state.robot_mode, RobotMode::Move);
    fastest
}

#[test]
fn the_stiffest_joint_impedance_does_not_ring() {
    for_each_plant(|pair, name| {
        pair.request(&Request::SetJointImpedance([14250.0; 7]));
        pair.start_joints();
        let hold = pair.q_d();
        let fastest = ringing(pair, |_| positions(&hold));
        assert!(fastest < 1e-3, "{name}: {fastest} rad/s");
    });
}

#[test]
fn the_stiffest_cartesian_impedance_does_not_ring() {
    for_each_plant(|pair, name| {
        let stiffness = [3000.0, 3000.0, 3000.0, 300.0, 300.0, 300.0];
        pair.request(&Request::SetCartesianImpedance(stiffness));
        pair.start(
            MoveControllerMode::CartesianImpedance,
            MoveGeneratorMode::JointPosition,
        );
        let hold = pair.q_d();
        let fastest = ringing(pair, |_| positions(&hold));
        // Motion in the null space of the task has only damping.
        assert!(fastest < 2e-2, "{name}: {fastest} rad/s");
    });
}

/// The client applies its gains once per millisecond, to a state that is one cycle old. The gains
/// are from libfranka 0.21, `joint_impedance_control.cpp`. The second case uses four times the
/// stiffness and twice the damping.
#[test]
fn a_clients_stiff_impedance_does_not_ring() {
    for factor in [1.0, 2.0] {
        for_each_plant(|pair, name| {
            pair.start_torques();
            let hold = pair.q();
            let k = JointVector::from([600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0]);
            let d = JointVector::from([50.0, 50.0, 50.0, 50.0, 30.0, 25.0, 15.0]);
            let (k, d) = (k * factor * factor, d * factor);
            let fastest = ringing(pair, |pair| {
                let dq = JointVector::from(pair.state.dq);
                torques(&(k.component_mul(&(hold - pair.q())) - d.component_mul(&dq)))
            });
            assert!(fastest < 1e-2, "{factor} {name}: {fastest} rad/s");
        });
    }
}
