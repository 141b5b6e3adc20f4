//! The handshake on a new command connection. `franka_proto::client::Session` defines its messages
//! and its verdict. `crate::error::connecting` recognises a second client.

use franka_proto::Protocol;
use franka_proto::client::{Event, Session};
use franka_rt::lifecycle::CloseReason;
use futures::{SinkExt, StreamExt};
use tokio_util::codec::Framed;

use crate::codec::{MessageCodec, StreamError};
use crate::error::ConnectError;
use crate::world::Stream;

/// Announces `udp_port`, to which the peer should send its states, and waits for the answer: the
/// connection is open, or the peer has a different version.
pub(crate) async fn shake_hands<P: Protocol>(
    stream: &mut Framed<Stream, MessageCodec>,
    session: &mut Session<P>,
    udp_port: u16,
) -> Result<(), ConnectError<P>> {
    stream
        .send(session.connect(udp_port))
        .await
        .map_err(broken)?;
    loop {
        let frame = match stream.next().await {
            Some(frame) => frame.map_err(broken)?,
            None => {
                return Err(ConnectError::ConnectionClosed {
                    reason: CloseReason::ClosedByPeer,
                });
            }
        };
        match session.on_message(frame.message())? {
            Event::Connected { .. } => return Ok(()),
            Event::Incompatible(refusal) => return Err(refusal.into()),
            // This message is not the answer, which may still come before the time limit.
            _ => {}
        }
    }
}

fn broken<P: Protocol>(error: StreamError) -> ConnectError<P> {
    match error {
        StreamError::Frame(error) => error.into(),
        error @ StreamError::Io(_) => ConnectError::ConnectionClosed {
            reason: error.into(),
        },
    }
}
