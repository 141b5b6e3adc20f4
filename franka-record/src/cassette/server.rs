//! Serves a cassette as a robot: players on sockets.

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

/// A server that plays a cassette to any client.
///
/// A client's first connection to a device gets the first recorded connection to this device, and
/// so on. The server plays each connection separately. If there are connections to an arm and its
/// hand, only the client synchronises them.
#[derive(Debug)]
pub struct CassetteServer {
    shared: Arc<Shared>,
    listeners: Vec<JoinHandle<()>>,
    addresses: BTreeMap<Device, SocketAddr>,
}

/// Result of a playback.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlayReport {
    /// The connections that were played to their end, in the order in which they ended.
    pub played: Vec<(Device, Tally)>,
}

/// Reason why a cassette was not played to its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlayError {
    /// A client deviated from the recorded client.
    #[error(transparent)]
    Mismatch(#[from] Mismatch),
    /// A client opened more connections to a device than the recording has.
    #[error(
        "the client opened connection {got} to the {device}, expected {recorded} at most, as \
        recorded"
    )]
    Connection {
        /// The device to which the client connected.
        device: Device,
        /// The number of the connection, from 1.
        got: usize,
        /// Number of recorded connections to the device.
        recorded: usize,
    },
    /// The recording cannot be played.
    #[error(transparent)]
    Unplayable(#[from] Unplayable),
    /// No client connected, or a client did not complete the recording in time.
    #[error(
        "{played} of {recorded} connections were played within {patience:?}, expected all; the \
         next is {awaited}"
    )]
    Unfinished {
        /// Time for which the server waited.
        patience: Duration,
        /// Number of connections that were played to their end.
        played: usize,
        /// Number of recorded connections.
        recorded: usize,
        /// The client's next step, as text.
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
    /// The steps for which the current connections wait, as text.
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

    /// Ends the playback.
    fn fail(&self, error: PlayError) {
        self.state().failure.get_or_insert(error);
        self.stop.store(true, Ordering::Relaxed);
        self.changed.notify_all();
    }
}

impl CassetteServer {
    /// Starts to serve a cassette at `ip`, on the devices' own ports.
    ///
    /// # Errors
    /// [`PlayError`] if a recorded connection cannot be played, or a port is not free.
    pub fn start(cassette: Cassette, ip: IpAddr, options: PlayOptions) -> Result<Self, PlayError> {
        let at = |device: Device| SocketAddr::new(ip, device.port());
        Self::start_at(cassette, at, options)
    }

    /// Starts to serve a cassette, each device at its address; port 0 selects any free port.
    ///
    /// # Errors
    /// The errors of [`Self::start`].
    pub fn start_at(
        cassette: Cassette,
        address: impl Fn(Device) -> SocketAddr,
        options: PlayOptions,
    ) -> Result<Self, PlayError> {
        let recorded = cassette.connections.len();
        let mut devices: BTreeMap<Device, Vec<Connection>> = BTreeMap::new();
        for connection in cassette.connections {
            // Reports an unplayable connection early.
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

    /// Returns the address of a device; `None` if the cassette has no connection to it.
    #[must_use]
    pub fn address(&self, device: Device) -> Option<SocketAddr> {
        self.addresses.get(&device).copied()
    }

    /// Waits until every recorded connection has been played, and ends the server.
    ///
    /// # Errors
    /// [`PlayError`] if a client deviated from the recording, or if `patience` expires first.
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

/// Accepts clients of a device until the playback ends.
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

/// The input from a client.
enum Input {
    Stream(Vec<u8>),
    Datagram(Vec<u8>),
    End,
}

/// Plays a connection to a client; `None` if the playback is stopped before its end.
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
                // A departing client may have closed its port.
                Some(port) => udp.send_to(&bytes, (ip, port)).map(drop).or(Ok(())),
                None => Ok(()),
            },
        };
        let outcome = drive(&mut player, &inputs, &mut send, &stopped, |awaited| {
            let key = (connection.device, number);
            shared.state().awaited.insert(key, awaited);
        });
        over.store(true, Ordering::Relaxed);
        // Readers that wait for space in the queue then end.
        drop(inputs);
        outcome
    })
}

/// Connects a player, a clock, and the client's input.
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
                // The client has disconnected. The end of its stream shows missing steps.
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

/// Interval of checks for a new client. Clients connect rarely, and allow a second for it.
const ACCEPT_TICK: Duration = Duration::from_millis(5);

/// Capacity of the player's queue; readers wait if it is full.
const INPUTS: usize = 256;
