use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use franka_model::JointVector;
use franka_proto::framing::next_message;
use franka_proto::{Request, RobotError, RobotMode, RobotState, Version, client};

use super::*;
use crate::network::Conditions;
use crate::robot::Touch;

/// Time limit for every event, long enough for a busy machine.
pub(super) const SOON: Duration = Duration::from_secs(300);

struct Client {
    stream: TcpStream,
    session: client::Session,
    socket: UdpSocket,
}

impl Client {
    fn connect(address: SocketAddr) -> Self {
        Self::try_connect(address).expect("a handshake")
    }

    fn try_connect(address: SocketAddr) -> std::io::Result<Self> {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
        socket.set_read_timeout(Some(SOON)).expect("a timeout");
        let mut stream = TcpStream::connect(address)?;
        stream.set_read_timeout(Some(SOON))?;
        let mut session = client::Session::new(Version::V10);
        let port = socket.local_addr().expect("an address").port();
        stream.write_all(session.connect(port).as_bytes())?;
        let mut reply = [0; 15];
        stream.read_exact(&mut reply)?;
        let message = next_message(&reply).expect("whole").expect("complete");
        session.on_message(message).expect("an answer");
        assert!(session.is_connected());
        Ok(Self {
            stream,
            session,
            socket,
        })
    }

    fn state(&self) -> RobotState {
        let mut buffer = [0; RobotState::MAX_SIZE];
        let received = loop {
            match self.socket.recv(&mut buffer) {
                // The process was stopped during the call.
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                received => break received,
            }
        };
        let length = received.expect("a state");
        RobotState::decode(Version::V10, &buffer[..length]).expect("a state")
    }
}

/// Waits for this number of milliseconds in robot time, and returns the state at the end.
pub(super) async fn robot_time(sim: &Running, milliseconds: u64) -> RobotState {
    let begun = Instant::now();
    let mut state = sim.state().await.expect("running");
    let end = state.message_id + milliseconds;
    while state.message_id < end {
        assert!(begun.elapsed() < SOON, "its time stands still");
        tokio::time::sleep(Duration::from_millis(1)).await;
        state = sim.state().await.expect("running");
    }
    state
}

pub(super) fn runtime() -> tokio::runtime::Runtime {
    tokio::runtime::Builder::new_multi_thread()
        .worker_threads(1)
        .enable_all()
        .build()
        .expect("a runtime")
}

#[test]
fn states_keep_coming_while_the_runtime_is_blocked() {
    let runtime = runtime();
    // The simulator is ahead of the client only by as much as the client's socket can hold.
    let (read, reads) = std::sync::mpsc::channel();
    (0..10).for_each(|_| read.send(()).expect("a receiver"));
    let mut served = false;
    let sim = Sim::fr3().every_millisecond(move |robot| {
        served |= robot.is_connected();
        // If there is no sender, the test has ended.
        let _ = served.then(|| reads.recv());
    });
    let sim = runtime.block_on(sim.start()).expect("a robot");
    let client = Client::connect(sim.addr());
    let (release, released) = std::sync::mpsc::channel::<()>();
    let (blocking, blocked) = std::sync::mpsc::channel();
    runtime.spawn(async move {
        blocking.send(()).expect("the test waits");
        // The only thread of the runtime waits for the end of the test.
        let _ = released.recv();
    });
    blocked.recv().expect("the runtime runs the task");
    let first = client.state().message_id;
    for later in 1..=200 {
        read.send(()).expect("a receiver");
        assert_eq!(client.state().message_id, first + later);
    }
    drop((read, release));
}

#[test]
fn jobs_before_and_after_each_state_miss_none() {
    let (sender, seen) = std::sync::mpsc::channel();
    let before = sender.clone();
    // This send fails after the test has ended.
    let sim = Sim::fr3().every_millisecond(move |robot| {
        let _ = before.send(("before", robot.state().message_id));
    });
    let sim = sim.after_each_state(move |robot| {
        let _ = sender.send(("after", robot.state().message_id));
    });
    let runtime = runtime();
    let _sim = runtime.block_on(sim.start()).expect("a robot");
    let seen: Vec<_> = seen.iter().take(100).collect();
    let (_, first) = seen[0];
    let expected = (first..).flat_map(|id| [("before", id), ("after", id + 1)]);
    let expected: Vec<_> = expected.take(100).collect();
    assert_eq!(seen, expected);
}

#[test]
fn robots_in_step_share_each_millisecond_until_one_stops() {
    let counts = [0, 1].map(|_| Arc::new(AtomicU64::new(0)));
    let apart = Arc::new(AtomicU64::new(0));
    let counting = |number: usize| {
        let (counts, apart) = (counts.clone(), apart.clone());
        move |_: &mut Robot| {
            let own = counts[number].fetch_add(1, Ordering::SeqCst) + 1;
            let other = counts[1 - number].load(Ordering::SeqCst);
            apart.fetch_max(own.abs_diff(other), Ordering::SeqCst);
        }
    };
    // Without synchronisation, this robot would be up to ten times as fast as the second robot.
    let fast = Sim::fr3().virtual_time(Duration::from_millis(1));
    let sims = [fast, Sim::fer()];
    let [first, second] = Sim::in_step(sims);
    let sims = [
        first.every_millisecond(counting(0)),
        second.every_millisecond(counting(1)),
    ];
    runtime().block_on(async {
        let [first, second] = sims;
        let first = first.start().await.expect("a robot");
        tokio::time::sleep(Duration::from_millis(20)).await;
        assert_eq!(
            counts[0].load(Ordering::SeqCst),
            0,
            "it waits for the other"
        );
        let second = second.start().await.expect("a robot");
        robot_time(&first, 200).await;
        assert_eq!(apart.load(Ordering::SeqCst), 1);
        first.stop().await;
        robot_time(&second, 50).await;
        second.stop().await;
    });
}

#[test]
fn second_client_is_reset_and_the_next_one_served() {
    let runtime = runtime();
    let sim = runtime.block_on(Sim::fr3().start()).expect("a robot");
    let first = Client::connect(sim.addr());
    let refused = Client::try_connect(sim.addr()).map(drop);
    let kind = refused.expect_err("the robot has a client").kind();
    assert_eq!(kind, ErrorKind::ConnectionReset);
    first.state();
    drop(first);
    // The client reconnects at once, while the old connection is still closing.
    for _ in 0..5 {
        Client::connect(sim.addr()).state();
    }
}

#[test]
fn silent_connection_is_closed_and_blocks_no_client() {
    let runtime = runtime();
    let sim = runtime.block_on(Sim::fr3().start()).expect("a robot");
    let mut silent = TcpStream::connect(sim.addr()).expect("a listener");
    Client::connect(sim.addr()).state();
    assert_eq!(silent.read(&mut [0; 1]).expect("an orderly end"), 0);
}

#[test]
fn garbage_closes_the_connection_and_the_robot_stays() {
    let runtime = runtime();
    let sim = runtime.block_on(Sim::fr3().start()).expect("a robot");
    let mut stream = TcpStream::connect(sim.addr()).expect("a listener");
    stream.set_read_timeout(Some(SOON)).expect("a timeout");
    stream.write_all(&[0xff; 100]).expect("an open stream");
    assert_eq!(stream.read_to_end(&mut Vec::new()).expect("its end"), 0);
    Client::connect(sim.addr()).state();
}

#[test]
fn a_client_that_does_not_read_makes_room_for_the_next() {
    let runtime = runtime();
    let sim = runtime.block_on(Sim::fr3().start()).expect("a robot");
    let mut deaf = Client::connect(sim.addr());
    let pause = Some(Duration::from_millis(200));
    deaf.stream.set_write_timeout(pause).expect("a timeout");
    deaf.socket.set_read_timeout(pause).expect("a timeout");
    deaf.stream.set_nodelay(true).expect("an option");
    // Copies of the long description fill every buffer on the path. The client requests only a few
    // per state, because a burst would end the session at once.
    let is_connected = || runtime.block_on(sim.with(|robot| robot.is_connected()));
    let (begun, mut room) = (Instant::now(), true);
    while is_connected().expect("running") {
        assert!(begun.elapsed() < SOON, "it keeps its place");
        for _ in 0..4 {
            let request = deaf.session.request(&Request::GetRobotModel);
            let request = request.expect("a request");
            deaf.session.abandon(request.id());
            room = room && deaf.stream.write_all(request.as_bytes()).is_ok();
        }
        let _ = deaf.socket.recv(&mut []);
    }
    Client::connect(sim.addr()).state();
}

#[test]
fn jobs_reach_the_robot_and_stopping_frees_the_port() {
    let runtime = runtime();
    runtime.block_on(async {
        let sim = Sim::fr3().start().await.expect("a robot");
        let address = sim.addr();
        sim.with(|robot| robot.press_user_stop(true))
            .await
            .expect("running");
        let state = robot_time(&sim, 20).await;
        assert_eq!(state.robot_mode, RobotMode::UserStopped);
        assert!(sim.pace().await.expect("running").cycles > 0);
        sim.stop().await;
        let again = Sim::fr3().bind(address).start().await;
        assert!(again.is_ok(), "{again:?}");
    });
}

#[test]
fn a_person_beside_the_robot_reaches_it_from_any_task() {
    let runtime = runtime();
    runtime.block_on(async {
        let sim = Sim::fr3()
            .hand(Fingers::new(), 0)
            .realtime(true)
            .start()
            .await
            .expect("a robot");
        let mode = async |sim: &Running| robot_time(sim, 20).await.robot_mode;
        sim.with(|robot| robot.close_brakes())
            .await
            .expect("running");
        assert_eq!(mode(&sim).await, RobotMode::Other);
        let guided = sim.with(|robot| {
            robot.open_brakes();
            robot.guide(true)
        });
        assert!(guided.await.expect("running"));
        assert_eq!(mode(&sim).await, RobotMode::Guiding);
        let torque = JointVector::from([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let push = sim.with(move |robot| robot.touch(Touch::torque(torque)));
        let push = push.await.expect("running");
        assert!(robot_time(&sim, 100).await.q[6] > franka_model::READY[6]);
        let released = sim.with(move |robot| {
            robot.guide(false);
            robot.release(push)
        });
        assert!(released.await.expect("running"));
        robot_time(&sim, 100).await;
        sim.with(|robot| robot.activate_safety_function(true))
            .await
            .expect("running");
        assert_eq!(mode(&sim).await, RobotMode::UserStopped);
        let tripped = sim.with(|robot| {
            robot.activate_safety_function(false);
            robot.trip(RobotError::JointReflex);
        });
        tripped.await.expect("running");
        assert_eq!(mode(&sim).await, RobotMode::Reflex);
        let hand = sim.hand().expect("a hand");
        let placed = hand.with(|hand| hand.mechanism_mut().place_object(0.04));
        assert_eq!(placed.await, Ok(true));
        let taken = hand.with(|hand| hand.mechanism_mut().take_object());
        assert_eq!(taken.await, Ok(Some(0.04)));
        sim.stop().await;
    });
}

#[test]
fn a_simulation_that_dies_says_so_and_closes_its_port() {
    let runtime = runtime();
    runtime.block_on(async {
        let sim = Sim::fr3().start().await.expect("a robot");
        let still = tokio::time::timeout(Duration::from_millis(20), sim.ended());
        still.await.expect_err("it runs");
        let died = sim.with(|_| panic!("by a test")).await;
        assert_eq!(died, Err(Stopped));
        sim.ended().await;
        sim.ended().await;
        let address = sim.addr();
        sim.stop().await;
        assert!(TcpStream::connect(address).is_err());
    });
}

#[test]
fn states_to_clients_pass_the_simulated_network() {
    let runtime = runtime();
    let delay = Duration::from_millis(30);
    let late = Conditions {
        delay,
        ..Conditions::default()
    };
    let network = Network::new(1, late, Conditions::default());
    let sim = Sim::fr3().network(network);
    let sim = runtime.block_on(sim.start()).expect("a robot");
    let newest = || runtime.block_on(sim.state()).expect("running").message_id;
    let client = Client::connect(sim.addr());
    for _ in 0..20 {
        let asked = Instant::now();
        let published = newest();
        // The answer may come within a cycle, so only the second state after it is certainly later.
        while client.state().message_id <= published + 1 {}
        assert!(asked.elapsed() >= delay, "{:?}", asked.elapsed());
    }
    let before = newest();
    drop(client);
    // Datagrams in transit to one client must not reach the next client.
    let next = Client::connect(sim.addr());
    assert!(next.state().message_id > before);
}

#[test]
fn in_virtual_time_a_network_delays_by_the_time_of_the_robot() {
    let runtime = runtime();
    let late = Conditions {
        delay: Duration::from_micros(29_500),
        ..Conditions::default()
    };
    let sim = Sim::fr3().network(Network::new(1, late, Conditions::default()));
    let sim = sim.virtual_time(SOON);
    let sim = runtime.block_on(sim.start()).expect("a robot");
    let client = Client::connect(sim.addr());
    for _ in 0..20 {
        let arrived = client.state().message_id;
        let newest = runtime.block_on(sim.state()).expect("running").message_id;
        assert!(newest >= arrived + 29, "{newest}, {arrived}");
    }
}

#[test]
fn datagrams_cut_by_the_network_reach_no_client() {
    let runtime = runtime();
    let mut network = Network::perfect();
    network.to_client.cut(Duration::ZERO..Duration::MAX);
    let sim = Sim::fr3().network(network);
    let sim = runtime.block_on(sim.start()).expect("a robot");
    let client = Client::connect(sim.addr());
    runtime.block_on(robot_time(&sim, 200));
    client.socket.set_nonblocking(true).expect("an option");
    let heard = client.socket.recv(&mut []).map_err(|error| error.kind());
    assert_eq!(heard, Err(ErrorKind::WouldBlock));
}

#[test]
fn a_network_comes_changes_and_goes_while_the_robot_runs() {
    let runtime = runtime();
    let sim = runtime.block_on(Sim::fr3().start()).expect("a robot");
    let client = Client::connect(sim.addr());
    client.state();
    let delay = Duration::from_millis(30);
    let late = Conditions {
        delay,
        ..Conditions::default()
    };
    let set = move |network: &mut Option<Network>, time| {
        let before = network.replace(Network::new(1, late, Conditions::default()));
        (before.is_some(), time)
    };
    let set = runtime.block_on(sim.with_network(set));
    assert_eq!(set, Ok((false, Duration::ZERO)));
    for _ in 0..20 {
        let asked = Instant::now();
        let published = runtime.block_on(sim.state()).expect("running").message_id;
        while client.state().message_id <= published + 1 {}
        assert!(asked.elapsed() >= delay, "{:?}", asked.elapsed());
    }
    let cut = runtime.block_on(sim.with_network(|network, time| {
        let path = &mut network.as_mut().expect("the one above").to_client;
        path.cut(time..Duration::MAX);
        (time, path.conditions().delay)
    }));
    let (time, got) = cut.expect("running");
    assert!(time >= 20 * delay && got == delay, "{time:?}, {got:?}");
    runtime.block_on(robot_time(&sim, 100));
    client.socket.set_nonblocking(true).expect("an option");
    while client.socket.recv(&mut []).is_ok() {}
    runtime.block_on(robot_time(&sim, 100));
    let heard = client.socket.recv(&mut []).map_err(|error| error.kind());
    assert_eq!(heard, Err(ErrorKind::WouldBlock));
    client.socket.set_nonblocking(false).expect("an option");
    let gone = sim.with_network(|network, _| network.take().is_some());
    assert_eq!(runtime.block_on(gone), Ok(true));
    client.state();
}

#[test]
fn robots_are_realistic_unless_they_are_to_be_ideal() {
    for (sim, kind) in [(Sim::fr3(), RobotKind::Fr3), (Sim::fer(), RobotKind::Fer)] {
        assert_eq!(sim.config.chosen_arm(), Arm::realistic(kind));
        assert_eq!(sim.ideal().config.chosen_arm(), Arm::ideal(kind));
    }
}

/// A program keeps the future on a stack. The stack of a thread may have only 2 MiB, and builds
/// without optimisation copy the future from frame to frame.
#[test]
fn the_future_of_a_start_is_small() {
    let size = size_of_val(&Sim::fr3().start());
    assert!(size < 10_000, "{size} bytes");
}

#[test]
fn robots_share_a_process() {
    let runtime = runtime();
    let sims: Vec<_> = (0..3)
        .map(|_| runtime.block_on(Sim::fr3().start()).expect("a robot"))
        .collect();
    let clients: Vec<_> = sims.iter().map(|s| Client::connect(s.addr())).collect();
    for client in &clients {
        assert_eq!(client.state().robot_mode, RobotMode::Idle);
    }
}

/// The hand's server moves the fingers on the robot's flange, in the same process as the arm.
#[cfg(feature = "mujoco")]
#[test]
fn a_hand_on_sockets_moves_the_fingers_in_the_scene() {
    use crate::end_effector::{Fingers, Mechanism as _};
    use crate::plant::{MujocoArm, Scene};
    use franka_proto::gripper;

    /// Returns the distance between the fingers in the scene, `[m]`.
    async fn gap(sim: &Running) -> f64 {
        sim.with(|robot| {
            let plant: &dyn std::any::Any = robot.plant();
            let arm = plant.downcast_ref::<MujocoArm>().expect("MuJoCo");
            let [left, right] = ["franka_finger_left", "franka_finger_right"]
                .map(|name| arm.body_pose(name).expect("a finger").translation.vector);
            (left - right).norm()
        })
        .await
        .expect("running")
    }

    let runtime = runtime();
    runtime.block_on(async {
        let scene = Scene::table().with_hand();
        let arm = MujocoArm::new(RobotKind::Fr3, scene).expect("a scene");
        let sim = Sim::fr3().tool(Tool::hand()).plant(arm);
        let sim = sim.hand(Fingers::new(), 0).start().await.expect("a robot");
        assert!((gap(&sim).await - Fingers::STROKE).abs() < 2e-3);
        let hand = sim.hand().expect("a hand");
        hand.with(|hand| hand.mechanism_mut().begin(&gripper::Request::Homing))
            .await
            .expect("running");
        let deadline = Instant::now() + SOON;
        while gap(&sim).await > 0.04 {
            assert!(Instant::now() < deadline, "the fingers do not close");
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
        let width = hand.with(|hand| hand.state().width).await.expect("running");
        assert!(width < 0.045, "{width} m");
    });
}
