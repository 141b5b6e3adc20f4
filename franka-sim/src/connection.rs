//! Connection of one client to a device. It answers the handshake and turns the bytes of the stream
//! into requests.

use std::collections::VecDeque;

use bytes::Bytes;
use franka_proto::framing::{FrameError, Message};
use franka_proto::server::{Event, Session};
use franka_proto::{Command, CommandId, Protocol, ServiceCommand, Violation};

/// Reason why a client is disconnected; `C` is the set of commands of the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError<C: ServiceCommand = Command> {
    /// The client sent bytes that are not a message.
    #[error("{0}")]
    Frame(FrameError),
    /// The client sent a message that the protocol does not permit.
    #[error("{0}")]
    Violation(Violation<C>),
    /// The client announced another protocol version. The server has already sent its own version
    /// to the client.
    #[error("got protocol {announced}, which this server does not support")]
    Incompatible {
        /// The version that the client announced.
        announced: u16,
    },
}

/// A state to send to the client.
#[derive(Debug, Clone, Copy)]
pub struct Datagram<'a> {
    /// The client's UDP port.
    pub port: u16,
    /// The encoded state.
    pub bytes: &'a [u8],
}

/// Function that splits the first message off a stream. It returns `None` while the message is
/// incomplete.
pub(crate) type Framing = fn(&[u8]) -> Result<Option<Message<'_>>, FrameError>;

/// A request, and the id that its answer must carry.
pub(crate) type Received<P> = (CommandId, <P as Protocol>::Request);

/// Connection of one client, from its first byte to its last.
pub(crate) struct Connection<P: Protocol> {
    pub(crate) session: Session<P>,
    framing: Framing,
    received: Vec<u8>,
    udp_port: Option<u16>,
}

impl<P: Protocol> Connection<P> {
    pub(crate) fn new(protocol: P, framing: Framing) -> Self {
        Self {
            session: Session::new(protocol),
            framing,
            received: Vec::new(),
            udp_port: None,
        }
    }

    /// The UDP port for states; unknown before the handshake.
    pub(crate) fn udp_port(&self) -> Option<u16> {
        self.udp_port
    }

    /// Appends bytes of the client's stream, which may arrive in pieces of any size.
    pub(crate) fn receive(&mut self, bytes: &[u8]) {
        self.received.extend_from_slice(bytes);
    }

    /// Returns the next complete request. This function itself answers handshakes, and requests
    /// that no device accepts, through `replies`.
    pub(crate) fn next_request(
        &mut self,
        replies: &mut VecDeque<Bytes>,
    ) -> Result<Option<Received<P>>, SessionError<P::Command>> {
        while let Some(message) = (self.framing)(&self.received).map_err(SessionError::Frame)? {
            let size = message.size();
            let event = self.session.on_message(message);
            let event = event.map_err(SessionError::Violation)?;
            self.received.drain(..size);
            let mut queue = |bytes: &[u8]| replies.push_back(Bytes::copy_from_slice(bytes));
            match event {
                Event::Connect {
                    udp_port, reply, ..
                } => {
                    self.udp_port = Some(udp_port);
                    queue(reply.as_bytes());
                }
                Event::Incompatible { version, reply } => {
                    queue(reply.as_bytes());
                    return Err(SessionError::Incompatible { announced: version });
                }
                Event::Rejected { reply, .. } => queue(reply.as_bytes()),
                Event::Request { id, request } => return Ok(Some((id, request))),
                _ => {}
            }
        }
        Ok(None)
    }
}
