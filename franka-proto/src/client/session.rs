//! The session of a client.

use crate::error::{DecodeError, RequestError, Violation};
use crate::framing::Message;
use crate::outgoing::Outgoing;
use crate::pending::{self, Entry, Pending};
use crate::service::{Command, CommandId, ConnectStatus, MoveStatus, Reply, Request};
use crate::version::{IncompatibleVersion, Version};

/// One connection to a robot, from its first byte to its last.
#[derive(Clone, Debug)]
pub struct Session {
    version: Version,
    phase: Phase,
    next_id: u32,
    pending: Pending,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Closed,
    Connecting,
    Open,
}

/// What a message of the robot means.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event<'a> {
    /// The handshake succeeded; requests may follow.
    Connected {
        /// The version of the session.
        version: Version,
    },
    /// The robot speaks another version. The connection is of no more use: open another one, with
    /// the robot's version if [`Version::from_number`] knows it.
    Incompatible(IncompatibleVersion),
    /// The answer to a request.
    ///
    /// [`MoveStatus::MotionStarted`] is the first of two answers; every other one is the last under
    /// its id.
    Reply {
        /// The request.
        id: CommandId,
        /// What it asked for.
        command: Command,
        /// The answer.
        reply: Reply<'a>,
    },
    /// An answer that nobody waits for, such as the late one of an abandoned request. It changes
    /// nothing.
    Unmatched {
        /// The id in the message.
        id: CommandId,
    },
}

impl Session {
    /// Requests that may wait for replies at the same time.
    pub const PENDING_LIMIT: usize = pending::LIMIT;

    /// A session that will announce `version`.
    #[must_use]
    pub fn new(version: Version) -> Self {
        Self {
            version,
            phase: Phase::Closed,
            next_id: 0,
            pending: Pending::new(),
        }
    }

    /// The version of the session.
    #[must_use]
    pub fn version(&self) -> Version {
        self.version
    }

    /// Whether the handshake is done.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.phase == Phase::Open
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
        self.phase = Phase::Connecting;
        let id = self.take_id();
        self.pending.insert(id, Command::Connect);
        let version = self.version.number();
        Request::Connect { version, udp_port }
            .encode(self.version, id)
            .expect("every version has Connect")
    }

    /// The message of a request, under the next id.
    ///
    /// # Errors
    /// [`RequestError`]; the session is then as before.
    pub fn request(&mut self, request: &Request) -> Result<Outgoing, RequestError> {
        let command = request.command();
        if command == Command::Connect {
            return Err(RequestError::Handshake);
        }
        if self.phase != Phase::Open {
            return Err(RequestError::NotConnected);
        }
        if self.pending.is_full() {
            return Err(RequestError::TooManyPending {
                limit: Self::PENDING_LIMIT,
            });
        }
        let outgoing = request.encode(self.version, CommandId(self.next_id))?;
        let id = self.take_id();
        self.pending.insert(id, command);
        Ok(outgoing)
    }

    /// Stops waiting for the replies of a request. Those that still come are
    /// [`Event::Unmatched`]. False if nothing waited under `id`.
    pub fn abandon(&mut self, id: CommandId) -> bool {
        self.pending.remove(id)
    }

    /// What a message of the robot means.
    ///
    /// # Errors
    /// [`Violation`]; [`Violation::is_fatal`] says whether the connection is of no more use.
    pub fn on_message<'a>(&mut self, message: Message<'a>) -> Result<Event<'a>, Violation> {
        let id = message.header.id();
        let Some(entry) = self.pending.get(id) else {
            return Ok(Event::Unmatched { id });
        };
        let Entry {
            command, started, ..
        } = entry;
        let reply = match Reply::decode(self.version, command, &message) {
            Ok(reply) => reply,
            Err(error) => {
                self.pending.remove(id);
                return Err(match error {
                    DecodeError::UnknownStatus {
                        command: Command::Connect,
                        status,
                    } => Violation::ConnectStatus { status },
                    error => Violation::Reply { id, error },
                });
            }
        };
        match reply {
            Reply::Move(MoveStatus::MotionStarted) if started => {
                Err(Violation::SecondMotionStarted { id })
            }
            Reply::Move(MoveStatus::MotionStarted) => {
                self.pending.start(id);
                Ok(Event::Reply { id, command, reply })
            }
            Reply::Connect { status, version } => {
                self.pending.remove(id);
                self.on_handshake(status, version)
            }
            reply => {
                self.pending.remove(id);
                Ok(Event::Reply { id, command, reply })
            }
        }
    }

    fn on_handshake(
        &mut self,
        status: ConnectStatus,
        reported: u16,
    ) -> Result<Event<'static>, Violation> {
        self.phase = Phase::Closed;
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
                self.phase = Phase::Open;
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
