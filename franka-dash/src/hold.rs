//! The motion of one hold: begins a session of target control, moves until it is told to end, lets
//! the arm go.

use std::time::Duration;

use franka_async::connection::CancellationToken;
use franka_async::diagnosis::Diagnose;
use franka_async::goal::{self, Budget, Deadman, DeadmanMonitor, ForceCap, Gains, Lead, Target};
use franka_async::model::{JointVector, Twist};
use franka_async::nalgebra::{UnitQuaternion, Vector3};
use franka_async::{Arm, Engage, MotionError, Pose, READY, Robot, pose};
use tokio::sync::watch;
use tokio::time::{MissedTickBehavior, interval};

use crate::pace;
use crate::request::{Axes, Motion, SPEED_MAX, Tuning};

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

/// What may change while a hold goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Settings {
    /// Greatest speed of any point of the arm, `[m/s]`.
    pub(crate) speed: f64,
    pub(crate) tuning: Tuning,
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
    settings: watch::Receiver<Settings>,
    deadman: DeadmanMonitor,
    end: CancellationToken,
) -> Ended {
    match attempt(robot, motion, settings, deadman, &end).await {
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
    mut settings: watch::Receiver<Settings>,
    deadman: DeadmanMonitor,
    end: &CancellationToken,
) -> Result<(), Fault> {
    let way = Way::of(robot, &motion);
    let now = *settings.borrow_and_update();
    let engage = Engage::default()
        .limits(way.budget(robot, now.speed))
        .gains(way.gains(&now.tuning))
        .force_cap(now.tuning.force_cap)
        .deadman(deadman);
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
        tuned = keep_tuned(&arm, way, settings.clone()) => tuned.map_err(Fault::Motion),
        moved = go(&arm, motion, way, &settings) => moved.map_err(Fault::Motion),
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

/// Where a motion goes.
#[derive(Clone, Copy)]
enum Way {
    /// The joints to a target, from where they were, `[rad]`.
    Joints { target: [f64; 7], way: [f64; 7] },
    /// The end effector, along.
    EndEffector,
}

impl Way {
    fn of(robot: &Robot, motion: &Motion) -> Self {
        let limits = robot.model().joint_limits();
        let (lower, upper) = (limits.lower, limits.upper);
        let inside = |q: JointVector| -> [f64; 7] {
            core::array::from_fn(|i| q[i].clamp(lower[i] + MARGIN, upper[i] - MARGIN))
        };
        let state = robot.state();
        let target = match motion {
            Motion::Joint { joint, up } => {
                // The others stay where they are, wherever that is.
                let mut q = state.q_d;
                let end = if *up { upper } else { lower };
                q[*joint] = inside(end)[*joint];
                q
            }
            Motion::Joints { q } => inside(JointVector::from(*q)),
            Motion::Ready {} => READY.into(),
            Motion::Translate { .. } | Motion::Rotate { .. } | Motion::Stay {} => {
                return Self::EndEffector;
            }
        };
        let way = core::array::from_fn(|i| target[i] - state.q[i]);
        Self::Joints { target, way }
    }

    fn budget(&self, robot: &Robot, speed: f64) -> Budget {
        match self {
            Self::Joints { way, .. } => pace::joints(robot.model(), &robot.state(), *way, speed),
            // A moving target leaves a tenth for catching up.
            Self::EndEffector => pace::end_effector_at(robot.model(), (speed / 0.9).min(SPEED_MAX)),
        }
    }

    /// The driver's gains for this kind of motion, tuned.
    fn gains(&self, tuning: &Tuning) -> Gains {
        let preset = match self {
            Self::Joints { .. } => Gains::joint(),
            Self::EndEffector => Gains::cartesian(),
        };
        let stiffness = preset.cartesian_stiffness.map(|k| k * tuning.end_effector);
        let gains = preset.with_cartesian_stiffness(stiffness);
        let joint_damping = tuning.damping * tuning.joints.sqrt();
        Gains {
            cartesian_damping: gains.cartesian_damping.map(|d| d * tuning.damping),
            joint_stiffness: gains.joint_stiffness.map(|k| k * tuning.joints),
            joint_damping: gains.joint_damping.map(|d| d * joint_damping),
            compensation: match tuning.compensation {
                true => gains.compensation,
                false => [0.0; 7],
            },
            ..gains
        }
    }
}

/// Has the session follow changes of speed and tuning, until it ends.
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

/// Moves to the target, or along until the future is dropped.
async fn go(
    arm: &Arm,
    motion: Motion,
    way: Way,
    settings: &watch::Receiver<Settings>,
) -> Result<(), MotionError> {
    if let Way::Joints { target, .. } = way {
        return arm.move_joints(target).await.map(drop);
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

/// Linear and angular velocity in base axes for a speed of 1 m/s, `[m/s]` and `[rad/s]`; `None` for
/// a motion that goes along nothing.
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
        Motion::Joint { .. } | Motion::Joints { .. } | Motion::Ready {} | Motion::Stay {} => None,
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
