//! A server with a simulated robot, and a viewer that is not a browser.

use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::extract::ConnectInfo;
use axum::{Extension, Router};
use franka_async::gripper::Gripper;
use franka_async::settings::Load;
use franka_async::{Realtime, Robot};
use franka_dash::Options;
use franka_sim::{Fingers, Running, Sim, Tool};
use serde_json::{Value, json};
use tokio::runtime::Runtime;
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// A server, its robot, and the robot's simulator.
pub(crate) struct Served {
    pub(crate) address: SocketAddr,
    pub(crate) robot: Robot,
    pub(crate) running: Arc<Running>,
    options: Options,
    runtime: Runtime,
}

impl Served {
    /// Starts a server with these options, which may use the simulator.
    pub(crate) fn new(options: impl FnOnce(&Arc<Running>) -> Options) -> Self {
        Self::start(Sim::fr3(), async |running| options(running))
    }

    /// Starts a server to which all requests come from this address.
    pub(crate) fn seen_from(peer: SocketAddr, options: Options) -> Self {
        let peer = Extension(ConnectInfo(peer));
        Self::start_as(Sim::fr3(), async |_| options, |page| page.layer(peer))
    }

    /// Starts a server with all permissions for an ideal arm with a Hand. It records to `folder`. A
    /// hold survives a busy machine.
    pub(crate) fn equipped(folder: &Path) -> Self {
        let sim = Sim::fr3().ideal().tool(Tool::hand());
        Self::start(sim.hand(Fingers::new(), 0), async |running| {
            let hand = running.hand().expect("a hand").addr();
            let gripper = Gripper::connect(hand).await.expect("a connection");
            let options = Options::default().allow_motion().simulated(running);
            let options = options.gripper(gripper).record_to(folder);
            options.patience(Duration::from_secs(30))
        })
    }

    fn start(sim: Sim, options: impl AsyncFnOnce(&Arc<Running>) -> Options) -> Self {
        Self::start_as(sim, options, |page| page)
    }

    fn start_as(
        sim: Sim,
        options: impl AsyncFnOnce(&Arc<Running>) -> Options,
        page: impl FnOnce(Router) -> Router,
    ) -> Self {
        let runtime = Runtime::new().expect("a runtime");
        let (address, robot, running, options) = runtime.block_on(async {
            let sim = sim.wait_for_commands(Duration::from_millis(500));
            let running = Arc::new(sim.start().await.expect("a simulated robot"));
            let builder = Robot::builder(running.addr()).realtime(Realtime::Ignore);
            let robot = builder.connect().await.expect("a connection");
            let options = options(&running).await;
            let here = "127.0.0.1:0".parse().expect("an address");
            let listener = franka_dash::bind(here, &options).await.expect("a port");
            let address = listener.local_addr().expect("an address");
            let router = page(franka_dash::router(robot.clone(), options.clone()));
            let router = router.into_make_service_with_connect_info::<SocketAddr>();
            tokio::spawn(axum::serve(listener, router).into_future());
            (address, robot, running, options)
        });
        Self {
            address,
            robot,
            running,
            options,
            runtime,
        }
    }

    /// Runs a function with the simulated robot.
    pub(crate) fn with<R: Send + 'static>(
        &self,
        job: impl FnOnce(&mut franka_sim::Robot) -> R + Send + 'static,
    ) -> R {
        let done = self.runtime.block_on(self.running.with(job));
        done.expect("it runs")
    }

    /// Declares a load of this mass, `[kg]`.
    pub(crate) fn set_load(&self, m_load: f64) {
        let load = Load {
            m_load,
            F_x_Cload: [0.0; 3],
            I_load: [1e-3, 0.0, 0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 1e-3],
        };
        let set = self.runtime.block_on(self.robot.set_load(load));
        set.expect("the robot takes it");
    }

    /// Ends the connection, and waits until the recordings are written.
    pub(crate) fn shut_down(&self) {
        self.runtime.block_on(self.robot.shutdown());
        self.runtime.block_on(self.options.recordings_ended());
    }

    /// Starts a server with all permissions for a robot in virtual time.
    pub(crate) fn in_virtual_time() -> Self {
        let sim = Sim::fr3().virtual_time(Duration::from_millis(1));
        Self::start(sim, async |running| {
            Options::default().allow_motion().simulated(running)
        })
    }

    pub(crate) fn movable() -> Self {
        Self::new(|running| Options::default().allow_motion().simulated(running))
    }

    pub(crate) fn height(&self) -> f64 {
        self.robot.pose().translation.z
    }

    /// Waits until the arm is at rest, for at most a few seconds.
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
    /// Number of refused requests.
    pub(crate) refused: usize,
    /// The newest status.
    status: Value,
    pub(crate) commander: Option<u64>,
    pub(crate) number: u64,
    /// The first message.
    pub(crate) hello: Value,
}

impl Viewer {
    pub(crate) fn connect(address: SocketAddr) -> Self {
        Self::connect_to(address, "ws")
    }

    /// Connects to the socket at this path.
    pub(crate) fn connect_to(address: SocketAddr, path: &str) -> Self {
        let mut viewer = Self::greeted(address, path);
        // Waits for the first frame, so that a round trip has been measured.
        viewer.wait_for("frame");
        viewer.wait_for("frame");
        viewer
    }

    /// Connects, and reads only the greeting.
    pub(crate) fn greeted(address: SocketAddr, path: &str) -> Self {
        let stream = TcpStream::connect(address).expect("a connection");
        let timeout = Some(Duration::from_secs(10));
        stream.set_read_timeout(timeout).expect("a timeout");
        let request = format!("ws://{address}/{path}");
        let request = request.into_client_request().expect("a request");
        let (socket, _) = tungstenite::client(request, stream).expect("a socket");
        let mut viewer = Self {
            socket,
            frame: Vec::new(),
            holding: false,
            refused: 0,
            status: Value::Null,
            commander: None,
            number: 0,
            hello: Value::Null,
        };
        viewer.hello = viewer.wait_for("hello");
        viewer.number = viewer.hello["viewer"].as_u64().expect("a number");
        viewer
    }

    pub(crate) fn send(&mut self, request: Value) {
        self.send_text(&request.to_string());
    }

    pub(crate) fn send_text(&mut self, text: &str) {
        let sent = self.socket.send(Message::text(text));
        sent.expect("the server reads");
    }

    /// Returns the next message, and acknowledges it if it is a frame. `None` if the server has
    /// closed the connection.
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
                    self.status = message.clone();
                }
                self.refused += usize::from(message["type"] == "refused");
                Some(message)
            }
            Ok(_) => Some(Value::Null),
            Err(tungstenite::Error::Io(error)) => panic!("no message: {error}"),
            Err(_) => None,
        }
    }

    /// Returns the next message, without an acknowledgement.
    pub(crate) fn read_only(&mut self) -> Message {
        self.socket.read().expect("a message")
    }

    /// Reads until a message of this type arrives, and returns it.
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

    /// Reads until an event arrives whose line contains this text.
    pub(crate) fn event(&mut self, text: &str) {
        let begin = Instant::now();
        loop {
            let message = self.read().expect("the server has closed");
            let told = message["text"]
                .as_str()
                .filter(|_| message["type"] == "event");
            if told.is_some_and(|it| it.contains(text)) {
                return;
            }
            assert!(begin.elapsed() < LONGEST, "nothing is told of: {text}");
        }
    }

    /// Reads messages of this type until `wanted` is true for one of them.
    pub(crate) fn wait_until(&mut self, kind: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        let begin = Instant::now();
        loop {
            let message = self.wait_for(kind);
            if wanted(&message) {
                return message;
            }
            assert!(begin.elapsed() < LONGEST, "{kind}: {message}");
        }
    }

    /// Reads until `wanted` is true for the newest status.
    pub(crate) fn wait_for_status(&mut self, wanted: impl Fn(&Value) -> bool) {
        let begin = Instant::now();
        while !wanted(&self.status) {
            assert!(begin.elapsed() < LONGEST, "{}", self.status);
            self.read().expect("the server has closed");
        }
    }

    /// Begins a hold, and continues it until `reached` is true. Tries again if the machine was too
    /// busy. Returns the number of the next message of the hold, which is still active.
    pub(crate) fn hold_until(&mut self, motion: &Value, reached: impl Fn() -> bool) -> u32 {
        let begin = Instant::now();
        loop {
            self.send(json!({"type": "begin", "motion": motion, "speed": 0.1}));
            if let Some(next) = self.go_on_until(1, &reached) {
                return next;
            }
            assert!(begin.elapsed() < LONGEST, "it does not move");
        }
    }

    /// Continues a hold from this message until `reached` is true; `None` if the hold has ended.
    pub(crate) fn go_on_until(&mut self, next: u32, reached: impl Fn() -> bool) -> Option<u32> {
        let begin = Instant::now();
        let mut last = begin;
        for seq in next.. {
            while last.elapsed() < Duration::from_millis(30) {
                self.wait_for("frame");
            }
            last = Instant::now();
            self.send(json!({"type": "hold", "seq": seq}));
            if reached() {
                self.wait_for("frame");
                if self.holding {
                    return Some(seq + 1);
                }
            }
            assert!(begin.elapsed() < LONGEST, "it does not come to that");
            if !self.holding && seq > 4 {
                break;
            }
        }
        None
    }
}

/// Time limit for slow steps on a busy machine.
pub(crate) const LONGEST: Duration = Duration::from_secs(60);
