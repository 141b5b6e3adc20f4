//! WebSocket server that shows a recording live in Foxglove.

use core::fmt;
use core::net::SocketAddr;
use std::sync::Arc;
use std::thread;

use foxglove::{
    Context, PartialMetadata, RawChannel, Schema, WebSocketServer, WebSocketServerHandle,
};
use tokio::runtime::{Builder, Runtime};

use super::encoder::Message;
use super::error::RecordError;
use super::options::Robot;
use crate::schema::{DESCRIPTORS, Topic};

/// Settings of the server that shows a recording live in Foxglove.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Live {
    /// Address of the server. The default, `127.0.0.1:8765`, is also Foxglove's default. Every
    /// client that can connect to this address can watch the robots. The server accepts no
    /// commands.
    pub address: SocketAddr,
    /// Interval between the cycles that are sent: the server sends every n-th cycle. The default is
    /// 20, which gives 50 cycles per second. The server sends all messages of the other channels.
    pub every: u32,
}

impl Default for Live {
    fn default() -> Self {
        Self {
            address: SocketAddr::from(([127, 0, 0, 1], 8765)),
            every: 20,
        }
    }
}

pub(super) struct Server {
    /// Runtime on a separate thread. Neither the recorder's thread nor the program waits for a
    /// viewer.
    runtime: Option<Runtime>,
    handle: Option<WebSocketServerHandle>,
    context: Arc<Context>,
    /// The channels of each robot, by topic.
    channels: Vec<Vec<Arc<RawChannel>>>,
    every: u32,
    /// Number of cycles so far, of all robots.
    cycles: u32,
}

impl Server {
    pub(super) fn start(live: &Live) -> Result<(Self, SocketAddr), RecordError> {
        if live.every == 0 {
            return Err(RecordError::Option {
                what: "live.every",
                got: "0".to_owned(),
                expected: "1 or more",
            });
        }
        let mut address = live.address;
        let host = match address {
            SocketAddr::V4(address) => address.ip().to_string(),
            SocketAddr::V6(address) => format!("[{}]", address.ip()),
        };
        let context = Context::new();
        let server = WebSocketServer::new()
            .name("franka-record")
            .context(&context)
            .message_backlog_size(BACKLOG)
            .bind(host, address.port());
        // Runs on a separate thread, because the current thread may belong to a runtime.
        let started = thread::scope(|scope| {
            let start = scope.spawn(|| {
                let runtime = Builder::new_multi_thread()
                    .worker_threads(1)
                    .thread_name("franka-live")
                    .enable_all()
                    .build()
                    .map_err(|error| error.to_string())?;
                let server = server.tokio_runtime(runtime.handle());
                let handle = runtime.block_on(server.start());
                Ok((runtime, handle.map_err(|error| error.to_string())?))
            });
            start.join().expect("no panic")
        });
        let (runtime, handle) = started.map_err(|reason: String| RecordError::Live {
            address: live.address,
            reason,
        })?;
        address.set_port(handle.port());
        let server = Self {
            runtime: Some(runtime),
            handle: Some(handle),
            context,
            channels: Vec::new(),
            every: live.every,
            cycles: 0,
        };
        Ok((server, address))
    }

    /// Adds the channels of the next robot.
    pub(super) fn add_robot(&mut self, robot: &Robot) -> Result<(), RecordError> {
        let channels = Topic::ALL.map(|topic| {
            let schema = Schema::new(topic.schema(), "protobuf", DESCRIPTORS);
            self.context
                .channel_builder(topic.channel(&robot.name))
                .message_encoding("protobuf")
                .schema(schema)
                .build_raw()
                .map_err(|error| RecordError::Encode {
                    reason: error.to_string(),
                })
        });
        let channels = channels.into_iter().collect::<Result<_, _>>()?;
        self.channels.push(channels);
        Ok(())
    }

    /// Sends a message to the viewers that subscribed to its channel. This method never waits;
    /// instead, a slow viewer loses the oldest messages.
    pub(super) fn send(&mut self, message: &Message) {
        if message.topic == Topic::Cycle {
            self.cycles = self.cycles.wrapping_add(1);
            if !self.cycles.is_multiple_of(self.every) {
                return;
            }
        }
        let robot = self.channels.get(message.robot);
        if let Some(channel) = robot.and_then(|channels| channels.get(message.topic as usize)) {
            let time = PartialMetadata {
                log_time: Some(message.time.as_nanos()),
            };
            channel.log_with_meta(&message.data, time);
        }
    }
}

impl Drop for Server {
    /// Ends the connections, without waiting for viewers.
    fn drop(&mut self) {
        if let Some(handle) = self.handle.take() {
            drop(handle.stop());
        }
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

impl fmt::Debug for Server {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Server")
            .field("robots", &self.channels.len())
            .finish_non_exhaustive()
    }
}

/// Largest number of messages that wait for a viewer. This is two seconds of all channels of one
/// robot.
const BACKLOG: usize = 512;
