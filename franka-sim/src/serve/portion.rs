//! The stream in portions that mean something.

use std::time::Duration;

use bytes::BytesMut;
use franka_proto::framing::MAX_REQUEST_SIZE;
use tokio::io::{AsyncRead, AsyncReadExt};
use tokio::time::{Instant, timeout_at};

use super::device::Device;

/// How long the rest of a message may take to come. Clients write each in one piece; one that
/// breaks off in the middle must not keep others out.
const UNFINISHED: Duration = Duration::from_millis(300);

/// Why no message comes any more.
pub(super) enum Silence {
    /// The stream has ended.
    Closed,
    /// It goes on, and breaks off within a message.
    Unfinished,
}

/// Waits until `received` begins with a whole message, or with what can never become one: with
/// something to give to the device. Returns its length.
///
/// # Cancel safety
/// Dropping the future loses nothing: what has been read stays in `received`.
pub(super) async fn portion<D: Device>(
    stream: &mut (impl AsyncRead + Unpin),
    received: &mut BytesMut,
) -> Result<usize, Silence> {
    // From the first byte of a message on, the rest has to come soon.
    let soon = || Instant::now() + UNFINISHED;
    let mut deadline = (!received.is_empty()).then(soon);
    loop {
        if let Some(length) = D::portion(received) {
            return Ok(length);
        }
        received.reserve(MAX_REQUEST_SIZE);
        let more = stream.read_buf(received);
        let count = match deadline {
            Some(deadline) => timeout_at(deadline, more)
                .await
                .map_err(|_| Silence::Unfinished)?,
            None => more.await,
        };
        if !count.is_ok_and(|count| count > 0) {
            return Err(Silence::Closed);
        }
        deadline.get_or_insert_with(soon);
    }
}
