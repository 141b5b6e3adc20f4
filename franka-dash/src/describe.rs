//! The first message to a page, which contains the constant data.

use franka_async::goal::target_range;
use franka_async::model::collision::{Body, Obstacle, Shape};
use franka_async::model::{EndEffector, Frame, JointVector, Model, RobotKind};
use franka_async::record::Guard;
use franka_async::{READY, pose};
use serde::Serialize;

use crate::frame;
use crate::hub::Hub;
use crate::request::{SPEED_MAX, SPEED_MIN, Tuning};
use crate::simulated::Simulated;
use crate::viewer_lease::ViewerId;

/// Data about the robot, and the permissions of this viewer.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename = "hello")]
pub(crate) struct Hello {
    frame_version: u8,
    viewer: ViewerId,
    /// Start of the server, `[ms]` since 1970. Frame times are relative to this time.
    server: u64,
    robot: &'static str,
    /// True if the robot is simulated and viewers may disturb it.
    simulated: bool,
    simulated_hand: bool,
    /// True if the robot is simulated in virtual time, so its speed can be set.
    virtual_time: bool,
    motion_allowed: bool,
    /// True if the server accepts any command.
    may_command: bool,
    gripper: bool,
    records: bool,
    speed_min: f64,
    speed_max: f64,
    joint_lower: [f64; 7],
    joint_upper: [f64; 7],
    /// Range of joint targets that the driver accepts, `[rad]`.
    target_lower: [f64; 7],
    target_upper: [f64; 7],
    joint_velocity: [f64; 7],
    joint_torque: [f64; 7],
    ready: [f64; 7],
    tunings: Vec<Named>,
    capsules: Vec<Capsule>,
    /// Name of the meshes of this arm.
    meshes: &'static str,
    /// Names of the guards, in the order of the bits of a state frame.
    guards: Vec<String>,
    keep_out: Vec<Region>,
    /// Names of all robots of the server, if it has several robots.
    siblings: Vec<String>,
}

/// A region that the arm must avoid, in the base frame, `[m]`.
#[derive(Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Region {
    /// All points p with `normal . p < offset`.
    Plane { normal: [f64; 3], offset: f64 },
    /// A box with its centre, its orientation (x y z w) and half of each side length.
    Box {
        position: [f64; 3],
        orientation: [f64; 4],
        half: [f64; 3],
    },
}

impl From<&Obstacle> for Region {
    fn from(obstacle: &Obstacle) -> Self {
        match obstacle {
            Obstacle::Plane { normal, offset } => Self::Plane {
                normal: normal.into_inner().into(),
                offset: *offset,
            },
            Obstacle::Box { pose, half } => {
                let (position, orientation) = pose::to_xyzw(pose);
                Self::Box {
                    position,
                    orientation,
                    half: (*half).into(),
                }
            }
        }
    }
}

#[derive(Debug, Serialize)]
struct Named {
    name: &'static str,
    tuning: Tuning,
}

/// A capsule of the driver's collision guard in the frame of its link, `[m]`. Link 0 is the base, 1
/// to 7 are the links, and 8 is the flange.
#[derive(Debug, PartialEq, Serialize)]
struct Capsule {
    link: usize,
    start: [f64; 3],
    end: [f64; 3],
    radius: f64,
}

impl Hello {
    pub(crate) fn new(hub: &Hub, viewer: ViewerId) -> Self {
        let (source, permissions) = (&hub.source, hub.permissions);
        let model = source.model();
        let limits = model.joint_limits();
        let targets = target_range(limits);
        let has_tool = {
            let tool = frame::end_effector(&source.newest().state).f_t_ee;
            tool[(2, 3)] > 0.01
        };
        Self {
            frame_version: frame::VERSION,
            viewer,
            server: hub.began_ms,
            robot: match model.kind() {
                RobotKind::Fer => "Franka Emika Robot",
                _ => "Franka Research 3",
            },
            simulated: permissions.disturbances,
            simulated_hand: hub.simulated.as_ref().is_some_and(Simulated::has_hand),
            virtual_time: {
                let simulated = hub.simulated.as_ref();
                simulated.is_some_and(Simulated::is_in_virtual_time)
            },
            motion_allowed: permissions.motion,
            may_command: permissions.any(),
            gripper: permissions.gripper,
            records: permissions.recording,
            speed_min: SPEED_MIN,
            speed_max: SPEED_MAX,
            joint_lower: limits.lower.into(),
            joint_upper: limits.upper.into(),
            target_lower: targets.map(|(lower, _)| lower),
            target_upper: targets.map(|(_, upper)| upper),
            joint_velocity: limits.velocity.into(),
            joint_torque: limits.torque.into(),
            ready: READY.into(),
            tunings: Tuning::presets()
                .map(|(name, tuning)| Named { name, tuning })
                .into(),
            capsules: capsules(model, has_tool),
            meshes: match model.kind() {
                RobotKind::Fer => "fer",
                _ => "fr3",
            },
            guards: Guard::ALL.map(|guard| guard.to_string()).into(),
            keep_out: hub.keep_out.iter().map(Region::from).collect(),
            siblings: hub.siblings.to_vec(),
        }
    }
}

/// Returns the capsules whose distances to obstacles the guards check.
fn capsules(model: &Model, with_hand: bool) -> Vec<Capsule> {
    let shape = Shape::covering(model.kind()).with_lengths(*model.lengths());
    let shape = if with_hand { shape.with_hand() } else { shape };
    let q = JointVector::zeros();
    let on_link = |(body, capsule): (Body, franka_async::model::collision::Capsule)| {
        let link = usize::from(body.number());
        let frame = match link {
            0 => Default::default(),
            link => {
                let tool = EndEffector::default();
                pose::from_matrix(&model.pose(Frame::ALL[link - 1], &q, &tool)).unwrap_or_default()
            }
        };
        let local = |point: franka_async::nalgebra::Vector3<f64>| -> [f64; 3] {
            frame.inverse_transform_point(&point.into()).coords.into()
        };
        Capsule {
            link,
            start: local(capsule.start),
            end: local(capsule.end),
            radius: capsule.radius,
        }
    };
    shape.at(&q).capsules().map(on_link).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capsules_on_their_links_are_where_the_guards_have_them() {
        let model = Model::fr3();
        let on_links = capsules(model, true);
        let placed = Shape::covering(RobotKind::Fr3).with_hand().at(&READY);
        assert_eq!(placed.capsules().count(), on_links.len());
        for (local, (body, wanted)) in on_links.iter().zip(placed.capsules()) {
            assert_eq!(local.link, usize::from(body.number()));
            assert_eq!(local.radius, wanted.radius);
            let frame = match local.link {
                0 => Default::default(),
                link => {
                    let pose = model.pose(Frame::ALL[link - 1], &READY, &EndEffector::default());
                    pose::from_matrix(&pose).expect("a rigid transformation")
                }
            };
            let end = frame.transform_point(&local.end.into()).coords;
            assert!((end - wanted.end).norm() < 1e-9, "{body:?}");
        }
    }
}
