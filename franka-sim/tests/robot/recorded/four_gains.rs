//! The realistic arm with the springs of an experiment on a real arm.
//!
//! Source: `examples/sysid.npz` of `Improbable-AI/aiofranka` at 01c6d1a8, under the MIT licence: a
//! Franka Research 3 in 2025, with torques from the client.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use franka_sim::Tool;
use franka_sim::arm::Arm;

use crate::pair::*;

/// Stiffness `[N·m/rad]` and damping `[N·m·s/rad]` of all joints, and the response of the real arm:
/// for each joint, the range of its motion divided by the range of its target.
const RECORDED: [(f64, f64, [f64; 7]); 4] = [
    (
        120.0,
        10.0,
        [1.178, 1.004, 1.188, 0.921, 0.950, 0.947, 0.944],
    ),
    (80.0, 4.0, [1.476, 1.026, 1.492, 1.001, 0.978, 0.963, 0.954]),
    (60.0, 3.0, [1.728, 1.128, 1.721, 1.054, 0.974, 0.973, 0.946]),
    (40.0, 2.0, [2.121, 1.393, 2.048, 0.934, 0.944, 0.933, 0.923]),
];

/// Position of the arm before each run, `[rad]`, held with 80 N·m/rad and 4 N·m·s/rad.
const HOME: [f64; 7] = [0.0, 0.0, 0.3, -FRAC_PI_2, 0.0, FRAC_PI_2, -FRAC_PI_4];

/// Largest deviation of a ratio.
const OFF_MAX: f64 = 0.05;

/// Period of the log, `[s]`.
pub(super) const PERIOD: f64 = 0.02;

/// An arm with springs that a client computes in every cycle.
pub(super) struct Sprung {
    pair: Pair,
    torque: JointVector,
}

/// One sample of the log, every [`PERIOD`].
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub(super) q: JointVector,
    pub(super) dq: JointVector,
    /// Commanded by the client, `[N·m]`.
    pub(super) torque: JointVector,
}

impl Row {
    pub(super) fn mean(rows: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> JointVector| -> JointVector {
            rows.iter().map(of).sum::<JointVector>() / rows.len() as f64
        };
        Self {
            q: mean(|row| row.q),
            dq: mean(|row| row.dq),
            torque: mean(|row| row.torque),
        }
    }
}

impl Sprung {
    pub(super) fn new(arm: Arm) -> Self {
        let mut pair = Pair::new(Config {
            q: HOME.into(),
            tool: Tool::hand(),
            arm: Some(arm),
            ..Config::default()
        });
        pair.start_torques();
        Self {
            pair,
            torque: JointVector::zeros(),
        }
    }

    /// Holds `target` for the [`PERIOD`] of the log.
    fn towards(&mut self, target: &JointVector, spring: f64, damper: f64) {
        for _ in 0..20 {
            let dq = JointVector::from(self.pair.state.dq);
            let wanted = spring * (target - self.pair.q()) - damper * dq;
            let most = JointVector::repeat(0.99); // the rate limit of a robot for torques
            self.torque += (wanted - self.torque).sup(&-most).inf(&most);
            self.pair.tick(Some(torques(&self.torque)));
        }
    }

    fn row(&self) -> Row {
        Row {
            q: self.pair.q(),
            dq: JointVector::from(self.pair.state.dq),
            torque: JointVector::from(self.pair.state.tau_J_d),
        }
    }

    /// Performs one run. The last row is the end of the run.
    fn run(&mut self, spring: f64, damper: f64) -> Vec<Row> {
        for _ in 0..150 {
            self.towards(&HOME.into(), 80.0, 4.0);
        }
        let from = self.pair.q();
        let mut rows = Vec::new();
        for k in 0..200 {
            rows.push(self.row());
            let sine = 0.15 * (PI * f64::from((k - 1).max(0)) / 50.0).sin();
            self.towards(&from.add_scalar(sine), spring, damper);
        }
        rows.push(self.row());
        rows
    }

    pub(super) fn runs(&mut self) -> [Vec<Row>; 4] {
        RECORDED.map(|(spring, damper, _)| self.run(spring, damper))
    }
}

/// The range of motion of each joint over the range of its target.
fn ratios(rows: &[Row]) -> JointVector {
    let first = rows[0].q;
    let (least, most) = rows.iter().fold((first, first), |(least, most), row| {
        (least.inf(&row.q), most.sup(&row.q))
    });
    (most - least) / 0.3
}

#[test]
fn joints_swing_under_soft_springs_as_those_of_a_real_arm() {
    let runs = Sprung::new(Arm::realistic(RobotKind::Fr3)).runs();
    for ((spring, _, recorded), rows) in RECORDED.iter().zip(&runs) {
        let off = ratios(rows).component_div(&JointVector::from(*recorded));
        let off = off.add_scalar(-1.0);
        println!("{spring} N m/rad: {:.3?}", off.as_slice());
        assert!(off.amax() < OFF_MAX, "{spring} N m/rad: {off:.3}");
    }
}
