//! The session of a robot.

use crate::error::{DecodeError, ReplyError, Violation};
use crate::framing::{Header, MAX_MESSAGE_SIZE, Message};
use crate::outgoing::Outgoing;
use crate::pending::{self, Pending};
use crate::service::{
    Command, CommandId, ConnectStatus, LibraryStatus, ModelStatus, MoveStatus, Reply, Request,
};
use crate::version::Version;

/// One connection of a client, from its first byte to its last.
#[derive(Clone, Debug)]
pub struct Session {
    version: Version,
    phase: Phase,
    pending: Pending,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Listening,
    Open,
}

/// What a message of a client asks for.
// The variants are moved once, from the session to the driver; a box would need an allocator.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// A client of the same version is there. Send `reply`; states go to `udp_port` from then on.
    Connect {
        /// The id of the handshake.
        id: CommandId,
        /// UDP port of the client.
        udp_port: u16,
        /// The answer that the session gives.
        reply: Outgoing,
    },
    /// A client of another version is there. Send `reply`; the client closes.
    Incompatible {
        /// The version that the client announces.
        version: u16,
        /// The answer that the session gives.
        reply: Outgoing,
    },
    /// A request to act on, and to answer with [`Session::reply`] or [`Session::model_header`].
    Request {
        /// The id to answer to.
        id: CommandId,
        /// What is asked for.
        request: Request,
    },
    /// A request with an enumerator that does not exist, such as a `Move` with an unknown mode. A
    /// robot answers it as an invalid argument. Send `reply`; the request is done.
    Rejected {
        /// The id of the request.
        id: CommandId,
        /// What is wrong with it.
        error: DecodeError,
        /// The answer that the session gives.
        reply: Outgoing,
    },
}

impl Session {
    /// Requests that may wait for replies at the same time.
    pub const PENDING_LIMIT: usize = pending::LIMIT;

    /// A session of a robot that speaks `version`.
    #[must_use]
    pub fn new(version: Version) -> Self {
        Self {
            version,
            phase: Phase::Listening,
            pending: Pending::new(),
        }
    }

    /// The version of the robot.
    #[must_use]
    pub fn version(&self) -> Version {
        self.version
    }

    /// Whether the handshake is done.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.phase == Phase::Open
    }

    /// What a message of the client asks for.
    ///
    /// # Errors
    /// [`Violation`]: the client is to be disconnected.
    pub fn on_message(&mut self, message: Message<'_>) -> Result<Event, Violation> {
        let id = message.header.id();
        let request = match Request::decode(self.version, &message) {
            Ok(request) => request,
            Err(error) => {
                let command = self.version.command_from_number(message.header.command);
                return match (error, command.and_then(Reply::to_unknown_value)) {
                    (DecodeError::UnknownValue { .. }, Some(reply))
                        if self.phase == Phase::Open =>
                    {
                        self.reject(id, reply, error)
                    }
                    _ => Err(Violation::Request { id, error }),
                };
            }
        };
        match (self.phase, request) {
            (Phase::Listening, Request::Connect { version, udp_port }) => {
                Ok(self.on_connect(id, version, udp_port))
            }
            (Phase::Listening, request) => Err(Violation::NotConnect {
                got: request.command(),
            }),
            (Phase::Open, Request::Connect { .. }) => Err(Violation::SecondConnect),
            (Phase::Open, request) => {
                self.remember(id, request.command())?;
                Ok(Event::Request { id, request })
            }
        }
    }

    /// The message that answers a request.
    ///
    /// A `Move` is answered twice: [`MoveStatus::MotionStarted`], then how it ended; or once, with
    /// a refusal. A model is answered with [`Session::model_header`] instead, unless it is refused.
    ///
    /// # Errors
    /// [`ReplyError`]; the session is then as before.
    pub fn reply(&mut self, id: CommandId, reply: Reply<'_>) -> Result<Outgoing, ReplyError> {
        if let Reply::Model { text: tail, .. } | Reply::ModelLibrary { library: tail, .. } = reply
            && !tail.is_empty()
        {
            return Err(ReplyError::TextLength { len: tail.len() });
        }
        self.answer(id, &reply, 0)
    }

    /// The beginning of the message that answers `GetRobotModel`: the caller sends `text_len` bytes
    /// of text right behind it.
    ///
    /// # Errors
    /// [`ReplyError::TextLength`] if the message would be longer than [`MAX_MESSAGE_SIZE`], and
    /// those of [`Session::reply`]; the session is then as before.
    pub fn model_header(&mut self, id: CommandId, text_len: usize) -> Result<Outgoing, ReplyError> {
        let reply = Reply::Model {
            status: ModelStatus::Success,
            text: &[],
        };
        self.answer_with_tail(id, &reply, text_len)
    }

    /// The beginning of the message that answers `LoadModelLibrary`: the caller sends the `len`
    /// bytes of the library right behind it.
    ///
    /// # Errors
    /// As [`Session::model_header`].
    pub fn library_header(&mut self, id: CommandId, len: usize) -> Result<Outgoing, ReplyError> {
        let reply = Reply::ModelLibrary {
            status: LibraryStatus::Success,
            library: &[],
        };
        self.answer_with_tail(id, &reply, len)
    }

    fn answer_with_tail(
        &mut self,
        id: CommandId,
        reply: &Reply<'_>,
        len: usize,
    ) -> Result<Outgoing, ReplyError> {
        if len > MAX_MESSAGE_SIZE - Header::SIZE - 1 {
            return Err(ReplyError::TextLength { len });
        }
        self.answer(id, reply, len)
    }

    fn answer(
        &mut self,
        id: CommandId,
        reply: &Reply<'_>,
        extra: usize,
    ) -> Result<Outgoing, ReplyError> {
        let entry = self.pending.get(id).ok_or(ReplyError::NotPending { id })?;
        let outgoing = reply.encode(self.version, entry.command, id, extra)?;
        match reply {
            Reply::Move(MoveStatus::MotionStarted) if entry.started => {
                return Err(ReplyError::AlreadyStarted { id });
            }
            Reply::Move(MoveStatus::MotionStarted) => self.pending.start(id),
            _ => {
                self.pending.remove(id);
            }
        }
        Ok(outgoing)
    }

    fn on_connect(&mut self, id: CommandId, version: u16, udp_port: u16) -> Event {
        let reply = |status| {
            let version = self.version.number();
            Reply::Connect { status, version }
                .encode(self.version, Command::Connect, id, 0)
                .expect("every version has Connect and both its statuses")
        };
        if version == self.version.number() {
            self.phase = Phase::Open;
            let reply = reply(ConnectStatus::Success);
            Event::Connect {
                id,
                udp_port,
                reply,
            }
        } else {
            let reply = reply(ConnectStatus::IncompatibleLibraryVersion);
            Event::Incompatible { version, reply }
        }
    }

    fn reject(
        &mut self,
        id: CommandId,
        (command, reply): (Command, Reply<'_>),
        error: DecodeError,
    ) -> Result<Event, Violation> {
        self.remember(id, command)?;
        // A version that has the command has this status, and the request has just been noted.
        let reply = self
            .reply(id, reply)
            .expect("a pending request can be rejected");
        Ok(Event::Rejected { id, error, reply })
    }

    fn remember(&mut self, id: CommandId, command: Command) -> Result<(), Violation> {
        if self.pending.get(id).is_some() {
            return Err(Violation::RepeatedId { id });
        }
        if !self.pending.insert(id, command) {
            return Err(Violation::TooManyPending {
                limit: Self::PENDING_LIMIT,
            });
        }
        Ok(())
    }
}
