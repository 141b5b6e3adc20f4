//! Follows a stream of targets without a generator, as naive programs do.

use franka_async::control::slot::Read;
use franka_async::control::{CartesianPose, Finish, slot};
use franka_async::nalgebra::Vector3;
use franka_async::{MotionError, MotionReport, Pose, Robot};
use tokio::sync::watch;

/// Steps towards the newest target with a bound on the velocity, and none on acceleration and jerk.
pub(crate) async fn follow(
    robot: &Robot,
    mut targets: watch::Receiver<Pose>,
) -> Result<MotionReport, MotionError> {
    // The control thread must not take the lock of a watch. Targets reach it through a slot, with a
    // flag for more targets.
    let (mut writer, mut reader) = slot::slot::<[f64; 4]>();
    let passing_on = tokio::spawn(async move {
        loop {
            let [x, y, z] = targets.borrow_and_update().translation.vector.into();
            writer.write(&[x, y, z, 0.0]);
            if targets.changed().await.is_err() {
                return writer.write(&[x, y, z, 1.0]);
            }
        }
    });
    let (mut pose, mut target, mut last) = (None, None, false);
    let control = robot.control_cartesian_pose(move |state, step| {
        let pose = pose.get_or_insert(state.O_T_EE_c);
        if let Read::Newer([x, y, z, over]) = reader.read_newer() {
            (target, last) = (Some(Vector3::new(x, y, z)), over == 1.0);
        }
        let at = Vector3::from_column_slice(&pose[12..15]);
        let way = target.map_or(Vector3::zeros(), |target| target - at);
        let next = at + way.cap_magnitude(VELOCITY * step.as_secs_f64());
        pose[12..15].copy_from_slice(next.as_slice());
        let pose = CartesianPose {
            O_T_EE: *pose,
            elbow: None,
        };
        pose.finish_if(last && way == Vector3::zeros())
    });
    let outcome = control.limit_rate(false).cutoff_frequency(1000.0).await;
    passing_on.abort();
    outcome
}

/// The speed limit of `--raw`, `[m/s]`.
const VELOCITY: f64 = 0.25;
