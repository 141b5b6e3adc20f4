//! Connections that have not sent their handshake yet. `crate::connection` answers the handshake.

use std::collections::VecDeque;
use std::net::SocketAddr;
use std::time::Duration;

use bytes::BytesMut;
use socket2::{SockRef, TcpKeepalive};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::{AbortHandle, JoinSet};
use tokio::time::sleep;

use super::stream::{Patience, StreamEnd, next_message};
use crate::connection::Framing;

/// Largest number of connections that may be pending. A further connection closes the oldest one,
/// because silent connections must not block a client.
const MAX_PENDING: usize = 64;

/// Wait after an error of the listener, for example if no file descriptors are left.
const RETRY: Duration = Duration::from_millis(100);

/// Silence after which the server probes the client's host, and number of lost probes after which
/// the host counts as gone. libfranka probes the robot with the same values.
const KEEPALIVE: (Duration, u32) = (Duration::from_secs(1), 3);

/// A connection whose first message has arrived.
pub(super) struct Handshake {
    pub(super) stream: TcpStream,
    pub(super) peer: SocketAddr,
    /// Bytes read from the stream. They begin with a message, or with bytes that can never become a
    /// message. More bytes may follow.
    pub(super) received: BytesMut,
}

/// The listener, and the connections whose handshake is awaited.
pub(super) struct PendingConnections {
    listener: TcpListener,
    name: &'static str,
    framing: Framing,
    handshakes: JoinSet<Option<Handshake>>,
    /// Tasks of the handshakes, oldest first.
    handles: VecDeque<AbortHandle>,
}

impl PendingConnections {
    pub(super) fn new(listener: TcpListener, name: &'static str, framing: Framing) -> Self {
        Self {
            listener,
            name,
            framing,
            handshakes: JoinSet::new(),
            handles: VecDeque::new(),
        }
    }

    /// Returns the next connection whose first message has arrived.
    ///
    /// # Cancel safety
    /// Dropping the future loses no connection.
    pub(super) async fn next(&mut self) -> Handshake {
        loop {
            tokio::select! {
                biased;
                Some(done) = self.handshakes.join_next() => {
                    if let Ok(Some(handshake)) = done {
                        return handshake;
                    }
                }
                accepted = self.listener.accept() => match accepted {
                    Ok((stream, peer)) => self.accept(stream, peer),
                    Err(error) => {
                        tracing::warn!(%error, "cannot accept a connection to the {}", self.name);
                        sleep(RETRY).await;
                    }
                },
            }
        }
    }

    fn accept(&mut self, stream: TcpStream, peer: SocketAddr) {
        self.handles.retain(|handshake| !handshake.is_finished());
        if self.handles.len() >= MAX_PENDING
            && let Some(oldest) = self.handles.pop_front()
        {
            tracing::warn!(
                "{MAX_PENDING} connections to the {} have sent no message",
                self.name
            );
            oldest.abort();
        }
        // Without these options, replies would be slower, and the server would detect a lost client
        // later.
        let (silence, count) = KEEPALIVE;
        let keepalive = TcpKeepalive::new()
            .with_time(silence)
            .with_interval(silence)
            .with_retries(count);
        let kept = SockRef::from(&stream).set_tcp_keepalive(&keepalive);
        if let Err(error) = stream.set_nodelay(true).and(kept) {
            tracing::debug!(%peer, %error, "an option of the connection");
        }
        let handshake = handshake(stream, peer, self.name, self.framing);
        self.handles.push_back(self.handshakes.spawn(handshake));
    }
}

/// Waits for the first message.
async fn handshake(
    mut stream: TcpStream,
    peer: SocketAddr,
    name: &'static str,
    framing: Framing,
) -> Option<Handshake> {
    let mut received = BytesMut::new();
    match next_message(&mut stream, &mut received, framing, Patience::HANDSHAKE).await {
        Ok(_) => Some(Handshake {
            stream,
            peer,
            received,
        }),
        Err(StreamEnd::Closed) => None,
        Err(StreamEnd::TooSlow) => {
            tracing::warn!(%peer, "connection to the {name} closed: no message arrived");
            None
        }
    }
}
