//! The messages of a socket, as JSON.

use franka_async::{Pose, Robot, pose};
use serde::{Deserialize, Serialize};

/// A message from a client.
#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Request {
    Take {
        /// Name of the lease holder for other clients; the default is the address of the socket.
        name: Option<String>,
    },
    Target(Placement),
    Alive,
    Release,
    Recover,
    Stop,
}

/// A message to a client.
#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Reply {
    Taken,
    /// The request was refused and had no effect.
    Refused {
        why: String,
    },
    /// The lease has ended, and the arm brakes.
    Lost {
        why: String,
    },
    Released,
    Recovered,
    /// The arm is at rest.
    Stopped,
    State {
        time: u64,
        mode: String,
        q: [f64; 7],
        #[serde(flatten)]
        pose: Placement,
    },
}

/// A pose in the base frame, `[m]` and x y z w.
#[derive(Serialize, Deserialize)]
pub(crate) struct Placement {
    position: [f64; 3],
    quaternion: [f64; 4],
}

pub(crate) fn refused(why: impl ToString) -> Reply {
    Reply::Refused {
        why: why.to_string(),
    }
}

impl Reply {
    /// Returns the newest state.
    pub(crate) fn state(robot: &Robot) -> Self {
        let state = robot.state();
        let (position, quaternion) = pose::to_xyzw(&robot.pose());
        Self::State {
            time: state.message_id,
            mode: state.robot_mode.to_string(),
            q: state.q,
            pose: Placement {
                position,
                quaternion,
            },
        }
    }
}

impl Placement {
    /// Returns the pose; `None` if the quaternion is not a rotation.
    pub(crate) fn pose(&self) -> Option<Pose> {
        pose::from_xyzw(self.position, self.quaternion)
    }
}
