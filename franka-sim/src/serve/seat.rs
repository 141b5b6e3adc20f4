//! A device on its sockets, one client at a time.

use std::net::{IpAddr, SocketAddr, UdpSocket};

use bytes::Bytes;
use franka_proto::RobotCommand;
use tokio::sync::mpsc;

use super::cycle::Pace;
use super::device::Device;

/// What is done with a device between two milliseconds.
type Hands<D> = Box<dyn FnOnce(&mut D, Pace) + Send>;

/// What the Tokio side asks of the thread.
pub(super) enum Order<D> {
    /// A client is there: where it is, and where its replies go.
    Connect {
        peer: IpAddr,
        replies: mpsc::Sender<Bytes>,
    },
    /// Bytes of the client's stream.
    Receive(Bytes),
    /// The client has gone.
    Disconnect,
    /// Something to do with the device.
    Hands(Hands<D>),
}

/// Datagrams read per cycle, at most: a flood must not stop the clock.
const DATAGRAMS: usize = 64;

/// Orders taken per cycle, at most, for the same reason. Fewer than the replies that may wait for
/// a client, so that one that reads is never taken for one that does not.
const ORDERS: usize = 32;

/// Device, UDP socket and the two queues.
pub(super) struct Seat<D> {
    device: D,
    socket: UdpSocket,
    orders: mpsc::Receiver<Order<D>>,
    client: Option<(IpAddr, mpsc::Sender<Bytes>)>,
}

impl<D: Device> Seat<D> {
    pub(super) fn new(device: D, socket: UdpSocket, orders: mpsc::Receiver<Order<D>>) -> Self {
        Self {
            device,
            socket,
            orders,
            client: None,
        }
    }

    /// One millisecond: commands, orders, state, replies. False at the end.
    pub(super) fn cycle(&mut self, pace: Pace) -> bool {
        self.take_commands();
        if !self.take_orders(pace) {
            return false;
        }
        self.send_replies();
        if let (Some(datagram), Some((peer, _))) = (self.device.tick(), &self.client) {
            // A client that does not listen loses states; TCP tells when it has gone.
            let _ = self
                .socket
                .send_to(datagram.bytes, SocketAddr::new(*peer, datagram.port));
        }
        self.send_replies();
        true
    }

    fn take_commands(&mut self) {
        let mut buffer = [0; RobotCommand::MAX_SIZE];
        for _ in 0..DATAGRAMS {
            match self.socket.recv_from(&mut buffer) {
                Ok((length, source)) => {
                    let known = self.client.as_ref().map(|(peer, _)| *peer);
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

    fn take_orders(&mut self, pace: Pace) -> bool {
        for _ in 0..ORDERS {
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
                Ok(Order::Hands(hands)) => hands(&mut self.device, pace),
                Err(mpsc::error::TryRecvError::Empty) => return true,
                Err(mpsc::error::TryRecvError::Disconnected) => return false,
            }
        }
        true
    }

    fn send_replies(&mut self) {
        while let Some(reply) = self.device.take_reply() {
            let full = match &self.client {
                Some((_, replies)) => replies.try_send(reply).is_err(),
                None => false,
            };
            if full {
                // It does not read, or has gone: without the sender the connection closes.
                self.device.disconnect();
                self.client = None;
            }
        }
    }
}
