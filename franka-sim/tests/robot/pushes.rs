//! Pushes on the flange on every plant: the force that the robot estimates, and how far an
//! impedance yields.

use franka_model::{Frame, Twist, rotation, transform};
use nalgebra::{Isometry3, Vector3};

use crate::pair::*;
use crate::plants::{robots, robots_with_and_without_hand};
use franka_sim::Touch;

/// Force with which a hand pushes, `[N]`.
const PUSH: f64 = 5.0;

/// Stiffness of the yielding impedances, `[N/m]`.
const STIFFNESS: f64 = 750.0;

/// Number of cycles until an impedance has yielded to a push, or has returned, except for a
/// hundredth of the distance.
const SETTLING: usize = 1500;

fn directions() -> [Vector3<f64>; 5] {
    [
        [1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, -1.0],
        [0.6, 0.0, 0.8],
        [-0.48, 0.64, 0.6],
    ]
    .map(Vector3::from)
}

fn push(pair: &mut Pair, direction: &Vector3<f64>) -> franka_sim::TouchId {
    let push = Touch::force(direction * PUSH).at(Frame::Flange);
    pair.robot.touch(push)
}

/// Returns the force of the hand on the robot, which is the negative force in the state.
fn felt(pair: &Pair) -> Vector3<f64> {
    let [x, y, z, ..] = pair.state.O_F_ext_hat_K;
    -Vector3::new(x, y, z)
}

fn end_effector(pair: &Pair) -> Isometry3<f64> {
    let pose = nalgebra::Matrix4::from_column_slice(&pair.state.O_T_EE);
    transform::isometry(&pose).expect("a rigid transform")
}

#[test]
fn push_of_5_newton_reads_true_within_100_milliseconds() {
    for (name, mut pair) in robots_with_and_without_hand() {
        let mut worst = 0.0_f64;
        for direction in directions() {
            let push = push(&mut pair, &direction);
            pair.idle(100);
            for _ in 0..400 {
                let seen = felt(&pair);
                let off = (seen - direction * PUSH).norm();
                worst = worst.max(off).max((seen.norm() - PUSH).abs());
                assert!(off < 0.3, "{name}, {direction}: {seen}");
                pair.tick(None);
            }
            assert!(pair.robot.release(push));
            pair.idle(100);
            assert!(felt(&pair).norm() < 0.3, "{name}, {direction}");
            pair.idle(200);
        }
        println!("{name}: {worst} N off at most");
    }
}

#[test]
fn robot_impedance_yields_by_force_over_stiffness() {
    let run = |name: &str, pair: &mut Pair| {
        let k = STIFFNESS;
        pair.request(&Request::SetCartesianImpedance([
            k, k, k, 200.0, 200.0, 200.0,
        ]));
        pair.start(
            MoveControllerMode::CartesianImpedance,
            MoveGeneratorMode::CartesianPosition,
        );
        let stay = RobotCommand {
            O_T_EE_c: pair.state.O_T_EE_c,
            ..RobotCommand::default()
        };
        gives_way(name, pair, |_| stay);
    };
    for (name, mut pair) in robots_with_and_without_hand() {
        run(&name, &mut pair);
    }
}

#[test]
fn client_impedance_yields_by_force_over_stiffness() {
    for (name, mut pair) in robots(&Config::default()) {
        pair.start_torques();
        let goal = end_effector(&pair);
        let model = pair.model();
        gives_way(&name, &mut pair, |pair| {
            let q = pair.q();
            let jacobian = model.zero_jacobian(Frame::EndEffector, &q, &Default::default());
            let pose = end_effector(pair);
            let shift = (goal.translation.vector - pose.translation.vector) * STIFFNESS;
            let turn = rotation::error(&goal.rotation, &pose.rotation) * 50.0;
            let velocity = jacobian * JointVector::from(pair.state.dq);
            let damper = Twist::from_fn(|i, _| if i < 3 { 55.0 } else { 14.0 } * velocity[i]);
            torques(&jacobian.tr_mul(&(stack(&shift, &turn) - damper)))
        });
    }
}

/// Pushes in each direction until the arm is at rest, and then releases it.
fn gives_way(name: &str, pair: &mut Pair, mut command: impl FnMut(&Pair) -> RobotCommand) {
    let mut run = |pair: &mut Pair, cycles, watch: &mut dyn FnMut(&Pair, usize)| {
        for cycle in 0..cycles {
            let command = command(pair);
            pair.tick(Some(command));
            watch(pair, cycle);
        }
        assert_eq!(pair.state.robot_mode, RobotMode::Move, "{name}");
    };
    let (mut misread, mut astray) = (0.0_f64, 0.0_f64);
    for direction in directions() {
        let start = end_effector(pair).translation.vector;
        let push = push(pair, &direction);
        run(pair, SETTLING, &mut |pair, cycle| {
            // The reading is also correct while the arm yields.
            if (100..500).contains(&cycle) {
                misread = misread.max((felt(pair).norm() - PUSH).abs());
            }
        });
        let moved = end_effector(pair).translation.vector - start;
        let expected = direction * (PUSH / STIFFNESS);
        astray = astray.max((moved - expected).norm() / expected.norm());
        assert!(pair.robot.release(push));
        run(pair, SETTLING, &mut |_, _| {});
    }
    println!("{name}: {misread} N off, {astray} of the way");
    assert!(misread < 0.3, "{name}: {misread} N off");
    assert!(astray < 0.05, "{name}: {astray} of the way off");
}
