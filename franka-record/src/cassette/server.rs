//! A server that plays back a cassette on sockets, as a robot.

use std::collections::BTreeMap;
use std::io::{self, Read as _, Write as _};
use std::net::{IpAddr, Shutdown, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::polling::{TICK, is_timeout};
use super::{
    Cassette, Connection, Device, Mismatch, Output, PlayOptions, Player, Tally, Unplayable,
};

/// A server that plays back a cassette to any client.
///
/// The client's first connection to a device receives the first recorded connection to this device,
/// and so on. The server plays back each connection separately. The connections to an arm and its
/// hand are synchronised only by the client.
#[derive(Debug)]
pub struct CassetteServer {
    shared: Arc<Shared>,
    listeners: Vec<JoinHandle<()>>,
    addresses: BTreeMap<Device, SocketAddr>,
}

/// Result of a complete playback.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlayReport {
    /// The connections that were played back to their end, in the order in which they ended.
    pub played: Vec<(Device, Tally)>,
}

/// Reason why a cassette was not played back to its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlayError {
    /// A client deviated from the recording.
    #[error(transparent)]
    Mismatch(#[from] Mismatch),
    /// A client opened more connections to a device than were recorded.
    #[error(
        "the client opened connection {got} to the {device}, expected {recorded} at most, as \
        recorded"
    )]
    Connection {
        /// The device to which the client connected.
        device: Device,
        /// Number of the connection, counted from 1.
        got: usize,
        /// Number of recorded connections to the device.
        recorded: usize,
    },
    /// The recording cannot be played back.
    #[error(transparent)]
    Unplayable(#[from] Unplayable),
    /// No client connected, or a client did not complete the recorded session in time.
    #[error(
        "{played} of {recorded} connections were played within {patience:?}, expected all; the \
         next is {awaited}"
    )]
    Unfinished {
        /// Time for which the server waited.
        patience: Duration,
        /// Number of connections that were played back to their end.
        played: usize,
        /// Number of recorded connections.
        recorded: usize,
        /// Description of the step that the client should perform next.
        awaited: String,
    },
    /// A socket failed.
    #[error("cannot play the cassette: {0}")]
    Io(#[from] io::Error),
}

#[derive(Debug)]
struct Shared {
    stop: AtomicBool,
    recorded: usize,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    report: PlayReport,
    failure: Option<PlayError>,
    /// Descriptions of the steps for which the current connections wait.
    awaited: BTreeMap<(Device, usize), String>,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_over(&self) -> bool {
        // Relaxed: the flag guards no data.
        self.stop.load(Ordering::Relaxed)
    }

    fn fail(&self, error: PlayError) {
        self.state().failure.get_or_insert(error);
        self.stop.store(true, Ordering::Relaxed);
        self.changed.notify_all();
    }
}

impl CassetteServer {
    /// Starts a server for a cassette at the address `ip`, on the devices' own ports.
    ///
    /// # Errors
    /// Returns [`PlayError`] if a recorded connection cannot be played back, or if a port is not
    /// free.
    pub fn start(cassette: Cassette, ip: IpAddr, options: PlayOptions) -> Result<Self, PlayError> {
        let at = |device: Device| SocketAddr::new(ip, device.port());
        Self::start_at(cassette, at, options)
    }

    /// Starts a server for a cassette, with one address per device. Port 0 selects any free port.
    ///
    /// # Errors
    /// Returns the errors of [`Self::start`].
    pub fn start_at(
        cassette: Cassette,
        address: impl Fn(Device) -> SocketAddr,
        options: PlayOptions,
    ) -> Result<Self, PlayError> {
        let recorded = cassette.connections.len();
        let mut devices: BTreeMap<Device, Vec<Connection>> = BTreeMap::new();
        for connection in cassette.connections {
            // This call reports early that a connection cannot be played back.
            Player::new(&connection, options, Duration::ZERO)?;
            devices
                .entry(connection.device)
                .or_default()
                .push(connection);
        }
        let mut this = Self {
            shared: Arc::new(Shared {
                stop: AtomicBool::new(false),
                recorded,
                state: Mutex::default(),
                changed: Condvar::new(),
            }),
            listeners: Vec::new(),
            addresses: BTreeMap::new(),
        };
        for (device, connections) in devices {
            let listener = TcpListener::bind(address(device))?;
            listener.set_nonblocking(true)?;
            this.addresses.insert(device, listener.local_addr()?);
            let shared = this.shared.clone();
            let serve = move || accept(&listener, device, connections, options, &shared);
            let name = format!("cassette {device}");
            let thread = std::thread::Builder::new().name(name).spawn(serve)?;
            this.listeners.push(thread);
        }
        Ok(this)
    }

    /// Returns the server's address for a device; `None` if the cassette contains no connection to
    /// the device.
    #[must_use]
    pub fn address(&self, device: Device) -> Option<SocketAddr> {
        self.addresses.get(&device).copied()
    }

    /// Waits until every recorded connection has been played back, and stops the server.
    ///
    /// # Errors
    /// Returns [`PlayError`] if a client deviated from the recording, or if `patience` expires
    /// before the playback is complete.
    pub fn finish(self, patience: Duration) -> Result<PlayReport, PlayError> {
        let recorded = self.shared.recorded;
        let going_on =
            |state: &mut State| state.failure.is_none() && state.report.played.len() < recorded;
        let state = self.shared.state();
        let waited = self
            .shared
            .changed
            .wait_timeout_while(state, patience, going_on);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if let Some(failure) = state.failure.take() {
            return Err(failure);
        }
        let played = state.report.played.len();
        if played < recorded {
            let awaited = state.awaited.values().next().cloned();
            return Err(PlayError::Unfinished {
                patience,
                played,
                recorded,
                awaited: awaited.unwrap_or_else(|| "a connection".to_owned()),
            });
        }
        Ok(std::mem::take(&mut state.report))
    }
}

impl Drop for CassetteServer {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        for listener in self.listeners.drain(..) {
            let _ = listener.join();
        }
    }
}

/// Accepts clients for a device until the playback ends.
fn accept(
    listener: &TcpListener,
    device: Device,
    connections: Vec<Connection>,
    options: PlayOptions,
    shared: &Arc<Shared>,
) {
    let recorded = connections.len();
    let mut connections = connections.into_iter();
    let mut threads = Vec::new();
    while !shared.is_over() {
        let Ok((client, _)) = listener.accept() else {
            std::thread::sleep(ACCEPT_TICK);
            continue;
        };
        let number = recorded - connections.len() + 1;
        let Some(connection) = connections.next() else {
            shared.fail(PlayError::Connection {
                device,
                got: number,
                recorded,
            });
            break;
        };
        let playing = shared.clone();
        let play = move || {
            let outcome = play(&client, &connection, number, options, &playing);
            // The socket may be closed already.
            let _ = client.shutdown(Shutdown::Both);
            let mut state = playing.state();
            state.awaited.remove(&(device, number));
            match outcome {
                Ok(Some(tally)) => state.report.played.push((device, tally)),
                Ok(None) => {}
                Err(error) => {
                    drop(state);
                    return playing.fail(error);
                }
            }
            drop(state);
            playing.changed.notify_all();
        };
        let name = format!("cassette {device} {number}");
        match std::thread::Builder::new().name(name).spawn(play) {
            Ok(thread) => threads.push(thread),
            Err(error) => shared.fail(error.into()),
        }
    }
    for thread in threads {
        let _ = thread.join();
    }
}

enum Input {
    Stream(Vec<u8>),
    Datagram(Vec<u8>),
    End,
}

/// Plays back a connection to a client. Returns `None` if the playback was stopped before its end.
fn play(
    mut client: &TcpStream,
    connection: &Connection,
    number: usize,
    options: PlayOptions,
    shared: &Shared,
) -> Result<Option<Tally>, PlayError> {
    client.set_nonblocking(false)?;
    client.set_nodelay(true)?;
    client.set_read_timeout(Some(TICK))?;
    let udp = UdpSocket::bind((client.local_addr()?.ip(), 0))?;
    udp.set_read_timeout(Some(TICK))?;
    let ip = client.peer_addr()?.ip();
    let over = AtomicBool::new(false);
    let stopped = || over.load(Ordering::Relaxed) || shared.is_over();
    let (sender, inputs) = sync_channel(INPUTS);
    std::thread::scope(|scope| {
        let from_udp = sender.clone();
        scope.spawn(|| read_datagrams(&udp, ip, from_udp, &stopped));
        scope.spawn(|| read_stream(client, sender, &stopped));
        let mut player = Player::new(connection, options, Duration::ZERO)?;
        let mut send = |output: Output, port: Option<u16>| match output {
            Output::Stream(bytes) => client.write_all(&bytes),
            Output::End => client.shutdown(Shutdown::Write),
            Output::Datagram(bytes) => match port {
                // A client that is disconnecting may have closed its port.
                Some(port) => udp.send_to(&bytes, (ip, port)).map(drop).or(Ok(())),
                None => Ok(()),
            },
        };
        let outcome = drive(&mut player, &inputs, &mut send, &stopped, |awaited| {
            let key = (connection.device, number);
            shared.state().awaited.insert(key, awaited);
        });
        over.store(true, Ordering::Relaxed);
        // After this call, readers that wait for space in the queue end.
        drop(inputs);
        outcome
    })
}

/// Connects a player, a clock and the client's input.
fn drive(
    player: &mut Player,
    inputs: &Receiver<Input>,
    send: &mut impl FnMut(Output, Option<u16>) -> io::Result<()>,
    stopped: &impl Fn() -> bool,
    mut awaits: impl FnMut(String),
) -> Result<Option<Tally>, PlayError> {
    let start = Instant::now();
    awaits(player.awaited());
    loop {
        while let Some(output) = player.poll(start.elapsed())? {
            if send(output, player.udp_port()).is_err() {
                // The client has disconnected. `on_end` reports any missing steps.
                break;
            }
        }
        if player.is_finished() {
            return Ok(Some(player.tally()));
        }
        if stopped() {
            return Ok(None);
        }
        let deadline = player.deadline();
        let wait = deadline.map_or(TICK, |deadline| deadline.saturating_sub(start.elapsed()));
        match inputs.recv_timeout(wait.min(TICK)) {
            Ok(Input::Stream(bytes)) => {
                player.on_stream(&bytes)?;
                awaits(player.awaited());
            }
            Ok(Input::Datagram(bytes)) => player.on_datagram(&bytes)?,
            Ok(Input::End) => player.on_end()?,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
        }
    }
}

fn read_stream(mut client: &TcpStream, inputs: SyncSender<Input>, stopped: &impl Fn() -> bool) {
    let mut buffer = [0; 4096];
    while !stopped() {
        let input = match client.read(&mut buffer) {
            Ok(0) => Input::End,
            Ok(length) => Input::Stream(buffer[..length].to_vec()),
            Err(error) if is_timeout(&error) => continue,
            Err(_) => Input::End,
        };
        let end = matches!(input, Input::End);
        if inputs.send(input).is_err() || end {
            return;
        }
    }
}

fn read_datagrams(
    udp: &UdpSocket,
    client: IpAddr,
    inputs: SyncSender<Input>,
    stopped: &impl Fn() -> bool,
) {
    let mut buffer = [0; 4096];
    while !stopped() {
        // Errors other than a timeout mean that one of our datagrams reached a closed port.
        let Ok((length, sender)) = udp.recv_from(&mut buffer) else {
            continue;
        };
        let input = Input::Datagram(buffer[..length].to_vec());
        if sender.ip() == client && inputs.send(input).is_err() {
            return;
        }
    }
}

/// Interval at which the server checks for a new client. Clients connect rarely and wait for a
/// second.
const ACCEPT_TICK: Duration = Duration::from_millis(5);

/// Capacity of the player's queue. Readers wait while it is full.
const INPUTS: usize = 256;
