//! Scenarios of the traced child: it controls a simulated robot in the same process, in every way.

use std::future::IntoFuture;
use std::net::{IpAddr, Ipv4Addr};
use std::ops::ControlFlow;
use std::os::fd::AsRawFd;
use std::os::unix::process::parent_id;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use franka_async::control::{
    Active, AsynchronousOptions, CartesianPose, CartesianVelocities, Control, Finish,
    JointPositions, JointVelocities, Next, Torques,
};
use franka_async::error::Lapse;
use franka_async::goal::{Backend, Chunk, Deadman, Free, Gains, OnTimeout, Setpoints, Tuning};
use franka_async::state::RobotState;
use franka_async::{Arm, Engage, Motion, MotionError, Pose, Realtime, Robot};
use franka_proto::{MoveControllerMode, RobotError, Version};
use franka_rt::driver::Driver;
use franka_rt::exchange;
use franka_rt::sched::Scheduling;
use franka_rt::thread::{self, ThreadConfig};
use franka_sim::{Running, Sim, Tool};
use franka_tests::PATIENCE;
use franka_tests::broken_socket::BrokenSocket;
use tokio::sync::watch;
use tokio::time::sleep;

/// Name of the thread that runs active control.
pub(crate) const ACTIVE: &str = "active-control";

/// A simulated FR3, which waits for each command, as tracing makes them late, and a handle on it.
async fn simulated() -> (Robot, Running) {
    let sim = Sim::fr3().ideal().tool(Tool::hand()).virtual_time(PATIENCE);
    let sim = sim.start().await.expect("a simulator starts");
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = builder.connect().await.expect("it takes a client");
    (robot, sim)
}

/// A motion of some twenty seconds of robot time.
fn long_way(robot: &Robot) -> <Motion as IntoFuture>::IntoFuture {
    robot.move_to(above(robot, 0.1)).speed(0.05).into_future()
}

fn above(robot: &Robot, metres: f64) -> Pose {
    Pose::translation(0.0, 0.0, metres) * robot.pose()
}

/// Waits until the control thread has received this many more states.
async fn states(robot: &Robot, count: u64) {
    let states = &robot.stats().states;
    let end = states.get() + count;
    until(|| states.get() >= end).await;
}

async fn until(holds: impl Fn() -> bool) {
    while !holds() {
        sleep(Duration::from_millis(1)).await;
    }
}

/// Delays the simulator until `noticed` completes.
async fn in_silence<T>(sim: &Running, noticed: impl Future<Output = T>) -> T {
    let (go_on, held) = mpsc::channel::<()>();
    let noticed = async {
        let noticed = noticed.await;
        drop(go_on);
        noticed
    };
    let (silence, noticed) = tokio::join!(sim.with(move |_| held.recv()), noticed);
    silence
        .expect("it comes back")
        .expect_err("nothing is sent");
    noticed
}

/// No motion; then no states either.
pub(crate) async fn watching() {
    let (robot, sim) = simulated().await;
    states(&robot, 1000).await;
    let reading = robot.read(|_| ControlFlow::<()>::Continue(()));
    let lost = in_silence(&sim, reading).await;
    lost.expect_err("the link is lost");
    states(&robot, 300).await;
    robot.shutdown().await;
}

/// Targets of both kinds, superseded, updated, stopped, and lost with the link.
pub(crate) async fn targets() {
    let (robot, sim) = simulated().await;
    let start = robot.pose();
    let first = tokio::spawn(long_way(&robot));
    states(&robot, 300).await;
    let mut q = robot.state().q_d;
    q[0] += 0.1;
    robot.move_joints(q).await.expect("it arrives");
    first.await.expect("no panic").expect_err("superseded");

    let (sender, targets) = watch::channel(robot.pose());
    let following = tokio::spawn(robot.follow(targets).into_future());
    for step in 1..=5 {
        let pose = Pose::translation(0.0, 0.004 * f64::from(step), 0.0) * start;
        sender.send(pose).expect("the motion goes on");
        states(&robot, 100).await;
    }
    drop(sender);
    following.await.expect("no panic").expect("it arrives");

    let stopped = tokio::spawn(long_way(&robot));
    states(&robot, 400).await;
    robot.stop().await.expect("the arm rests");
    stopped.await.expect("no panic").expect_err("stopped");

    let lost = tokio::spawn(long_way(&robot));
    states(&robot, 400).await;
    let lost = in_silence(&sim, lost).await;
    lost.expect("no panic").expect_err("the link is lost");
    robot.shutdown().await;
}

/// Sessions of both backends with every kind of goal, an observer, a deadman and a stream that
/// times out.
pub(crate) async fn engaged() {
    let (robot, _sim) = simulated().await;
    let (engage, alive) = kept_alive();
    let arm = robot.engage(engage).await.expect("it begins");
    every_kind_of_goal(&robot, &arm).await;
    arm.guide(Free::ALL).await.expect("it floats");
    states(&robot, 500).await;
    let tuning = Tuning {
        gains: Some(Gains::cartesian()),
        budget: None,
        ..Tuning::default()
    };
    arm.tune(tuning).await.expect("gains within their bounds");
    states(&robot, 500).await;
    // The arm is held when the deadman times out.
    alive.store(false, Ordering::Relaxed);
    let held = arm.move_to(above(&robot, 0.1)).speed(0.05).await;
    assert_eq!(held, Err(MotionError::Held(Lapse::Deadman)));
    alive.store(true, Ordering::Relaxed);
    arm.disengage().await.expect("it ends");

    let (engage, _alive) = kept_alive();
    let backend = Backend::joint_impedance(Setpoints::JointPositions);
    let arm = robot.engage(engage.backend(backend)).await;
    let arm = arm.expect("it begins");
    every_kind_of_goal(&robot, &arm).await;
    arm.disengage().await.expect("it ends");
    robot.shutdown().await;
}

/// A session with a deadman that its observer keeps alive while the flag is set.
fn kept_alive() -> (Engage, Arc<AtomicBool>) {
    let (deadman, monitor) = Deadman::new(Duration::from_millis(500));
    let alive = Arc::new(AtomicBool::new(true));
    let seen = alive.clone();
    let engage = Engage::default().deadman(monitor).observer(move |_, _| {
        if seen.load(Ordering::Relaxed) {
            deadman.keep_alive();
        }
    });
    (engage, alive)
}

/// Joint positions, a chunk, and a stream of poses that times out.
async fn every_kind_of_goal(robot: &Robot, arm: &Arm) {
    let mut q = robot.state().q_d;
    q[0] += 0.05;
    arm.set(q).await.expect("the session takes it");
    states(robot, 500).await;
    let q = robot.state().q_d;
    let points = (0..6).map(|k| {
        let mut q = q;
        q[0] += 0.01 * f64::from(k);
        (Duration::from_millis(50) * k, q)
    });
    let chunk = Chunk::joints(points).expect("finite points");
    arm.chunk(chunk).await.expect("the session takes it");
    states(robot, 500).await;
    let (sender, targets) = watch::channel(robot.pose());
    let silence = Duration::from_millis(200);
    let following = arm.follow(targets).watchdog(silence, OnTimeout::Brake);
    let following = tokio::spawn(following.into_future());
    for step in 1..=3 {
        // On a slow host it has timed out before.
        let _ = sender.send(above(robot, 0.01 * f64::from(step)));
        states(robot, 100).await;
    }
    let lapse = following
        .await
        .expect("no panic")
        .expect_err("it is silent");
    assert!(
        matches!(lapse, MotionError::Braked(Lapse::Silent { .. })),
        "{lapse}"
    );
}

/// A control function that answers this many states with a command, and calls `also` each time.
fn holding<C: Finish + Copy + Send + 'static>(
    command: C,
    mut also: impl FnMut() + Send + 'static,
) -> impl FnMut(&RobotState, Duration) -> Next<C> + Send + 'static {
    let mut left = 200;
    move |_, _| {
        also();
        left -= 1;
        if left == 0 {
            command.finish()
        } else {
            command.into()
        }
    }
}

/// Control functions for the four generators that leave the arm where it is.
fn generators(robot: &Robot) -> [Control; 4] {
    let state = robot.state();
    let pose = CartesianPose {
        O_T_EE: state.O_T_EE_c,
        elbow: Some(state.elbow_c),
    };
    let twist = CartesianVelocities {
        O_dP_EE: [0.0; 6],
        elbow: None,
    };
    [
        robot.control_joint_positions(holding(JointPositions(state.q_d), || {})),
        robot.control_joint_velocities(holding(JointVelocities([0.0; 7]), || {})),
        robot.control_cartesian_pose(holding(pose, || {})),
        robot.control_cartesian_velocities(holding(twist, || {})),
    ]
}

/// Control functions of all nine kinds, with filter and limiter; then a function that causes a
/// reflex.
pub(crate) async fn functions() {
    let (robot, sim) = simulated().await;
    let torques = || holding(Torques([0.0; 7]), || {});
    let mut functions = vec![robot.control_torques(torques())];
    functions.extend(generators(&robot));
    functions.extend(generators(&robot).map(|function| function.with_torques(torques())));
    for function in functions {
        let report = function.limit_rate(true).await.expect("it finishes");
        assert!(report.duration > Duration::from_millis(100), "{report:?}");
    }
    let endless = |_: &RobotState, _: Duration| Next::from(Torques([0.0; 7]));
    let tripped = tokio::spawn(robot.control_torques(endless).into_future());
    states(&robot, 100).await;
    let trip = sim.with(|robot| robot.trip(RobotError::CartesianReflex));
    trip.await.expect("the simulator runs");
    let error = tripped.await.expect("no panic").expect_err("a reflex");
    let control = error.control().expect("ended by the robot");
    assert!(!control.log.is_empty(), "{control:?}");
    robot.recover().await.expect("it recovers");
    states(&robot, 200).await;
    robot.shutdown().await;
}

/// A thread of the user's program runs the cycle for a while.
pub(crate) async fn active() {
    let (robot, _sim) = simulated().await;
    let control = robot.active_torques().await.expect("it begins");
    let thread = std::thread::Builder::new().name(ACTIVE.into());
    let thread = thread.spawn(move || hold(control)).expect("a thread");
    let joined = tokio::task::spawn_blocking(|| thread.join());
    joined.await.expect("no panic").expect("no panic");
    // The driver's own thread has the cycle again.
    let up = above(&robot, 0.02);
    robot.move_to(up).await.expect("it arrives");
    robot.shutdown().await;
}

fn hold(mut control: Active<Torques>) {
    for _ in 0..1000 {
        control.read_once().expect("a state");
        let still = control.write_once(Torques([0.0; 7]));
        assert_eq!(still.expect("it takes the command"), None);
    }
    control.read_once().expect("a state");
    let end = control.write_once(Torques([0.0; 7]).finish());
    end.expect("it ends").expect("with a report");
}

/// Targets between which the robot itself plans.
pub(crate) async fn asynchronous() {
    let (robot, _sim) = simulated().await;
    let options = AsynchronousOptions::default();
    let control = robot.asynchronous_joint_positions(options).await;
    let control = control.expect("it begins");
    let mut q = robot.state().q_d;
    for way in [0.1, 0.1, -0.15] {
        q[0] += way;
        control.set_target(q).expect("it takes the target");
        states(&robot, 500).await;
    }
    control.reached().await.expect("it arrives");
    control.finish().await.expect("it ends");
    robot.shutdown().await;
}

/// A control thread whose receives fail, and whose borrower runs no turn.
pub(crate) async fn failing() {
    let robot = IpAddr::V4(Ipv4Addr::LOCALHOST);
    let socket = exchange::bind(robot).expect("a free port");
    let descriptor = socket.as_raw_fd();
    let config = ThreadConfig {
        scheduling: Scheduling {
            realtime: Realtime::Ignore,
            ..Scheduling::default()
        },
        ..ThreadConfig::default()
    };
    let version = Version::V10;
    let handle = thread::spawn(config, Driver::new(version), socket, robot, version);
    let handle = handle.expect("nothing is enforced");
    let broken = BrokenSocket::new(descriptor).expect("a descriptor");
    until(|| handle.stats.receive_errors.get() >= 1000).await;
    drop(broken);
    let lease = handle.lender.borrow().expect("the cycle is not lent");
    until(|| handle.thread.stalled().is_some()).await;
    drop(lease);
    until(|| handle.thread.stalled().is_none()).await;
    // The cycle is back with its thread.
    drop(handle.lender.borrow().expect("the cycle is not lent"));
    handle.thread.join().map(drop).expect("nothing panics");
}

/// A control function that makes another system call: `getppid`.
pub(crate) async fn asking() {
    let (robot, _sim) = simulated().await;
    let ask = || {
        std::hint::black_box(parent_id());
    };
    let asking = robot.control_joint_velocities(holding(JointVelocities([0.0; 7]), ask));
    let asking = asking.controller(MoveControllerMode::JointImpedance);
    asking.await.expect("it finishes");
    robot.shutdown().await;
}

/// A control function that writes to `/dev/null` instead of the eventfd.
pub(crate) async fn writing() {
    use std::io::Write;

    let (robot, _sim) = simulated().await;
    let nowhere = std::fs::OpenOptions::new().write(true).open("/dev/null");
    let mut nowhere = nowhere.expect("it is always there");
    let write = move || nowhere.write_all(b"a line of a log").expect("it fits");
    let writing = robot.control_joint_velocities(holding(JointVelocities([0.0; 7]), write));
    writing.await.expect("it finishes");
    robot.shutdown().await;
}
