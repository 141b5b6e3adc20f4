//! A tap between clients and a robot, which forwards and records all data.

mod journal;
mod link;

use std::io;
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::{SystemTime, UNIX_EPOCH};

use self::journal::Journal;
use super::polling::TICK;
use super::{CassetteError, CassetteWriter, Device};

/// A tap on the connections to a robot and its end effectors. It runs on its own threads.
///
/// A client connects to the tap instead of the robot, and the tap connects to the robot. The tap
/// forwards all bytes unchanged, except the UDP port in `Connect`, because states and commands must
/// also pass through the tap. The recording contains the bytes as their sender sent them. A
/// separate thread writes the recording and never delays the bytes. Events that this thread cannot
/// record in time count as missing.
///
/// Dropping the tap ends all connections, like [`Self::finish`].
#[derive(Debug)]
pub struct Tap {
    stop: Arc<AtomicBool>,
    listeners: Vec<JoinHandle<()>>,
    addresses: Vec<(Device, SocketAddr)>,
    connections: Arc<AtomicUsize>,
    journal: Option<Journal>,
}

/// A device, and the address at which clients connect to it through the tap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Route {
    /// The device.
    pub device: Device,
    /// The address at which the tap listens. Port 0 selects any free port.
    pub listen: SocketAddr,
    /// The address of the device, or of a simulator.
    pub robot: SocketAddr,
}

/// Result of a recording with a tap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct TapReport {
    /// Number of client connections.
    pub connections: usize,
    /// Number of events in the file.
    pub events: u64,
    /// Number of events that are missing from the file.
    pub dropped: u64,
}

impl Route {
    /// Returns the routes of an arm, its Hand and its vacuum gripper. All routes use the devices'
    /// own ports.
    #[must_use]
    pub fn all(robot: IpAddr, listen: IpAddr) -> [Self; 3] {
        Device::ALL.map(|device| Self {
            device,
            listen: (listen, device.port()).into(),
            robot: (robot, device.port()).into(),
        })
    }
}

impl Tap {
    /// Starts a tap that records to a new file at `path`.
    ///
    /// # Errors
    /// Returns [`CassetteError`] if an address is not free, or if the file exists or cannot be
    /// created.
    pub fn start(routes: &[Route], path: impl AsRef<Path>) -> Result<Self, CassetteError> {
        let listeners = routes.iter().map(|route| {
            let listener = TcpListener::bind(route.listen)?;
            listener.set_nonblocking(true)?;
            Ok((listener, *route))
        });
        let listeners = listeners.collect::<io::Result<Vec<_>>>()?;
        let file = std::fs::File::create_new(path)?;
        let started = SystemTime::now().duration_since(UNIX_EPOCH);
        let started = started.map_or(0, |time| u64::try_from(time.as_nanos()).unwrap_or_default());
        let writer = CassetteWriter::new(io::BufWriter::new(file), started)?;
        let journal = Journal::start(writer)?;
        let mut this = Self {
            stop: Arc::default(),
            listeners: Vec::new(),
            addresses: Vec::new(),
            connections: Arc::default(),
            journal: Some(journal),
        };
        for (listener, route) in listeners {
            this.addresses.push((route.device, listener.local_addr()?));
            let (stop, connections) = (this.stop.clone(), this.connections.clone());
            let recorder = this.journal.as_ref().map(Journal::recorder);
            let recorder = recorder.expect("it was put there above");
            let accept = move || accept(&listener, route, &connections, &recorder, &stop);
            let name = format!("tap {}", route.device);
            let thread = std::thread::Builder::new().name(name).spawn(accept)?;
            this.listeners.push(thread);
        }
        Ok(this)
    }

    /// Returns the address at which clients connect to a device; `None` if the tap has no route for
    /// the device.
    #[must_use]
    pub fn address(&self, device: Device) -> Option<SocketAddr> {
        let mut addresses = self.addresses.iter();
        let found = addresses.find(|(other, _)| *other == device);
        found.map(|(_, address)| *address)
    }

    /// Ends all connections and completes the file.
    ///
    /// # Errors
    /// Returns [`CassetteError`] if the file could not be written. The tap has forwarded all data
    /// nevertheless.
    pub fn finish(mut self) -> Result<TapReport, CassetteError> {
        self.end()
    }

    fn end(&mut self) -> Result<TapReport, CassetteError> {
        // Relaxed: the threads are joined below, and the flag guards no data.
        self.stop.store(true, Ordering::Relaxed);
        for listener in self.listeners.drain(..) {
            // The panic message of this thread has been printed. The data recorded so far is kept.
            let _ = listener.join();
        }
        let Some(journal) = self.journal.take() else {
            return Ok(TapReport::default());
        };
        let (events, dropped) = journal.finish()?;
        Ok(TapReport {
            connections: self.connections.load(Ordering::Relaxed),
            events,
            dropped,
        })
    }
}

impl Drop for Tap {
    fn drop(&mut self) {
        // The error is ignored here. `finish` returns it.
        let _ = self.end();
    }
}

/// Accepts clients until the tap is stopped, and then ends their connections.
fn accept(
    listener: &TcpListener,
    route: Route,
    connections: &AtomicUsize,
    recorder: &journal::Recorder,
    stop: &Arc<AtomicBool>,
) {
    let mut threads: Vec<JoinHandle<()>> = Vec::new();
    while !stop.load(Ordering::Relaxed) {
        let Ok((client, _)) = listener.accept() else {
            // No client connected, or the client has disconnected already.
            std::thread::sleep(TICK);
            continue;
        };
        let number = connections.fetch_add(1, Ordering::Relaxed);
        threads.retain(|thread| !thread.is_finished());
        threads.extend(start(client, number, route, recorder, stop));
    }
    for thread in threads {
        let _ = thread.join();
    }
}

/// Starts to serve a client. Closes the client's connection if this fails.
fn start(
    client: TcpStream,
    number: usize,
    route: Route,
    recorder: &journal::Recorder,
    stop: &Arc<AtomicBool>,
) -> Option<JoinHandle<()>> {
    let (recorder, stop) = (recorder.clone(), stop.clone());
    let serve = move || link::serve(client, route, number, &recorder, &stop);
    let name = format!("tap {} {number}", route.device);
    let thread = std::thread::Builder::new().name(name).spawn(serve);
    thread.ok()
}
