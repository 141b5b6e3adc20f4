//! The session of the socket that holds the lease.

use std::future::pending;
use std::pin::{Pin, pin};
use std::time::{Duration, Instant};

use franka_async::connection::lease::{Holder, Lost};
use franka_async::diagnosis::Diagnose;
use franka_async::goal::Lead;
use franka_async::{Arm, Engage, MotionError, MotionReport, Pose, Robot};
use tokio::sync::watch;

use crate::messages::{Reply, refused};

/// A session that controls the arm. Dropping it brakes the arm, releases it and frees the lease, in
/// this order.
pub(crate) struct Session {
    following: Following,
    targets: watch::Sender<Pose>,
    arm: Arm,
    holder: Holder,
}

/// Largest speed of any joint and of the hand, `[m/s]`: a person may be near.
const SPEED_CAP: f64 = 0.25;

type Following = Pin<Box<dyn Future<Output = Result<MotionReport, MotionError>> + Send>>;

impl Session {
    /// Engages the arm for the holder of the lease. The control thread itself monitors the silence:
    /// it brakes the arm even if this program is blocked.
    pub(crate) async fn begin(robot: &Robot, holder: Holder) -> Result<Self, MotionError> {
        let engage = Engage::default().speed_cap(SPEED_CAP);
        // After a session that has just ended, this waits until the arm is at rest.
        let mut engaging = pin!(robot.engage(engage.deadman(holder.deadman())));
        let arm = loop {
            tokio::select! {
                arm = &mut engaging => break arm?,
                // The client waits for its answer, and sends nothing meanwhile.
                () = tokio::time::sleep(Duration::from_millis(5)) => {
                    let _ = holder.keep_alive(Instant::now()); // a lost lease holds the arm
                }
            }
        };
        let (targets, following) = follow(&arm);
        Ok(Self {
            following,
            targets,
            arm,
            holder,
        })
    }

    pub(crate) fn keep_alive(&self) -> Result<(), Lost> {
        self.holder.keep_alive(Instant::now())
    }

    pub(crate) fn head_for(&self, target: Pose) {
        self.targets.send_replace(target);
    }

    /// Resolves when the arm has stopped following, with the reply for the client. After a refused
    /// target, the arm brakes and then follows the next one. Every other reason ends the session:
    /// the client was silent, or the robot stopped itself.
    pub(crate) async fn trouble(session: &mut Option<Self>) -> Reply {
        let Some(held) = session else { pending().await };
        let why = tokio::select! {
            ended = &mut held.following => match ended {
                Err(MotionError::Goal(error)) => {
                    (held.targets, held.following) = follow(&held.arm);
                    return refused(error);
                }
                ended => ended.err().map_or_else(String::new, explain),
            },
            lost = held.holder.lost() => lost.to_string(),
        };
        *session = None;
        Reply::Lost { why }
    }
}

/// Follows targets, starting with the current pose of the hand.
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

/// Largest distance of a target ahead of the arm: a wild target does not move the arm far.
const LEAD: Lead = Lead {
    translation: 0.1,
    rotation: 0.3,
    joints: 0.3,
};
