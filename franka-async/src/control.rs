//! Control at 1 kHz by the program itself.
//!
//! * [`Control`]: a function that the real-time thread calls with every state. The call is a
//!   future: [`Robot::control_torques`](crate::Robot::control_torques) and its siblings.
//! * [`Active`]: the same in a thread of the program, which reads states and writes commands.
//! * [`AsynchronousControl`]: sparse joint targets between which the robot plans.
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
