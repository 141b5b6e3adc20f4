//! The right of one socket to move the arm.

use std::future::pending;
use std::pin::Pin;
use std::time::Duration;

use franka_async::diagnosis::Diagnose;
use franka_async::goal::{Deadman, Lead};
use franka_async::{Arm, Engage, MotionError, MotionReport, Pose, Robot};
use tokio::sync::{OwnedSemaphorePermit, watch};

use crate::messages::{Reply, refused};

/// The right to move the arm. Dropping it brakes the arm, lets it go and frees the permit, in this
/// order.
pub(crate) struct Lease {
    following: Following,
    targets: watch::Sender<Pose>,
    arm: Arm,
    deadman: Deadman,
    _permit: OwnedSemaphorePermit,
}

/// Greatest speed of any joint and of the hand, `[m/s]`: a person may be near.
const SPEED_CAP: f64 = 0.25;

type Following = Pin<Box<dyn Future<Output = Result<MotionReport, MotionError>> + Send>>;

impl Lease {
    /// Engages the arm. The control thread itself watches for the silence: it brakes the arm even
    /// if this program is stuck.
    pub(crate) async fn begin(
        robot: &Robot,
        permit: OwnedSemaphorePermit,
        silence: Duration,
    ) -> Result<Self, MotionError> {
        let (deadman, monitor) = Deadman::new(silence);
        // After a lease that has just ended, this waits until the arm rests.
        let engage = Engage::default().speed_cap(SPEED_CAP).deadman(monitor);
        let arm = robot.engage(engage).await?;
        deadman.keep_alive();
        let (targets, following) = follow(&arm);
        Ok(Self {
            following,
            targets,
            arm,
            deadman,
            _permit: permit,
        })
    }

    pub(crate) fn keep_alive(&self) {
        self.deadman.keep_alive();
    }

    pub(crate) fn head_for(&self, target: Pose) {
        self.targets.send_replace(target);
    }

    /// Resolves when the arm has stopped following, with what to tell the client. A target that was
    /// refused has braked the arm, which follows the next one. Anything else ends the lease: the
    /// client was silent, or the robot stopped itself.
    pub(crate) async fn trouble(lease: &mut Option<Self>) -> Reply {
        let Some(held) = lease else { pending().await };
        match (&mut held.following).await {
            Err(MotionError::Goal(error)) => {
                (held.targets, held.following) = follow(&held.arm);
                refused(error)
            }
            ended => {
                *lease = None;
                let why = ended.err().map_or_else(String::new, explain);
                Reply::Lost { why }
            }
        }
    }
}

/// Follows targets, beginning with where the hand is.
fn follow(arm: &Arm) -> (watch::Sender<Pose>, Following) {
    let (targets, followed) = watch::channel(arm.robot().pose());
    (targets, arm.follow(followed).lead(LEAD).into_future())
}

fn explain(error: MotionError) -> String {
    match error.diagnose() {
        Some(diagnosis) => format!("{error}\n{diagnosis}"),
        None => error.to_string(),
    }
}

/// How far ahead of the arm a target counts: a wild one does not send the arm far.
const LEAD: Lead = Lead {
    translation: 0.1,
    rotation: 0.3,
    joints: 0.3,
};
