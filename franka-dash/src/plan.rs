//! Previews of motions that have a target. The page and the hold use the same preview, so they
//! refuse the same motions.

use franka_async::error::PathError;
use franka_async::model::JointVector;
use franka_async::model::collision::Obstacle;
use franka_async::motion::Preview;
use franka_async::nalgebra::Vector3;
use franka_async::state::RobotState;
use franka_async::{MotionError, Robot};
use serde::Serialize;

use crate::frame;
use crate::request::{Motion, SPEED_MAX};
use crate::way::Way;

/// A viewer's question about a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Question {
    /// Number of the question, which the answer repeats.
    pub(crate) number: u32,
    pub(crate) motion: Motion,
    /// Largest speed, `[m/s]`.
    pub(crate) speed: f64,
}

/// Returns true if the motion has a target, so that it can be planned.
pub(crate) fn has_end(motion: &Motion) -> bool {
    matches!(
        motion,
        Motion::Joints { .. } | Motion::Ready {} | Motion::Pose { .. }
    )
}

/// The preview of a motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Plan {
    /// Duration of the motion if nothing delays it, `[s]`.
    duration: f64,
    /// Length of the end effector's path, `[m]`.
    length: f64,
    /// Largest speed of the joints, the flange and the end effector on the path, `[m/s]`.
    fastest: f64,
    /// Joint positions at the end, `[rad]`.
    q: [f64; 7],
    /// Poses at the end of the motion, in the order of a state frame. Each is a position and a
    /// quaternion x y z w.
    poses: Vec<f64>,
    /// Path of the end effector, `[m]`.
    line: Vec<[f64; 3]>,
}

/// Previews a motion that [has a target](has_end) and starts now. Returns the reason if the motion
/// is refused. The computation takes milliseconds.
pub(crate) fn plan(
    robot: &Robot,
    motion: &Motion,
    speed: f64,
    keep_out: &[Obstacle],
) -> Result<Plan, String> {
    let way = Way::of(robot, motion);
    let target = way.target().filter(|_| has_end(motion));
    let target = target.ok_or("a motion without an end has no preview")?;
    let moving = robot.move_to(target).limits(way.budget(robot, speed));
    let preview = moving.preview().map_err(refusal)?;
    let state = robot.state();
    let blocked = preview.blocked(robot.model(), &state, keep_out);
    let place = |q| robot.pose_at(q).translation.vector;
    if let Some(blocked) = blocked.map_err(|error| error.to_string())? {
        let what = match blocked.region {
            Some(region) => format!("keep-out region {region}"),
            None => "itself".to_owned(),
        };
        let (after, at) = (blocked.time.as_secs_f64(), millimetres(place(blocked.q)));
        return Err(format!(
            "the arm would come too close to {what} after {after:.1} s, with the end effector at \
             {at}"
        ));
    }
    let fastest = fastest(robot, &state, &preview);
    if fastest > SPEED_MAX {
        return Err(format!(
            "a point of the arm would move at {:.0} mm/s, expected {:.0} mm/s at most: choose a \
             lower speed",
            fastest * 1e3,
            SPEED_MAX * 1e3
        ));
    }
    let line: Vec<_> = preview.postures.iter().map(|(_, q)| place(*q)).collect();
    let q = preview.end();
    let poses = frame::poses(robot.model(), &state, q);
    Ok(Plan {
        duration: preview.duration().as_secs_f64(),
        length: line.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum(),
        fastest,
        q,
        poses: poses.flat_map(|(p, r)| p.into_iter().chain(r)).collect(),
        line: thinned(&line),
    })
}

/// Like [`plan`], but runs in a separate task that delays no other task.
pub(crate) async fn in_background(
    robot: &Robot,
    motion: Motion,
    speed: f64,
    keep_out: Vec<Obstacle>,
) -> Result<Plan, String> {
    let robot = robot.clone();
    let planned = move || plan(&robot, &motion, speed, &keep_out);
    let planned = tokio::task::spawn_blocking(planned).await;
    planned.unwrap_or_else(|error| Err(error.to_string()))
}

/// Returns the text of a refusal. The text omits the number of the waypoint, because a viewer sets
/// only one target.
fn refusal(error: MotionError) -> String {
    match error {
        MotionError::Path(PathError::Waypoint { error, .. }) => error.to_string(),
        MotionError::Path(PathError::Way {
            x,
            y,
            z,
            translation,
            joint,
            ..
        }) => {
            let why = match joint {
                Some(joint) => format!("joint {joint} is at the end of its range"),
                None => "the arm is stretched out, or cannot turn further".to_owned(),
            };
            let at = millimetres(Vector3::new(x, y, z));
            let off = translation * 1e3;
            format!(
                "the arm cannot follow the straight line beyond {at}, where it is off by \
                {off:.0} mm: {why}"
            )
        }
        MotionError::Path(PathError::Turn { degrees, .. }) => {
            format!(
                "the turn is {degrees} degrees, expected less than 170 degrees: the direction of a larger turn is ambiguous"
            )
        }
        error => error.to_string(),
    }
}

fn millimetres(at: Vector3<f64>) -> String {
    let [x, y, z] = [at.x, at.y, at.z].map(|x| (x * 1e3).round() as i64);
    format!("({x}, {y}, {z}) mm")
}

/// Returns the speed of the fastest point on the path, `[m/s]`.
fn fastest(robot: &Robot, state: &RobotState, preview: &Preview) -> f64 {
    let tool = frame::end_effector(state);
    let speeds = preview.postures.windows(2).map(|ends| {
        let [(from, q), (to, next)] = [ends[0], ends[1]];
        let time = (to - from).as_secs_f64();
        let [q, next] = [q, next].map(JointVector::from);
        robot.model().fastest_point(&q, &((next - q) / time), &tool)
    });
    speeds.fold(0.0, f64::max)
}

/// Returns at most [`LINE_MAX`] points of a line, including its ends.
fn thinned(line: &[Vector3<f64>]) -> Vec<[f64; 3]> {
    let last = line.len().saturating_sub(1);
    let count = last.min(LINE_MAX - 1);
    let points = (0..=count).map(|i| line[i * last / count.max(1)]);
    points.map(Into::into).collect()
}

/// Largest number of points of a line that the server sends.
const LINE_MAX: usize = 100;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_keeps_its_ends_and_has_no_more_points_than_are_sent() {
        for count in [1, 2, 3, 99, 100, 101, 1000] {
            let line: Vec<_> = (0..count).map(|i| Vector3::repeat(i as f64)).collect();
            let thin = thinned(&line);
            assert_eq!(thin.len(), count.min(LINE_MAX));
            assert_eq!(
                (thin[0], thin[thin.len() - 1]),
                ([0.0; 3], [count as f64 - 1.0; 3])
            );
        }
    }
}
