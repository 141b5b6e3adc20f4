//! Errors, grouped by the party that can act on them. Texts are the same as in libfranka if
//! libfranka has the same error. [`Error`](crate::Error) can hold any of them.
//! [`MotionError`](crate::MotionError) is the reason why a motion ended before its goal.

/// Defines the accessors of an error's method `row`.
macro_rules! row_accessors {
    () => {
        /// Returns the name of this error's row in the book's `errors.md`.
        pub fn entry(&self) -> &'static str {
            self.row().0
        }

        /// Returns the party that can act on this error.
        pub fn party(&self) -> Party {
            self.row().1
        }
    };
}

pub(crate) mod any;
mod calls;
mod connecting;

use franka_proto::{gripper, vacuum};

pub use crate::endpoint::EndpointError;
pub use calls::{ActionError, ActiveError, CommandError, IdentifyError, ReadError, TareError};
#[cfg(feature = "urdf")]
pub use connecting::ModelError;
pub use connecting::{Attempt, ConnectError};

#[cfg(all(feature = "model-library", target_os = "linux"))]
pub use calls::ModelLibraryError;
#[cfg(all(feature = "model-library", target_os = "linux"))]
pub use franka_model::model_library::LibraryError;
#[cfg(feature = "urdf")]
pub use franka_model::urdf::UrdfError;
pub use franka_proto::framing::FrameError;
pub use franka_proto::gripper::Failure as ActionFailure;
pub use franka_proto::{
    Command, ControlFailure, DecodeError, IncompatibleVersion, LibraryStatus, ModelStatus,
    MoveStatus, RecoveryStatus, Refusal, RequestError, SetterStatus, Status, StopStatus,
    SuccessRate, Violation,
};
pub use franka_rt::control::WriteError;
pub use franka_rt::driver::LinkTimeoutError;
pub use franka_rt::exchange::SendError;
pub use franka_rt::identify::{FitError, KnownError};
pub use franka_rt::law::GainError;
pub use franka_rt::lifecycle::{CloseReason, ControlError, Party, Stage, Unready};
pub use franka_rt::sched::SchedError;
pub use franka_rt::session::condition::ConditionError;
pub use franka_rt::session::{
    ChunkError, GoalError, Hindrance, Lapse, LimitedTorque, PathError, PoseError, Shortfall,
    TooManyChunks,
};
pub use franka_rt::shaping::{FilterFault, InvalidCommand, Signal};
pub use franka_rt::thread::{BorrowError, LinkFault, WriteFault};
pub use franka_rt::together::StartFault;

/// Name of an error's row in the book's `errors.md`, and the party that can act on the error.
type Row = (&'static str, Party);

/// Reason why an action of the Franka Hand returned neither true nor false.
pub type GripperError = ActionError<gripper::Command>;

/// Reason why an action of the vacuum gripper returned neither true nor false.
pub type VacuumGripperError = ActionError<vacuum::Command>;
