//! Messages for viewers about one cycle: poses, joints and the external force.

use franka_model::geometry::{FLANGE, Lengths};
use franka_model::transform;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::options::Robot;
use crate::schema::foxglove::{
    ArrowPrimitive, Color, FrameTransform, FrameTransforms, JointState, JointStates, Pose,
    PoseInFrame, Quaternion, SceneEntity, SceneUpdate, Vector3 as Vector,
};
use crate::{Cycle, HostTime};

/// Names of one robot's frames and joints: the names in `franka_description`, with the robot's name
/// as prefix.
#[derive(Debug)]
pub(super) struct Frames {
    prefix: String,
    lengths: Lengths,
}

impl Frames {
    pub(super) fn of(robot: &Robot) -> Self {
        let arm = robot.arm();
        let prefix = match robot.name.as_str() {
            "" => arm.to_owned(),
            name => format!("{name}_{arm}"),
        };
        Self {
            prefix,
            lengths: robot.lengths,
        }
    }

    fn link(&self, number: usize) -> String {
        format!("{}_link{number}", self.prefix)
    }

    fn named(&self, name: &str) -> String {
        format!("{}_{name}", self.prefix)
    }

    /// Returns the pose of each link relative to the previous link. The pose of the end effector is
    /// relative to the flange, and the poses of the reference and the target are relative to the
    /// base.
    pub(super) fn transforms(&self, cycle: &Cycle) -> FrameTransforms {
        let mut transforms = Vec::with_capacity(12);
        let mut put = |parent: String, child: String, pose: &Isometry3<f64>| {
            transforms.push(FrameTransform {
                timestamp: Some(timestamp(cycle.time)),
                parent_frame_id: parent,
                child_frame_id: child,
                translation: Some(vector(&pose.translation.vector)),
                rotation: Some(quaternion(&pose.rotation)),
            });
        };
        let origins = self.lengths.joint_origins();
        for (joint, (origin, q)) in origins.iter().zip(cycle.state.q).enumerate() {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), origin.roll)
                * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), q);
            let pose = Isometry3::from_parts(Translation3::from(origin.translation), turn);
            put(self.link(joint), self.link(joint + 1), &pose);
        }
        put(
            self.link(7),
            self.link(8),
            &Isometry3::translation(0.0, 0.0, FLANGE),
        );
        if let Some(pose) = transform::isometry_from_array(&cycle.state.F_T_EE) {
            put(self.link(8), self.named("ee"), &pose);
        }
        for (name, pose) in [
            ("reference", cycle.reference),
            ("target", cycle.record.pose_target),
        ] {
            if let Some(pose) = pose {
                put(self.link(0), self.named(name), &pose);
            }
        }
        FrameTransforms { transforms }
    }

    /// Returns the pose towards which the reference moves, if any.
    pub(super) fn target(&self, cycle: &Cycle) -> Option<PoseInFrame> {
        let target = cycle.record.pose_target?;
        Some(PoseInFrame {
            timestamp: Some(timestamp(cycle.time)),
            frame_id: self.link(0),
            pose: Some(pose(&target)),
        })
    }

    pub(super) fn joints(&self, cycle: &Cycle) -> JointStates {
        let state = &cycle.state;
        let joint = |index: usize| JointState {
            name: format!("{}_joint{}", self.prefix, index + 1),
            position: Some(state.q[index]),
            velocity: Some(state.dq[index]),
            acceleration: None,
            effort: Some(state.tau_J[index]),
        };
        JointStates {
            timestamp: Some(timestamp(cycle.time)),
            joints: (0..7).map(joint).collect(),
        }
    }

    /// Returns the external force on the arm as an arrow that ends at the stiffness frame. The
    /// length of the arrow is 1 cm per newton. The arrow fades if no newer arrow arrives. A force
    /// below 1 N has no arrow.
    pub(super) fn scene(&self, cycle: &Cycle) -> Option<SceneUpdate> {
        let [x, y, z, ..] = cycle.state.O_F_ext_hat_K;
        // The state contains the force with which the robot pushes.
        let force = -Vector3::new(x, y, z);
        let newtons = force.norm();
        if newtons.is_nan() || newtons < FORCE_MIN {
            return None;
        }
        let end_effector = transform::isometry_from_array(&cycle.state.O_T_EE)?;
        let stiffness = transform::isometry_from_array(&cycle.state.EE_T_K)?;
        let tip = (end_effector * stiffness).translation.vector;
        let length = newtons.min(FORCE_MAX) * METRES_PER_NEWTON;
        let start = tip - force / newtons * length;
        // The arrow points along the x axis of its pose. For the direction opposite to x, any half
        // turn about an axis perpendicular to x works.
        let turn = UnitQuaternion::rotation_between(&Vector3::x(), &force).unwrap_or_else(|| {
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), core::f64::consts::PI)
        });
        let arrow = ArrowPrimitive {
            pose: Some(pose(&Isometry3::from_parts(start.into(), turn))),
            shaft_length: 0.8 * length,
            shaft_diameter: 0.01,
            head_length: 0.2 * length,
            head_diameter: 0.02,
            color: Some(Color {
                r: 0.9,
                g: 0.3,
                b: 0.1,
                a: 1.0,
            }),
        };
        let entity = SceneEntity {
            timestamp: Some(timestamp(cycle.time)),
            frame_id: self.link(0),
            id: self.named("force"),
            lifetime: Some(prost_types::Duration {
                seconds: 0,
                nanos: 100_000_000,
            }),
            frame_locked: true,
            arrows: vec![arrow],
        };
        Some(SceneUpdate {
            deletions: Vec::new(),
            entities: vec![entity],
        })
    }
}

/// Force below which the estimate is mostly noise, `[N]`.
const FORCE_MIN: f64 = 1.0;

/// Force above which the arrow would not fit in the picture, `[N]`.
const FORCE_MAX: f64 = 100.0;

const METRES_PER_NEWTON: f64 = 0.01;

/// Converts a time to the format of Foxglove's messages.
pub(super) fn timestamp(time: HostTime) -> prost_types::Timestamp {
    let nanos = time.as_nanos();
    prost_types::Timestamp {
        seconds: (nanos / 1_000_000_000) as i64,
        nanos: (nanos % 1_000_000_000) as i32,
    }
}

fn vector(vector: &Vector3<f64>) -> Vector {
    let [x, y, z] = (*vector).into();
    Vector { x, y, z }
}

fn quaternion(rotation: &UnitQuaternion<f64>) -> Quaternion {
    let [x, y, z, w] = rotation.coords.into();
    Quaternion { x, y, z, w }
}

fn pose(isometry: &Isometry3<f64>) -> Pose {
    Pose {
        position: Some(vector(&isometry.translation.vector)),
        orientation: Some(quaternion(&isometry.rotation)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::{EndEffector, Frame, Model, RobotKind};

    fn isometry(transform: &FrameTransform) -> Isometry3<f64> {
        let (t, r) = (transform.translation.unwrap(), transform.rotation.unwrap());
        let rotation = nalgebra::Quaternion::new(r.w, r.x, r.y, r.z);
        Isometry3::from_parts(
            Translation3::new(t.x, t.y, t.z),
            UnitQuaternion::from_quaternion(rotation),
        )
    }

    #[test]
    fn frames_lead_from_base_to_end_effector() {
        let mut robot = Robot::new(RobotKind::Fr3);
        robot.lengths = Lengths::RECORDED_FR3;
        let model = Model::fr3().clone().with_lengths(robot.lengths);
        let mut cycle = Cycle::default();
        cycle.state.q = [0.1, -0.7, 0.2, -2.3, 0.3, 1.5, 0.7];
        cycle.state.F_T_EE[14] = 0.1034;
        let FrameTransforms { transforms } = Frames::of(&robot).transforms(&cycle);
        let names: Vec<_> = transforms
            .iter()
            .map(|t| (t.parent_frame_id.as_str(), t.child_frame_id.as_str()))
            .collect();
        assert_eq!(names[0], ("fr3_link0", "fr3_link1"));
        assert_eq!(
            names[7..],
            [("fr3_link7", "fr3_link8"), ("fr3_link8", "fr3_ee")]
        );
        let tip = transforms
            .iter()
            .map(isometry)
            .fold(Isometry3::identity(), |pose, next| pose * next);
        let ee = EndEffector::from_arrays(&cycle.state.F_T_EE, &cycle.state.EE_T_K);
        let q = cycle.state.q.into();
        let expected = model.pose(Frame::EndEffector, &q, &ee);
        let error = (transform::matrix(&tip) - expected).amax();
        assert!(error < 1e-12, "{error}");
    }

    #[test]
    fn the_arrow_of_a_force_ends_at_the_end_effector() {
        let mut robot = Robot::new(RobotKind::Fer);
        robot.name = "left".to_owned();
        for push in [[10.0, 0.0, 0.0], [-10.0, 0.0, 0.0], [3.0, -4.0, 12.0]] {
            let mut cycle = Cycle::default();
            cycle.state.O_T_EE[12..15].copy_from_slice(&[0.5, 0.1, 0.4]);
            cycle.state.O_F_ext_hat_K[..3].copy_from_slice(&push);
            let scene = Frames::of(&robot).scene(&cycle).unwrap();
            let entity = &scene.entities[0];
            assert_eq!(entity.frame_id, "left_fer_link0");
            let arrow = entity.arrows[0];
            let (p, r) = (
                arrow.pose.unwrap().position.unwrap(),
                arrow.pose.unwrap().orientation.unwrap(),
            );
            let rotation =
                UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(r.w, r.x, r.y, r.z));
            let length = arrow.shaft_length + arrow.head_length;
            let along = rotation * Vector3::x() * length;
            assert!(
                (along * 100.0 + Vector3::from(push)).norm() < 1e-9,
                "{along}"
            );
            let end = Vector3::new(p.x, p.y, p.z) + along;
            assert!((end - Vector3::new(0.5, 0.1, 0.4)).norm() < 1e-9, "{end}");
        }
        assert_eq!(Frames::of(&robot).scene(&Cycle::default()), None);
    }
}
