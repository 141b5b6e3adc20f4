//! Control at 1 kHz by code of the program.
//!
//! * [`Control`]: a function that the real-time thread calls with every state.
//!   [`Robot::control_torques`](crate::Robot::control_torques) and similar methods return this
//!   future.
//! * [`Active`]: a thread of the program reads states and writes commands itself.
//! * [`AsynchronousControl`]: sparse joint targets; the robot plans the motion between them.
//! * [`slot`]: passes values into a control function, which must not lock.

pub use crate::active_control::Active;
pub use crate::asynchronous_control::{AsynchronousControl, AsynchronousOptions};
pub use crate::control_function::Control;
pub use franka_proto::MoveControllerMode;
pub use franka_rt::control::{
    AbortReason, CartesianPose, CartesianVelocities, Finish, JointPositions, JointVelocities, Next,
    TargetStatus, Torques,
};
pub use franka_rt::slot;
