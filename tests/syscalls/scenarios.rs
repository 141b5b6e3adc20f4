//! What the traced child does: it controls a simulated robot in the same process, in every way.

use std::future::IntoFuture;
use std::os::unix::process::parent_id;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use franka_async::control::{
    CartesianPose, CartesianVelocities, Finish, JointPositions, JointVelocities, Next, Torques,
};
use franka_async::error::Lapse;
use franka_async::goal::{Backend, Chunk, Deadman, Free, Gains, OnTimeout, Setpoints, Tuning};
use franka_async::{
    Active, Arm, AsynchronousOptions, Control, Engage, MotionError, Pose, Realtime, Robot,
    RobotState,
};
use franka_proto::{MoveControllerMode, RobotError};
use franka_sim::{Running, Sim, Tool};
use tokio::sync::watch;
use tokio::time::sleep;

/// Name of the thread that runs active control.
pub(crate) const ACTIVE: &str = "active-control";

/// A simulated FR3 and a handle on it. Tracing makes commands late, which this robot tolerates.
async fn simulated() -> (Robot, Running) {
    let sim = Sim::fr3().tool(Tool::hand());
    let sim = sim.enforce_limits(false).enforce_communication(false);
    let sim = sim.start().await.expect("a simulator starts");
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let builder = builder.link_timeout(Duration::from_millis(500));
    let robot = builder.connect().await.expect("it takes a client");
    (robot, sim)
}

fn above(robot: &Robot, metres: f64) -> Pose {
    Pose::translation(0.0, 0.0, metres) * robot.pose()
}

/// No motion; then no states either.
pub(crate) async fn watching() {
    let (robot, sim) = simulated().await;
    sleep(Duration::from_secs(1)).await;
    // Longer than the link timeout.
    let silence = sim.with(|_| std::thread::sleep(Duration::from_millis(900)));
    silence.await.expect("it comes back");
    sleep(Duration::from_millis(300)).await;
    robot.shutdown().await;
}

/// Targets of both kinds, superseded, updated, stopped, and lost with the link.
pub(crate) async fn targets() {
    let (robot, sim) = simulated().await;
    let start = robot.pose();
    let first = tokio::spawn(robot.move_to(above(&robot, 0.1)).into_future());
    sleep(Duration::from_millis(300)).await;
    let mut q = robot.state().q_d;
    q[0] += 0.1;
    robot.move_joints(q).await.expect("it arrives");
    first.await.expect("no panic").expect_err("superseded");

    let (sender, targets) = watch::channel(robot.pose());
    let following = tokio::spawn(robot.follow(targets).into_future());
    for step in 1..=5 {
        let pose = Pose::translation(0.0, 0.004 * f64::from(step), 0.0) * start;
        sender.send(pose).expect("the motion goes on");
        sleep(Duration::from_millis(100)).await;
    }
    drop(sender);
    following.await.expect("no panic").expect("it arrives");

    let stopped = tokio::spawn(robot.move_to(above(&robot, 0.1)).into_future());
    sleep(Duration::from_millis(400)).await;
    robot.stop().await.expect("the arm rests");
    stopped.await.expect("no panic").expect_err("stopped");

    let lost = tokio::spawn(robot.move_to(above(&robot, 0.1)).into_future());
    sleep(Duration::from_millis(400)).await;
    let silence = sim.with(|_| std::thread::sleep(Duration::from_millis(900)));
    silence.await.expect("it comes back");
    lost.await.expect("no panic").expect_err("the link is lost");
    robot.shutdown().await;
}

/// Sessions of both backends with every kind of goal, an observer, a deadman and a stream that
/// times out.
pub(crate) async fn engaged() {
    let (robot, _sim) = simulated().await;
    let (deadman, monitor) = Deadman::new(Duration::from_millis(500));
    let seen = Arc::new(AtomicU64::new(0));
    let count = seen.clone();
    let engage = Engage::default().deadman(monitor).observer(move |_, _| {
        count.fetch_add(1, Ordering::Relaxed);
    });
    let arm = robot.engage(engage).await.expect("it begins");
    every_kind_of_goal(&robot, &arm, &deadman).await;
    arm.guide(Free::ALL).await.expect("it floats");
    still(&deadman).await;
    let tuning = Tuning {
        gains: Some(Gains::cartesian()),
        budget: None,
        ..Tuning::default()
    };
    arm.tune(tuning).await.expect("gains within their bounds");
    still(&deadman).await;
    let records = seen.load(Ordering::Relaxed);
    assert!(records > 500, "{records} cycles seen");
    // The arm is held when the deadman times out.
    let held = arm.move_to(above(&robot, 0.1)).await;
    assert_eq!(held, Err(MotionError::Held(Lapse::Deadman)));
    deadman.keep_alive();
    arm.disengage().await.expect("it ends");

    let (deadman, monitor) = Deadman::new(Duration::from_millis(500));
    let backend = Backend::RobotController(Setpoints::Joints);
    let engage = Engage::default().deadman(monitor).backend(backend);
    let arm = robot.engage(engage).await.expect("it begins");
    every_kind_of_goal(&robot, &arm, &deadman).await;
    arm.disengage().await.expect("it ends");
    robot.shutdown().await;
}

/// Joint positions, a chunk, and a stream of poses that times out.
async fn every_kind_of_goal(robot: &Robot, arm: &Arm, deadman: &Deadman) {
    let mut q = robot.state().q_d;
    q[0] += 0.05;
    arm.set_joints(q).await.expect("the session takes it");
    still(deadman).await;
    let q = robot.state().q_d;
    let points = (0..6).map(|k| {
        let mut q = q;
        q[0] += 0.01 * f64::from(k);
        (Duration::from_millis(50) * k, q)
    });
    let chunk = Chunk::joints(points).expect("finite points");
    arm.chunk(chunk).await.expect("the session takes it");
    still(deadman).await;
    let (sender, targets) = watch::channel(robot.pose());
    let silence = Duration::from_millis(200);
    let following = arm.follow(targets).watchdog(silence, OnTimeout::Brake);
    let following = tokio::spawn(following.into_future());
    for step in 1..=3 {
        sender
            .send(above(robot, 0.01 * f64::from(step)))
            .expect("it goes on");
        sleep(Duration::from_millis(100)).await;
        deadman.keep_alive();
    }
    still(deadman).await;
    let lapse = following
        .await
        .expect("no panic")
        .expect_err("it is silent");
    assert!(
        matches!(lapse, MotionError::Braked(Lapse::Silent { .. })),
        "{lapse}"
    );
    deadman.keep_alive();
}

/// Half a second in which the deadman is kept alive.
async fn still(deadman: &Deadman) {
    for _ in 0..10 {
        sleep(Duration::from_millis(50)).await;
        deadman.keep_alive();
    }
}

/// A control function that answers so many states with a command, and calls `also` each time.
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

/// Control functions of all nine kinds, with filter and limiter; then one that causes a reflex.
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
    let tripped = tokio::spawn(robot.control_torques(torques()).into_future());
    sleep(Duration::from_millis(100)).await;
    let trip = sim.with(|robot| robot.trip(RobotError::CartesianReflex));
    trip.await.expect("the simulator runs");
    let error = tripped.await.expect("no panic").expect_err("a reflex");
    let control = error.control().expect("ended by the robot");
    assert!(!control.log.is_empty(), "{control:?}");
    robot.recover().await.expect("it recovers");
    sleep(Duration::from_millis(200)).await;
    robot.shutdown().await;
}

/// A thread of the user's program is the cycle for a while.
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

/// Targets between which the robot plans by itself.
pub(crate) async fn asynchronous() {
    let (robot, _sim) = simulated().await;
    let options = AsynchronousOptions::default();
    let control = robot.asynchronous_joint_positions(options).await;
    let control = control.expect("it begins");
    let mut q = robot.state().q_d;
    for way in [0.1, 0.1, -0.15] {
        q[0] += way;
        control.set_target(q).expect("it takes the target");
        sleep(Duration::from_millis(500)).await;
    }
    control.reached().await.expect("it arrives");
    control.finish().await.expect("it ends");
    robot.shutdown().await;
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
