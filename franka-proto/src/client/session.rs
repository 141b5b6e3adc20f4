//! The client's side of a session: the handshake, then requests and their replies.

use crate::command::CommandId;
use crate::command::ServiceCommand;
use crate::framing::Message;
use crate::outgoing::Outgoing;
use crate::pending::{self, Pending};
use crate::protocol::ConnectStatus;
use crate::protocol::IncompatibleVersion;
use crate::protocol::{DecodeError, RequestError, Violation};
use crate::protocol::{Progress, Protocol};
use crate::version::Version;

/// State of one connection to a device, from its first byte to its last. The protocol `P`
/// determines the device: a robot or an end effector.
#[derive(Clone, Debug)]
pub struct Session<P: Protocol = Version> {
    version: P,
    phase: ConnectionPhase,
    next_id: u32,
    pending: Pending<P::Command>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ConnectionPhase {
    Closed,
    Connecting,
    Open,
}

/// The meaning of a message from the device.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event<'a, P: Protocol = Version> {
    /// The handshake succeeded; requests may follow.
    Connected {
        /// The version of the session.
        version: P,
    },
    /// The device uses another version, and the connection is no longer usable. If
    /// [`Version::from_number`] knows the device's version, open another connection with that
    /// version.
    Incompatible(IncompatibleVersion<P>),
    /// The answer to a request.
    ///
    /// [`MoveStatus::MotionStarted`](crate::MoveStatus::MotionStarted) is the first of two answers.
    /// Every other reply is the last reply with its id.
    Reply {
        /// The id of the request.
        id: CommandId,
        /// The command of the request.
        command: P::Command,
        /// The answer.
        reply: P::Reply<'a>,
    },
    /// An answer to a request that is not pending, for example because the caller abandoned it. The
    /// session does not change.
    Unmatched {
        /// The id in the message.
        id: CommandId,
    },
}

impl<P: Protocol> Session<P> {
    /// Largest number of requests that may wait for replies at the same time.
    pub const PENDING_LIMIT: usize = pending::LIMIT;

    /// Creates a session that announces `version`.
    #[must_use]
    pub fn new(version: P) -> Self {
        Self {
            version,
            phase: ConnectionPhase::Closed,
            next_id: 0,
            pending: Pending::new(),
        }
    }

    /// Returns the version of the session.
    #[must_use]
    pub fn version(&self) -> P {
        self.version
    }

    /// Returns true if the handshake has succeeded.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.phase == ConnectionPhase::Open
    }

    /// Returns the number of requests that wait for a reply. A `Move` counts until its last reply.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.pending.len()
    }

    /// Returns the handshake, which is the first message on a new connection. `udp_port` is the
    /// client's port for states.
    ///
    /// This method resets the session: ids begin at 0, and no request is pending.
    pub fn connect(&mut self, udp_port: u16) -> Outgoing {
        *self = Self::new(self.version);
        self.phase = ConnectionPhase::Connecting;
        let id = self.take_id();
        self.pending.insert(id, P::Command::CONNECT);
        let hello = self.version.connect(udp_port);
        let hello = self.version.encode_request(&hello, id);
        hello.expect("every version has Connect")
    }

    /// Returns the message of a request, with the next id.
    ///
    /// # Errors
    /// Returns [`RequestError`] if the request cannot be sent. The session is then unchanged.
    pub fn request(&mut self, request: &P::Request) -> Result<Outgoing, RequestError> {
        if P::handshake(request).is_some() {
            return Err(RequestError::Handshake);
        }
        if self.phase != ConnectionPhase::Open {
            return Err(RequestError::NotConnected);
        }
        if self.pending.is_full() {
            return Err(RequestError::TooManyPending {
                limit: Self::PENDING_LIMIT,
            });
        }
        let id = CommandId(self.next_id);
        let outgoing = self.version.encode_request(request, id)?;
        self.take_id();
        self.pending.insert(id, P::command_of(request));
        Ok(outgoing)
    }

    /// Stops waiting for the replies of a request. Later replies become [`Event::Unmatched`].
    /// Returns false if no request with this `id` was waiting.
    pub fn abandon(&mut self, id: CommandId) -> bool {
        self.pending.remove(id)
    }

    /// Processes a message from the device and returns its meaning.
    ///
    /// # Errors
    /// Returns [`Violation`] if the device violated the protocol. [`Violation::is_fatal`] is true
    /// if the connection is no longer usable.
    pub fn on_message<'a>(
        &mut self,
        message: Message<'a>,
    ) -> Result<Event<'a, P>, Violation<P::Command>> {
        let id = message.header.id();
        let Some(entry) = self.pending.get(id) else {
            return Ok(Event::Unmatched { id });
        };
        let command = entry.command;
        let reply = match self.version.decode_reply(command, &message) {
            Ok(reply) => reply,
            Err(error) => {
                self.pending.remove(id);
                return Err(match error {
                    DecodeError::UnknownStatus { command, status }
                        if command == P::Command::CONNECT =>
                    {
                        Violation::ConnectStatus { status }
                    }
                    error => Violation::Reply { id, error },
                });
            }
        };
        match P::progress(&reply) {
            Progress::Started if entry.started => Err(Violation::SecondMotionStarted { id }),
            Progress::Started => {
                self.pending.start(id);
                Ok(Event::Reply { id, command, reply })
            }
            Progress::Handshake(status, version) => {
                self.pending.remove(id);
                self.on_handshake(status, version)
            }
            Progress::Ended => {
                self.pending.remove(id);
                Ok(Event::Reply { id, command, reply })
            }
        }
    }

    fn on_handshake<'a>(
        &mut self,
        status: ConnectStatus,
        reported: u16,
    ) -> Result<Event<'a, P>, Violation<P::Command>> {
        self.phase = ConnectionPhase::Closed;
        let announced = self.version.number();
        match status {
            ConnectStatus::IncompatibleLibraryVersion => {
                Ok(Event::Incompatible(IncompatibleVersion {
                    server_version: reported,
                    library_version: self.version,
                }))
            }
            // libfranka does not check the version here, so it fails later, at the first datagram.
            ConnectStatus::Success if reported != announced => Err(Violation::ForeignVersion {
                announced,
                reported,
            }),
            ConnectStatus::Success => {
                self.phase = ConnectionPhase::Open;
                Ok(Event::Connected {
                    version: self.version,
                })
            }
        }
    }

    fn take_id(&mut self) -> CommandId {
        let id = CommandId(self.next_id);
        self.next_id = self.next_id.wrapping_add(1);
        id
    }
}
