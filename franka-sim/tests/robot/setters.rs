use franka_model::{JointVector, READY};
use franka_proto::{
    CollisionBehavior, Filters, Load, MoveControllerMode, MoveGeneratorMode, Request, RobotError,
    SetterStatus, Status,
};
use franka_sim::Touch;
use nalgebra::Vector3;

use crate::pair::{Pair, positions};

const SUCCESS: Status = Status::Setter(SetterStatus::Success);
const INVALID: Status = Status::Setter(SetterStatus::InvalidArgumentRejected);
const NOT_POSSIBLE: Status = Status::Setter(SetterStatus::CommandNotPossibleRejected);

fn mirrored() -> [f64; 16] {
    let mut matrix = [0.0; 16];
    (matrix[0], matrix[5], matrix[10], matrix[15]) = (-1.0, 1.0, 1.0, 1.0);
    matrix
}

#[test]
fn a_value_out_of_its_range_is_an_invalid_argument() {
    let mut pair = Pair::fr3();
    let mut negative = CollisionBehavior::uniform([20.0; 7], [40.0; 7], [20.0; 6], [40.0; 6]);
    negative.lower_force_thresholds_nominal[0] = -1.0;
    let light = Load {
        m_load: -0.1,
        ..Load::default()
    };
    for request in [
        Request::SetJointImpedance([14_250.1; 7]),
        Request::SetJointImpedance([f64::NAN; 7]),
        Request::SetCartesianImpedance([3000.1, 100.0, 100.0, 10.0, 10.0, 10.0]),
        Request::SetCartesianImpedance([100.0, 100.0, 100.0, 0.9, 10.0, 10.0]),
        Request::SetCollisionBehavior(negative),
        Request::SetEEToK(mirrored()),
        Request::SetNEToEE(mirrored()),
        Request::SetLoad(light),
    ] {
        assert_eq!(pair.ask(&request), INVALID, "{request:?}");
    }
    let mut pair = Pair::fer();
    let filters = Request::SetFilters(Filters::uniform(0.5));
    assert_eq!(pair.ask(&filters), INVALID);
}

/// Returns every setter with one large finite number in it.
fn large(value: f64) -> [Request; 8] {
    let mut frame = mirrored();
    frame[0] = 1.0;
    frame[12] = value;
    let load = |mass: f64, com: f64, inertia: f64| {
        Request::SetLoad(Load {
            m_load: mass,
            F_x_Cload: [0.0, 0.0, com],
            I_load: [inertia, 0.0, 0.0, 0.0, inertia, 0.0, 0.0, 0.0, inertia],
        })
    };
    [
        load(value, 0.0, 0.0),
        load(1.0, value, 0.0),
        load(1.0, 0.0, value),
        Request::SetEEToK(frame),
        Request::SetNEToEE(frame),
        Request::SetJointImpedance([value; 7]),
        Request::SetCartesianImpedance([value; 6]),
        Request::SetCollisionBehavior(CollisionBehavior::uniform(
            [value; 7], [value; 7], [value; 6], [value; 6],
        )),
    ]
}

#[test]
fn huge_setter_values_move_no_standing_arm() {
    for kind in [Pair::fr3, Pair::fer] {
        let mut pair = kind();
        for value in [1e6, 1e20, 1e300] {
            for request in large(value) {
                // Very large thresholds are harmless, because they are never reached.
                let expected = match request {
                    Request::SetCollisionBehavior(_) => SUCCESS,
                    _ => INVALID,
                };
                assert_eq!(pair.ask(&request), expected, "{request:?}");
                pair.idle(20);
                assert!(pair.robot.dq().amax() < 1e-6, "{request:?}");
            }
        }
        pair.start(
            MoveControllerMode::CartesianImpedance,
            MoveGeneratorMode::JointPosition,
        );
        for _ in 0..100 {
            pair.tick(Some(positions(&READY)));
        }
        assert!((pair.q() - READY).amax() < 1e-6, "{}", pair.q());
    }
}

#[test]
fn largest_accepted_setter_values_leave_arm_controllable() {
    let inertia = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let load = |m_load: f64, com: f64| {
        Request::SetLoad(Load {
            m_load,
            F_x_Cload: [0.0, com, 0.0],
            I_load: inertia,
        })
    };
    let mut frame = mirrored();
    frame[0] = 1.0;
    frame[12] = 2.0;
    let requests = [
        load(10.0, 0.0),
        load(1.0, 1.0),
        Request::SetEEToK(frame),
        Request::SetNEToEE(frame),
    ];
    for request in requests {
        let mut pair = Pair::fr3();
        assert_eq!(pair.ask(&request), SUCCESS, "{request:?}");
        for _ in 0..2000 {
            pair.tick(None);
            assert!(pair.robot.dq().amax() < 2.0, "{request:?}");
        }
        assert!(pair.robot.dq().amax() < 1e-2, "{request:?}");
        assert!((pair.q() - READY).amax() < 0.1, "{request:?}: {}", pair.q());
    }
}

#[test]
fn physics_that_diverges_is_an_error_that_can_be_recovered_from() {
    for (touch, kind) in [(1e300, Pair::fr3 as fn() -> Pair), (f64::NAN, Pair::fer)] {
        let mut pair = kind();
        let id = pair.start_torques();
        let touch = pair.robot.touch(Touch::torque(JointVector::repeat(touch)));
        pair.tick(None);
        pair.assert_reflex(id, &[RobotError::InstabilityDetected]);
        pair.idle(10);
        assert!((pair.q() - pair.robot.q()).amax() < 1e-6);
        assert!((pair.q() - READY).amax() < 1e-6, "{}", pair.q());
        assert!(pair.robot.release(touch));
        pair.recover();
        pair.start_joints();
        for _ in 0..100 {
            pair.tick(Some(positions(&READY)));
        }
        assert!(pair.state.errors.is_empty());
    }
}

#[test]
fn a_threshold_of_zero_is_always_reached() {
    let zero = CollisionBehavior::uniform([0.0; 7], [0.0; 7], [0.0; 6], [0.0; 6]);
    let mut pair = Pair::fr3();
    assert_eq!(pair.ask(&Request::SetCollisionBehavior(zero)), SUCCESS);
    pair.idle(1);
    assert_eq!(pair.state.joint_contact, [1.0; 7]);
    assert_eq!(pair.state.cartesian_contact, [1.0; 6]);
    // An arm at rest has no motion to end.
    assert!(pair.state.errors.is_empty());
    let id = pair.request(&Request::Move(franka_proto::MoveRequest::new(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointPosition,
    )));
    pair.tick(None);
    pair.assert_reflex(id, &[RobotError::JointReflex, RobotError::CartesianReflex]);
}

#[test]
fn a_joint_stiffness_of_zero_is_an_arm_that_only_carries_itself() {
    let mut pair = Pair::fr3();
    assert_eq!(pair.ask(&Request::SetJointImpedance([0.0; 7])), SUCCESS);
    // The documented ranges of the Cartesian stiffness begin above zero.
    assert_eq!(pair.ask(&Request::SetCartesianImpedance([0.0; 6])), INVALID);
    pair.start_joints();
    for _ in 0..500 {
        pair.tick(Some(positions(&READY)));
    }
    assert!((pair.q() - READY).amax() < 1e-3, "{}", pair.q());
    let mut push = JointVector::zeros();
    push[6] = 2.0;
    pair.robot.push_joints(push, 200);
    for _ in 0..200 {
        pair.tick(Some(positions(&READY)));
    }
    assert!(pair.q()[6] > READY[6] + 0.05, "{}", pair.q());
    assert!(pair.state.errors.is_empty(), "{:?}", pair.state.errors);
}

#[test]
fn in_a_motion_no_setter_is_possible() {
    let mut pair = Pair::fr3();
    pair.start_torques();
    let mut frame = mirrored();
    frame[0] = 1.0;
    for request in [
        Request::SetJointImpedance([1000.0; 7]),
        Request::SetCartesianImpedance([1000.0, 1000.0, 1000.0, 100.0, 100.0, 100.0]),
        Request::SetCollisionBehavior(CollisionBehavior::uniform(
            [20.0; 7], [40.0; 7], [20.0; 6], [40.0; 6],
        )),
        Request::SetGuidingMode {
            guiding_mode: [true; 6],
            nullspace: true,
        },
        Request::SetEEToK(frame),
        Request::SetNEToEE(frame),
        Request::SetLoad(Load::default()),
    ] {
        assert_eq!(pair.ask(&request), NOT_POSSIBLE, "{request:?}");
    }
    // A client may request the description at any time.
    let id = pair.request(&Request::GetRobotModel);
    assert_eq!(pair.statuses(id).len(), 1);
}

#[test]
fn the_joint_stiffness_is_that_of_the_internal_controller() {
    let mut torque = JointVector::zeros();
    torque[3] = 5.0;
    for stiffness in [100.0, 500.0, 14_250.0] {
        let mut pair = Pair::fr3();
        let status = pair.ask(&Request::SetJointImpedance([stiffness; 7]));
        assert_eq!(status, SUCCESS);
        pair.start_joints();
        pair.robot.touch(Touch::torque(torque));
        for _ in 0..2500 {
            pair.tick(Some(positions(&READY)));
        }
        let yielded = pair.robot.q()[3] - READY[3];
        let expected = torque[3] / stiffness;
        assert!(
            (yielded - expected).abs() < 0.05 * expected,
            "{stiffness}: {yielded} instead of {expected}"
        );
    }
}

#[test]
fn cartesian_controller_is_soft_in_its_soft_axes_only() {
    let give = |stiffness: [f64; 6], force: Vector3<f64>| {
        let mut pair = Pair::fr3();
        assert_eq!(
            pair.ask(&Request::SetCartesianImpedance(stiffness)),
            SUCCESS
        );
        pair.start(
            MoveControllerMode::CartesianImpedance,
            MoveGeneratorMode::JointPosition,
        );
        let before = Vector3::from(pair.position());
        pair.robot.touch(Touch::force(force));
        for _ in 0..2500 {
            pair.tick(Some(positions(&READY)));
        }
        Vector3::from(pair.position()) - before
    };
    let down = Vector3::new(0.0, 0.0, -10.0);
    let soft_z = [3000.0, 3000.0, 300.0, 300.0, 300.0, 300.0];
    let soft_x = [300.0, 3000.0, 3000.0, 300.0, 300.0, 300.0];
    let sunk = -give(soft_z, down).z;
    assert!((sunk - 10.0 / 300.0).abs() < 0.1 * sunk, "{sunk}");
    let sunk = -give(soft_x, down).z;
    assert!((sunk - 10.0 / 3000.0).abs() < 0.1 * sunk, "{sunk}");
}
