//! The model of an arm: kinematics, dynamics, limits, inverse kinematics, distances.
//!
//! [`Robot::model`](crate::Robot::model) returns the model of the connected arm, from the robot's
//! own description (feature `urdf`, on by default). [`Model::fr3`] and [`Model::fer`] need no
//! robot. Control functions may call the functions here, because they neither allocate nor wait.
//! Load models from a description or a library beforehand. [`StateModel`] takes the end effector
//! and the load from a state.
//!
//! ```
//! use franka_async::READY;
//! use franka_async::model::{EndEffector, Frame, Model};
//! use franka_async::pose;
//!
//! let flange = Model::fr3().pose(Frame::Flange, &READY, &EndEffector::default());
//! let flange = pose::from_matrix(&flange).expect("a model's poses are rigid");
//! assert!((flange.translation.z - 0.590_282_052).abs() < 1e-9);
//! ```
//!
//! With the feature `model-library` (off by default), [`load_model_library`] loads the code that a
//! Franka Emika Robot provides.
//!
//! [`load_model_library`]: crate::Robot::load_model_library

pub use crate::state_model::StateModel;
#[cfg(all(feature = "model-library", target_os = "linux"))]
pub use franka_model::model_library::ModelLibrary;
pub use franka_model::{
    AsBuilt, CYCLE, Dynamics, EndEffector, Frame, GRAVITY_EARTH, Jacobian, JointMargins,
    JointVector, Load, MassMatrix, Model, OperationalSpace, RigidBody, RobotKind, Symmetric3,
    Twist, Wrench, analytic_ik, collision, contact as contacts, differential_ik, elbow, geometry,
    inverse_kinematics, joint_vector, layout, limits, manipulability,
};
pub use franka_proto::{Architecture, System};
