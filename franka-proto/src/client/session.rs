//! The session of a client: the handshake, then requests and their replies.

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

/// One connection to a device, from its first byte to its last: to a robot, unless `P` says
/// otherwise.
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

/// What a message of the device means.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event<'a, P: Protocol = Version> {
    /// The handshake succeeded; requests may follow.
    Connected {
        /// The version of the session.
        version: P,
    },
    /// The device speaks another version. The connection cannot be used any further: open another
    /// one, with a robot's version if [`Version::from_number`] knows it.
    Incompatible(IncompatibleVersion<P>),
    /// The answer to a request.
    ///
    /// [`MoveStatus::MotionStarted`](crate::MoveStatus::MotionStarted) is the first of two answers;
    /// every other one is the last under its id.
    Reply {
        /// The request.
        id: CommandId,
        /// What it asked for.
        command: P::Command,
        /// The answer.
        reply: P::Reply<'a>,
    },
    /// An answer to no pending request, such as the late one of an abandoned request. The session
    /// does not change.
    Unmatched {
        /// The id in the message.
        id: CommandId,
    },
}

impl<P: Protocol> Session<P> {
    /// Requests that may wait for replies at the same time.
    pub const PENDING_LIMIT: usize = pending::LIMIT;

    /// A session that will announce `version`.
    #[must_use]
    pub fn new(version: P) -> Self {
        Self {
            version,
            phase: ConnectionPhase::Closed,
            next_id: 0,
            pending: Pending::new(),
        }
    }

    /// The version of the session.
    #[must_use]
    pub fn version(&self) -> P {
        self.version
    }

    /// True if the handshake is done.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.phase == ConnectionPhase::Open
    }

    /// How many requests wait for a reply; a motion counts until its last one.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.pending.len()
    }

    /// The handshake: the first message on a fresh connection. `udp_port` is where the client
    /// expects states.
    ///
    /// The session starts over with it: ids begin at 0 and no request is pending.
    pub fn connect(&mut self, udp_port: u16) -> Outgoing {
        *self = Self::new(self.version);
        self.phase = ConnectionPhase::Connecting;
        let id = self.take_id();
        self.pending.insert(id, P::Command::CONNECT);
        let hello = self.version.connect(udp_port);
        let hello = self.version.encode_request(&hello, id);
        hello.expect("every version has Connect")
    }

    /// The message of a request, under the next id.
    ///
    /// # Errors
    /// [`RequestError`]; the session is then as before.
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

    /// Stops waiting for the replies of a request. Those that still come are
    /// [`Event::Unmatched`]. False if nothing waited under `id`.
    pub fn abandon(&mut self, id: CommandId) -> bool {
        self.pending.remove(id)
    }

    /// What a message of the device means.
    ///
    /// # Errors
    /// [`Violation`]; [`Violation::is_fatal`] says whether the connection is of no more use.
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
            // libfranka does not look at the version here and fails at the first datagram.
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
