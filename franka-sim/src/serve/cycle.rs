//! The thread that keeps the millisecond.

use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use bytes::Bytes;
use franka_proto::RobotCommand;
use tokio::sync::{mpsc, oneshot};

use crate::robot::Robot;

/// What the Tokio side asks of the thread.
pub(super) enum Order {
    /// A client is there: where it is, and where its replies go.
    Connect {
        peer: IpAddr,
        replies: mpsc::Sender<Bytes>,
    },
    /// Bytes of the client's stream.
    Receive(Bytes),
    /// The client has gone.
    Disconnect,
    /// Something to do with the robot.
    Hands(Box<dyn FnOnce(&mut Robot) + Send>),
    /// Tell how well the cycle is kept.
    Pace(oneshot::Sender<Pace>),
}

/// How well a simulation has kept its millisecond.
///
/// The thread has ordinary priority. When the host lets it sleep over deadlines, it publishes the
/// states that are due in a burst, as a robot's network does after a stall; when more than
/// [`Pace::BURST`] are due, it lets the rest of the lost time go. `message_id` advances by one per
/// state in any case, so robot time then runs behind the clock on the wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pace {
    /// States due so far.
    pub cycles: u64,
    /// Those that followed another one in a burst: the client had no time to answer the one before.
    pub burst: u64,
    /// Milliseconds let go.
    pub skipped: u64,
}

impl Pace {
    /// States published at once, at most.
    pub const BURST: u32 = 4;
}

const PERIOD: Duration = Duration::from_millis(1);

/// Datagrams read per cycle, at most: a flood must not stop the clock.
const DATAGRAMS: usize = 64;

/// Robot, UDP socket and the two queues.
pub(super) struct Cycle {
    robot: Robot,
    socket: UdpSocket,
    orders: mpsc::Receiver<Order>,
    client: Option<(IpAddr, mpsc::Sender<Bytes>)>,
    pace: Pace,
}

impl Cycle {
    pub(super) fn new(robot: Robot, socket: UdpSocket, orders: mpsc::Receiver<Order>) -> Self {
        Self {
            robot,
            socket,
            orders,
            client: None,
            pace: Pace::default(),
        }
    }

    /// Runs until nobody can give orders any more.
    pub(super) fn run(mut self) {
        let mut deadline = Instant::now() + PERIOD;
        loop {
            std::thread::sleep(deadline.saturating_duration_since(Instant::now()));
            let late = deadline.elapsed().as_micros() / PERIOD.as_micros();
            let due = 1 + u32::try_from(late).unwrap_or(u32::MAX - 1);
            for n in 0..due.min(Pace::BURST) {
                self.pace.cycles += 1;
                self.pace.burst += u64::from(n > 0);
                if !self.cycle() {
                    return;
                }
            }
            self.pace.skipped += u64::from(due.saturating_sub(Pace::BURST));
            deadline += PERIOD * due;
        }
    }

    /// One millisecond: commands, orders, state, replies. False at the end.
    fn cycle(&mut self) -> bool {
        self.take_commands();
        if !self.take_orders() {
            return false;
        }
        self.send_replies();
        if let (Some(datagram), Some((peer, _))) = (self.robot.tick(), &self.client) {
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
                        self.robot.command(&buffer[..length]);
                    }
                }
                // A client's closed port comes back as an error of this socket.
                Err(error) if error.kind() == std::io::ErrorKind::ConnectionRefused => {}
                Err(_) => break,
            }
        }
    }

    fn take_orders(&mut self) -> bool {
        loop {
            match self.orders.try_recv() {
                Ok(Order::Connect { peer, replies }) => {
                    self.robot.disconnect();
                    self.robot.connect();
                    self.client = Some((peer, replies));
                }
                Ok(Order::Receive(bytes)) => {
                    let result = self.robot.receive(&bytes);
                    self.send_replies();
                    if let Err(error) = result {
                        tracing::warn!(%error, "client disconnected");
                        self.client = None;
                    }
                }
                Ok(Order::Disconnect) => {
                    self.robot.disconnect();
                    self.client = None;
                }
                Ok(Order::Hands(hands)) => hands(&mut self.robot),
                Ok(Order::Pace(answer)) => {
                    // Whoever asked may have gone.
                    let _ = answer.send(self.pace);
                }
                Err(mpsc::error::TryRecvError::Empty) => return true,
                Err(mpsc::error::TryRecvError::Disconnected) => return false,
            }
        }
    }

    fn send_replies(&mut self) {
        while let Some(reply) = self.robot.take_reply() {
            let full = match &self.client {
                Some((_, replies)) => replies.try_send(reply).is_err(),
                None => false,
            };
            if full {
                // It does not read, or has gone: without the sender the connection closes.
                self.robot.disconnect();
                self.client = None;
            }
        }
    }
}
