//! Sockets of one device, and the device's handle for other tasks. `sessions` serves the device's
//! clients.

use std::fmt;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

use super::clock::Pace;
use super::device::Device;
use super::device_server::{Between, DeviceServer, Job};
use super::relay::Relay;
use super::sessions;
use crate::network::Network;

/// A device on its sockets. Dropping this value closes the sockets.
pub struct Service<D> {
    address: SocketAddr,
    jobs: mpsc::Sender<Job<D>>,
    server: JoinHandle<()>,
}

/// Error: the simulation has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the simulated robot has stopped")]
pub struct Stopped;

/// Opens the sockets of a device. Returns the device's handle, and its server for the thread.
/// Errors contain the address, because a simulation has several addresses.
pub(super) async fn open<D: Device>(
    bind: SocketAddr,
    device: Box<D>,
) -> io::Result<(Service<D>, DeviceServer<D>)> {
    let listener = TcpListener::bind(bind)
        .await
        .map_err(|error| io::Error::new(error.kind(), format!("{bind}: {error}")))?;
    let address = listener.local_addr()?;
    let mut beside = address;
    beside.set_port(0);
    let socket = UdpSocket::bind(beside)?;
    socket.set_nonblocking(true)?;
    let (orders, stream) = mpsc::channel(QUEUE);
    let (jobs, waiting) = mpsc::channel(QUEUE);
    let server = tokio::spawn(sessions::serve(listener, orders, device.name(), D::FRAMING));
    let service = Service {
        address,
        jobs,
        server,
    };
    Ok((service, DeviceServer::new(device, socket, stream, waiting)))
}

impl<D: 'static> Service<D> {
    /// Returns the address to which clients connect.
    pub fn addr(&self) -> SocketAddr {
        self.address
    }

    /// Runs `job` on the device between two milliseconds. `job` runs on the simulator's thread, so
    /// it must be short.
    ///
    /// # Errors
    /// Returns [`Stopped`] if the simulation has ended. Only a panic causes such an end.
    ///
    /// # Cancel safety
    /// If the future is dropped after its first poll, `job` may still run.
    pub async fn with<R: Send + 'static>(
        &self,
        job: impl FnOnce(&mut D) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        self.ask(|between| job(between.device)).await
    }

    /// Timing record of the thread so far.
    pub(super) async fn pace(&self) -> Result<Pace, Stopped> {
        self.ask(|between| between.pace).await
    }

    /// Runs `job` on the network between socket and device, at the network's time.
    pub(super) async fn with_network<R: Send + 'static>(
        &self,
        job: impl FnOnce(&mut Option<Network>, Duration) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        self.ask(|between| Relay::change(between.relay, between.now, job))
            .await
    }

    async fn ask<R: Send + 'static>(
        &self,
        job: impl FnOnce(Between<'_, D>) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        let (answer, result) = oneshot::channel();
        let job: Job<D> = Box::new(move |between| {
            // The future that waits for the answer may have been dropped.
            let _ = answer.send(job(between));
        });
        self.jobs.send(job).await.map_err(|_| Stopped)?;
        result.await.map_err(|_| Stopped)
    }

    /// Closes the sockets of the stream, and returns when no more orders can come.
    pub(super) async fn close(mut self) {
        self.server.abort();
        // An aborted task ends with an error, which is intended here.
        let _ = (&mut self.server).await;
    }
}

impl<D> fmt::Debug for Service<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut service = f.debug_struct("Service");
        service.field("address", &self.address);
        service.finish_non_exhaustive()
    }
}

impl<D> Drop for Service<D> {
    fn drop(&mut self) {
        self.server.abort();
    }
}

/// Number of client messages, and of jobs, that may wait for the thread. The thread processes some
/// of them every millisecond.
const QUEUE: usize = 64;
