//! The motion of one hold: begins a session of target control, moves until it is told to end, lets
//! the arm go.

use std::time::Duration;

use franka_async::connection::CancellationToken;
use franka_async::diagnosis::Diagnose;
use franka_async::goal::{Budget, Deadman, DeadmanMonitor, Lead, Target};
use franka_async::model::{JointVector, Twist};
use franka_async::nalgebra::{UnitQuaternion, Vector3};
use franka_async::{Arm, Engage, MotionError, Pose, READY, Robot, pose};
use tokio::time::{MissedTickBehavior, interval};

use crate::pace;
use crate::request::{Axes, Motion, SPEED_MAX};

/// A hold as the server keeps it. Dropping it brakes the arm: the control thread by the deadman,
/// whatever becomes of this process's runtime, and the task by the token.
pub(crate) struct Hold {
    deadman: Deadman,
    end: CancellationToken,
}

impl Hold {
    /// The hold, and what its motion needs. News of it may come later by `patience`.
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

/// How a motion ended before its button was released.
#[derive(Debug)]
pub(crate) enum Ended {
    /// At the target, or told to.
    AsAsked,
    /// Otherwise: one line, and what to change.
    Failed(String, Option<String>),
}

/// Moves until `end` is cancelled or the target is reached. The arm is braked and let go when it
/// returns.
pub(crate) async fn run(
    robot: &Robot,
    motion: Motion,
    speed: f64,
    deadman: DeadmanMonitor,
    end: CancellationToken,
) -> Ended {
    match attempt(robot, motion, speed, deadman, &end).await {
        Ok(()) => Ended::AsAsked,
        // What follows on the end of the hold, or on a stop by a viewer.
        Err(Fault::Motion(
            MotionError::Stopped | MotionError::Held(_) | MotionError::Disengaged,
        )) if end.is_cancelled() => Ended::AsAsked,
        Err(Fault::Fast(speed)) => {
            let text = format!(
                "A point of the arm moved at {speed:.2} m/s, above {SPEED_MAX} m/s: the hold has ended"
            );
            Ended::Failed(text, None)
        }
        Err(Fault::Motion(error)) => {
            let why = error.diagnose().map(|diagnosis| diagnosis.to_string());
            Ended::Failed(error.to_string(), why)
        }
    }
}

async fn attempt(
    robot: &Robot,
    motion: Motion,
    speed: f64,
    deadman: DeadmanMonitor,
    end: &CancellationToken,
) -> Result<(), Fault> {
    let budget = budget(robot, &motion, speed);
    let engage = Engage::default().limits(budget).deadman(deadman);
    let arm = tokio::select! {
        biased;
        // Dropping the future ends the session.
        () = end.cancelled() => return Ok(()),
        arm = robot.engage(engage) => arm.map_err(Fault::Motion)?,
    };
    let moved = tokio::select! {
        biased;
        () = end.cancelled() => Ok(()),
        speed = too_fast(robot) => Err(Fault::Fast(speed)),
        moved = go(&arm, motion, speed) => moved.map_err(Fault::Motion),
    };
    let let_go = arm.disengage().await.map_err(Fault::Motion);
    moved.and(let_go.map(drop))
}

/// Why a hold ended before it was told to.
enum Fault {
    Motion(MotionError),
    Fast(f64),
}

/// Resolves when a joint, the flange or the end effector is faster than is allowed, with its speed,
/// `[m/s]`.
async fn too_fast(robot: &Robot) -> f64 {
    let mut clock = ticks(Duration::from_millis(10));
    loop {
        clock.tick().await;
        let speed = pace::fastest(robot.model(), &robot.state());
        if speed > SPEED_MAX {
            return speed;
        }
    }
}

/// Where the joints go; `None` for motions of the end effector.
fn joint_target(robot: &Robot, motion: &Motion) -> Option<[f64; 7]> {
    let limits = robot.model().joint_limits();
    let (lower, upper) = (limits.lower, limits.upper);
    let inside = |q: JointVector| -> [f64; 7] {
        core::array::from_fn(|i| q[i].clamp(lower[i] + MARGIN, upper[i] - MARGIN))
    };
    match motion {
        Motion::Joint { joint, up } => {
            // The others stay where they are, wherever that is.
            let mut q = robot.state().q_d;
            let end = if *up { upper } else { lower };
            q[*joint] = inside(end)[*joint];
            Some(q)
        }
        Motion::Joints { q } => Some(inside(JointVector::from(*q))),
        Motion::Ready {} => Some(READY.into()),
        Motion::Translate { .. } | Motion::Rotate { .. } => None,
    }
}

fn budget(robot: &Robot, motion: &Motion, speed: f64) -> Budget {
    let state = robot.state();
    match joint_target(robot, motion) {
        Some(target) => {
            let way = core::array::from_fn(|i| target[i] - state.q[i]);
            pace::joints(robot.model(), &state, way, speed)
        }
        // A moving target leaves a tenth for catching up.
        None => pace::end_effector_at(robot.model(), (speed / 0.9).min(SPEED_MAX)),
    }
}

/// Moves to the target, or along until the future is dropped.
async fn go(arm: &Arm, motion: Motion, speed: f64) -> Result<(), MotionError> {
    if let Some(target) = joint_target(arm.robot(), &motion) {
        return arm.move_joints(target).await.map(drop);
    }
    let Some(start) = arm.reference().map(|reference| reference.pose) else {
        return arm.ended().await.map(drop);
    };
    let (linear, angular) = velocity(&start, motion, speed);
    let twist = Twist::from_iterator(linear.iter().chain(&angular).copied());
    let begin = tokio::time::Instant::now();
    let (targets, followed) = tokio::sync::watch::channel(Target::from((start, twist)));
    let moving = async {
        let mut clock = ticks(STEP);
        loop {
            clock.tick().await;
            let time = begin.elapsed().as_secs_f64();
            let turn = UnitQuaternion::from_scaled_axis(angular * time);
            let along = Pose::translation(linear.x * time, linear.y * time, linear.z * time);
            let target = along * pose::rotated(&start, turn);
            targets.send_replace(Target::from((target, twist)));
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

/// Linear and angular velocity in base axes, `[m/s]` and `[rad/s]`.
fn velocity(start: &Pose, motion: Motion, speed: f64) -> (Vector3<f64>, Vector3<f64>) {
    let along = |direction: [f64; 3], axes: Axes| {
        let direction = Vector3::from(direction).normalize();
        match axes {
            Axes::Base => direction,
            Axes::Tool => start.rotation * direction,
        }
    };
    match motion {
        Motion::Translate { direction, axes } => (along(direction, axes) * speed, Vector3::zeros()),
        Motion::Rotate { direction, axes } => {
            let turn = along(direction, axes) * (speed / pace::TURNING_RADIUS);
            (Vector3::zeros(), turn)
        }
        Motion::Joint { .. } | Motion::Joints { .. } | Motion::Ready {} => {
            (Vector3::zeros(), Vector3::zeros())
        }
    }
}

fn ticks(period: Duration) -> tokio::time::Interval {
    let mut clock = interval(period);
    clock.set_missed_tick_behavior(MissedTickBehavior::Skip);
    clock
}

/// Silence after which the control thread itself brakes, in the robot's time.
const SILENCE: Duration = Duration::from_millis(200);

/// Time between two targets of a jog.
const STEP: Duration = Duration::from_millis(20);

/// Distance from the end of a joint's range that a target keeps, `[rad]`.
const MARGIN: f64 = 0.02;
