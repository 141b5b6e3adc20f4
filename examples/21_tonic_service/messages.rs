//! The messages of the service, and what they are made of.

use franka_async::diagnosis::Diagnose;
use franka_async::error::Party;
use franka_async::state::RobotState;
use franka_async::{MotionError, Robot, pose};
use prost::Message;
use tonic::{Code, Status};

use proto::{Pose, Reflex, State};

/// Made by `build.rs`.
pub(crate) mod proto {
    #![allow(missing_docs, unreachable_pub, clippy::all)]
    tonic::include_proto!("franka.example");
}

/// The newest state.
pub(crate) fn state(robot: &Robot, state: &RobotState) -> State {
    let (position, quaternion) = pose::to_xyzw(&robot.pose_at(state.q));
    State {
        time: state.message_id,
        mode: state.robot_mode.to_string(),
        q: state.q.to_vec(),
        pose: Some(Pose {
            position: position.to_vec(),
            quaternion: quaternion.to_vec(),
        }),
        errors: state.errors.iter().map(|error| error.to_string()).collect(),
    }
}

impl Pose {
    /// In place of what it leaves out, that of `start`.
    pub(crate) fn to_isometry(
        &self,
        start: &franka_async::Pose,
    ) -> Result<franka_async::Pose, Status> {
        let (position, quaternion) = (&self.position[..], &self.quaternion[..]);
        let three = || Status::invalid_argument("a position has three numbers");
        let position = position.try_into().map_err(|_| three())?;
        let quaternion = match quaternion {
            [] => start.rotation.coords.into(),
            _ => quaternion
                .try_into()
                .map_err(|_| Status::invalid_argument("a quaternion has four numbers"))?,
        };
        let none = || Status::invalid_argument("the quaternion is no rotation");
        pose::from_xyzw(position, quaternion).ok_or_else(none)
    }
}

/// An error of a motion as a status; of a reflex, with [`Reflex`] in its details.
pub(crate) fn status(error: MotionError) -> Status {
    let text = error.to_string();
    let code = match &error {
        MotionError::Goal(_) => Code::InvalidArgument,
        MotionError::Control(control) => {
            let errors = control.failure.reflex_reason;
            let reflex = Reflex {
                errors: errors.iter().map(|error| error.to_string()).collect(),
                diagnosis: error
                    .diagnose()
                    .map_or_else(String::new, |why| why.to_string()),
            };
            return with_detail(Code::FailedPrecondition, text, &reflex);
        }
        MotionError::ConnectionClosed { .. } => Code::Unavailable,
        // The link is lost, or a supervised robot is away.
        _ if error.party() == Party::Link => Code::Unavailable,
        MotionError::Rejected(_) | MotionError::NotReady { .. } | MotionError::Busy => {
            Code::FailedPrecondition
        }
        MotionError::Violation(_) | MotionError::Protocol { .. } => Code::Internal,
        _ => Code::Aborted, // stopped, superseded, given up: the arm rests or goes on
    };
    Status::new(code, text)
}

fn with_detail(code: Code, text: String, detail: &Reflex) -> Status {
    let detail = prost_types::Any::from_msg(detail).expect("it is in memory");
    let status = tonic_types::Status {
        code: code.into(),
        message: text.clone(),
        details: vec![detail],
    };
    Status::with_details(code, text, status.encode_to_vec().into())
}
