//! Messages on the command stream.

use std::io;
use std::time::Duration;

use bytes::{Bytes, BytesMut};
use franka_proto::Outgoing;
use franka_proto::framing::{self, FrameError, Header, Message};
use franka_proto::gripper;
use franka_rt::lifecycle::CloseReason;
use futures::SinkExt;
use tokio_util::codec::{Decoder, Encoder, Framed};

use crate::world::{self, Stream};

/// Time limit for sending a request. Source: `SO_SNDTIMEO` of libfranka's command socket.
const SEND_TIMEOUT: Duration = Duration::from_secs(1);

/// Splits the stream into messages, and writes requests to it.
#[derive(Debug)]
pub(crate) struct MessageCodec {
    next: fn(&[u8]) -> Result<Option<Message<'_>>, FrameError>,
}

impl MessageCodec {
    /// The codec for the robot's stream.
    pub(crate) const ROBOT: Self = Self {
        next: framing::next_message,
    };

    /// The codec for the stream of an end effector, whose headers are shorter.
    pub(crate) const END_EFFECTOR: Self = Self {
        next: gripper::next_message,
    };
}

/// One whole message.
#[derive(Debug)]
pub(crate) struct Frame {
    header: Header,
    payload: Bytes,
}

impl Frame {
    pub(crate) fn message(&self) -> Message<'_> {
        Message {
            header: self.header,
            payload: &self.payload,
        }
    }
}

/// Sends a request. The error is the reason why the connection can no longer be used.
pub(crate) async fn send(
    stream: &mut Framed<Stream, MessageCodec>,
    request: Outgoing,
) -> Result<(), CloseReason> {
    match world::timeout(SEND_TIMEOUT, stream.send(request)).await {
        Ok(Ok(())) => Ok(()),
        Ok(Err(StreamError::Io(error))) => Err(failed("TCP send bytes", &error)),
        Ok(Err(StreamError::Frame(error))) => Err(StreamError::from(error).into()),
        Err(_) => Err(failed("TCP send bytes", &io::ErrorKind::TimedOut.into())),
    }
}

/// Returns the reason why a connection ended on whose sockets `what` failed.
pub(crate) fn failed(what: &str, error: &io::Error) -> CloseReason {
    CloseReason::Io {
        kind: error.kind(),
        text: format!("libfranka: {what}: {}", reason(error)),
    }
}

/// Reason why the stream can no longer be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StreamError {
    #[error(transparent)]
    Frame(#[from] FrameError),
    #[error("libfranka: TCP receive: {}", reason(.0))]
    Io(#[from] io::Error),
}

impl From<StreamError> for CloseReason {
    fn from(error: StreamError) -> Self {
        match error {
            StreamError::Frame(error) => Self::Protocol {
                text: error.to_string(),
            },
            StreamError::Io(error) => failed("TCP receive", &error),
        }
    }
}

impl Decoder for MessageCodec {
    type Item = Frame;
    type Error = StreamError;

    fn decode(&mut self, received: &mut BytesMut) -> Result<Option<Frame>, StreamError> {
        let Some(message) = (self.next)(received)? else {
            return Ok(None);
        };
        let (header, size) = (message.header, message.size());
        let start = size - message.payload.len();
        let payload = received.split_to(size).freeze().slice(start..);
        Ok(Some(Frame { header, payload }))
    }

    /// Reports a stream that ends within a message as closed, not as failed.
    fn decode_eof(&mut self, received: &mut BytesMut) -> Result<Option<Frame>, StreamError> {
        let frame = self.decode(received)?;
        if frame.is_none() {
            received.clear();
        }
        Ok(frame)
    }
}

impl Encoder<Outgoing> for MessageCodec {
    type Error = StreamError;

    fn encode(&mut self, message: Outgoing, stream: &mut BytesMut) -> Result<(), StreamError> {
        stream.extend_from_slice(message.as_bytes());
        Ok(())
    }
}

/// Returns the name that libfranka's socket library gives to this class of failure.
pub(crate) fn reason(error: &io::Error) -> String {
    use io::ErrorKind;
    match error.kind() {
        ErrorKind::TimedOut | ErrorKind::WouldBlock => "Timeout".into(),
        ErrorKind::ConnectionRefused => "Connection refused".into(),
        ErrorKind::ConnectionReset | ErrorKind::BrokenPipe => "Connection reset by peer".into(),
        ErrorKind::ConnectionAborted => "Software caused connection abort".into(),
        ErrorKind::HostUnreachable | ErrorKind::NetworkUnreachable => "Net Exception".into(),
        _ => "I/O error".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn codec() -> MessageCodec {
        MessageCodec::ROBOT
    }

    #[test]
    fn cuts_messages_out_of_pieces_of_any_size() {
        let mut stream = Vec::new();
        for (command_id, payload) in [(1, &b"a"[..]), (2, b""), (3, b"robot")] {
            let size = (Header::SIZE + payload.len()) as u32;
            stream.extend(
                Header {
                    command: 9,
                    command_id,
                    size,
                }
                .to_bytes(),
            );
            stream.extend(payload);
        }
        for piece in 1..stream.len() {
            let mut buffer = BytesMut::new();
            let mut seen = Vec::new();
            for bytes in stream.chunks(piece) {
                buffer.extend_from_slice(bytes);
                while let Some(frame) = codec().decode(&mut buffer).unwrap() {
                    seen.push((
                        frame.message().header.command_id,
                        frame.message().payload.to_vec(),
                    ));
                }
            }
            assert_eq!(
                seen,
                [
                    (1, b"a".to_vec()),
                    (2, b"".to_vec()),
                    (3, b"robot".to_vec())
                ]
            );
        }
    }

    #[test]
    fn a_stream_that_ends_within_a_message_ends() {
        let mut buffer = BytesMut::from(&[0, 0, 0, 0, 1, 0, 0, 0, 13, 0, 0, 0][..]);
        assert!(codec().decode(&mut buffer).unwrap().is_none());
        assert!(codec().decode_eof(&mut buffer).unwrap().is_none());
        assert!(buffer.is_empty());
    }

    #[test]
    fn garbage_is_an_error_and_not_a_wait() {
        let mut buffer = BytesMut::from(&b"HTTP/1.1 400 Bad Request\r\n\r\n"[..]);
        assert!(codec().decode(&mut buffer).is_err());
        let mut buffer = BytesMut::from(&[0_u8; 64][..]);
        let error = codec().decode(&mut buffer).unwrap_err();
        assert_eq!(error.to_string(), "libfranka: Incorrect TCP message size.");
    }
}
