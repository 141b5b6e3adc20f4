//! The motion of a hold. It starts a session of target control, moves the arm until the hold ends,
//! and releases the arm.

use std::time::Duration;

use franka_async::connection::CancellationToken;
use franka_async::diagnosis::Diagnose;
use franka_async::goal::{self, Deadman, DeadmanMonitor, ForceCap, Lead, Target};
use franka_async::model::Twist;
use franka_async::model::collision::Obstacle;
use franka_async::nalgebra::{UnitQuaternion, Vector3};
use franka_async::{Arm, Engage, MotionError, Pose, Robot, pose};
use tokio::sync::watch;
use tokio::time::{MissedTickBehavior, interval};

use crate::pace;
use crate::plan::{self, Plan};
use crate::request::{Axes, Motion, SPEED_MAX, Tuning};
use crate::way::Way;

/// The server's handle of a hold. Dropping it makes the arm brake in two ways. The token stops the
/// task. The deadman makes the control thread brake, even if the runtime of this process fails.
pub(crate) struct Hold {
    deadman: Deadman,
    end: CancellationToken,
}

impl Hold {
    /// Creates a hold and the inputs of its motion. Messages of the hold may be late by `patience`.
    pub(crate) fn new(patience: Duration) -> (Self, DeadmanMonitor, CancellationToken) {
        let (deadman, monitor) = Deadman::new(SILENCE + patience);
        deadman.keep_alive();
        let end = CancellationToken::new();
        let told = end.clone();
        (Self { deadman, end }, monitor, told)
    }

    pub(crate) fn keep_alive(&self) {
        self.deadman.keep_alive();
    }
}

impl Drop for Hold {
    fn drop(&mut self) {
        self.end.cancel();
    }
}

/// Settings that can change during a hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Settings {
    /// Largest speed of any point of the arm, `[m/s]`.
    pub(crate) speed: f64,
    pub(crate) tuning: Tuning,
}

/// Reason why a motion ended before its button was released.
#[derive(Debug)]
pub(crate) enum Ended {
    /// The motion reached its target, or a viewer ended it.
    AsAsked,
    /// The motion failed. The values are one line of text, and the recommended change.
    Failed(String, Option<String>),
}

/// The motion to perform while a button is held.
pub(crate) struct Task {
    pub(crate) motion: Motion,
    pub(crate) settings: watch::Receiver<Settings>,
    pub(crate) keep_out: Vec<Obstacle>,
    pub(crate) deadman: DeadmanMonitor,
    pub(crate) end: CancellationToken,
}

/// Moves the arm until the task is cancelled or the target is reached. Before this function
/// returns, the arm has braked and is released. For a planned motion, the function calls `show`
/// with the plan before the arm moves.
pub(crate) async fn run(robot: &Robot, task: Task, show: impl FnOnce(Plan)) -> Ended {
    let end = task.end.clone();
    match attempt(robot, task, show).await {
        Ok(()) => Ended::AsAsked,
        // The end of the hold, or a viewer's stop, caused this error.
        Err(Fault::Motion(
            MotionError::Stopped | MotionError::Held(_) | MotionError::Disengaged,
        )) if end.is_cancelled() => Ended::AsAsked,
        Err(Fault::Refused(why)) => Ended::Failed(format!("Not moved: {why}"), None),
        Err(Fault::Motion(error)) => {
            let why = error.diagnose().map(|diagnosis| diagnosis.to_string());
            Ended::Failed(error.to_string(), why)
        }
    }
}

async fn attempt(robot: &Robot, task: Task, show: impl FnOnce(Plan)) -> Result<(), Fault> {
    let Task {
        motion,
        mut settings,
        keep_out,
        deadman,
        end,
    } = task;
    let now = *settings.borrow_and_update();
    if plan::has_end(&motion) {
        let planned = plan::in_background(robot, motion, now.speed, keep_out.clone()).await;
        show(planned.map_err(Fault::Refused)?);
    }
    let way = Way::of(robot, &motion);
    let engage = Engage::default()
        .limits(way.budget(robot, now.speed))
        .gains(way.gains(&now.tuning))
        .force_cap(now.tuning.force_cap)
        .keep_out(keep_out)
        .speed_cap(SPEED_MAX)
        .deadman(deadman);
    let arm = tokio::select! {
        biased;
        // Dropping the future of the motion ends the session.
        () = end.cancelled() => return Ok(()),
        arm = robot.engage(engage) => arm.map_err(Fault::Motion)?,
    };
    let moved = tokio::select! {
        biased;
        () = end.cancelled() => Ok(()),
        tuned = keep_tuned(&arm, way, settings.clone()) => tuned.map_err(Fault::Motion),
        moved = go(&arm, motion, way, &settings) => moved.map_err(Fault::Motion),
    };
    let let_go = arm.disengage().await.map_err(Fault::Motion);
    moved.and(let_go.map(drop))
}

/// Reason why a hold ended early.
enum Fault {
    /// The driver refused the motion before it began.
    Refused(String),
    Motion(MotionError),
}

/// Applies changes of speed and stiffness to the session, until the session ends.
async fn keep_tuned(
    arm: &Arm,
    way: Way,
    mut settings: watch::Receiver<Settings>,
) -> Result<(), MotionError> {
    while settings.changed().await.is_ok() {
        let now = *settings.borrow_and_update();
        let tuning = goal::Tuning {
            gains: Some(way.gains(&now.tuning)),
            budget: Some(way.budget(arm.robot(), now.speed)),
            force_cap: Some(ForceCap::Newtons(now.tuning.force_cap)),
            ..goal::Tuning::default()
        };
        arm.tune(tuning).await?;
    }
    arm.ended().await.map(drop)
}

/// Moves to the target. For a motion without a target, moves until the future is dropped.
async fn go(
    arm: &Arm,
    motion: Motion,
    way: Way,
    settings: &watch::Receiver<Settings>,
) -> Result<(), MotionError> {
    match way {
        Way::Joints { target, .. } => return arm.move_joints(target).await.map(drop),
        // As in the preview, the driver refuses the motion if no straight path is possible.
        Way::Pose(pose) => return arm.move_through([pose]).await.map(drop),
        Way::EndEffector => {}
    }
    let start = arm.reference().map(|reference| reference.pose);
    let Some((start, (linear, angular))) =
        start.and_then(|start| Some((start, direction(&start, motion)?)))
    else {
        return arm.ended().await.map(drop);
    };
    let along = Twist::from_iterator(linear.iter().chain(&angular).copied());
    let at = |distance: f64, speed: f64| {
        let turn = UnitQuaternion::from_scaled_axis(angular * distance);
        let shift = linear * distance;
        let shift = Pose::translation(shift.x, shift.y, shift.z);
        let target = shift * pose::rotated(&start, turn);
        Target::from((target, along * speed))
    };
    let (targets, followed) = watch::channel(at(0.0, settings.borrow().speed));
    let moving = async {
        let (mut clock, mut distance) = (ticks(STEP), 0.0);
        let mut last = tokio::time::Instant::now();
        loop {
            let now = clock.tick().await;
            let speed = settings.borrow().speed;
            distance += speed * now.saturating_duration_since(last).as_secs_f64();
            last = now;
            targets.send_replace(at(distance, speed));
        }
    };
    let lead = Lead {
        translation: 0.02,
        rotation: 0.08,
        joints: 0.1,
    };
    let following = arm.follow(followed).lead(lead);
    tokio::select! {
        followed = following.into_future() => followed.map(drop),
        () = moving => Ok(()),
    }
}

/// Returns the linear velocity, `[m/s]`, and the angular velocity, `[rad/s]`, for a speed of 1 m/s,
/// in base axes. `None` for a motion without a direction.
fn direction(start: &Pose, motion: Motion) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let along = |direction: [f64; 3], axes: Axes| {
        let direction = Vector3::from(direction).normalize();
        match axes {
            Axes::Base => direction,
            Axes::Tool => start.rotation * direction,
        }
    };
    match motion {
        Motion::Translate { direction, axes } => Some((along(direction, axes), Vector3::zeros())),
        Motion::Rotate { direction, axes } => {
            let turn = along(direction, axes) / pace::TURNING_RADIUS;
            Some((Vector3::zeros(), turn))
        }
        Motion::Joint { .. }
        | Motion::Joints { .. }
        | Motion::Ready {}
        | Motion::Pose { .. }
        | Motion::Stay {} => None,
    }
}

fn ticks(period: Duration) -> tokio::time::Interval {
    let mut clock = interval(period);
    clock.set_missed_tick_behavior(MissedTickBehavior::Skip);
    clock
}

/// Silence after which the control thread itself brakes, measured in robot time.
const SILENCE: Duration = Duration::from_millis(200);

/// Interval between two targets of a motion in a direction.
const STEP: Duration = Duration::from_millis(20);
