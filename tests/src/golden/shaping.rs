//! The limiters and the bounds of commands against libfranka's: `rate_limiting_vectors.json`.
//!
//! Scalars and joints are compared to the last bit. What goes through rotations and norms is not
//! the same arithmetic to the last bit, and gets [`CARTESIAN`].

use franka_model::limits::{BrakingEnvelope, CLIENT_MARGIN, JointLimits};
use franka_model::{JointVector, Load, RobotKind};
use franka_proto::{RobotState, Version};
use franka_rt::shaping::limiter::{self, AxisBounds, JointBounds, POSE_ROTATION_SHARE};
use franka_rt::shaping::{Bounds, CYCLE, VelocityBounds, check};
use nalgebra::{Matrix3, Vector3};

use super::{Case, Malformed, Node, Report, shaping_errors};

/// Of Cartesian values, `[m]`, `[m/s]`, `[rad/s]` and elements of rotations: some steps of a double
/// at 1.
const CARTESIAN: f64 = 2e-14;
/// Of the model's totals of loads, whose sums are in another order, `[kg m^2]`.
const TOTALS: f64 = 1e-15;

/// Checks `rate_limiting_vectors.json`.
pub(super) fn limiters(root: &Node<'_>) -> Result<Report, Malformed> {
    let mut report = Report::default();
    for version in Version::ALL {
        let section = Section {
            node: root.get(&format!("v{version}"))?,
            bounds: match version {
                Version::V5 => Bounds::fer(),
                Version::V10 => Bounds::fr3(),
            },
        };
        section.constants(&mut report)?;
        section.torques(&mut report)?;
        section.joints(&mut report)?;
        section.elbow(&mut report)?;
        section.cartesian(&mut report)?;
        section.transformations(&mut report)?;
        section.load_totals(&mut report)?;
        if let Some(node) = section.node.find("joint_velocity_limits") {
            envelope(&mut report, &section.bounds, &node)?;
        }
        shaping_errors::limiters(&mut report, &section.bounds, &section.node.get("errors")?)?;
    }
    Ok(report)
}

/// One version's part of the file.
struct Section<'a> {
    node: Node<'a>,
    bounds: Bounds,
}

impl Section<'_> {
    fn cases(&self, name: &str) -> Result<Vec<Node<'_>>, Malformed> {
        self.node.get(name)?.list()
    }

    /// Every constant of the file, by name; one that is not known here fails.
    fn constants(&self, report: &mut Report) -> Result<(), Malformed> {
        let bounds = &self.bounds;
        let (linear, angular) = (&bounds.cartesian.translation, &bounds.cartesian.rotation);
        for (name, node) in self.node.get("constants")?.members()? {
            let got: Vec<f64> = match name {
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
                _ => return Err(node.malformed("a constant of rate_limiting.h")),
            };
            let want = node.number().map(|x| vec![x]).or_else(|_| node.vector())?;
            report.case(node.path(), |case| case.near(name, &got, &want, 0.0));
        }
        Ok(())
    }

    fn torques(&self, report: &mut Report) -> Result<(), Malformed> {
        for node in self.cases("torque")? {
            let [command, last, expected] = fields(&node, ["commanded", "last", "expected"])?;
            let got = limiter::torques(&command, &last, &self.bounds.torque_rate);
            report.case(node.path(), |case| compare(case, got, &expected, 0.0));
        }
        Ok(())
    }

    fn joints(&self, report: &mut Report) -> Result<(), Malformed> {
        let bounds = |node: &Node<'_>| -> Result<JointBounds, Malformed> {
            let [upper_velocity, lower_velocity] =
                fields(node, ["upper_velocity", "lower_velocity"])?;
            Ok(JointBounds {
                upper_velocity,
                lower_velocity,
                acceleration: self.bounds.joint_acceleration,
                jerk: self.bounds.joint_jerk,
            })
        };
        for node in self.cases("joint_velocities")? {
            let [command, dq, ddq, expected] = fields(
                &node,
                [
                    "commanded_velocity",
                    "last_velocity",
                    "last_acceleration",
                    "expected",
                ],
            )?;
            let bounds = bounds(&node)?;
            let got = limiter::joint_velocities(&bounds, &command, &dq, &ddq);
            report.case(node.path(), |case| {
                compare(case, got, &expected, 0.0);
                let axis = axis(&bounds, 6);
                let got = limiter::velocity(&axis, command[6], dq[6], ddq[6]);
                compare(case, got.map(|x| [x]), &[expected[6]], 0.0);
            });
        }
        for node in self.cases("joint_positions")? {
            let [command, q, dq, ddq, expected] = fields(
                &node,
                [
                    "commanded_position",
                    "last_position",
                    "last_velocity",
                    "last_acceleration",
                    "expected",
                ],
            )?;
            let bounds = bounds(&node)?;
            let got = limiter::joint_positions(&bounds, &command, &q, &dq, &ddq);
            report.case(node.path(), |case| {
                compare(case, got, &expected, 0.0);
                let axis = axis(&bounds, 6);
                let got = limiter::position(&axis, command[6], q[6], dq[6], ddq[6]);
                compare(case, got.map(|x| [x]), &[expected[6]], 0.0);
            });
        }
        Ok(())
    }

    fn elbow(&self, report: &mut Report) -> Result<(), Malformed> {
        for node in self.cases("elbow_position")? {
            let number = |name| node.get(name)?.number();
            let (command, last) = (number("commanded")?, number("last")?);
            let (velocity, acceleration) = (number("last_velocity")?, number("last_acceleration")?);
            let bounds = &self.bounds.elbow;
            let got = limiter::position(bounds, command, last, velocity, acceleration);
            let expected = [number("expected")?];
            report.case(node.path(), |case| {
                compare(case, got.map(|x| [x]), &expected, 0.0);
            });
        }
        Ok(())
    }

    fn cartesian(&self, report: &mut Report) -> Result<(), Malformed> {
        let bounds = &self.bounds.cartesian;
        for node in self.cases("cartesian_velocity")? {
            let [command, velocity, acceleration, expected] = fields(
                &node,
                [
                    "commanded",
                    "last_velocity",
                    "last_acceleration",
                    "expected",
                ],
            )?;
            let got = limiter::cartesian_velocity(bounds, &command, &velocity, &acceleration);
            report.case(tagged(&node)?, |case| {
                compare(case, got, &expected, CARTESIAN);
            });
        }
        for node in self.cases("cartesian_pose")? {
            let [command, last, expected] = fields(&node, ["commanded", "last_pose", "expected"])?;
            let [velocity, acceleration] = fields(&node, ["last_velocity", "last_acceleration"])?;
            let got = limiter::cartesian_pose(bounds, &command, &last, &velocity, &acceleration);
            report.case(tagged(&node)?, |case| {
                compare(case, got, &expected, CARTESIAN);
            });
        }
        Ok(())
    }

    fn transformations(&self, report: &mut Report) -> Result<(), Malformed> {
        for node in self.cases("is_homogeneous_transformation")? {
            let [matrix] = fields(&node, ["matrix"])?;
            let valid = node.get("valid")?.boolean()?;
            report.case(node.path(), |case| {
                case.equal("valid", check::is_homogeneous(&matrix), valid);
                case.equal("sent", check::pose(&matrix).is_ok(), valid);
            });
        }
        Ok(())
    }

    /// Both as the model combines loads and as a state tells their total.
    fn load_totals(&self, report: &mut Report) -> Result<(), Malformed> {
        for node in self.cases("load_totals")? {
            let number = |name| node.get(name)?.number();
            let (m_ee, m_load) = (number("m_ee")?, number("m_load")?);
            let [ee, load, centre] = fields(&node, ["F_x_Cee", "F_x_Cload", "F_x_Ctotal"])?;
            let [i_ee, i_load, inertia] = fields(&node, ["I_ee", "I_load", "I_total"])?;
            let mass = number("m_total")?;
            let body = |mass, centre: [f64; 3], inertia: [f64; 9]| Load {
                mass,
                com: Vector3::from(centre),
                inertia: Matrix3::from_column_slice(&inertia),
            };
            let combined = body(m_ee, ee, i_ee).combine(&body(m_load, load, i_load));
            let state = RobotState {
                m_ee,
                F_x_Cee: ee,
                I_ee: i_ee,
                m_load,
                F_x_Cload: load,
                I_load: i_load,
                ..RobotState::default()
            };
            // The functions behind the file take `f64`, whatever the version.
            let total = state.total_load(Version::V5);
            report.case(node.path(), |case| {
                case.near("mass", &[combined.mass], &[mass], TOTALS);
                case.near("centre", combined.com.as_slice(), &centre, TOTALS);
                case.near("inertia", combined.inertia.as_slice(), &inertia, TOTALS);
                case.near("mass of a state", &[total.m_total], &[mass], 0.0);
                case.near("centre of a state", &total.F_x_Ctotal, &centre, 0.0);
                case.near("inertia of a state", &total.I_total, &inertia, 0.0);
            });
        }
        Ok(())
    }
}

/// Bounds on velocities at positions, from parameters as a robot's description names them.
fn envelope(report: &mut Report, bounds: &Bounds, node: &Node<'_>) -> Result<(), Malformed> {
    let parameters = node.get("parameters")?;
    let of_joints = |name: &str| -> Result<JointVector, Malformed> {
        let joints = parameters.list()?;
        let values = joints.iter().map(|joint| joint.get(name)?.number());
        let values: Vec<f64> = values.collect::<Result<_, _>>()?;
        let values = <[f64; 7]>::try_from(values).map_err(|_| parameters.malformed("7 joints"))?;
        Ok(values.into())
    };
    let described = bounds.with_envelope_of(&JointLimits {
        velocity: of_joints("max_velocity")?,
        hard_upper: of_joints("upper_position_limit")?,
        hard_lower: of_joints("lower_position_limit")?,
        envelope: Some(BrakingEnvelope {
            deceleration: of_joints("deceleration_limit")?,
            offset: of_joints("velocity_offset")?,
        }),
        ..*JointLimits::of(RobotKind::Fr3)
    });
    for node in node.get("cases")?.list()? {
        let [q, upper, lower] = fields(&node, ["q", "upper", "lower"])?;
        let [upper_of_header, lower_of_header]: [[f64; 7]; 2] =
            fields(&node, ["deprecated_upper", "deprecated_lower"])?;
        report.case(node.path(), |case| {
            let (got_lower, got_upper) = described.joint_velocity.at(&q);
            case.near("upper", &got_upper, &upper, 0.0);
            case.near("lower", &got_lower, &lower, 0.0);
            let (got_lower, got_upper) = bounds.joint_velocity.at(&q);
            case.near("upper of the FR3", &got_upper, &upper_of_header, 0.0);
            case.near("lower of the FR3", &got_lower, &lower_of_header, 0.0);
        });
    }
    Ok(())
}

fn axis(bounds: &JointBounds, joint: usize) -> AxisBounds {
    AxisBounds {
        upper_velocity: bounds.upper_velocity[joint],
        lower_velocity: bounds.lower_velocity[joint],
        acceleration: bounds.acceleration[joint],
        jerk: bounds.jerk[joint],
    }
}

/// Arrays of the same length, by name.
pub(super) fn fields<const N: usize, const M: usize>(
    node: &Node<'_>,
    names: [&str; M],
) -> Result<[[f64; N]; M], Malformed> {
    let mut values = [[0.0; N]; M];
    for (value, name) in values.iter_mut().zip(names) {
        *value = node.get(name)?.numbers()?;
    }
    Ok(values)
}

/// The name of a case, with what it exercises.
pub(super) fn tagged(node: &Node<'_>) -> Result<String, Malformed> {
    Ok(format!("{} ({})", node.path(), node.get("tag")?.text()?))
}

/// Compares a result with what is expected of it; an error fails.
pub(super) fn compare<const N: usize>(
    case: &mut Case<'_>,
    got: Result<[f64; N], impl std::fmt::Display>,
    expected: &[f64; N],
    tolerance: f64,
) {
    match got {
        Ok(got) => case.near("expected", &got, expected, tolerance),
        Err(error) => case.fail(error.to_string()),
    }
}
