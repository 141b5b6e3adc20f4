//! Asynchronous joint positions: the robot itself plans the motion from target to target.

use std::sync::{Mutex, PoisonError};

use franka_model::Model;
use franka_proto::{RequestError, RobotState};
use franka_rt::control::{AbortReason, AsynchronousPositions, AsynchronousTarget, TargetStatus};
use franka_rt::driver::Program;
use franka_rt::lifecycle::{MotionError, Outcome};
use franka_rt::session::{GoalError, GoalId};
use franka_rt::shaping::check;
use franka_rt::triple_buffer::Writer;
use futures::FutureExt;
use futures::future::{BoxFuture, Shared};

use crate::input::unserved;
use crate::robot::Robot;

/// Options of [`Robot::asynchronous_joint_positions`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AsynchronousOptions {
    /// Limits of the joint velocities, `[rad/s]`.
    pub maximum_joint_velocities: [f64; 7],
    /// The target counts as reached if the robot's desired joint positions are at most this far
    /// from it: a Euclidean norm, `[rad]`. The maximum is 20, which is more than the distance
    /// between any two postures.
    pub goal_tolerance: f64,
}

impl Default for AsynchronousOptions {
    /// Returns the speeds and the tolerance of the example of libfranka 0.21: 0.655 rad/s for
    /// joints 1 to 4, and 1.315 rad/s for the others. The tolerance is 1 mrad.
    fn default() -> Self {
        Self {
            maximum_joint_velocities: [0.655, 0.655, 0.655, 0.655, 1.315, 1.315, 1.315],
            goal_tolerance: TargetStatus::GOAL_TOLERANCE,
        }
    }
}

impl AsynchronousOptions {
    fn check(&self, model: &Model) -> Result<(), GoalError> {
        const WHAT: [&str; 7] = [
            "maximum velocity of joint 1",
            "maximum velocity of joint 2",
            "maximum velocity of joint 3",
            "maximum velocity of joint 4",
            "maximum velocity of joint 5",
            "maximum velocity of joint 6",
            "maximum velocity of joint 7",
        ];
        let limits = &model.joint_limits().velocity;
        let velocities = (0..7).map(|i| {
            (
                WHAT[i],
                self.maximum_joint_velocities[i],
                "rad/s",
                limits[i],
            )
        });
        let tolerance = ("goal tolerance", self.goal_tolerance, "rad", FARTHEST);
        for (what, got, unit, most) in velocities.chain([tolerance]) {
            if !(LEAST..=most).contains(&got) {
                let least = LEAST;
                return Err(GoalError::Number {
                    what,
                    got,
                    unit,
                    least,
                    most,
                });
            }
        }
        Ok(())
    }
}

/// Smallest velocity, `[rad/s]`, and smallest tolerance, `[rad]`.
const LEAST: f64 = 1e-6;

/// More than the distance between any two postures of an arm, `[rad]`. The vendor's examples have a
/// tolerance of 10.
const FARTHEST: f64 = 20.0;

impl Robot {
    /// Starts a motion in which the robot itself plans the way to sparse joint targets, and
    /// resolves when the motion runs. Such motions exist only in protocol 10, and are experimental.
    ///
    /// # Errors
    /// Returns [`MotionError::Unsupported`] if the protocol version has no such motions. Returns
    /// [`MotionError::Goal`] if a velocity or a tolerance is not positive, or exceeds the robot's
    /// limit. In both cases nothing was sent. Returns [`MotionError::Busy`] if anything else
    /// controls the arm. If the motion ends before the robot runs it, returns the reason.
    ///
    /// # Cancel safety
    /// Dropping the future stops the robot.
    pub async fn asynchronous_joint_positions(
        &self,
        options: AsynchronousOptions,
    ) -> Result<AsynchronousControl, MotionError> {
        let version = self.version();
        if !version.has_asynchronous_motion() {
            let what = "asynchronous motion";
            return Err(RequestError::Unsupported { what, version }.into());
        }
        options.check(self.model())?;
        let (program, targets) = AsynchronousPositions::new();
        let request = AsynchronousPositions::request(options.maximum_joint_velocities);
        let id = self.next_goal();
        let program = Program::Asynchronous(program);
        let outcome = self.begin_program(id, program, request).await?;
        let end = outcome.map(|outcome| outcome.unwrap_or_else(unserved));
        Ok(AsynchronousControl {
            robot: self.clone(),
            id,
            targets: Mutex::new(Targets {
                writer: targets,
                newest: None,
            }),
            goal_tolerance: options.goal_tolerance,
            end: end.boxed().shared(),
        })
    }
}

/// A motion from target to target that the robot itself plans. Tasks may share it.
///
/// Dropping this value stops the robot.
#[derive(Debug)]
pub struct AsynchronousControl {
    robot: Robot,
    id: GoalId,
    targets: Mutex<Targets>,
    goal_tolerance: f64,
    end: Shared<BoxFuture<'static, Outcome>>,
}

#[derive(Debug)]
struct Targets {
    writer: Writer<AsynchronousTarget>,
    newest: Option<[f64; 7]>,
}

impl AsynchronousControl {
    /// Makes the robot move to `q`, `[rad]`, and stop there. This replaces an earlier target. The
    /// target is sent with the next state.
    ///
    /// # Errors
    /// Returns [`MotionError::Invalid`] if a number is not finite, and the reason why the motion
    /// ended if it has ended.
    pub fn set_target(&self, q: [f64; 7]) -> Result<(), MotionError> {
        check::finite(&q)?;
        if let Some(outcome) = self.end.clone().now_or_never() {
            return Err(end_of(outcome));
        }
        self.write(q, false);
        Ok(())
    }

    /// Returns the progress towards the newest target.
    pub fn status(&self) -> TargetStatus {
        if self.end.clone().now_or_never().is_some() {
            return TargetStatus::Aborted(AbortReason::Ended);
        }
        self.status_in(&self.robot.state())
    }

    /// Resolves when the newest target is reached. The wait has no time limit, because only the
    /// robot knows the duration.
    ///
    /// # Errors
    /// Returns the reason why the motion ended if it ended earlier. This call never returns
    /// [`MotionError::Goal`], because the robot does the planning.
    ///
    /// # Cancel safety
    /// Dropping the future has no effect: the robot continues to move.
    pub async fn reached(&self) -> Result<(), MotionError> {
        let mut states = self.robot.states();
        loop {
            // The first value of `states` may be older than the target.
            let status = self.status_in(&self.robot.state());
            if status == TargetStatus::TargetReached {
                return Ok(());
            }
            tokio::select! {
                outcome = self.end.clone() => return Err(end_of(outcome)),
                changed = states.changed() => if changed.is_err() {
                    return Err(end_of(self.end.clone().await));
                },
            }
        }
    }

    /// Ends the motion at the newest target, or where the arm is if there was no target. Resolves
    /// when the robot has ended the motion. Await [`Self::reached`] first, because the robot may
    /// refuse to end a motion while the arm moves.
    ///
    /// # Errors
    /// Returns the reason if the motion ends in any other way, for example with a reflex.
    ///
    /// # Cancel safety
    /// Once the future has been polled, the motion ends in any case. If you then drop the future
    /// before it resolves, the robot is asked to stop at once, so the arm may not reach the target.
    pub async fn finish(self) -> Outcome {
        let newest = self.lock().newest;
        self.write(newest.unwrap_or(self.robot.state().q_d), true);
        self.end.clone().await
    }

    fn status_in(&self, state: &RobotState) -> TargetStatus {
        TargetStatus::of(state, self.lock().newest.as_ref(), self.goal_tolerance)
    }

    fn write(&self, q: [f64; 7], finished: bool) {
        let mut targets = self.lock();
        targets.newest = Some(q);
        targets.writer.write(AsynchronousTarget { q, finished });
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Targets> {
        // A panic cannot leave the writer half-finished.
        self.targets.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for AsynchronousControl {
    fn drop(&mut self) {
        self.robot.cancel(self.id);
    }
}

/// Returns the error for a request that is unanswered because the motion ended.
fn end_of(outcome: Outcome) -> MotionError {
    outcome.err().unwrap_or(MotionError::Stopped)
}
