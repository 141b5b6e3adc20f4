//! States of the robot, whether the arm moves or not: the newest state as it changes ([`States`]),
//! or every state ([`StateStream`]).

pub use crate::state_stream::{Reading, StateStream};
pub use crate::states::States;
pub use crate::tare::{TaredState, TaredStates};
pub use franka_proto::{
    ControllerMode, Errors, MotionGeneratorMode, RobotError, RobotMode, RobotState, TotalLoad,
};
pub use franka_rt::tare::{TareRefused, Taring, WrenchTare};
