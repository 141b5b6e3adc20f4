//! A client's stream, divided into messages, with time limits.

use std::time::Duration;

use bytes::BytesMut;
use franka_proto::framing::MAX_REQUEST_SIZE;
use tokio::io::{AsyncRead, AsyncReadExt};
use tokio::time::{Instant, timeout_at};

use crate::connection::Framing;

/// Time limits for a message. Clients write each message in one piece. A message that stops in the
/// middle must not block other clients. But a message on a slow network must not be interrupted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Patience {
    /// Longest time to the first byte of a message; `None` for no limit.
    pub(super) first: Option<Duration>,
    /// Longest time between two bytes.
    pub(super) gap: Duration,
    /// Longest time between the first byte and the last byte.
    pub(super) total: Duration,
}

impl Patience {
    /// Limits for the requests of a session. A client may pause between requests.
    pub(super) const SESSION: Self = Self {
        first: None,
        gap: Duration::from_millis(300),
        total: Duration::from_secs(5),
    };

    /// Limits for the handshake. Clients send it immediately.
    pub(super) const HANDSHAKE: Self = Self {
        first: Some(Duration::from_secs(1)),
        ..Self::SESSION
    };
}

/// Reason why no more messages arrive.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum StreamEnd {
    Closed,
    /// The stream was slower than the time limits.
    TooSlow,
}

/// Waits until `received` begins with a whole message, or with bytes that can never become a
/// message. Returns the length of this input for the device.
///
/// # Cancel safety
/// Dropping the future loses nothing: the bytes read stay in `received`.
pub(super) async fn next_message(
    stream: &mut (impl AsyncRead + Unpin),
    received: &mut BytesMut,
    framing: Framing,
    patience: Patience,
) -> Result<usize, StreamEnd> {
    let mut begun = (!received.is_empty()).then(Instant::now);
    let opened = Instant::now();
    loop {
        match framing(received) {
            Ok(Some(message)) => return Ok(message.size()),
            Ok(None) => {}
            Err(_) => return Ok(received.len()),
        }
        received.reserve(MAX_REQUEST_SIZE);
        let deadline = match begun {
            Some(begun) => Some((Instant::now() + patience.gap).min(begun + patience.total)),
            None => patience.first.map(|first| opened + first),
        };
        let more = stream.read_buf(received);
        let count = match deadline {
            Some(deadline) => timeout_at(deadline, more)
                .await
                .map_err(|_| StreamEnd::TooSlow)?,
            None => more.await,
        };
        if !count.is_ok_and(|count| count > 0) {
            return Err(StreamEnd::Closed);
        }
        begun.get_or_insert_with(Instant::now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_proto::framing::Header;
    use tokio::io::AsyncWriteExt;

    const LONG: Duration = Duration::from_secs(100);

    /// Returns the result for a whole message whose bytes arrive one by one, with this pause
    /// between them.
    async fn trickled(patience: Patience, pause: Duration) -> Result<usize, StreamEnd> {
        let (mut client, mut stream) = tokio::io::duplex(64);
        let size = u32::try_from(Header::SIZE + 4).expect("small");
        let mut message = vec![0; size as usize];
        message[8..12].copy_from_slice(&size.to_le_bytes());
        let writing = tokio::spawn(async move {
            for byte in message {
                if client.write_all(&[byte]).await.is_err() {
                    return;
                }
                tokio::time::sleep(pause).await;
            }
        });
        let framing: Framing = crate::robot::next_request;
        let result = next_message(&mut stream, &mut BytesMut::new(), framing, patience).await;
        writing.abort();
        result
    }

    #[tokio::test]
    async fn a_message_may_come_byte_by_byte() {
        let patience = Patience {
            first: Some(LONG),
            gap: LONG,
            total: LONG,
        };
        let size = trickled(patience, Duration::from_millis(5)).await;
        assert_eq!(size, Ok(Header::SIZE + 4));
    }

    #[tokio::test]
    async fn a_message_is_cut_off_by_a_gap_and_by_its_whole_duration() {
        let gap = Patience {
            first: Some(LONG),
            gap: Duration::from_millis(10),
            total: LONG,
        };
        assert_eq!(trickled(gap, LONG).await, Err(StreamEnd::TooSlow));
        let total = Patience {
            first: Some(LONG),
            gap: LONG,
            total: Duration::from_millis(20),
        };
        let pause = Duration::from_millis(5);
        assert_eq!(trickled(total, pause).await, Err(StreamEnd::TooSlow));
    }

    #[tokio::test]
    async fn a_stream_that_says_nothing_is_closed_after_the_first_wait() {
        let patience = Patience {
            first: Some(Duration::from_millis(10)),
            gap: LONG,
            total: LONG,
        };
        let (_client, mut stream) = tokio::io::duplex(64);
        let framing: Framing = crate::robot::next_request;
        let end = next_message(&mut stream, &mut BytesMut::new(), framing, patience).await;
        assert_eq!(end, Err(StreamEnd::TooSlow));
    }
}
