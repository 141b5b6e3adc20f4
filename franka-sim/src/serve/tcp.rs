//! The stream: one client at a time.
//!
//! ```text
//! lobby: anybody ── first message is whole ──> waits a moment ── seat is free ──> session
//!          └─ too slow, too many: closed            └─ seat is taken: closed
//! ```
//!
//! A connection takes the seat with its first message and not before, so that one that says nothing
//! keeps nobody out.

use std::time::Duration;

use bytes::Bytes;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpListener;
use tokio::sync::mpsc;
use tokio::time::{Instant, sleep_until, timeout};

use super::device::Device;
use super::lobby::{Lobby, Visitor};
use super::portion::{Silence, portion};
use super::seat::{Order, REPLIES};

/// How long a client may leave no room for a reply. One that does not read must not keep others
/// out.
const SEND_TIMEOUT: Duration = Duration::from_secs(1);

/// How long a second client waits for the first to be gone. One that reconnects arrives a moment
/// before its old connection has been taken down.
const HANDOVER: Duration = Duration::from_millis(50);

/// Serves clients until the thread has gone or the task is aborted.
pub(super) async fn serve<D: Device>(
    listener: TcpListener,
    orders: mpsc::Sender<Order>,
    name: &'static str,
) {
    let mut lobby = Lobby::<D>::new(listener, name);
    let mut next = None;
    while !orders.is_closed() {
        let visitor = match next.take() {
            Some(visitor) => visitor,
            None => lobby.next().await,
        };
        let mut session = std::pin::pin!(session::<D>(visitor, orders.clone(), name));
        let mut waiting: Option<(Visitor, Instant)> = None;
        loop {
            let patience = waiting.as_ref().map(|(_, deadline)| *deadline);
            tokio::select! {
                biased;
                () = &mut session => break,
                visitor = lobby.next() => {
                    let deadline = Instant::now() + HANDOVER;
                    if let Some((other, _)) = waiting.replace((visitor, deadline)) {
                        refuse(other, name);
                    }
                }
                () = until(patience) => {
                    if let Some((visitor, _)) = waiting.take() {
                        refuse(visitor, name);
                    }
                }
            }
        }
        next = waiting.map(|(visitor, _)| visitor);
    }
}

/// Refused by a reset, which every client takes for the end of the connection. libfranka 0.21 waits
/// for its first answer beyond an orderly end, for ever.
fn refuse(visitor: Visitor, name: &str) {
    let peer = visitor.peer;
    tracing::warn!(%peer, "refused: the {name} has a client");
    if let Err(error) = visitor.stream.set_zero_linger() {
        tracing::debug!(%peer, %error, "an option of the connection");
    }
}

async fn until(deadline: Option<Instant>) {
    match deadline {
        Some(deadline) => sleep_until(deadline).await,
        None => std::future::pending().await,
    }
}

/// One client from first message to last.
async fn session<D: Device>(visitor: Visitor, orders: mpsc::Sender<Order>, name: &str) {
    let peer = visitor.peer;
    tracing::info!(%peer, "client of the {name} connected");
    let (sender, replies) = mpsc::channel(REPLIES);
    let connect = Order::Connect {
        peer,
        replies: sender,
    };
    if orders.send(connect).await.is_ok() {
        transfer::<D>(visitor, &orders, replies, name).await;
        // If the thread has gone, so has the robot.
        let _ = orders.send(Order::Disconnect).await;
    }
    tracing::info!(%peer, "client of the {name} gone");
}

/// Moves messages both ways until either side is done.
async fn transfer<D: Device>(
    visitor: Visitor,
    orders: &mpsc::Sender<Order>,
    mut replies: mpsc::Receiver<Bytes>,
    name: &str,
) {
    let Visitor {
        mut stream,
        peer,
        mut received,
    } = visitor;
    let (mut read, mut write) = stream.split();
    let incoming = async {
        loop {
            match portion::<D>(&mut read, &mut received).await {
                Ok(length) => {
                    let bytes = received.split_to(length).freeze();
                    if orders.send(Order::Receive(bytes)).await.is_err() {
                        return;
                    }
                }
                Err(Silence::Closed) => return,
                Err(Silence::Unfinished) => {
                    tracing::warn!(%peer, "client of the {name} disconnected: half a message");
                    return;
                }
            }
        }
    };
    let outgoing = async {
        // The thread drops its end to close the connection.
        while let Some(reply) = replies.recv().await {
            let sent = timeout(SEND_TIMEOUT, write.write_all(&reply)).await;
            if !matches!(sent, Ok(Ok(()))) {
                return;
            }
        }
    };
    tokio::select! {
        () = incoming => {}
        () = outgoing => {}
    }
}
