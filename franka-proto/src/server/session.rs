//! The device's side of a session: the answer to the handshake, then requests and their replies.

use crate::command::CommandId;
use crate::command::ServiceCommand;
use crate::framing::{Header, MAX_MESSAGE_SIZE, Message};
use crate::outgoing::Outgoing;
use crate::pending::{self, Pending};
use crate::protocol::ConnectStatus;
use crate::protocol::{DecodeError, ReplyError, Violation};
use crate::protocol::{Progress, Protocol};
use crate::robot::{LibraryStatus, ModelStatus, Reply};
use crate::version::Version;

/// State of one connection of a client, from its first byte to its last. The protocol `P`
/// determines the device: a robot or an end effector.
#[derive(Clone, Debug)]
pub struct Session<P: Protocol = Version> {
    version: P,
    phase: ConnectionPhase,
    pending: Pending<P::Command>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ConnectionPhase {
    Listening,
    Open,
}

/// The event that a message of a client causes.
// The large variant is not boxed, because a box requires an allocator, and each event is moved only
// once.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event<P: Protocol = Version> {
    /// A client with the same version connected. Send `reply`, then send states to `udp_port`.
    Connect {
        /// The id of the handshake.
        id: CommandId,
        /// UDP port of the client.
        udp_port: u16,
        /// The answer to send.
        reply: Outgoing,
    },
    /// A client with another version connected. Send `reply`; the client then closes the
    /// connection.
    Incompatible {
        /// The version that the client announces.
        version: u16,
        /// The answer to send.
        reply: Outgoing,
    },
    /// A request to process. Answer it with [`Session::reply`], or with `Session::model_header` for
    /// a model.
    Request {
        /// The id of the request. Use it in the answer.
        id: CommandId,
        /// The request.
        request: P::Request,
    },
    /// A request with an undefined enumerator, such as a `Move` with an unknown mode. Send `reply`,
    /// which reports an invalid argument as a robot does. The request is then complete.
    Rejected {
        /// The id of the request.
        id: CommandId,
        /// The decoding error.
        error: DecodeError<P::Command>,
        /// The answer to send.
        reply: Outgoing,
    },
}

impl<P: Protocol> Session<P> {
    /// Largest number of requests that may wait for replies at the same time.
    pub const PENDING_LIMIT: usize = pending::LIMIT;

    /// Creates a session of a device that speaks `version`.
    #[must_use]
    pub fn new(version: P) -> Self {
        Self {
            version,
            phase: ConnectionPhase::Listening,
            pending: Pending::new(),
        }
    }

    /// Returns the version of the device.
    #[must_use]
    pub fn version(&self) -> P {
        self.version
    }

    /// Returns true if the handshake has succeeded.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.phase == ConnectionPhase::Open
    }

    /// Processes a message of the client and returns the resulting event.
    ///
    /// # Errors
    /// Returns [`Violation`] if the client violated the protocol. Disconnect the client then.
    pub fn on_message(&mut self, message: Message<'_>) -> Result<Event<P>, Violation<P::Command>> {
        let id = message.header.id();
        let request = match self.version.decode_request(&message) {
            Ok(request) => request,
            Err(error) => return self.on_unreadable(&message, error),
        };
        match (self.phase, P::handshake(&request)) {
            (ConnectionPhase::Listening, Some((version, udp_port))) => {
                Ok(self.on_connect(id, version, udp_port))
            }
            (ConnectionPhase::Listening, None) => Err(Violation::NotConnect {
                got: P::command_of(&request),
            }),
            (ConnectionPhase::Open, Some(_)) => Err(Violation::SecondConnect),
            (ConnectionPhase::Open, None) => {
                self.remember(id, P::command_of(&request))?;
                Ok(Event::Request { id, request })
            }
        }
    }

    /// Returns the message that answers a request.
    ///
    /// A robot answers `Move` twice:
    /// [`MoveStatus::MotionStarted`](crate::MoveStatus::MotionStarted), then the result. It answers
    /// a refused `Move` only once. Use this method to refuse a request for a model. To send a
    /// model, use [`Session::model_header`] or [`Session::library_header`] instead.
    ///
    /// # Errors
    /// Returns [`ReplyError`] if the reply cannot be sent. The session is then unchanged.
    pub fn reply(
        &mut self,
        id: CommandId,
        reply: P::Reply<'_>,
    ) -> Result<Outgoing, ReplyError<P::Command>> {
        self.answer(id, &reply, 0)
    }

    fn answer(
        &mut self,
        id: CommandId,
        reply: &P::Reply<'_>,
        extra: usize,
    ) -> Result<Outgoing, ReplyError<P::Command>> {
        let entry = self.pending.get(id).ok_or(ReplyError::NotPending { id })?;
        let outgoing = self.version.encode_reply(entry.command, id, reply, extra)?;
        match P::progress(reply) {
            Progress::Started if entry.started => return Err(ReplyError::AlreadyStarted { id }),
            Progress::Started => self.pending.start(id),
            _ => {
                self.pending.remove(id);
            }
        }
        Ok(outgoing)
    }

    fn on_connect(&mut self, id: CommandId, version: u16, udp_port: u16) -> Event<P> {
        let device = self.version;
        let reply = |status| {
            device
                .encode_reply(P::Command::CONNECT, id, &device.answer_handshake(status), 0)
                .expect("every version has Connect and both its statuses")
        };
        if version == device.number() {
            self.phase = ConnectionPhase::Open;
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

    /// Answers a message with an undefined enumerator. Other messages that cannot be decoded get no
    /// answer.
    fn on_unreadable(
        &mut self,
        message: &Message<'_>,
        error: DecodeError<P::Command>,
    ) -> Result<Event<P>, Violation<P::Command>> {
        let id = message.header.id();
        let unknown_value = matches!(error, DecodeError::UnknownValue { .. });
        let rejection = self.version.rejection(message);
        match rejection.filter(|_| unknown_value && self.phase == ConnectionPhase::Open) {
            Some((command, reply)) => {
                self.remember(id, command)?;
                // This cannot fail: every version with this command has this status, and the
                // session has recorded the request.
                let reply = self.reply(id, reply);
                let reply = reply.expect("a pending request can be rejected");
                Ok(Event::Rejected { id, error, reply })
            }
            None => Err(Violation::Request { id, error }),
        }
    }

    fn remember(
        &mut self,
        id: CommandId,
        command: P::Command,
    ) -> Result<(), Violation<P::Command>> {
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

impl Session {
    /// Returns the beginning of the message that answers `GetRobotModel`. The caller sends
    /// `text_len` bytes of text directly afterwards.
    ///
    /// # Errors
    /// Returns [`ReplyError::TextLength`] if the message would be longer than [`MAX_MESSAGE_SIZE`],
    /// or an error of [`Session::reply`]. After an error, the session is unchanged.
    pub fn model_header(&mut self, id: CommandId, text_len: usize) -> Result<Outgoing, ReplyError> {
        let reply = Reply::Model {
            status: ModelStatus::Success,
            text: &[],
        };
        self.answer_with_tail(id, &reply, text_len)
    }

    /// Returns the beginning of the message that answers `LoadModelLibrary`. The caller sends the
    /// `len` bytes of the library directly afterwards.
    ///
    /// # Errors
    /// Returns the same errors as [`Session::model_header`].
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
}
