//! A device on its sockets, one client at a time.

use std::net::{SocketAddr, UdpSocket};

use bytes::Bytes;
use franka_proto::{RobotCommand, server};
use tokio::sync::mpsc;

use super::cycle::Pace;
use super::device::Device;

/// Something to do with a device between two milliseconds.
pub(super) type Hands<D> = Box<dyn FnOnce(&mut D, Pace) + Send>;

/// What the stream asks of the thread.
pub(super) enum Order {
    /// A client is there: where it is, and where its replies go.
    Connect {
        peer: SocketAddr,
        replies: mpsc::Sender<Bytes>,
    },
    /// Bytes of the client's stream.
    Receive(Bytes),
    /// The client has gone.
    Disconnect,
}

/// Datagrams read per cycle, at most: a flood must not stop the clock.
const DATAGRAMS: usize = 64;

/// Orders taken per cycle, at most, for the same reason.
const ORDERS: usize = 32;

/// Replies that may wait for a client. One that has no room for the answers to what is open and to
/// one request more is not heard until it has read some.
pub(super) const REPLIES: usize = 2 * ANSWERS;
const ANSWERS: usize = 1 + <server::Session>::PENDING_LIMIT;

/// Device, UDP socket and the queues.
pub(super) struct Seat<D> {
    device: D,
    socket: UdpSocket,
    orders: mpsc::Receiver<Order>,
    hands: mpsc::Receiver<Hands<D>>,
    client: Option<(SocketAddr, mpsc::Sender<Bytes>)>,
}

impl<D: Device> Seat<D> {
    pub(super) fn new(
        device: D,
        socket: UdpSocket,
        orders: mpsc::Receiver<Order>,
        hands: mpsc::Receiver<Hands<D>>,
    ) -> Self {
        Self {
            device,
            socket,
            orders,
            hands,
            client: None,
        }
    }

    /// The device, between two milliseconds.
    pub(super) fn device_mut(&mut self) -> &mut D {
        &mut self.device
    }

    /// One millisecond: commands, orders, hands, state, replies. False at the end.
    pub(super) fn cycle(&mut self, pace: Pace) -> bool {
        self.take_commands();
        self.take_orders();
        if !self.lend_hands(pace) {
            return false;
        }
        self.send_replies();
        if let (Some(datagram), Some((peer, _))) = (self.device.tick(), &self.client) {
            // With the interface of a link-local peer.
            let mut listener = *peer;
            listener.set_port(datagram.port);
            // A client that does not listen loses states; TCP tells when it has gone.
            let _ = self.socket.send_to(datagram.bytes, listener);
        }
        self.send_replies();
        true
    }

    fn take_commands(&mut self) {
        let mut buffer = [0; RobotCommand::MAX_SIZE];
        for _ in 0..DATAGRAMS {
            match self.socket.recv_from(&mut buffer) {
                Ok((length, source)) => {
                    let known = self.client.as_ref().map(|(peer, _)| peer.ip());
                    if known == Some(source.ip()) {
                        self.device.command(&buffer[..length]);
                    }
                }
                // A client's closed port comes back as an error of this socket.
                Err(error) if error.kind() == std::io::ErrorKind::ConnectionRefused => {}
                Err(_) => break,
            }
        }
    }

    fn take_orders(&mut self) {
        for _ in 0..ORDERS {
            if !self.has_room() {
                return;
            }
            match self.orders.try_recv() {
                Ok(Order::Connect { peer, replies }) => {
                    self.device.disconnect();
                    self.device.connect();
                    self.client = Some((peer, replies));
                }
                Ok(Order::Receive(bytes)) => {
                    let result = self.device.receive(&bytes);
                    self.send_replies();
                    if let Err(error) = result {
                        tracing::warn!(%error, "client of the {} disconnected", self.device.name());
                        self.client = None;
                    }
                }
                Ok(Order::Disconnect) => {
                    self.device.disconnect();
                    self.client = None;
                }
                Err(_) => return,
            }
        }
    }

    /// Whether the client has room for what may be answered to one more order. One that has gone
    /// needs none.
    fn has_room(&self) -> bool {
        let full =
            |replies: &mpsc::Sender<Bytes>| !replies.is_closed() && replies.capacity() < ANSWERS;
        !self
            .client
            .as_ref()
            .is_some_and(|(_, replies)| full(replies))
    }

    /// False if nobody is left who could lend any.
    fn lend_hands(&mut self, pace: Pace) -> bool {
        for _ in 0..ORDERS {
            match self.hands.try_recv() {
                Ok(hands) => hands(&mut self.device, pace),
                Err(mpsc::error::TryRecvError::Empty) => return true,
                Err(mpsc::error::TryRecvError::Disconnected) => return false,
            }
        }
        true
    }

    fn send_replies(&mut self) {
        while let Some(reply) = self.device.take_reply() {
            let gone = match &self.client {
                Some((_, replies)) => replies.try_send(reply).is_err(),
                None => false,
            };
            if gone {
                // It has gone: without the sender the connection closes.
                self.device.disconnect();
                self.client = None;
            }
        }
    }
}
