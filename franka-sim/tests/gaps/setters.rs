use franka_model::{JointVector, READY};
use franka_proto::{
    CollisionBehavior, Filters, Load, MoveControllerMode, MoveGeneratorMode, Request, SetterStatus,
    Status,
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
    // The description may be asked for at any time.
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
fn the_cartesian_controller_is_soft_in_the_axes_that_are_set_soft() {
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
