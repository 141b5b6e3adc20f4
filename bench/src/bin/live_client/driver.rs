//! The project's own driver, used like in programs.

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use franka_async::control::{Finish as _, Torques};
use franka_async::{Pose, Realtime, Robot};
use tokio::sync::watch;

/// Controls with a function that returns zero torques: a cycle without any user computation.
#[tokio::main]
pub(crate) async fn torques(address: &str, time: Duration, fifo: bool) -> anyhow::Result<()> {
    let robot = connect(address, fifo).await?;
    let mut passed = Duration::ZERO;
    let motion = robot.control_torques(move |_, step| {
        passed += step;
        let none = Torques([0.0; 7]);
        if passed < time {
            none.into()
        } else {
            none.finish()
        }
    });
    motion.await?;
    robot.shutdown().await;
    Ok(())
}

/// Makes the arm follow targets that step along a circle.
#[tokio::main]
pub(crate) async fn targets(address: &str, time: Duration, fifo: bool) -> anyhow::Result<()> {
    let robot = connect(address, fifo).await?;
    let start = robot.pose();
    let (sender, targets) = watch::channel(start);
    let following = tokio::spawn(robot.follow(targets).into_future());
    let begun = Instant::now();
    while begun.elapsed() < time && !following.is_finished() {
        tokio::time::sleep(STEP).await;
        let angle = TAU * begun.elapsed().as_secs_f64() / ROUND.as_secs_f64();
        let (y, z) = (RADIUS * angle.sin(), RADIUS * (1.0 - angle.cos()));
        // A send fails once the motion has ended; the motion returns the reason.
        let _ = sender.send(Pose::translation(0.0, y, z) * start);
    }
    drop(sender);
    following.await??;
    robot.shutdown().await;
    Ok(())
}

async fn connect(address: &str, fifo: bool) -> anyhow::Result<Robot> {
    let builder = Robot::builder(address).realtime(Realtime::Ignore);
    let builder = if fifo {
        builder
    } else {
        builder.priority(NO_PRIORITY)
    };
    Ok(builder.connect().await?)
}

/// `SCHED_FIFO` has no priority 0: requesting it is refused, even for root, and the thread stays
/// under the normal scheduler.
const NO_PRIORITY: i32 = 0;

/// Interval between targets.
const STEP: Duration = Duration::from_millis(100);

/// Duration of one round, well within the arm's limits at this radius, `[m]`.
const ROUND: Duration = Duration::from_secs(4);
const RADIUS: f64 = 0.05;
