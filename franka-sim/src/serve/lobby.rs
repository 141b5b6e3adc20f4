//! Where connections wait until their first message is there.

use std::collections::VecDeque;
use std::marker::PhantomData;
use std::net::SocketAddr;
use std::time::Duration;

use bytes::BytesMut;
use socket2::{SockRef, TcpKeepalive};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::{AbortHandle, JoinSet};
use tokio::time::{sleep, timeout};

use super::device::Device;
use super::portion::{Silence, portion};

/// Connections that may be here at the same time. The next one is taken in and the oldest closed,
/// so that any number of silent ones keeps nobody out.
const GUESTS: usize = 64;

/// How long the first message may take. Clients send it at once.
const GREETING: Duration = Duration::from_secs(1);

/// How long to wait after the listener failed (out of file descriptors, for one).
const RETRY: Duration = Duration::from_millis(100);

/// Silence after which the host of a client is asked whether it is there, and how often before it
/// counts as gone. The figures are those of libfranka, which asks the robot.
const KEEPALIVE: (Duration, u32) = (Duration::from_secs(1), 3);

/// A connection whose first message has come.
pub(super) struct Visitor {
    pub(super) stream: TcpStream,
    pub(super) peer: SocketAddr,
    /// What has been read of the stream: the message, or what can never become one, and maybe more.
    pub(super) received: BytesMut,
}

/// The listener, and the connections that have not said anything yet.
pub(super) struct Lobby<D> {
    listener: TcpListener,
    name: &'static str,
    greetings: JoinSet<Option<Visitor>>,
    /// Of the greetings, oldest first.
    handles: VecDeque<AbortHandle>,
    device: PhantomData<fn(D)>,
}

impl<D: Device> Lobby<D> {
    pub(super) fn new(listener: TcpListener, name: &'static str) -> Self {
        Self {
            listener,
            name,
            greetings: JoinSet::new(),
            handles: VecDeque::new(),
            device: PhantomData,
        }
    }

    /// The next connection whose first message is there.
    ///
    /// # Cancel safety
    /// Dropping the future loses no connection.
    pub(super) async fn next(&mut self) -> Visitor {
        loop {
            tokio::select! {
                biased;
                Some(greeted) = self.greetings.join_next() => {
                    if let Ok(Some(visitor)) = greeted {
                        return visitor;
                    }
                }
                accepted = self.listener.accept() => match accepted {
                    Ok((stream, peer)) => self.take_in(stream, peer),
                    Err(error) => {
                        tracing::warn!(%error, "cannot accept a connection to the {}", self.name);
                        sleep(RETRY).await;
                    }
                },
            }
        }
    }

    fn take_in(&mut self, stream: TcpStream, peer: SocketAddr) {
        self.handles.retain(|greeting| !greeting.is_finished());
        if self.handles.len() >= GUESTS
            && let Some(oldest) = self.handles.pop_front()
        {
            tracing::warn!("{GUESTS} connections to the {} say nothing", self.name);
            oldest.abort();
        }
        // Without these options replies are slower, and a client that lost its network stays
        // longer.
        let (silence, count) = KEEPALIVE;
        let keepalive = TcpKeepalive::new()
            .with_time(silence)
            .with_interval(silence)
            .with_retries(count);
        let kept = SockRef::from(&stream).set_tcp_keepalive(&keepalive);
        if let Err(error) = stream.set_nodelay(true).and(kept) {
            tracing::debug!(%peer, %error, "an option of the connection");
        }
        let greeting = greet::<D>(stream, peer, self.name);
        self.handles.push_back(self.greetings.spawn(greeting));
    }
}

/// Waits for the first message.
async fn greet<D: Device>(
    mut stream: TcpStream,
    peer: SocketAddr,
    name: &'static str,
) -> Option<Visitor> {
    let mut received = BytesMut::new();
    match timeout(GREETING, portion::<D>(&mut stream, &mut received)).await {
        Ok(Ok(_)) => Some(Visitor {
            stream,
            peer,
            received,
        }),
        // It has gone by itself.
        Ok(Err(Silence::Closed)) => None,
        Ok(Err(Silence::Unfinished)) | Err(_) => {
            tracing::warn!(%peer, "connection to the {name} closed: no message came");
            None
        }
    }
}
