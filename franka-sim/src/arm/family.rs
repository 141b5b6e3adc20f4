//! Families of arms, with a distribution for every parameter.

use franka_model::geometry::Lengths;
use franka_model::{JointVector, RobotKind};
use nalgebra::{Isometry3, Vector3};

mod built_in;
mod distribution;

pub use distribution::{Distribution, Values};

use super::{
    Arm, Body, Bristle, Drive, Elasticity, Friction, PoseTorque, Ripple, Sensors, StateGeometry,
    SystemLimits,
};
use crate::network::Stalls;
use crate::noise::Random;

/// Family of arms: one distribution for each parameter of an arm.
///
/// Units are SI. Unless noted otherwise, a parameter is drawn for each joint (or link). Its
/// distribution contains one number for all joints, or seven numbers. With the feature `serde`, a
/// family can be read from JSON text, which must contain every field:
///
#[cfg_attr(feature = "serde", doc = "```")]
#[cfg_attr(not(feature = "serde"), doc = "```ignore")]
/// use franka_model::RobotKind;
/// use franka_sim::arm::{Arm, Distribution, Family, Values};
///
/// let mut family = Family::realistic();
/// family.torque_lag = Distribution::Uniform {
///     low: Values::One(0.001),
///     high: Values::One(0.003),
/// };
/// let again = Family::from_json(&family.to_json()).expect("what was written");
/// assert_eq!(again, family);
/// let arm = Arm::sample(RobotKind::Fr3, 7, &family);
/// assert!((0.001..0.003).contains(&arm.drive.torque_lag));
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Family {
    /// Breakaway torque, `[N·m]`. The factor [`static_friction_scale`](Self::static_friction_scale)
    /// multiplies it.
    pub static_friction: Distribution,
    /// Factor on the breakaway torques of all joints, drawn once per arm.
    pub static_friction_scale: Distribution,
    /// Kinetic friction divided by static friction, 0 to 1.
    pub kinetic_ratio: Distribution,
    /// Speed at which friction falls from static to kinetic friction
    /// ([`Friction::stribeck_speed`]), `[rad/s]`.
    pub stribeck_speed: Distribution,
    /// Stiffness of the bristles ([`Bristle`]), `[N·m/rad]`.
    pub bristle_stiffness: Distribution,
    /// Damping of the bristles, `[N·m·s/rad]`.
    pub bristle_damping: Distribution,
    /// Viscous friction, `[N·m·s/rad]`.
    pub viscous_friction: Distribution,
    /// Share of the friction that is on the link's side of the torque sensor, 0 to 1.
    pub link_share: Distribution,
    /// Rotor inertia at the joint without torque control, `[kg·m²]`.
    pub rotor_inertia: Distribution,
    /// Gain of the torque loop, drawn once per arm.
    pub torque_loop_gain: Distribution,
    /// Time constant of the torque loop, `[s]`, drawn once per arm.
    pub torque_lag: Distribution,
    /// Delay of commands in whole cycles, at least 1, drawn once per arm.
    pub command_delay: Distribution,
    /// Elasticity of the joints; `null` in JSON for rigid joints.
    // `Option::deserialize` is required here, because a plain `Option` may be missing.
    #[cfg_attr(
        feature = "serde",
        serde(deserialize_with = "serde::Deserialize::deserialize")
    )]
    pub elasticity: Option<Elastic>,
    /// Amplitude of the torque ripple, `[N·m]`.
    pub ripple_amplitude: Distribution,
    /// Periods of the torque ripple per turn of the joint.
    pub ripple_order: Distribution,
    /// Each of the two coefficients of [`PoseTorque`], `[N·m]`.
    pub pose_torque: Distribution,
    /// Zero error of the torque sensors, `[N·m]`.
    pub torque_offset: Distribution,
    /// Step of the torque sensors, `[N·m]`.
    pub torque_quantum: Distribution,
    /// Noise of the torque sensors at rest, standard deviation, `[N·m]`.
    pub torque_noise_at_rest: Distribution,
    /// Noise of the torque sensors at 1 rad/s and above, standard deviation, `[N·m]`.
    pub torque_noise_in_motion: Distribution,
    /// Noise of the joint velocities at rest, standard deviation, `[rad/s]`.
    pub velocity_noise_at_rest: Distribution,
    /// Noise of the joint velocities at 1 rad/s and above, standard deviation, `[rad/s]`.
    pub velocity_noise_in_motion: Distribution,
    /// Noise of the joint positions, standard deviation, `[rad]`.
    pub position_noise: Distribution,
    /// Error of a link's mass, as a fraction of this mass.
    pub mass_error: Distribution,
    /// Error of each coordinate of a link's centre of mass, `[m]`.
    pub com_error: Distribution,
    /// Error of each coordinate of the rotation vector of a joint's frame, `[rad]`.
    pub axis_error: Distribution,
    /// Error of each coordinate of the position of a joint's frame, `[m]`.
    pub length_error: Distribution,
    /// Difference between the lengths of upper arm and forearm and the vendor's description, `[m]`,
    /// drawn once per arm. The states of a Franka Research 3, and the description that it serves,
    /// contain this difference. A value of 0.2 mm results in [`StateGeometry::RECORDED_FR3`]. A
    /// Franka Emika Robot has the described lengths.
    pub state_length_excess: Distribution,
    /// Error of the joint frames that the states use: each coordinate of the rotation vector in the
    /// described frame, `[rad]`.
    pub state_axis_error: Distribution,
    /// Error of the joint frames that the states use: each coordinate of the position in the
    /// described frame, `[m]`.
    pub state_length_error: Distribution,
    /// Undeclared mass on the flange, `[kg]`, drawn once per arm.
    pub undeclared_mass: Distribution,
    /// Error of each coordinate of the tool's centre of mass, `[m]`.
    pub load_com_error: Distribution,
    /// Tilt about each horizontal axis, `[rad]`.
    pub base_tilt: Distribution,
    /// Stalls per second of a Franka Emika Robot's network interface, drawn once per arm. A Franka
    /// Research 3 has no stalls. [`Stalls::FER`] defines their lengths.
    pub stalls_per_second: Distribution,
    /// Zero error of the motors' positions, for a Franka Research 3, `[rad]`. A Franka Emika Robot
    /// has no such error.
    pub motor_offset: Distribution,
    /// Joint limits of a Franka Research 3: `"5.9"` or `"before-5.9"`.
    pub limits: SystemLimits,
}

/// Distributions of the joints' elasticity.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Elastic {
    /// Stiffness of the joints, `[N·m/rad]`.
    pub stiffness: Distribution,
    /// Damping of the joints, `[N·m·s/rad]`.
    pub damping: Distribution,
}

/// Reason why a text is not a valid family of arms.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FamilyError {
    /// The text is not JSON, lacks a field, or has an unknown field or a wrong type.
    #[error("{0}")]
    Unreadable(String),
    /// The text contains a value that no arm can have.
    #[error("{field}: {got}, expected {expected}")]
    Invalid {
        /// The field's name.
        field: &'static str,
        /// The value in the text.
        got: String,
        /// The permitted values.
        expected: String,
    },
}

impl Family {
    /// Reads a family from JSON.
    ///
    /// # Errors
    /// Returns [`FamilyError`] if the text is not JSON, if it lacks a field or contains an unknown
    /// field, or if a distribution has impossible values.
    #[cfg(feature = "serde")]
    pub fn from_json(text: &str) -> Result<Self, FamilyError> {
        let mut reader = serde_json::Deserializer::from_str(text);
        let family: Self = serde_path_to_error::deserialize(&mut reader)
            .map_err(|error| FamilyError::Unreadable(error.to_string()))?;
        reader
            .end()
            .map_err(|error| FamilyError::Unreadable(error.to_string()))?;
        family.check()?;
        Ok(family)
    }

    /// Returns the family as JSON.
    #[cfg(feature = "serde")]
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("plain data")
    }

    /// Checks that every arm of the family has valid parameters.
    ///
    /// # Errors
    /// Returns [`FamilyError::Invalid`] with the first field that is invalid.
    pub fn check(&self) -> Result<(), FamilyError> {
        use distribution::Bounds::{Any, Between, NotNegative, Positive, Whole};
        let once = [
            (
                "static_friction_scale",
                &self.static_friction_scale,
                Positive,
            ),
            ("torque_loop_gain", &self.torque_loop_gain, NotNegative),
            ("torque_lag", &self.torque_lag, Between(0.0, 0.1)),
            ("command_delay", &self.command_delay, Whole(1, 20)),
            ("undeclared_mass", &self.undeclared_mass, NotNegative),
            ("load_com_error", &self.load_com_error, Any),
            ("base_tilt", &self.base_tilt, Any),
            (
                "state_length_excess",
                &self.state_length_excess,
                Between(-0.05, 0.05),
            ),
            (
                "stalls_per_second",
                &self.stalls_per_second,
                Between(0.0, 100.0),
            ),
        ];
        let each = [
            ("static_friction", &self.static_friction, NotNegative),
            ("kinetic_ratio", &self.kinetic_ratio, Between(0.0, 1.0)),
            ("stribeck_speed", &self.stribeck_speed, Positive),
            ("bristle_stiffness", &self.bristle_stiffness, Positive),
            ("bristle_damping", &self.bristle_damping, NotNegative),
            ("viscous_friction", &self.viscous_friction, NotNegative),
            ("link_share", &self.link_share, Between(0.0, 1.0)),
            ("rotor_inertia", &self.rotor_inertia, Positive),
            ("ripple_amplitude", &self.ripple_amplitude, NotNegative),
            ("ripple_order", &self.ripple_order, NotNegative),
            ("pose_torque", &self.pose_torque, Any),
            ("torque_offset", &self.torque_offset, Any),
            ("torque_quantum", &self.torque_quantum, NotNegative),
            (
                "torque_noise_at_rest",
                &self.torque_noise_at_rest,
                NotNegative,
            ),
            (
                "torque_noise_in_motion",
                &self.torque_noise_in_motion,
                NotNegative,
            ),
            (
                "velocity_noise_at_rest",
                &self.velocity_noise_at_rest,
                NotNegative,
            ),
            (
                "velocity_noise_in_motion",
                &self.velocity_noise_in_motion,
                NotNegative,
            ),
            ("position_noise", &self.position_noise, NotNegative),
            ("mass_error", &self.mass_error, Between(-0.9, 10.0)),
            ("com_error", &self.com_error, Any),
            ("axis_error", &self.axis_error, Any),
            ("length_error", &self.length_error, Any),
            ("motor_offset", &self.motor_offset, Any),
            ("state_axis_error", &self.state_axis_error, Any),
            ("state_length_error", &self.state_length_error, Any),
        ];
        for (field, distribution, bounds) in once {
            distribution.check_single(field)?;
            distribution.check(field, bounds)?;
        }
        for (field, distribution, bounds) in each {
            distribution.check(field, bounds)?;
        }
        if let Some(Elastic { stiffness, damping }) = &self.elasticity {
            stiffness.check("elasticity.stiffness", Positive)?;
            damping.check("elasticity.damping", NotNegative)?;
        }
        Ok(())
    }

    /// Returns the arm of this seed, or the central arm if the seed is `None`.
    pub(super) fn arm(&self, kind: RobotKind, seed: Option<u64>) -> Arm {
        let mut draw = Draw {
            random: seed.map(Random::new),
        };
        // The same seed must give the same arm, so the order of the draws must not change.
        let scale = draw.once(&self.static_friction_scale);
        let static_torque = draw.joints(&self.static_friction) * scale;
        let friction = Friction {
            static_torque,
            kinetic_torque: draw
                .joints(&self.kinetic_ratio)
                .component_mul(&static_torque),
            stribeck_speed: draw.joints(&self.stribeck_speed),
            viscous: draw.joints(&self.viscous_friction),
            bristle: Some(Bristle {
                stiffness: draw.joints(&self.bristle_stiffness),
                damping: draw.joints(&self.bristle_damping),
            }),
            link_share: draw.joints(&self.link_share),
        };
        let mut drive = Drive {
            rotor_inertia: draw.joints(&self.rotor_inertia),
            torque_loop_gain: draw.once(&self.torque_loop_gain),
            torque_lag: draw.once(&self.torque_lag),
            command_delay: draw.whole(&self.command_delay),
            elasticity: self.elasticity.as_ref().map(|elastic| Elasticity {
                stiffness: draw.joints(&elastic.stiffness),
                damping: draw.joints(&elastic.damping),
            }),
            ripple: Ripple {
                amplitude: draw.joints(&self.ripple_amplitude),
                order: draw.joints(&self.ripple_order),
            },
            pose_torque: PoseTorque::NONE,
        };
        let mut sensors = Sensors {
            torque_offset: draw.joints(&self.torque_offset),
            torque_quantum: draw.joints(&self.torque_quantum),
            torque_noise_at_rest: draw.joints(&self.torque_noise_at_rest),
            torque_noise_in_motion: draw.joints(&self.torque_noise_in_motion),
            velocity_noise_at_rest: draw.joints(&self.velocity_noise_at_rest),
            velocity_noise_in_motion: draw.joints(&self.velocity_noise_in_motion),
            position_noise: draw.joints(&self.position_noise),
            motor_offset: JointVector::zeros(),
        };
        let tilt = Vector3::new(draw.once(&self.base_tilt), draw.once(&self.base_tilt), 0.0);
        let exact = Body::exact(kind).tilted(tilt);
        let body = Body {
            mass_error: draw.joints(&self.mass_error).into(),
            com_error: std::array::from_fn(|i| draw.vector(&self.com_error, i)),
            kinematic_error: std::array::from_fn(|i| {
                let shift = draw.vector(&self.length_error, i);
                Isometry3::new(shift, draw.vector(&self.axis_error, i))
            }),
            undeclared_mass: draw.once(&self.undeclared_mass),
            load_com_error: draw.vector(&self.load_com_error, 0),
            ..exact
        };
        let per_second = draw.once(&self.stalls_per_second);
        let stalls = (kind == RobotKind::Fer && per_second > 0.0).then_some(Stalls {
            per_second,
            ..Stalls::FER
        });
        let motor_offset = draw.joints(&self.motor_offset);
        if kind == RobotKind::Fr3 {
            sensors.motor_offset = motor_offset;
        }
        let body = Body {
            state_geometry: self.state_geometry(kind, &mut draw),
            ..body
        };
        drive.pose_torque = PoseTorque {
            sine: draw.joints(&self.pose_torque),
            cosine: draw.joints(&self.pose_torque),
        };
        Arm {
            friction,
            drive,
            sensors,
            body,
            limits: self.limits,
            stalls,
        }
    }
}

impl Family {
    fn state_geometry(&self, kind: RobotKind, draw: &mut Draw) -> StateGeometry {
        let excess = draw.once(&self.state_length_excess);
        let described = Lengths::DESCRIBED;
        let lengths = match kind {
            RobotKind::Fr3 => Lengths {
                upper_arm: described.upper_arm + excess,
                forearm: described.forearm + excess,
            },
            _ => described,
        };
        let deviations = std::array::from_fn(|i| {
            let shift = draw.vector(&self.state_length_error, i);
            Isometry3::new(shift, draw.vector(&self.state_axis_error, i))
        });
        StateGeometry {
            lengths,
            deviations,
        }
    }
}

/// Source of parameters: random values, or the middle of each distribution.
struct Draw {
    random: Option<Random>,
}

impl Draw {
    fn number(&mut self, distribution: &Distribution, joint: usize) -> f64 {
        match (*distribution, &mut self.random) {
            (Distribution::Constant(value), _) => value.of(joint),
            (Distribution::Uniform { low, high }, None) => 0.5 * (low.of(joint) + high.of(joint)),
            (Distribution::Uniform { low, high }, Some(random)) => {
                let (low, high) = (low.of(joint), high.of(joint));
                low + (high - low) * random.uniform()
            }
            (Distribution::Normal { mean, .. }, None) => mean.of(joint),
            (Distribution::Normal { mean, rms }, Some(random)) => {
                mean.of(joint) + rms.of(joint) * random.normal()
            }
        }
    }

    fn once(&mut self, distribution: &Distribution) -> f64 {
        self.number(distribution, 0)
    }

    /// A whole number between the ends of the distribution. All numbers are equally probable.
    fn whole(&mut self, distribution: &Distribution) -> u32 {
        let wide = match *distribution {
            Distribution::Uniform { low, high } if self.random.is_some() => Distribution::Uniform {
                low,
                high: Values::One(high.of(0) + 1.0),
            },
            other => other,
        };
        self.once(&wide) as u32
    }

    fn joints(&mut self, distribution: &Distribution) -> JointVector {
        JointVector::from_fn(|i, _| self.number(distribution, i))
    }

    fn vector(&mut self, distribution: &Distribution, link: usize) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.number(distribution, link))
    }
}

#[cfg(test)]
mod tests;
