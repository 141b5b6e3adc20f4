//! Comparison of the friction of realistic arms and of a real arm. Both are fitted in the same way
//! to the experiment of [`four_gains`](super::four_gains).
//!
//! The fit is biased, because the torque steps every 20 ms, and because friction is not the sum of
//! the two fitted terms. The fit can therefore compare arms, but its figures are not parameters of
//! a family.

use franka_model::Model;
use franka_sim::Tool;
use franka_sim::arm::{Arm, Family};
use nalgebra::{Matrix4, Vector3, Vector4};

use super::four_gains::{PERIOD, Row, Sprung};
use crate::pair::*;

/// Friction between the commanded torque and the link at [`SPEEDS`], `[N·m]`, fitted to the log of
/// the real arm (source and licence: [`four_gains`](super::four_gains)).
const RECORDED: [[f64; 7]; 2] = [
    [0.93, 0.81, 0.56, 0.93, 0.59, 0.43, 0.35],
    [1.20, 0.91, 0.82, 1.12, 0.48, 0.28, 0.13],
];

/// Speeds of [`RECORDED`], `[rad/s]`.
const SPEEDS: [f64; 2] = [0.1, 0.43];

/// Speed above which a joint counts as moving, `[rad/s]`.
const MOVING: f64 = 0.02;

/// Velocity at which the fitted Coulomb friction has reached 76 %, `[rad/s]`.
const SIGN_VELOCITY: f64 = 0.03;

/// Number of rows over which noise is averaged.
const AVERAGED: usize = 3;

/// Friction at [`SPEEDS`] of each joint: Coulomb friction, viscous friction, rotor inertia and an
/// offset are fitted to the torque minus the torque of the links.
fn friction(runs: &[Vec<Row>]) -> [[f64; 7]; 2] {
    let model = Model::physically_consistent(RobotKind::Fr3);
    let load = Tool::hand().load;
    let mut normal = [Matrix4::zeros(); 7];
    let mut right = [Vector4::zeros(); 7];
    for run in runs {
        let rows: Vec<Row> = run.windows(AVERAGED).map(Row::mean).collect();
        for window in rows.windows(3) {
            let (before, now, after) = (&window[0], &window[1], &window[2]);
            let ddq = (after.dq - before.dq) / (2.0 * PERIOD);
            let links = model.inverse_dynamics(&now.q, &now.dq, &ddq, &load, &Vector3::zeros());
            for i in (0..7).filter(|&i| now.dq[i].abs() > MOVING) {
                let v = now.dq[i];
                let terms = Vector4::new((v / SIGN_VELOCITY).tanh(), v, ddq[i], 1.0);
                normal[i] += terms * terms.transpose();
                right[i] += terms * (now.torque[i] - links[i]);
            }
        }
    }
    let fits: [Vector4<f64>; 7] = std::array::from_fn(|i| {
        let normal = normal[i].cholesky().expect("the joint moves");
        normal.solve(&right[i])
    });
    SPEEDS.map(|speed| fits.map(|fit| fit[0] + fit[1] * speed))
}

#[test]
fn friction_of_a_real_arm_is_within_that_of_the_family() {
    let family = Family::realistic();
    let arms: Vec<[[f64; 7]; 2]> = (0..24)
        .map(|seed| friction(&Sprung::new(Arm::sample(RobotKind::Fr3, seed, &family)).runs()))
        .collect();
    for (s, speed) in SPEEDS.into_iter().enumerate() {
        for joint in 0..7 {
            let of_arms = arms.iter().map(|arm| arm[s][joint]);
            let least = of_arms.clone().fold(f64::INFINITY, f64::min);
            let most = of_arms.fold(f64::NEG_INFINITY, f64::max);
            let recorded = RECORDED[s][joint];
            println!("joint {joint} at {speed}: {recorded} in {least:.2} to {most:.2}");
            assert!(
                least < recorded && recorded < most,
                "joint {joint} at {speed} rad/s: {recorded}, arms {least} to {most}"
            );
        }
    }
}
