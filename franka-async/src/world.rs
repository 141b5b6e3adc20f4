//! Access to the outside world: network, clock, tasks and threads. `clippy.toml` forbids other
//! ways, so that a simulated world must replace only this file.
#![expect(
    clippy::disallowed_methods,
    clippy::disallowed_types,
    reason = "the one place from which the crate reaches the outside"
)]

use std::fmt;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::time::Duration;

use franka_proto::Version;
use franka_rt::driver::Driver;
use franka_rt::event_fd::EventFd;
use franka_rt::exchange;
use franka_rt::thread::{self, Handle, StartError, ThreadConfig};
use socket2::{SockRef, TcpKeepalive};
use tokio::io::unix::AsyncFd;
use tokio::io::{AsyncRead, AsyncWrite, Interest};
use tokio::runtime;
use tokio::task::JoinHandle;
use tokio::time::error::Elapsed;

/// The command connection: bytes in order, in both directions.
pub(crate) type Stream = Box<dyn ByteStream>;

pub(crate) trait ByteStream: AsyncRead + AsyncWrite + Unpin + Send + fmt::Debug {}

impl<T: AsyncRead + AsyncWrite + Unpin + Send + fmt::Debug> ByteStream for T {}

pub(crate) async fn connect(address: SocketAddr) -> io::Result<Stream> {
    let stream = tokio::net::TcpStream::connect(address).await?;
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "cannot set TCP_NODELAY: small requests may be delayed");
    }
    let (idle, interval, count) = KEEPALIVE;
    let keepalive = TcpKeepalive::new()
        .with_time(idle)
        .with_interval(interval)
        .with_retries(count);
    if let Err(error) = SockRef::from(&stream).set_tcp_keepalive(&keepalive) {
        tracing::debug!(%error, "cannot set TCP keepalive on the command connection");
    }
    Ok(Box::new(stream))
}

/// Keepalive of the command connection: idle time, interval, count. Source: libfranka 0.21,
/// `network.cpp`.
const KEEPALIVE: (Duration, Duration, u32) = (Duration::from_secs(1), Duration::from_secs(1), 3);

/// Asks the system for the addresses of a host.
pub(crate) async fn look_up(
    name: &str,
    port: u16,
) -> io::Result<impl Iterator<Item = SocketAddr> + use<>> {
    let found: Vec<SocketAddr> = tokio::net::lookup_host((name, port)).await?.collect();
    Ok(found.into_iter())
}

/// The UDP port to which a peer sends its states.
pub(crate) struct StatePort {
    socket: std::net::UdpSocket,
    peer: IpAddr,
}

pub(crate) type Datagrams = tokio::net::UdpSocket;

impl StatePort {
    /// Opens a free port for the states of `peer`.
    pub(crate) fn open(peer: IpAddr) -> io::Result<Self> {
        let socket = exchange::bind(peer)?;
        Ok(Self { socket, peer })
    }

    pub(crate) fn number(&self) -> io::Result<u16> {
        Ok(self.socket.local_addr()?.port())
    }

    /// Converts the port into a socket for tasks.
    pub(crate) fn datagrams(self) -> io::Result<Datagrams> {
        self.socket.set_nonblocking(true)?;
        Datagrams::from_std(self.socket)
    }

    /// Starts a control thread and passes the port to it.
    pub(crate) fn control_thread(
        self,
        config: ThreadConfig,
        driver: Driver,
        version: Version,
    ) -> Result<Handle, StartError> {
        thread::spawn(config, driver, self.socket, self.peer, version)
    }
}

/// Wake-ups from a control thread, as a future.
pub(crate) struct Wake(AsyncFd<EventFd>);

impl Wake {
    /// Registers the eventfd of the thread with this runtime.
    ///
    /// # Errors
    /// Returns an error if the poll of the runtime does not accept the descriptor.
    pub(crate) fn attach(event_fd: EventFd) -> io::Result<Self> {
        // SAFETY: an `EventFd` owns its eventfd through an `Arc` that nothing replaces: the
        // descriptor is open, and the same, for as long as the `EventFd` lives, and the `AsyncFd`
        // owns the `EventFd`.
        let attached = unsafe { AsyncFd::register_with_interest(event_fd, Interest::READABLE) };
        attached.map(Self).map_err(Into::into)
    }

    /// Waits until the thread has written to its eventfd, and drains it.
    ///
    /// # Cancel safety
    /// A wake-up is not lost: the next call returns at once.
    pub(crate) async fn woken(&self) -> io::Result<()> {
        let mut guard = self.0.readable().await?;
        self.0.get_ref().drain();
        guard.clear_ready();
        Ok(())
    }
}

pub(crate) type Instant = tokio::time::Instant;

pub(crate) fn now() -> Instant {
    Instant::now()
}

pub(crate) fn sleep(duration: Duration) -> impl Future<Output = ()> {
    tokio::time::sleep(duration)
}

pub(crate) fn sleep_until(deadline: Instant) -> impl Future<Output = ()> {
    tokio::time::sleep_until(deadline)
}

pub(crate) fn timeout<F: Future>(
    limit: Duration,
    future: F,
) -> impl Future<Output = Result<F::Output, Elapsed>> {
    tokio::time::timeout(limit, future)
}

pub(crate) fn timeout_at<F: Future>(
    deadline: Instant,
    future: F,
) -> impl Future<Output = Result<F::Output, Elapsed>> {
    tokio::time::timeout_at(deadline, future)
}

/// Runs a task on the runtime of the caller.
pub(crate) fn spawn<F>(task: F) -> JoinHandle<F::Output>
where
    F: Future<Output: Send> + Send + 'static,
{
    tokio::spawn(task)
}

/// Runs blocking work on a thread of the runtime of the caller.
pub(crate) fn spawn_blocking<T: Send + 'static>(
    blocking: impl FnOnce() -> T + Send + 'static,
) -> JoinHandle<T> {
    tokio::task::spawn_blocking(blocking)
}

/// A runtime that callers without one can use.
pub(crate) struct Runtime(runtime::Handle);

impl Runtime {
    /// Returns the runtime of the caller.
    ///
    /// # Panics
    /// Panics outside of a runtime.
    pub(crate) fn current() -> Self {
        Self(runtime::Handle::current())
    }

    pub(crate) fn spawn<F>(&self, task: F) -> JoinHandle<F::Output>
    where
        F: Future<Output: Send> + Send + 'static,
    {
        self.0.spawn(task)
    }
}

#[cfg(feature = "doctor")]
pub(crate) fn has_runtime() -> bool {
    runtime::Handle::try_current().is_ok()
}

/// Starts a runtime with its own thread.
#[cfg(feature = "blocking")]
pub(crate) fn background() -> io::Result<runtime::Runtime> {
    runtime::Builder::new_multi_thread()
        .worker_threads(1)
        .thread_name("franka-async")
        .enable_all()
        .build()
}

#[cfg(feature = "record")]
pub(crate) fn start_thread(
    name: &str,
    run: impl FnOnce() + Send + 'static,
) -> io::Result<std::thread::JoinHandle<()>> {
    std::thread::Builder::new().name(name.into()).spawn(run)
}
