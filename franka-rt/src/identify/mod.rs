//! Measures friction and bias of the joints, and the load at the flange, with small motions that
//! take a minute.
//!
//! ```text
//! RobotState -> Plan -> a session runs its motions -> Record -> Fit -> Identified
//!                                   later connections: Lifecycle::knowing <---'
//! ```
//!
//! A `Plan` lists the motions. While they run, a `Fit` collects the record of every cycle. In
//! steady motion, the part of a joint's torque that the model does not explain is `direction *
//! friction + bias + G(q) load`. The part that changes with the pose is attributed to the load, and
//! the rest to the joint. The load includes the load that is configured at the robot. The state's
//! `O_ddP_O` determines the direction of gravity. This module sends nothing to a robot.

mod fit;
mod plan;

use core::fmt;

use franka_model::{JointVector, Load, Model, RobotKind};
use franka_proto::RobotState;
use nalgebra::{SMatrix, Vector3, Vector4};

use crate::law::compensation::Learned;

pub use fit::{Fit, FitError};
pub use plan::{Plan, PlannedMotion, Reach};

/// A measured quantity with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// Most likely value, in the unit of the quantity.
    pub value: f64,
    /// Standard deviation, in the same unit.
    pub deviation: f64,
}

impl fmt::Display for Estimate {
    /// Prints `0.842 ± 0.031`, or another number of digits if a precision is given.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(3);
        write!(f, "{:.digits$} ± {:.digits$}", self.value, self.deviation)
    }
}

/// Torques of one joint that the robot's model does not contain.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct IdentifiedJoint {
    /// Friction at the velocity `Plan::SPEED` that the robot's own compensation does not cover,
    /// including the viscous part, `[N m]`.
    pub friction: Estimate,
    /// Torque that is the same in both directions and in every pose, for example the zero error of
    /// the torque sensor, `[N m]`.
    pub bias: Estimate,
}

/// Load at the flange, without the end effector that is configured at the robot (`m_ee`). It
/// includes the declared load, and the difference between the real and the configured end effector.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct IdentifiedLoad {
    /// Mass, `[kg]`. Without a load it may be slightly negative.
    pub mass: Estimate,
    /// Mass times centre of mass, in the flange frame, `[kg m]`.
    pub moment: [Estimate; 3],
}

impl IdentifiedLoad {
    /// Returns the centre of mass in the flange frame, `[m]`. Returns `None` if the mass is less
    /// than three of its standard deviations, because the centre is then unknown. You can pass the
    /// mass and this centre to `set_load`.
    pub fn center(&self) -> Option<[Estimate; 3]> {
        let Estimate { value, deviation } = self.mass;
        (value > 3.0 * deviation).then(|| {
            self.moment.map(|moment| {
                let center = moment.value / value;
                Estimate {
                    value: center,
                    deviation: (moment.deviation / value).hypot(center * deviation / value),
                }
            })
        })
    }
}

/// Properties of an arm, measured with the motions of a `Plan`.
///
/// `Display` prints a readable table. With the feature `serde`, the value can be stored.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Identified {
    /// The kind of the robot.
    pub kind: RobotKind,
    /// Joints of the arm, base to flange.
    pub joints: [IdentifiedJoint; 7],
    /// Load at the flange.
    pub load: IdentifiedLoad,
}

/// Reason why [`Identified`] values cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnownError {
    /// The values were measured with a different kind of robot.
    #[error(
        "the identified values belong to another kind of robot: got {got:?}, expected {expected:?}"
    )]
    Kind {
        /// Kind of robot with which the values were measured.
        got: RobotKind,
        /// Kind of the connected robot.
        expected: RobotKind,
    },
    /// A number is implausible for any arm.
    #[error(
        "the identified values have an implausible {name}: got {got}, expected {least} to {most}"
    )]
    Number {
        /// Name of the number, with its unit.
        name: &'static str,
        /// Value of the number.
        got: f64,
        /// The lowest accepted value.
        least: f64,
        /// The highest accepted value.
        most: f64,
    },
}

impl Identified {
    /// Checks that these values are plausible and suit this kind of robot.
    ///
    /// # Errors
    /// Returns [`KnownError::Kind`] if the values were measured with a different kind of robot, and
    /// [`KnownError::Number`] if a number is not finite or not plausible.
    pub fn check(&self, expected: RobotKind) -> Result<(), KnownError> {
        let got = self.kind;
        if got != expected {
            return Err(KnownError::Kind { got, expected });
        }
        let number = |name, got: f64, least, most| match (least..=most).contains(&got) {
            true => Ok(()),
            false => Err(KnownError::Number {
                name,
                got,
                least,
                most,
            }),
        };
        let estimate = |[name, deviation]: [&'static str; 2], of: &Estimate, least, most| {
            number(name, of.value, least, most)?;
            number(deviation, of.deviation, 0.0, f64::MAX)
        };
        for joint in &self.joints {
            let names = ["friction [N m]", "deviation of the friction [N m]"];
            estimate(names, &joint.friction, 0.0, TORQUE_MAX)?;
            let names = ["bias [N m]", "deviation of the bias [N m]"];
            estimate(names, &joint.bias, -TORQUE_MAX, TORQUE_MAX)?;
        }
        let names = ["mass of the load [kg]", "deviation of the mass [kg]"];
        estimate(names, &self.load.mass, -1.0, MASS_MAX)?;
        for moment in &self.load.moment {
            let names = [
                "moment of the load [kg m]",
                "deviation of the moment [kg m]",
            ];
            estimate(names, moment, -MASS_MAX, MASS_MAX)?;
        }
        Ok(())
    }

    /// Returns the initial values of the law for the robot's current state. The part of the load
    /// that is not declared in this state counts as bias.
    pub(crate) fn learned(&self, model: &Model, state: &RobotState) -> Learned {
        let IdentifiedLoad { mass, moment } = self.load;
        let [x, y, z] = moment.map(|of| of.value);
        let load = Vector4::new(mass.value, x, y, z) - declared(state);
        let gravity = load_gravity(model, &state.q.into(), &state.O_ddP_O.into());
        let [x, y, z] = moment.map(|of| of.deviation);
        let unsure = Vector4::new(mass.deviation, x, y, z);
        Learned::known(core::array::from_fn(|i| {
            let IdentifiedJoint { friction, bias } = self.joints[i];
            let row = gravity.row(i).transpose();
            let off = row.component_mul(&unsure).norm();
            let friction = (friction.value, friction.deviation);
            let at = bias.value + row.dot(&load);
            (friction, (at, bias.deviation.hypot(off)))
        }))
    }
}

impl fmt::Display for Identified {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "joint  friction, N m   bias, N m")?;
        for (i, IdentifiedJoint { friction, bias }) in self.joints.iter().enumerate() {
            let (friction, bias) = (friction.to_string(), bias.to_string());
            writeln!(f, "{}      {friction:<13}   {bias}", i + 1)?;
        }
        write!(f, "load   {} kg", self.load.mass)?;
        match self.load.center() {
            Some([x, y, z]) => write!(
                f,
                ", centre of mass at {x:.3}, {y:.3}, {z:.3} m in the flange frame"
            ),
            None => Ok(()),
        }
    }
}

/// Returns the torques that hold a load, per mass and per mass times centre of mass in the flange
/// frame, `[N m/kg]` and `[N m/(kg m)]`. The torques are linear in both. `gravity` is in the base
/// frame, `[m/s²]`.
fn load_gravity(model: &Model, q: &JointVector, gravity: &Vector3<f64>) -> SMatrix<f64, 7, 4> {
    let at = |com: Vector3<f64>| {
        let load = Load {
            mass: 1.0,
            com,
            ..Load::NONE
        };
        model.gravity(q, &load, gravity)
    };
    let flange = at(Vector3::zeros());
    let mass = flange - model.gravity(q, &Load::NONE, gravity);
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| at(axis) - flange);
    SMatrix::from_columns(&[mass, x, y, z])
}

/// Returns mass and moment of the load that is configured at the robot, `[kg]` and `[kg m]`.
fn declared(state: &RobotState) -> Vector4<f64> {
    let (mass, [x, y, z]) = (state.m_load, state.F_x_Cload);
    Vector4::new(1.0, x, y, z) * mass
}

/// Largest plausible friction and bias of a joint, `[N m]`.
const TORQUE_MAX: f64 = 20.0;

/// Largest plausible mass, `[kg]`, and moment, `[kg m]`, of a load.
const MASS_MAX: f64 = 20.0;

#[cfg(test)]
mod tests {
    use franka_model::GRAVITY_EARTH;

    use super::*;

    fn found() -> Identified {
        let of = |value| Estimate {
            value,
            deviation: 0.05,
        };
        let joint = IdentifiedJoint {
            friction: of(0.8),
            bias: of(-0.3),
        };
        Identified {
            kind: RobotKind::Fr3,
            joints: [joint; 7],
            load: IdentifiedLoad {
                mass: of(0.5),
                moment: [of(0.0), of(0.01), of(0.05)],
            },
        }
    }

    #[test]
    #[cfg(feature = "serde")]
    fn identified_survives_a_round_trip_through_json() {
        let text = serde_json::to_string(&found()).unwrap();
        assert!(text.starts_with(r#"{"kind":"Fr3","joints":[{"friction":{"value":0.8,"#));
        assert_eq!(serde_json::from_str::<Identified>(&text).unwrap(), found());
    }

    #[test]
    fn another_kind_and_implausible_numbers_are_refused() {
        assert_eq!(found().check(RobotKind::Fr3), Ok(()));
        let error = found().check(RobotKind::Fer).unwrap_err();
        let text = "the identified values belong to another kind of robot: got Fr3, expected Fer";
        assert_eq!(error.to_string(), text);
        type Number = fn(&mut Identified) -> &mut f64;
        let numbers: [(Number, f64); 6] = [
            (|of| &mut of.joints[3].friction.value, -0.1),
            (|of| &mut of.joints[6].bias.value, f64::NAN),
            (|of| &mut of.joints[0].bias.deviation, f64::INFINITY),
            (|of| &mut of.load.mass.value, 21.0),
            (|of| &mut of.load.mass.deviation, -1.0),
            (|of| &mut of.load.moment[2].value, f64::NEG_INFINITY),
        ];
        for (number, wrong) in numbers {
            let mut wrong_one = found();
            *number(&mut wrong_one) = wrong;
            let error = wrong_one.check(RobotKind::Fr3).unwrap_err();
            assert!(matches!(error, KnownError::Number { .. }), "{error}");
            assert!(error.to_string().contains(&format!("got {wrong}, ")));
        }
    }

    #[test]
    fn an_undeclared_load_is_bias_and_a_declared_one_is_not() {
        let model = Model::fr3();
        let mut state = RobotState {
            q: franka_model::READY.into(),
            O_ddP_O: GRAVITY_EARTH.into(),
            ..RobotState::default()
        };
        let joint = |state: &RobotState| {
            let (friction, bias) = found().learned(model, state).of(3);
            assert_eq!(friction, 0.8);
            bias
        };
        // The load is half a kilogram, some 0.5 m from joint 4.
        assert!((2.0..3.0).contains(&(joint(&state) + 0.3)));
        state.m_load = 0.5;
        state.F_x_Cload = [0.0, 0.02, 0.1];
        assert!((joint(&state) + 0.3).abs() < 1e-9);
    }

    /// The robot reports gravity as the acceleration of its base, in the axes of the base.
    #[test]
    fn a_load_pulls_where_the_base_is_mounted_to() {
        let model = Model::fr3();
        let bias = |gravity: Vector3<f64>| {
            let state = RobotState {
                q: franka_model::READY.into(),
                O_ddP_O: gravity.into(),
                ..RobotState::default()
            };
            found().learned(model, &state).of(3).1 + 0.3
        };
        let upright = bias(GRAVITY_EARTH);
        assert!((2.0..3.0).contains(&upright));
        assert!((bias(-GRAVITY_EARTH) + upright).abs() < 1e-9, "hanging");
        let load = Load {
            mass: 0.5,
            com: Vector3::new(0.0, 0.02, 0.1),
            ..Load::NONE
        };
        let sideways = Vector3::new(9.81, 0.0, 0.0);
        let of = |load| model.gravity(&franka_model::READY, load, &sideways)[3];
        let expected = of(&load) - of(&Load::NONE);
        assert!((bias(sideways) - expected).abs() < 1e-9, "on a wall");
    }

    #[test]
    fn a_center_is_told_of_what_surely_has_a_mass() {
        let mut load = found().load;
        let [x, _, z] = load.center().expect("ten deviations");
        assert_eq!((x.value, z.value), (0.0, 0.1));
        load.mass.value = 0.14;
        assert_eq!(load.center(), None);
        let text = found().to_string();
        assert!(
            text.contains(
                "\n7      0.800 ± 0.050   -0.300 ± 0.050\nload   0.500 ± 0.050 kg, centre"
            )
        );
    }

    #[test]
    fn without_motion_nothing_is_found() {
        let error = Fit::new(Model::fr3(), &RobotState::default()).finish();
        assert!(matches!(
            error,
            Err(FitError::TooLittle {
                joint: 1,
                got: 0,
                ..
            })
        ));
    }
}
