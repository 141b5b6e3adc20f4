//! The client's connection: stream bytes to requests, and replies back.

use bytes::Bytes;
use franka_proto::framing::{FrameError, MAX_REQUEST_SIZE, next_message_within};
use franka_proto::server::{Event, Session};
use franka_proto::{
    Command, CommandId, LibraryStatus, MoveStatus, Reply, Request, RobotMode, ServiceCommand,
    SetterStatus, Version, Violation, VirtualWall,
};

use super::{Activity, Arm, Robot};

/// The client that is connected.
pub(super) struct Client {
    session: Session,
    received: Vec<u8>,
    udp_port: Option<u16>,
}

impl Client {
    fn new(version: Version) -> Self {
        Self {
            session: Session::new(version),
            received: Vec::new(),
            udp_port: None,
        }
    }

    /// Where to send states; unknown before the handshake.
    pub(super) fn udp_port(&self) -> Option<u16> {
        self.udp_port
    }
}

/// Why a client is disconnected; `C` is what it could have asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError<C: ServiceCommand = Command> {
    /// Its bytes are no messages.
    #[error("{0}")]
    Frame(FrameError),
    /// Its messages are not allowed.
    #[error("{0}")]
    Violation(Violation<C>),
    /// It speaks another version, and is told so.
    #[error("it speaks protocol {announced}, which is not understood here")]
    Incompatible {
        /// The version that it announces.
        announced: u16,
    },
}

impl Robot {
    /// Takes a client in. False if another one is there: the robot has one client at a time.
    pub fn connect(&mut self) -> bool {
        if self.client.is_some() {
            return false;
        }
        self.replies.clear();
        self.client = Some(Client::new(self.version()));
        true
    }

    /// Takes leave of the client. A motion of its ends: the arm brakes and holds.
    pub fn disconnect(&mut self) {
        if self.client.is_some() {
            self.forget_client();
            self.client = None;
            self.replies.clear();
        }
    }

    /// Whether a client is there.
    pub fn is_connected(&self) -> bool {
        self.client.is_some()
    }

    /// Takes bytes from the client's stream, in any portions.
    ///
    /// # Errors
    /// [`SessionError`] if the client left the protocol or speaks another version. It is then
    /// disconnected, after the replies that are still to be sent.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), SessionError> {
        let Some(client) = &mut self.client else {
            return Ok(());
        };
        client.received.extend_from_slice(bytes);
        let result = self.take_messages();
        if result.is_err() {
            self.forget_client();
            self.client = None;
        }
        result
    }

    /// The next message for the client's stream, to be written whole.
    pub fn take_reply(&mut self) -> Option<Bytes> {
        self.replies.pop_front()
    }

    fn take_messages(&mut self) -> Result<(), SessionError> {
        while let Some(client) = &mut self.client {
            let message = next_message_within(&client.received, MAX_REQUEST_SIZE)
                .map_err(SessionError::Frame)?;
            let Some(message) = message else {
                break;
            };
            let size = message.size();
            let event = client
                .session
                .on_message(message)
                .map_err(SessionError::Violation)?;
            client.received.drain(..size);
            match event {
                Event::Connect {
                    udp_port, reply, ..
                } => {
                    client.udp_port = Some(udp_port);
                    self.replies
                        .push_back(Bytes::copy_from_slice(reply.as_bytes()));
                }
                Event::Incompatible { version, reply } => {
                    self.replies
                        .push_back(Bytes::copy_from_slice(reply.as_bytes()));
                    return Err(SessionError::Incompatible { announced: version });
                }
                Event::Rejected { reply, .. } => {
                    self.replies
                        .push_back(Bytes::copy_from_slice(reply.as_bytes()));
                }
                Event::Request { id, request } => self.answer(id, &request),
                _ => {}
            }
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

    /// Frames and load may have changed: what is derived from them follows.
    fn refresh_frames(&mut self) {
        self.refresh_dynamics();
        if !self.is_moving() {
            let arm = Arm::new(self.kind, self.model, &self.settings.frames, &self.config);
            self.desired.follow_joints(&arm);
        }
    }

    /// Queues a reply for the client. One that has gone by now gets none.
    pub(super) fn reply(&mut self, id: CommandId, reply: Reply<'_>) {
        let Some(client) = &mut self.client else {
            return;
        };
        // The session refuses replies to what it has not been asked, and none is made up here.
        if let Ok(message) = client.session.reply(id, reply) {
            self.replies
                .push_back(Bytes::copy_from_slice(message.as_bytes()));
        }
    }

    /// A wall that nobody has set up is not active.
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
        // A version without the request never gets here.
        let text = self.description.as_deref().unwrap_or_default().as_bytes();
        if let Ok(header) = client.session.model_header(id, text.len()) {
            self.replies.push_back(joined(header.as_bytes(), text));
        }
    }

    fn send_library(&mut self, id: CommandId) {
        let Some(library) = &self.config.model_library else {
            return self.reply(id, NO_LIBRARY);
        };
        let Some(client) = &mut self.client else {
            return;
        };
        // One that is longer than a message may be is as good as none.
        match client.session.library_header(id, library.len()) {
            Ok(header) => self.replies.push_back(joined(header.as_bytes(), library)),
            Err(_) => self.reply(id, NO_LIBRARY),
        }
    }

    /// Ends a motion without a brake, for an arm that is about to stand elsewhere.
    pub(super) fn forget_motion(&mut self) {
        if let Activity::Moving(motion) = &self.activity {
            let id = motion.id();
            self.command = None;
            self.reply(id, Reply::Move(MoveStatus::Preempted));
        }
        self.activity = Activity::Holding;
    }
}

fn joined(header: &[u8], tail: &[u8]) -> Bytes {
    [header, tail].concat().into()
}

/// A wall that is none.
const NO_WALL: VirtualWall = VirtualWall {
    object_world_size: [0.0; 3],
    object_frame: [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ],
    object_activation: false,
};

/// There is no model library to load.
const NO_LIBRARY: Reply<'static> = Reply::ModelLibrary {
    status: LibraryStatus::Error,
    library: &[],
};
