//! A server before a simulated robot, and a viewer of it that is no browser.

use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

use franka_async::{Realtime, Robot};
use franka_dash::Options;
use franka_sim::{Running, Sim};
use serde_json::{Value, json};
use tokio::runtime::Runtime;
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// A server, the robot that it shows, and the simulator of that.
pub(crate) struct Served {
    pub(crate) address: SocketAddr,
    pub(crate) robot: Robot,
    runtime: Runtime,
    _running: Arc<Running>,
}

impl Served {
    /// A server with these options, which may know the simulator.
    pub(crate) fn new(options: impl FnOnce(&Arc<Running>) -> Options) -> Self {
        let runtime = Runtime::new().expect("a runtime");
        let (address, robot, running) = runtime.block_on(async {
            let sim = Sim::fr3().wait_for_commands(Duration::from_millis(500));
            let running = Arc::new(sim.start().await.expect("a simulated robot"));
            let builder = Robot::builder(running.addr()).realtime(Realtime::Ignore);
            let robot = builder.connect().await.expect("a connection");
            let options = options(&running);
            let here = "127.0.0.1:0".parse().expect("an address");
            let listener = franka_dash::bind(here, &options).await.expect("a port");
            let address = listener.local_addr().expect("an address");
            let router = franka_dash::router(robot.clone(), options);
            tokio::spawn(async move { axum::serve(listener, router).await });
            (address, robot, running)
        });
        Self {
            address,
            robot,
            runtime,
            _running: running,
        }
    }

    pub(crate) fn movable() -> Self {
        Self::new(|running| Options::default().allow_motion().simulated(running))
    }

    pub(crate) fn height(&self) -> f64 {
        self.robot.pose().translation.z
    }

    /// Waits until the arm rests, which it has to within a few seconds.
    pub(crate) fn wait_for_rest(&self) {
        let begin = Instant::now();
        let moving = |dq: &f64| dq.abs() > 2e-3;
        while self.robot.state().motion_running() || self.robot.state().dq.iter().any(moving) {
            assert!(
                begin.elapsed() < Duration::from_secs(10),
                "the arm still moves"
            );
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.runtime.block_on(self.robot.shutdown());
    }
}

/// A viewer.
pub(crate) struct Viewer {
    socket: WebSocket<TcpStream>,
    /// The newest frame.
    pub(crate) frame: Vec<u8>,
    pub(crate) holding: bool,
    pub(crate) commander: Option<u64>,
    pub(crate) number: u64,
}

impl Viewer {
    pub(crate) fn connect(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).expect("a connection");
        let timeout = Some(Duration::from_secs(10));
        stream.set_read_timeout(timeout).expect("a timeout");
        let request = format!("ws://{address}/ws");
        let request = request.into_client_request().expect("a request");
        let (socket, _) = tungstenite::client(request, stream).expect("a socket");
        let mut viewer = Self {
            socket,
            frame: Vec::new(),
            holding: false,
            commander: None,
            number: 0,
        };
        let hello = viewer.wait_for("hello");
        viewer.number = hello["viewer"].as_u64().expect("a number");
        // The first frame, so that a round trip has been measured.
        viewer.wait_for("frame");
        viewer.wait_for("frame");
        viewer
    }

    pub(crate) fn send(&mut self, request: Value) {
        self.send_text(&request.to_string());
    }

    pub(crate) fn send_text(&mut self, text: &str) {
        let sent = self.socket.send(Message::text(text));
        sent.expect("the server reads");
    }

    /// The next message, acknowledged if it is a frame; `None` when the server has closed.
    pub(crate) fn read(&mut self) -> Option<Value> {
        match self.socket.read() {
            Ok(Message::Binary(frame)) => {
                let server_ms = u64::from_le_bytes(frame[8..16].try_into().expect("eight bytes"));
                self.frame = frame.to_vec();
                self.send(json!({"type": "seen", "server_ms": server_ms}));
                Some(json!({"type": "frame"}))
            }
            Ok(Message::Text(text)) => {
                let message: Value = serde_json::from_str(&text).expect("JSON");
                if message["type"] == "status" {
                    self.holding = message["holding"] == true;
                    self.commander = message["commander"].as_u64();
                }
                Some(message)
            }
            Ok(_) => Some(Value::Null),
            Err(tungstenite::Error::Io(error)) => panic!("no message: {error}"),
            Err(_) => None,
        }
    }

    /// The next message, without an acknowledgement.
    pub(crate) fn read_only(&mut self) -> Message {
        self.socket.read().expect("a message")
    }

    /// Reads on to a message of this type.
    pub(crate) fn wait_for(&mut self, kind: &str) -> Value {
        loop {
            let message = self.read().expect("the server has closed");
            if message["type"] == kind {
                return message;
            }
        }
    }

    pub(crate) fn refusal(&mut self) -> String {
        let refused = self.wait_for("refused");
        refused["why"].as_str().expect("a text").to_owned()
    }

    pub(crate) fn take(&mut self) {
        self.send(json!({"type": "take", "name": "a test"}));
        while self.commander != Some(self.number) {
            self.wait_for("status");
        }
    }

    /// Begins a hold, as often as the machine is too busy for it, and goes on until `reached`.
    /// Returns the number of the next message of the hold, which goes on.
    pub(crate) fn hold_until(&mut self, motion: &Value, reached: impl Fn() -> bool) -> u32 {
        let begin = Instant::now();
        loop {
            self.send(json!({"type": "begin", "motion": motion, "speed": 0.1}));
            let mut last = Instant::now();
            for seq in 1.. {
                while last.elapsed() < Duration::from_millis(30) {
                    self.wait_for("frame");
                }
                last = Instant::now();
                self.send(json!({"type": "hold", "seq": seq}));
                if reached() {
                    self.wait_for("frame");
                    if self.holding {
                        return seq + 1;
                    }
                }
                assert!(
                    begin.elapsed() < Duration::from_secs(60),
                    "it does not move"
                );
                if !self.holding && seq > 4 {
                    break;
                }
            }
        }
    }
}
