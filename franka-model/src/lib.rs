//! Kinematics, dynamics and limits of Franka robots.
//!
//! ```text
//! q, dq ──> chain (axes and origins in base axes) ──> pose, Jacobians
//!                 │
//!                 └─> bodies (com and inertia in base axes, load included)
//!                         └─> mass, Coriolis, gravity, inverse and forward dynamics
//! ```
//!
//! Every function depends only on constants ([`Model`]) and on its arguments. No function allocates
//! or panics, and each does a bounded amount of work. All functions may therefore run in a
//! real-time cycle, unless their documentation states a longer time. One call, [`Model::dynamics`],
//! returns all quantities that a control law needs in one cycle.
//!
//! | module | content |
//! |---|---|
//! | [`frame`], [`load`] | the ten frames of the vendor's model, end effector, payload |
//! | [`geometry`] | lengths and joint frames |
//! | [`limits`] | position, velocity, acceleration, jerk, torque and Cartesian limits |
//! | [`rotation`] | rotation vectors: exponential, logarithm, angular velocity and acceleration |
//! | [`transform`] | column-major arrays and 4×4 matrices to isometries and back |
//! | [`differential_ik`] | joint velocities for a twist, exactly inside a box |
//! | [`inverse_kinematics`] | joint positions for a pose or a point, by iteration |
//! | [`analytic_ik`] | every joint position for a pose and a redundancy parameter, and reachability |
//! | [`elbow`] | the vendor's elbow parameter, and the swivel angle |
//! | [`operational_space`] | the apparent inertia at a point and in a direction |
//! | [`layout`] | conversions to libfranka's arrays |
//! | [`collision`] | distances within the arm, to planes and to boxes, with gradients |
//! | [`contact`] | place and force of a contact, from external torques |
//! | `urdf` (a feature) | models from the description that a robot provides |
//! | `model_library` (a feature) | the compiled model code of a Franka Emika Robot |
//!
//! The driver's control uses the modules from `frame` to `elbow`, the dynamics and `collision`. Use
//! [`analytic_ik`], [`manipulability`] and [`JointMargins`] outside the control cycle: they return
//! postures for a pose, check if a target is reachable, and measure distances to the limits.
//!
//! # Conventions
//!
//! All values are in SI units and radians. The base frame O is the frame of link 0. Its origin is
//! at the centre of the base, and its z axis is the axis of joint 1. Twists and wrenches are
//! `[linear; angular]`. Poses are homogeneous 4×4 matrices, because the rotation block of the
//! vendor's end-effector frame may not be exactly a rotation, and the model uses the frame
//! unchanged. [`transform::isometry`] converts to [`nalgebra::Isometry3`].
//!
//! # Example
//!
//! ```
//! use franka_model::{EndEffector, GRAVITY_EARTH, JointVector, Load, Model, READY};
//!
//! let model = Model::fr3();
//! let dynamics = model.dynamics(
//!     &READY,
//!     &JointVector::zeros(),
//!     &EndEffector::default(),
//!     &Load::NONE,
//!     &GRAVITY_EARTH,
//! );
//! assert!((dynamics.pose[(2, 3)] - 0.590_282_052).abs() < 1e-9);
//! assert!((dynamics.gravity[3] - 18.958_219_373).abs() < 1e-9);
//! ```
//!
//! # What it does not do
//!
//! Friction, rotor inertia and joint elasticity are not part of the model, as in the vendor's
//! model.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![cfg_attr(not(feature = "model-library"), forbid(unsafe_code))]

#[cfg(any(test, feature = "std"))]
extern crate std;

mod as_built;
mod bodies;
mod box_qp;
mod chain;
mod dynamics;
mod inertia;
mod jacobian;
mod kind;
mod ldl;
mod margins;
mod merge;
mod model;
mod robots;
mod scalar;

pub mod analytic_ik;
pub mod collision;
pub mod contact;
pub mod differential_ik;
pub mod elbow;
pub mod frame;
pub mod geometry;
pub mod inverse_kinematics;
pub mod layout;
pub mod limits;
pub mod load;
#[cfg(all(feature = "model-library", target_os = "linux"))]
pub mod model_library;
pub mod operational_space;
pub mod rotation;
pub mod transform;
#[cfg(feature = "urdf")]
pub mod urdf;

#[cfg(test)]
mod identities;
#[cfg(test)]
mod known_numbers;
#[cfg(test)]
mod oracle;
#[cfg(test)]
mod random;

pub use as_built::AsBuilt;
pub use dynamics::Dynamics;
pub use frame::{EndEffector, Frame};
pub use inertia::{RigidBody, Symmetric3};
pub use jacobian::manipulability;
pub use kind::RobotKind;
pub use load::Load;
pub use margins::JointMargins;
pub use model::Model;
pub use operational_space::OperationalSpace;

use nalgebra::{ArrayStorage, SMatrix, SVector, Vector3};

// Compiles the program in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// One number per joint, from base to flange.
pub type JointVector = SVector<f64, 7>;

/// A 6×7 matrix that maps joint velocities to a twist `[linear; angular]`.
pub type Jacobian = SMatrix<f64, 6, 7>;

/// Joint-space inertia, `[kg·m²]`, symmetric and positive definite.
pub type MassMatrix = SMatrix<f64, 7, 7>;

/// A velocity `[linear; angular]`, `[m/s, rad/s]`, or its derivative.
pub type Twist = SVector<f64, 6>;

/// A wrench `[force; torque]`, `[N, N·m]`.
pub type Wrench = SVector<f64, 6>;

/// Duration of a control cycle, `[s]`. The robot sends a state and expects a command in every
/// cycle, even after lost states.
pub const CYCLE: f64 = 1e-3;

/// Gravitational acceleration in the base frame of an upright robot, `[m/s²]`.
///
/// This is the default value of the vendor's model (libfranka 0.21, `model.h`).
pub const GRAVITY_EARTH: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

/// The ready pose of the vendor's examples, `[rad]`. The hand is in front of the arm and points
/// down, far from limits and singularities.
pub const READY: JointVector = {
    use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    joint_vector([
        0.0,
        -FRAC_PI_4,
        0.0,
        -3.0 * FRAC_PI_4,
        0.0,
        FRAC_PI_2,
        FRAC_PI_4,
    ])
};

/// Creates a [`JointVector`] from an array. Constants may call this function.
pub const fn joint_vector(values: [f64; 7]) -> JointVector {
    JointVector::from_array_storage(ArrayStorage([values]))
}
