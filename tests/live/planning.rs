//! Paths are planned in parallel with the task that serves stops. These tests hold a plan where it
//! begins: the thread that plans writes a line to the log, and the log waits for the test.

use std::future::IntoFuture;
use std::sync::{PoisonError, RwLock, RwLockWriteGuard};
use std::thread;
use std::time::Duration;

use franka_async::error::GoalError;
use franka_async::goal::{Budget, Deviation, Tuning};
use franka_async::state::RobotMode;
use franka_async::{Engage, MotionError, MotionReport, Pose, Robot};
use franka_sim::Running;
use tokio::runtime::{Builder, Runtime};
use tokio::task::JoinHandle;
use tokio::time::timeout;
use tracing::{Event, Subscriber};
use tracing_subscriber::layer::{Context, Layer};

use crate::telemetry::listen;
use crate::{SOON, alone, robot_time, simulated, under_way};

type Outcome = Result<MotionReport, MotionError>;

fn runtime() -> Runtime {
    Runtime::new().expect("a runtime starts")
}

/// Every plan waits where it begins for this lock.
static PLANS: RwLock<()> = RwLock::new(());

/// Holds every plan until it is dropped.
struct Hold {
    _guard: RwLockWriteGuard<'static, ()>,
}

fn hold() -> Hold {
    listen();
    let _guard = PLANS.write().unwrap_or_else(PoisonError::into_inner);
    Hold { _guard }
}

/// A log that waits at the first line of each plan.
pub(crate) struct Barrier;

impl<S: Subscriber> Layer<S> for Barrier {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        if event.metadata().target() == "franka_async::bridge::planning" {
            drop(PLANS.read().unwrap_or_else(PoisonError::into_inner));
        }
    }
}

struct Scene {
    robot: Robot,
    _sim: Running,
    q: [f64; 7],
    /// Two poses at the side of and above the arm.
    way: [Pose; 2],
}

impl Scene {
    async fn new() -> Self {
        let (robot, sim) = simulated().await;
        let (q, start) = (robot.state().q, robot.pose());
        let way = [(0.03, 0.0), (0.03, 0.03)].map(|(y, z)| Pose::translation(0.0, y, z) * start);
        let _sim = sim;
        Self {
            robot,
            _sim,
            q,
            way,
        }
    }

    /// A motion along the way whose plan is held.
    async fn planned(&self) -> JoinHandle<Outcome> {
        let moving = tokio::spawn(self.robot.move_through(self.way).into_future());
        robot_time(&self.robot, 200).await;
        assert!(!moving.is_finished());
        self.assert_still();
        moving
    }

    fn assert_still(&self) {
        let state = self.robot.state();
        assert_eq!(state.robot_mode, RobotMode::Idle);
        assert_eq!(state.q, self.q);
    }
}

#[test]
fn stop_and_cancel_are_served_while_a_path_is_planned() {
    let _alone = alone();
    runtime().block_on(async {
        let scene = Scene::new().await;
        let robot = &scene.robot;
        let release = hold();

        let stopped = scene.planned().await;
        let stop = timeout(SOON, robot.stop()).await;
        stop.expect("it is served").expect("nothing moves");
        assert_eq!(stopped.await.unwrap(), Err(MotionError::Stopped));

        let motion = robot.move_through(scene.way);
        let handle = motion.handle();
        let cancelled = tokio::spawn(motion.into_future());
        robot_time(robot, 50).await;
        handle.cancel();
        assert_eq!(cancelled.await.unwrap(), Err(MotionError::Stopped));

        let dropped = scene.planned().await;
        dropped.abort();
        let superseded = scene.planned().await;
        let moving = scene.planned().await;
        let engaged = robot.engage(Engage::default()).await.map(drop);
        assert_eq!(engaged, Err(MotionError::Busy));

        drop(release);
        assert_eq!(superseded.await.unwrap(), Err(MotionError::Superseded));
        moving.await.unwrap().expect("it arrives");
        let end = scene.way[1].translation.vector;
        assert!((robot.pose().translation.vector - end).norm() < 1e-3);
        robot.shutdown().await;
    });
}

/// A path that is refused, or cancelled before it begins, has superseded nothing.
#[test]
fn path_that_is_planned_begins_after_newer_ones_that_do_not() {
    let _alone = alone();
    runtime().block_on(async {
        let scene = Scene::new().await;
        let robot = &scene.robot;
        let release = hold();
        let moving = scene.planned().await;
        let beyond = Pose::translation(2.0, 0.0, 0.0) * robot.pose();
        let refused = tokio::spawn(robot.move_through([scene.way[0], beyond]).into_future());
        robot_time(robot, 100).await;
        // The line through the axis of the base collides with the arm itself.
        let across = Pose::translation(-2.0 * robot.pose().translation.x, 0.0, -0.2);
        let no_line = robot.move_to(across * robot.pose()).await.unwrap_err();
        assert!(
            matches!(no_line, MotionError::Goal(GoalError::NoLine { .. })),
            "{no_line}"
        );
        let dropped = scene.planned().await;
        dropped.abort();
        assert!(dropped.await.unwrap_err().is_cancelled());
        assert!(!moving.is_finished() && !refused.is_finished());

        drop(release);
        let refused = refused.await.unwrap().unwrap_err();
        assert!(matches!(refused, MotionError::Path(_)), "{refused}");
        moving.await.unwrap().expect("it arrives");
        let end = scene.way[1].translation.vector;
        assert!((robot.pose().translation.vector - end).norm() < 1e-3);

        // If very many wait, the oldest end at once.
        let release = hold();
        let mut back = Vec::new();
        for _ in 0..6 {
            back.push(tokio::spawn(
                robot.move_through([scene.way[0]]).into_future(),
            ));
            robot_time(robot, 20).await;
        }
        for superseded in back.drain(..2) {
            assert_eq!(superseded.await.unwrap(), Err(MotionError::Superseded));
        }
        drop(release);
        let last = back.pop().unwrap();
        last.await.unwrap().expect("it arrives");
        for superseded in back {
            assert_eq!(superseded.await.unwrap(), Err(MotionError::Superseded));
        }
        scene.robot.shutdown().await;
    });
}

/// The bridge finds the cancellation and the plan at the same time.
#[test]
fn path_cancelled_before_its_plan_is_ready_supersedes_nothing() {
    let _alone = alone();
    let runtime = Builder::new_current_thread().enable_all().build();
    runtime.expect("a runtime starts").block_on(async {
        let scene = Scene::new().await;
        for _ in 0..10 {
            let release = hold();
            let motion = scene.robot.move_through([scene.way[0]]);
            let older = tokio::spawn(motion.into_future());
            robot_time(&scene.robot, 50).await;
            let motion = scene.robot.move_through([scene.way[1]]);
            let handle = motion.handle();
            let cancelled = tokio::spawn(motion.into_future());
            robot_time(&scene.robot, 50).await;
            handle.cancel();
            drop(release);
            // The only thread of the runtime waits, so the bridge does not run meanwhile.
            thread::sleep(Duration::from_millis(30));
            assert_eq!(cancelled.await.unwrap(), Err(MotionError::Stopped));
            older.await.unwrap().expect("it arrives");
        }
        scene.robot.shutdown().await;
    });
}

/// A motion under way leaves the start of the plan. The new plan begins where the arm is.
#[test]
fn path_of_an_arm_that_has_moved_on_is_planned_anew() {
    let _alone = alone();
    runtime().block_on(async {
        let scene = Scene::new().await;
        let robot = &scene.robot;
        let turned = |by: f64| {
            let mut q = scene.q;
            q[0] += by;
            q
        };
        let moving = robot.move_joints(turned(0.4)).speed(0.2);
        let moving = tokio::spawn(moving.into_future());
        under_way(robot).await;
        let release = hold();
        let path = robot.move_through([turned(0.45), turned(0.5)]);
        let path = tokio::spawn(path.into_future());
        moving.await.unwrap().expect("it arrives meanwhile");
        assert!(!path.is_finished());

        drop(release);
        let mut least = f64::INFINITY;
        while !path.is_finished() {
            robot_time(robot, 1).await;
            least = least.min(robot.state().q[0]);
        }
        path.await.unwrap().expect("it arrives");
        let back = turned(0.4)[0] - least;
        assert!(back < 0.01, "it turned back by {back} rad");
        robot.shutdown().await;
    });
}

#[test]
fn path_in_planning_gives_way_to_newer_goal_of_session() {
    let _alone = alone();
    runtime().block_on(async {
        let scene = Scene::new().await;
        let arm = scene.robot.engage(Engage::default()).await.unwrap();
        let release = hold();
        let begin = || tokio::spawn(arm.move_through(scene.way).into_future());

        let superseded = begin();
        robot_time(&scene.robot, 100).await;
        arm.move_to(Pose::translation(0.0, 0.0, 0.01) * scene.robot.pose())
            .await
            .expect("it arrives meanwhile");
        assert_eq!(superseded.await.unwrap(), Err(MotionError::Superseded));

        // Tuned before it begins.
        let slow = Tuning {
            budget: Some(Budget::of(scene.robot.model().joint_limits()).scaled(0.2)),
            deviation: Some(Deviation::default()),
            ..Tuning::default()
        };
        let tuned = begin();
        robot_time(&scene.robot, 100).await;
        arm.tune(slow).await.unwrap();
        drop(release);
        let report = tuned.await.unwrap().expect("it arrives");
        assert!(report.duration > Duration::from_secs(1), "{report:?}");

        let release = hold();
        let ended = begin();
        robot_time(&scene.robot, 100).await;
        arm.clone().disengage().await.expect("it rests");
        assert_eq!(ended.await.unwrap(), Err(MotionError::Stopped));
        drop(release);
        scene.robot.shutdown().await;
    });
}
