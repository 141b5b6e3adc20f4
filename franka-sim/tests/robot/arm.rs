//! Arms that are not ideal, as a client sees them.

use franka_model::{JointVector, READY};
use franka_proto::{RobotCommand, RobotState};
use franka_sim::Arm;
use franka_sim::arm::{Family, Friction};
use nalgebra::Vector3;

use crate::pair::*;

/// Returns a robot with an ideal arm, except for one change.
fn pair(change: impl Fn(&mut Arm)) -> Pair {
    let mut arm = Arm::ideal(RobotKind::Fr3);
    change(&mut arm);
    Pair::new(Config {
        arm: Some(arm),
        ..Config::default()
    })
}

/// Commands a torque on joint 1 that rises to `most`, for this number of milliseconds.
fn lean(pair: &mut Pair, most: f64, milliseconds: u32) -> RobotState {
    for cycle in 0..milliseconds {
        let torque = most * (f64::from(cycle) * 1e-3).min(1.0);
        let mut tau = JointVector::zeros();
        tau[0] = torque;
        pair.tick(Some(torques(&tau)));
    }
    pair.state
}

#[test]
fn estimate_shows_friction_of_the_link_side_only() {
    for share in [0.0, 0.5, 1.0] {
        let mut pair = pair(|arm| {
            arm.friction = Friction {
                link_share: JointVector::repeat(share),
                ..Arm::realistic(RobotKind::Fr3).friction
            };
        });
        let before = pair.state.tau_J[0];
        pair.start_torques();
        let state = lean(&mut pair, 0.6, 2500);
        assert!((pair.robot.q() - READY).amax() < 1e-3, "it sticks");
        let (sensed, external) = (state.tau_J[0] - before, state.tau_ext_hat_filtered[0]);
        assert!((sensed - 0.6 * share).abs() < 0.01, "{share}: {sensed}");
        assert!(
            (external.abs() - 0.6 * share).abs() < 0.01,
            "{share}: {external}"
        );
    }
}

#[test]
fn an_offset_of_the_torque_sensors_shows_and_pulls() {
    let offset = 0.3;
    let mut pair = pair(|arm| {
        arm.friction = Friction::NONE;
        arm.sensors.torque_offset[1] = offset;
    });
    pair.idle(1000);
    let shown = pair.state.tau_ext_hat_filtered[1].abs();
    // The robot's own controller holds the arm, so the sensor reads the weight of the arm plus the
    // offset.
    assert!((shown - offset).abs() < 0.02, "{shown}");
    // Under torque control nothing holds the arm, because the torque loop interprets the offset as
    // torque.
    let before = pair.robot.q()[1];
    pair.start_torques();
    for _ in 0..300 {
        pair.tick(Some(RobotCommand::default()));
    }
    let moved = pair.robot.q()[1] - before;
    assert!(moved < -1e-3, "{moved}");
}

#[test]
fn a_torque_acts_after_the_delay_and_then_with_the_lag() {
    for (delay, lag) in [(1, 0.0), (3, 0.0), (1, 0.005), (4, 0.01)] {
        let mut pair = pair(|arm| {
            arm.friction = Friction::NONE;
            arm.drive.command_delay = delay;
            arm.drive.torque_lag = lag;
        });
        pair.start_torques();
        let mut tau = JointVector::zeros();
        tau[0] = 0.9;
        let mut velocities = vec![0.0];
        for _ in 0..100 {
            pair.tick(Some(torques(&tau)));
            velocities.push(pair.robot.dq()[0]);
        }
        let gain: Vec<f64> = velocities
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        let settled = gain[99];
        let first = gain
            .iter()
            .position(|gain| gain.abs() > 1e-9)
            .expect("it moves");
        // The first command answers the first state of the motion.
        let immediate = delay as usize - 1;
        assert_eq!(first, immediate, "{delay} cycles, {lag} s");
        // The lag causes the deviation from constant acceleration.
        let missing: f64 = gain[first..].iter().map(|gain| 1.0 - gain / settled).sum();
        assert!(
            (missing * 1e-3 - lag).abs() < 3e-4,
            "{delay} cycles, {lag} s: {missing} ms"
        );
    }
}

#[test]
fn the_state_has_the_models_pose_and_the_robot_the_true_one() {
    let mut pair = pair(|arm| {
        arm.body.kinematic_error[3].translation.vector = Vector3::new(0.0, 0.004, 0.0);
        arm.body.kinematic_error[5].rotation =
            nalgebra::UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, 0.01));
    });
    pair.idle(100);
    let shown = Vector3::from(pair.position());
    let truth = pair.robot.true_pose().translation.vector;
    let ideal = Pair::fr3().robot.true_pose().translation.vector;
    assert!((shown - ideal).norm() < 1e-4, "{shown} {ideal}");
    assert!((truth - ideal).norm() > 2e-3, "{truth} {ideal}");
    // The wall is between the end effector's true and reported positions.
    let apart = shown.z - truth.z;
    assert!(apart.abs() > 1e-3, "{apart}");
    let wall = Vector3::new(0.0, 0.0, truth.z + 0.5 * apart);
    pair.robot
        .touch(franka_sim::Touch::wall(wall, Vector3::z()));
    pair.idle(500);
    let force = pair.state.O_F_ext_hat_K[2];
    let is_inside = apart > 0.0;
    assert_eq!(force.abs() > 1.0, is_inside, "{force} N, {apart} m apart");
}

#[test]
fn reported_pose_is_separate_from_the_links_true_pose() {
    use franka_model::{EndEffector, Frame, Model};
    use franka_sim::arm::StateGeometry;

    let random = StateGeometry::random(3);
    for geometry in [StateGeometry::RECORDED_FR3, random] {
        for error in [0.0, 0.004] {
            let mut pair = pair(|arm| {
                arm.body.state_geometry = geometry;
                arm.body.kinematic_error[3].translation.vector.y = error;
            });
            pair.idle(100);
            let shown = Vector3::from(pair.position());
            let q = JointVector::from(pair.state.q);
            let place = |model: &Model| {
                let pose = model.pose(Frame::EndEffector, &q, &EndEffector::default());
                Vector3::new(pose.m14, pose.m24, pose.m34)
            };
            let own = Model::fr3()
                .clone()
                .with_lengths(geometry.lengths)
                .with_deviations(&geometry.deviations);
            assert!((shown - place(&own)).norm() < 2e-6, "{geometry:?}");
            let off = (shown - place(Model::fr3())).norm();
            assert!((1e-4..4e-3).contains(&off), "{off}");
            let truth = pair.robot.true_pose().translation.vector;
            let apart = (shown - truth).norm();
            let is_expected = if error == 0.0 {
                apart < 1e-5
            } else {
                apart > 2e-3
            };
            assert!(is_expected, "{apart} m apart with an error of {error} m");
            // The description must contain the lengths.
            let text = pair.robot.description().expect("an FR3 serves one");
            let expected = format!("xyz=\"0 -{} 0\"", geometry.lengths.upper_arm);
            assert!(text.contains(&expected), "{expected}");
        }
    }
}

#[test]
fn torques_come_in_quanta_and_noise_is_as_large_as_the_arm_says() {
    let mut pair = pair(|arm| {
        arm.sensors.torque_quantum = JointVector::repeat(0.025);
        arm.sensors.torque_noise_at_rest = JointVector::repeat(0.06);
        arm.sensors.torque_noise_in_motion = JointVector::repeat(0.3);
        arm.sensors.velocity_noise_at_rest = JointVector::repeat(5e-4);
        arm.sensors.position_noise = JointVector::repeat(5e-6);
    });
    let (mut q, mut dq, mut tau) = (vec![], vec![], vec![]);
    for _ in 0..2000 {
        pair.tick(None);
        let steps = pair.robot.state().tau_J.map(|tau| tau / 0.025);
        assert!(
            steps
                .iter()
                .all(|steps| (steps - steps.round()).abs() < 1e-9)
        );
        q.push(pair.robot.state().q[0] - pair.robot.q()[0]);
        dq.push(pair.robot.state().dq[0] - pair.robot.dq()[0]);
        tau.push(pair.robot.state().tau_J[0]);
    }
    let deviation = |values: &[f64]| {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt()
    };
    assert!(
        (deviation(&q) / 5e-6 - 1.0).abs() < 0.1,
        "{}",
        deviation(&q)
    );
    assert!(
        (deviation(&dq) / 5e-4 - 1.0).abs() < 0.1,
        "{}",
        deviation(&dq)
    );
    // The robot's own controller also reacts to the noise of position and velocity.
    assert!(
        (0.055..0.15).contains(&deviation(&tau)),
        "{}",
        deviation(&tau)
    );
}

#[test]
fn sampled_arms_hold_still_under_the_robots_controllers() {
    for family in [Family::nominal(), Family::realistic(), Family::bad()] {
        for seed in 0..5 {
            let kind = [RobotKind::Fr3, RobotKind::Fer][seed as usize % 2];
            let mut pair = Pair::new(Config {
                kind,
                arm: Some(Arm::sample(kind, seed, &family)),
                ..Config::default()
            });
            pair.start_joints();
            for _ in 0..3000 {
                pair.tick(Some(positions(&READY)));
            }
            assert_eq!(pair.state.robot_mode, RobotMode::Move, "seed {seed}");
            assert!(
                (pair.robot.q() - READY).amax() < 5e-3,
                "seed {seed}: {}",
                pair.robot.q()
            );
            let shaking = pair.robot.dq().amax();
            assert!(shaking < 0.02, "seed {seed}: {shaking} rad/s");
        }
    }
}

#[test]
fn closed_brakes_hold_every_family() {
    for arm in [Arm::nominal, Arm::realistic, Arm::bad] {
        let mut pair = Pair::new(Config {
            arm: Some(arm(RobotKind::Fr3)),
            ..Config::default()
        });
        pair.robot.close_brakes();
        pair.idle(200);
        let held = *pair.robot.q();
        pair.robot
            .touch(franka_sim::Touch::torque(JointVector::repeat(3.0)));
        pair.idle(2000);
        assert!(
            (pair.robot.q() - held).amax() < 2e-3,
            "{}",
            pair.robot.q() - held
        );
        assert!(pair.robot.dq().amax() < 1e-3, "{}", pair.robot.dq());
    }
}

#[test]
fn a_torque_motion_of_an_untouched_arm_stays_where_it_is() {
    let mut pair = Pair::new(Config {
        arm: Some(Arm::sample(RobotKind::Fr3, 3, &Family::realistic())),
        ..Config::default()
    });
    pair.start_torques();
    for _ in 0..3000 {
        pair.tick(Some(RobotCommand::default()));
    }
    let moved = (pair.robot.q() - READY).amax();
    assert!(moved < 2e-3, "{moved}: friction does not hold the arm");
}
