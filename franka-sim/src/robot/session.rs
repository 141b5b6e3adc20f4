//! The robot's session with its client: the robot accepts one client, answers its requests, and
//! disconnects it. `connection` handles the handshake. `serve::sessions` refuses a second client.

use bytes::Bytes;
use franka_proto::framing::{FrameError, MAX_REQUEST_SIZE, Message, next_message_within};
use franka_proto::{
    CommandId, LibraryStatus, MoveStatus, Reply, Request, RobotMode, SetterStatus, VirtualWall,
};

use super::{Activity, ArmModel, Robot};
use crate::connection::{Connection, SessionError};

/// Splits the first message off a client's stream.
pub(crate) fn next_request(received: &[u8]) -> Result<Option<Message<'_>>, FrameError> {
    next_message_within(received, MAX_REQUEST_SIZE)
}

impl Robot {
    /// Connects a client. Returns false if another client is connected, because the robot accepts
    /// only one client at a time.
    pub fn connect(&mut self) -> bool {
        if self.client.is_some() {
            return false;
        }
        self.replies.clear();
        self.client = Some(Connection::new(self.version(), next_request));
        true
    }

    /// Disconnects the client. If the client runs a motion, the arm brakes and holds its position.
    pub fn disconnect(&mut self) {
        if self.client.is_some() {
            self.forget_client();
            self.client = None;
            self.replies.clear();
        }
    }

    /// True if a client is connected.
    pub fn is_connected(&self) -> bool {
        self.client.is_some()
    }

    /// Accepts bytes from the client's stream, in pieces of any size.
    ///
    /// # Errors
    /// Returns [`SessionError`] if the client violated the protocol or uses another version. The
    /// robot then disconnects the client. Send the remaining replies from
    /// [`take_reply`](Self::take_reply), and close the stream.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), SessionError> {
        let Some(client) = &mut self.client else {
            return Ok(());
        };
        client.receive(bytes);
        let result = self.take_requests();
        if result.is_err() {
            self.forget_client();
            self.client = None;
        }
        result
    }

    /// Returns the next bytes for the client's stream: a message, or one of its two parts.
    pub fn take_reply(&mut self) -> Option<Bytes> {
        self.replies.pop_front()
    }

    fn take_requests(&mut self) -> Result<(), SessionError> {
        while let Some(client) = &mut self.client {
            let Some((id, request)) = client.next_request(&mut self.replies)? else {
                break;
            };
            self.answer(id, &request);
        }
        Ok(())
    }

    fn answer(&mut self, id: CommandId, request: &Request) {
        match request {
            Request::Move(request) => self.request_move(id, *request),
            Request::StopMove => self.request_stop(id),
            Request::AutomaticErrorRecovery => self.request_recovery(id),
            Request::GetRobotModel => self.send_description(id),
            Request::GetCartesianLimit { id: wall } => self.send_wall(id, *wall),
            Request::LoadModelLibrary { .. } => self.send_library(id),
            setter => {
                let status = if self.lock.safety_function {
                    self.kind.safety.setter
                } else if self.takes_setters() {
                    self.settings.apply(setter)
                } else {
                    SetterStatus::CommandNotPossibleRejected
                };
                self.refresh_frames();
                self.reply(id, Reply::Setter(status));
            }
        }
    }

    fn takes_setters(&self) -> bool {
        let setters = &self.config.unpublished.setters;
        match self.robot_mode() {
            RobotMode::Idle => true,
            RobotMode::Move => false,
            RobotMode::Reflex => setters.reflex,
            RobotMode::Guiding => setters.guiding,
            RobotMode::UserStopped => setters.user_stopped,
            RobotMode::Other | RobotMode::AutomaticErrorRecovery => setters.other,
        }
    }

    /// Recomputes the values that depend on frames and load.
    fn refresh_frames(&mut self) {
        self.refresh_dynamics();
        if !self.is_moving() {
            let arm = ArmModel::new(self.kind, &self.model, &self.settings.frames, &self.config);
            self.desired.follow_joints(&arm);
        }
    }

    /// Queues a reply for the client. A disconnected client receives no reply.
    pub(super) fn reply(&mut self, id: CommandId, reply: Reply<'_>) {
        let Some(client) = &mut self.client else {
            return;
        };
        // The session refuses a reply to which no request belongs.
        if let Ok(message) = client.session.reply(id, reply) {
            self.replies
                .push_back(Bytes::copy_from_slice(message.as_bytes()));
        }
    }

    /// Answers with the wall of this number, or with an inactive wall if no such wall was set up.
    fn send_wall(&mut self, id: CommandId, number: i32) {
        let known = self.config.walls.iter().find(|(known, _)| *known == number);
        let wall = known.map_or(NO_WALL, |(_, wall)| *wall);
        let status = SetterStatus::Success;
        self.reply(id, Reply::CartesianLimit { status, wall });
    }

    fn send_description(&mut self, id: CommandId) {
        let Some(client) = &mut self.client else {
            return;
        };
        // Clients of versions without this request cannot reach this line.
        let text = self.description.clone().unwrap_or_default();
        if let Ok(header) = client.session.model_header(id, text.len()) {
            let header = Bytes::copy_from_slice(header.as_bytes());
            self.replies.extend([header, text]);
        }
    }

    fn send_library(&mut self, id: CommandId) {
        let Some(library) = &self.config.model_library else {
            return self.reply(id, NO_LIBRARY);
        };
        let Some(client) = &mut self.client else {
            return;
        };
        // The robot does not serve a library that is longer than a message can be.
        match client.session.library_header(id, library.len()) {
            Ok(header) => {
                // The library's bytes are shared, not copied, because a library has megabytes.
                let header = Bytes::copy_from_slice(header.as_bytes());
                self.replies.extend([header, library.clone()]);
            }
            Err(_) => self.reply(id, NO_LIBRARY),
        }
    }

    /// Ends a motion with this status and without braking. The caller then places the arm at
    /// another position.
    pub(super) fn forget_motion(&mut self, status: MoveStatus) {
        if let Activity::Moving(motion) = &self.activity {
            let id = motion.id();
            self.command = None;
            self.reply(id, Reply::Move(status));
        }
        self.activity = Activity::Holding;
    }
}

const NO_WALL: VirtualWall = VirtualWall {
    object_world_size: [0.0; 3],
    object_frame: [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ],
    object_activation: false,
};

/// Answer of a robot without a model library.
const NO_LIBRARY: Reply<'static> = Reply::ModelLibrary {
    status: LibraryStatus::Error,
    library: &[],
};
