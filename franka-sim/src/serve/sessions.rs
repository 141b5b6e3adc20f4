//! Sessions of clients. A device has one client at a time, and refuses a second client.
//!
//! ```text
//! pending ── handshake is whole ──> waits a moment ── device is free ──> session
//!   └─ too slow, too many: closed      └─ device has a client: refused
//! ```
//!
//! A connection occupies the device only after its handshake, because a silent connection must not
//! block clients.

use std::time::Duration;

use bytes::Bytes;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpListener;
use tokio::sync::mpsc;
use tokio::time::{Instant, sleep_until, timeout};

use super::device_server::{Order, REPLIES};
use super::pending::{Handshake, PendingConnections};
use super::stream::{Patience, StreamEnd, next_message};
use crate::connection::Framing;

/// Longest time for which a client's queue may have no room for a reply. A client that does not
/// read must not block other clients.
const SEND_TIMEOUT: Duration = Duration::from_secs(1);

/// Time for which a second client waits until the first client disconnects. A client that
/// reconnects may arrive before its old connection is closed.
const HANDOVER: Duration = Duration::from_millis(50);

/// Serves clients until the thread has ended or the task is aborted.
pub(super) async fn serve(
    listener: TcpListener,
    orders: mpsc::Sender<Order>,
    name: &'static str,
    framing: Framing,
) {
    let mut pending = PendingConnections::new(listener, name, framing);
    let mut next = None;
    while !orders.is_closed() {
        let handshake = match next.take() {
            Some(handshake) => handshake,
            None => pending.next().await,
        };
        let mut session = std::pin::pin!(session(handshake, orders.clone(), name, framing));
        let mut second: Option<(Handshake, Instant)> = None;
        loop {
            let patience = second.as_ref().map(|(_, deadline)| *deadline);
            tokio::select! {
                biased;
                () = &mut session => break,
                handshake = pending.next() => {
                    let deadline = Instant::now() + HANDOVER;
                    if let Some((other, _)) = second.replace((handshake, deadline)) {
                        refuse(other, name);
                    }
                }
                () = until(patience) => {
                    if let Some((handshake, _)) = second.take() {
                        refuse(handshake, name);
                    }
                }
            }
        }
        next = second.map(|(handshake, _)| handshake);
    }
}

/// Refuses a second client by resetting its connection, because every client understands a reset.
/// After an orderly close, libfranka 0.21 would wait for its first answer forever.
fn refuse(second: Handshake, name: &str) {
    let peer = second.peer;
    tracing::warn!(%peer, "refused: the {name} already has a client");
    if let Err(error) = second.stream.set_zero_linger() {
        tracing::debug!(%peer, %error, "an option of the connection");
    }
}

async fn until(deadline: Option<Instant>) {
    match deadline {
        Some(deadline) => sleep_until(deadline).await,
        None => std::future::pending().await,
    }
}

/// Serves one client from its first message to its last.
async fn session(handshake: Handshake, orders: mpsc::Sender<Order>, name: &str, framing: Framing) {
    let peer = handshake.peer;
    tracing::info!(%peer, "client of the {name} connected");
    let (sender, replies) = mpsc::channel(REPLIES);
    let connect = Order::Connect {
        peer,
        replies: sender,
    };
    if orders.send(connect).await.is_ok() {
        transfer(handshake, &orders, replies, name, framing).await;
        // If the thread has ended, the robot has also ended.
        let _ = orders.send(Order::Disconnect).await;
    }
    tracing::info!(%peer, "client of the {name} disconnected");
}

/// Passes messages in both directions until the client or the device ends the session.
async fn transfer(
    handshake: Handshake,
    orders: &mpsc::Sender<Order>,
    mut replies: mpsc::Receiver<Bytes>,
    name: &str,
    framing: Framing,
) {
    let Handshake {
        mut stream,
        peer,
        mut received,
    } = handshake;
    let (mut read, mut write) = stream.split();
    let incoming = async {
        loop {
            match next_message(&mut read, &mut received, framing, Patience::SESSION).await {
                Ok(length) => {
                    let bytes = received.split_to(length).freeze();
                    if orders.send(Order::Receive(bytes)).await.is_err() {
                        return;
                    }
                }
                Err(StreamEnd::Closed) => return,
                Err(StreamEnd::TooSlow) => {
                    tracing::warn!(%peer, "client of the {name} disconnected in the middle of a \
                        message");
                    return;
                }
            }
        }
    };
    let outgoing = async {
        // To close the connection, the thread drops its end of the queue.
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
