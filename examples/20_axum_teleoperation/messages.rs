//! What goes over a socket, as JSON.

use franka_async::{Pose, Robot, pose};
use serde::{Deserialize, Serialize};

/// From a client.
#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Request {
    Take {
        /// Other clients are told who holds the lease: this, or the address of the socket.
        name: Option<String>,
    },
    Target(Placement),
    Alive,
    Release,
    Recover,
    Stop,
}

/// To a client.
#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Reply {
    Taken,
    /// Nothing has changed.
    Refused {
        why: String,
    },
    /// The lease has ended, and the arm brakes.
    Lost {
        why: String,
    },
    Released,
    Recovered,
    /// The arm rests.
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
    /// The newest state.
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
    /// `None` if the quaternion is no rotation.
    pub(crate) fn pose(&self) -> Option<Pose> {
        pose::from_xyzw(self.position, self.quaternion)
    }
}
