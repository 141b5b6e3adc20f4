//! The stream: one client at a time.

use std::time::Duration;

use bytes::{Bytes, BytesMut};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::mpsc;
use tokio::time::timeout;

use super::device::Device;
use super::seat::Order;

/// Replies that may wait for a client that does not read.
const REPLIES: usize = 64;

/// How long a client may leave no room for a reply. One that does not read must not keep others out.
const SEND_TIMEOUT: Duration = Duration::from_secs(1);

/// How long a second client waits for the first to be gone. One that reconnects arrives a moment
/// before its old connection has been taken down.
const HANDOVER: Duration = Duration::from_millis(50);

/// How long to wait after the listener failed (out of file descriptors, for one).
const RETRY: Duration = Duration::from_millis(100);

/// Serves clients until the thread has gone or the task is aborted.
pub(super) async fn serve<D: Device>(
    listener: TcpListener,
    orders: mpsc::Sender<Order<D>>,
    name: &'static str,
) {
    let mut next = None;
    while !orders.is_closed() {
        let stream = match next.take() {
            Some(stream) => stream,
            None => accept(&listener).await,
        };
        let mut session = std::pin::pin!(session(stream, orders.clone(), name));
        loop {
            tokio::select! {
                biased;
                () = &mut session => break,
                other = accept(&listener) => {
                    // Refused by closing: a client sees an orderly end instead of silence.
                    if timeout(HANDOVER, &mut session).await.is_ok() {
                        next = Some(other);
                        break;
                    }
                }
            }
        }
    }
}

async fn accept(listener: &TcpListener) -> TcpStream {
    loop {
        match listener.accept().await {
            Ok((stream, _)) => return stream,
            Err(error) => {
                tracing::warn!(%error, "cannot accept a connection");
                tokio::time::sleep(RETRY).await;
            }
        }
    }
}

/// One client from first byte to last.
async fn session<D: Device>(stream: TcpStream, orders: mpsc::Sender<Order<D>>, name: &str) {
    let Ok(peer) = stream.peer_addr() else {
        return;
    };
    // Replies are small and their delay is felt; without it, they are only slower.
    let _ = stream.set_nodelay(true);
    tracing::info!(%peer, "client of the {name} connected");
    let (sender, replies) = mpsc::channel(REPLIES);
    let connect = Order::Connect {
        peer: peer.ip(),
        replies: sender,
    };
    if orders.send(connect).await.is_ok() {
        transfer(stream, &orders, replies).await;
        // If the thread has gone, so has the robot.
        let _ = orders.send(Order::Disconnect).await;
    }
    tracing::info!(%peer, "client of the {name} gone");
}

/// Moves bytes both ways until either side is done.
async fn transfer<D: Device>(
    mut stream: TcpStream,
    orders: &mpsc::Sender<Order<D>>,
    mut replies: mpsc::Receiver<Bytes>,
) {
    let (mut read, mut write) = stream.split();
    let incoming = async {
        let mut buffer = BytesMut::with_capacity(4096);
        while matches!(read.read_buf(&mut buffer).await, Ok(count) if count > 0) {
            let bytes = buffer.split().freeze();
            if orders.send(Order::Receive(bytes)).await.is_err() {
                return;
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
