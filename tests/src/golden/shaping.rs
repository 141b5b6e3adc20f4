//! The limiters and the bounds of commands against libfranka's: `rate_limiting_vectors.json`.
//!
//! Scalars and joints are compared to the last bit. Rotations and norms use another arithmetic in
//! the last bits, so their results have the tolerance [`CARTESIAN`].

use std::collections::BTreeMap;

use anyhow::bail;
use franka_model::limits::{BrakingEnvelope, CLIENT_MARGIN, JointLimits};
use franka_model::{JointVector, RobotKind};
use franka_proto::{RobotState, Version};
use franka_rt::shaping::limiter::{self, AxisBounds, JointBounds, POSE_ROTATION_SHARE};
use franka_rt::shaping::{Bounds, CYCLE, VelocityBounds, check};
use serde::Deserialize;

use super::loads::{Parts, Total};
use super::shaping_errors::{self, Refused};
use super::{Report, Versions};

/// Tolerance of Cartesian values, `[m]`, `[m/s]`, `[rad/s]` and elements of rotations: some steps
/// of a double at 1.
const CARTESIAN: f64 = 2e-14;

#[derive(Deserialize)]
struct Section {
    constants: BTreeMap<String, Constant>,
    torque: Vec<Torques>,
    joint_velocities: Vec<JointVelocities>,
    joint_positions: Vec<JointPositions>,
    elbow_position: Vec<ElbowPosition>,
    cartesian_velocity: Vec<CartesianVelocity>,
    cartesian_pose: Vec<CartesianPose>,
    is_homogeneous_transformation: Vec<Transformation>,
    load_totals: Vec<LoadTotals>,
    joint_velocity_limits: Option<Envelope>,
    errors: Vec<Refused>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Constant {
    Number(f64),
    Joints([f64; 7]),
}

#[derive(Deserialize)]
struct Torques {
    commanded: [f64; 7],
    last: [f64; 7],
    expected: [f64; 7],
}

#[derive(Deserialize)]
struct JointVelocities {
    upper_velocity: [f64; 7],
    lower_velocity: [f64; 7],
    commanded_velocity: [f64; 7],
    last_velocity: [f64; 7],
    last_acceleration: [f64; 7],
    expected: [f64; 7],
}

#[derive(Deserialize)]
struct JointPositions {
    upper_velocity: [f64; 7],
    lower_velocity: [f64; 7],
    commanded_position: [f64; 7],
    last_position: [f64; 7],
    last_velocity: [f64; 7],
    last_acceleration: [f64; 7],
    expected: [f64; 7],
}

#[derive(Deserialize)]
struct ElbowPosition {
    commanded: f64,
    last: f64,
    last_velocity: f64,
    last_acceleration: f64,
    expected: f64,
}

#[derive(Deserialize)]
struct CartesianVelocity {
    commanded: [f64; 6],
    last_velocity: [f64; 6],
    last_acceleration: [f64; 6],
    expected: [f64; 6],
}

#[derive(Deserialize)]
struct CartesianPose {
    commanded: [f64; 16],
    last_pose: [f64; 16],
    last_velocity: [f64; 6],
    last_acceleration: [f64; 6],
    expected: [f64; 16],
}

#[derive(Deserialize)]
struct Transformation {
    matrix: [f64; 16],
    valid: bool,
}

#[derive(Deserialize)]
struct LoadTotals {
    #[serde(flatten)]
    parts: Parts,
    #[serde(flatten)]
    total: Total,
}

/// Bounds on velocities at positions, from parameters as a robot's description names them.
#[derive(Deserialize)]
struct Envelope {
    parameters: [JointParameters; 7],
    cases: Vec<VelocityLimits>,
}

#[derive(Deserialize)]
struct JointParameters {
    max_velocity: f64,
    velocity_offset: f64,
    deceleration_limit: f64,
    upper_position_limit: f64,
    lower_position_limit: f64,
}

#[derive(Deserialize)]
struct VelocityLimits {
    q: [f64; 7],
    upper: [f64; 7],
    lower: [f64; 7],
    deprecated_upper: [f64; 7],
    deprecated_lower: [f64; 7],
}

/// Checks `rate_limiting_vectors.json`.
pub(super) fn limiters(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: Versions<Section> = serde_json::from_slice(text)?;
    for (version, section) in file.each() {
        let bounds = match version {
            Version::V5 => Bounds::fer(),
            Version::V10 => Bounds::fr3(),
        };
        let part = format!("v{version}");
        constants(&mut report, &part, &bounds, &section.constants)?;
        section.joints(&mut report, &part, &bounds);
        section.cartesian(&mut report, &part, &bounds);
        section.totals(&mut report, &part);
        if let Some(limits) = &section.joint_velocity_limits {
            limits.check(&mut report, &part, &bounds);
        }
        shaping_errors::limiters(&mut report, &part, &bounds, &section.errors)?;
    }
    Ok(report)
}

/// Every constant of the file, by name; an unknown one is an error.
fn constants(
    report: &mut Report,
    part: &str,
    bounds: &Bounds,
    constants: &BTreeMap<String, Constant>,
) -> anyhow::Result<()> {
    let (linear, angular) = (&bounds.cartesian.translation, &bounds.cartesian.rotation);
    for (name, want) in constants {
        let got: Vec<f64> = match name.as_str() {
            "DELTA_T" => vec![CYCLE],
            "LIMIT_EPS" => vec![CLIENT_MARGIN],
            "NORM_EPS" => vec![f64::EPSILON],
            "FACTOR_CARTESIAN_ROTATION_POSE_INTERFACE" => vec![POSE_ROTATION_SHARE],
            "MAX_TORQUE_RATE" => bounds.torque_rate.into(),
            "MAX_JOINT_JERK" => bounds.joint_jerk.into(),
            "MAX_JOINT_ACCELERATION" => bounds.joint_acceleration.into(),
            "MAX_JOINT_VELOCITY" => bounds.joint_velocity.at(&[0.0; 7]).1.into(),
            "JOINT_VELOCITY_LIMITS_TOLERANCE" => match bounds.joint_velocity {
                VelocityBounds::Envelope { margin, .. } => vec![margin; 7],
                VelocityBounds::Everywhere(_) => vec![],
            },
            "MAX_TRANSLATIONAL_JERK" => vec![linear.jerk],
            "MAX_TRANSLATIONAL_ACCELERATION" => vec![linear.acceleration],
            "MAX_TRANSLATIONAL_VELOCITY" => vec![linear.velocity],
            "MAX_ROTATIONAL_JERK" => vec![angular.jerk],
            "MAX_ROTATIONAL_ACCELERATION" => vec![angular.acceleration],
            "MAX_ROTATIONAL_VELOCITY" => vec![angular.velocity],
            "MAX_ELBOW_JERK" => vec![bounds.elbow.jerk],
            "MAX_ELBOW_ACCELERATION" => vec![bounds.elbow.acceleration],
            "MAX_ELBOW_VELOCITY" => vec![bounds.elbow.upper_velocity],
            "MIN_ELBOW_VELOCITY" => vec![bounds.elbow.lower_velocity],
            // In the bounds on velocities.
            "TOL_NUMBER_PACKETS_LOST" => continue,
            _ => bail!("{part}.constants.{name}: expected a constant of rate_limiting.h"),
        };
        let want = match want {
            Constant::Number(number) => std::slice::from_ref(number),
            Constant::Joints(joints) => joints,
        };
        report.case(format!("{part}.constants.{name}"), |case| {
            case.near(name, &got, want, 0.0);
        });
    }
    Ok(())
}

impl Section {
    fn joints(&self, report: &mut Report, part: &str, bounds: &Bounds) {
        let of_joints = |upper_velocity, lower_velocity| JointBounds {
            upper_velocity,
            lower_velocity,
            acceleration: bounds.joint_acceleration,
            jerk: bounds.joint_jerk,
        };
        report.each(format!("{part}.torque"), &self.torque, |case, v| {
            let got = limiter::torques(&v.commanded, &v.last, &bounds.torque_rate);
            case.result(got, &v.expected, 0.0);
        });
        let list = format!("{part}.joint_velocities");
        report.each(list, &self.joint_velocities, |case, v| {
            let bounds = of_joints(v.upper_velocity, v.lower_velocity);
            let (command, dq, ddq) = (v.commanded_velocity, v.last_velocity, v.last_acceleration);
            let got = limiter::joint_velocities(&bounds, &command, &dq, &ddq);
            case.result(got, &v.expected, 0.0);
            let got = limiter::velocity(&axis(&bounds, 6), command[6], dq[6], ddq[6]);
            case.result(got.map(|x| [x]), &[v.expected[6]], 0.0);
        });
        let list = format!("{part}.joint_positions");
        report.each(list, &self.joint_positions, |case, v| {
            let bounds = of_joints(v.upper_velocity, v.lower_velocity);
            let (command, q) = (v.commanded_position, v.last_position);
            let (dq, ddq) = (v.last_velocity, v.last_acceleration);
            let got = limiter::joint_positions(&bounds, &command, &q, &dq, &ddq);
            case.result(got, &v.expected, 0.0);
            let got = limiter::position(&axis(&bounds, 6), command[6], q[6], dq[6], ddq[6]);
            case.result(got.map(|x| [x]), &[v.expected[6]], 0.0);
        });
        let list = format!("{part}.elbow_position");
        report.each(list, &self.elbow_position, |case, v| {
            let (velocity, acceleration) = (v.last_velocity, v.last_acceleration);
            let got = limiter::position(&bounds.elbow, v.commanded, v.last, velocity, acceleration);
            case.result(got.map(|x| [x]), &[v.expected], 0.0);
        });
    }

    fn cartesian(&self, report: &mut Report, part: &str, bounds: &Bounds) {
        let bounds = &bounds.cartesian;
        let list = format!("{part}.cartesian_velocity");
        report.each(list, &self.cartesian_velocity, |case, v| {
            let (velocity, acceleration) = (&v.last_velocity, &v.last_acceleration);
            let got = limiter::cartesian_velocity(bounds, &v.commanded, velocity, acceleration);
            case.result(got, &v.expected, CARTESIAN);
        });
        let list = format!("{part}.cartesian_pose");
        report.each(list, &self.cartesian_pose, |case, v| {
            let (pose, velocity, acceleration) =
                (&v.last_pose, &v.last_velocity, &v.last_acceleration);
            let got = limiter::cartesian_pose(bounds, &v.commanded, pose, velocity, acceleration);
            case.result(got, &v.expected, CARTESIAN);
        });
        let list = format!("{part}.is_homogeneous_transformation");
        report.each(list, &self.is_homogeneous_transformation, |case, v| {
            case.equal("valid", check::is_homogeneous(&v.matrix), v.valid);
            case.equal("sent", check::pose(&v.matrix).is_ok(), v.valid);
        });
    }

    /// The total of loads, as the model combines them and as a state contains it.
    fn totals(&self, report: &mut Report, part: &str) {
        report.each(
            format!("{part}.load_totals"),
            &self.load_totals,
            |case, LoadTotals { parts, total }| {
                total.check(case, &parts.combined());
                let state = RobotState {
                    m_ee: parts.m_ee,
                    F_x_Cee: parts.F_x_Cee,
                    I_ee: parts.I_ee,
                    m_load: parts.m_load,
                    F_x_Cload: parts.F_x_Cload,
                    I_load: parts.I_load,
                    ..RobotState::default()
                };
                // The functions behind the file use `f64` in every version.
                let got = state.total_load(Version::V5);
                case.near("mass of a state", &[got.m_total], &[total.m_total], 0.0);
                let (centre, inertia) = (&total.F_x_Ctotal, &total.I_total);
                case.near("centre of a state", &got.F_x_Ctotal, centre, 0.0);
                case.near("inertia of a state", &got.I_total, inertia, 0.0);
            },
        );
    }
}

impl Envelope {
    fn check(&self, report: &mut Report, part: &str, bounds: &Bounds) {
        let of_joints = |value: fn(&JointParameters) -> f64| {
            JointVector::from_iterator(self.parameters.iter().map(value))
        };
        let described = bounds.with_envelope_of(&JointLimits {
            velocity: of_joints(|joint| joint.max_velocity),
            hard_upper: of_joints(|joint| joint.upper_position_limit),
            hard_lower: of_joints(|joint| joint.lower_position_limit),
            envelope: Some(BrakingEnvelope {
                deceleration: of_joints(|joint| joint.deceleration_limit),
                offset: of_joints(|joint| joint.velocity_offset),
            }),
            ..*JointLimits::of(RobotKind::Fr3)
        });
        let list = format!("{part}.joint_velocity_limits.cases");
        report.each(list, &self.cases, |case, v| {
            let (lower, upper) = described.joint_velocity.at(&v.q);
            case.near("upper", &upper, &v.upper, 0.0);
            case.near("lower", &lower, &v.lower, 0.0);
            let (lower, upper) = bounds.joint_velocity.at(&v.q);
            case.near("upper of the FR3", &upper, &v.deprecated_upper, 0.0);
            case.near("lower of the FR3", &lower, &v.deprecated_lower, 0.0);
        });
    }
}

fn axis(bounds: &JointBounds, joint: usize) -> AxisBounds {
    AxisBounds {
        upper_velocity: bounds.upper_velocity[joint],
        lower_velocity: bounds.lower_velocity[joint],
        acceleration: bounds.acceleration[joint],
        jerk: bounds.jerk[joint],
    }
}
