//! The description that the robot serves: a URDF text.
//!
//! Clients read two things from the description: the velocity envelope (from the joint limits and
//! an XML element of the vendor), and the rigid-body model. Both parsers of libfranka 0.21 require
//! the following:
//!
//! - all of `joint1` to `joint7`, each with `limit` (lower, upper, velocity, effort) and
//!   `position_based_velocity_limits` as direct children; no other joint name may contain one of
//!   these names (the names of finger joints do);
//! - exactly seven movable joints, a link named `link8`, an `axis` for each joint;
//! - no fixed link with mass after link 7, because a hand is part of `m_ee`.
//!
//! Numbers have the fewest digits that read back as the same value.

use core::fmt::Write;

use franka_model::geometry::FLANGE;
use franka_model::{Model, RigidBody};

/// Returns the URDF text that describes `model` as a robot called `name`.
///
/// If the model has no velocity envelope, the text has no element for it.
pub(crate) fn text(name: &str, model: &Model) -> String {
    let mut text = format!("<?xml version=\"1.0\" ?>\n<robot name=\"{name}\">\n");
    write_robot(&mut text, model).expect("writing to a string cannot fail");
    text
}

fn write_robot(text: &mut String, model: &Model) -> core::fmt::Result {
    let bodies = core::iter::once(model.base()).chain(model.links());
    for (i, body) in bodies.enumerate() {
        write_link(text, i, body)?;
    }
    writeln!(text, "  <link name=\"link8\"/>")?;
    for i in 0..7 {
        write_joint(text, i, model)?;
    }
    writeln!(
        text,
        "  <joint name=\"joint8\" type=\"fixed\">\n    \
         <origin rpy=\"0 0 0\" xyz=\"0 0 {FLANGE}\"/>\n    \
         <parent link=\"link7\"/>\n    <child link=\"link8\"/>\n  </joint>\n</robot>"
    )
}

fn write_link(text: &mut String, i: usize, body: &RigidBody) -> core::fmt::Result {
    let (com, inertia) = (&body.com, &body.inertia);
    writeln!(
        text,
        "  <link name=\"link{i}\">\n    <inertial>\n      \
         <origin rpy=\"0 0 0\" xyz=\"{} {} {}\"/>\n      <mass value=\"{}\"/>\n      \
         <inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>\n    \
         </inertial>\n  </link>",
        com.x,
        com.y,
        com.z,
        body.mass,
        inertia.xx,
        inertia.xy,
        inertia.xz,
        inertia.yy,
        inertia.yz,
        inertia.zz,
    )
}

fn write_joint(text: &mut String, i: usize, model: &Model) -> core::fmt::Result {
    let (origin, limits) = (&model.lengths().joint_origins()[i], model.joint_limits());
    let (at, roll) = (&origin.translation, origin.roll);
    let (parent, child) = (i, i + 1);
    writeln!(
        text,
        "  <joint name=\"joint{child}\" type=\"revolute\">\n    \
         <origin rpy=\"{roll} 0 0\" xyz=\"{} {} {}\"/>\n    \
         <parent link=\"link{parent}\"/>\n    <child link=\"link{child}\"/>\n    \
         <axis xyz=\"0 0 1\"/>\n    \
         <limit effort=\"{}\" lower=\"{}\" upper=\"{}\" velocity=\"{}\"/>",
        at.x,
        at.y,
        at.z,
        limits.torque[i],
        limits.hard_lower[i],
        limits.hard_upper[i],
        limits.velocity[i],
    )?;
    if let Some(envelope) = &limits.envelope {
        writeln!(
            text,
            "    <position_based_velocity_limits deceleration_limit=\"{}\" velocity_offset=\"{}\"/>",
            envelope.deceleration[i], envelope.offset[i],
        )?;
    }
    writeln!(text, "  </joint>")
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::{GRAVITY_EARTH, JointVector, Load, MassMatrix, READY};
    use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

    fn text() -> String {
        super::text("fr3", Model::fr3())
    }

    /// The numbers of attribute `name` in the first `<element` after `start`.
    fn attribute(text: &str, element: &str, name: &str) -> Vec<f64> {
        let tag = &text[text.find(&format!("<{element} ")).expect(element)..];
        let tag = &tag[..tag.find('>').expect("a closed tag")];
        let value = &tag[tag.find(&format!("{name}=\"")).expect(name) + name.len() + 2..];
        value[..value.find('"').expect("a closed value")]
            .split(' ')
            .map(|number| number.parse().expect("a number"))
            .collect()
    }

    fn element<'a>(text: &'a str, kind: &str, name: &str) -> &'a str {
        let start = text.find(&format!("<{kind} name=\"{name}\"")).expect(name);
        let end = text[start..].find(&format!("</{kind}>")).expect("an end");
        &text[start..start + end]
    }

    /// Mass matrix and gravity torque, summed body by body from the values in the text.
    fn dynamics_of_text(text: &str, q: &JointVector) -> (MassMatrix, JointVector) {
        let mut pose = Isometry3::identity();
        let mut axes: Vec<(Vector3<f64>, Vector3<f64>)> = Vec::new();
        let (mut mass, mut gravity) = (MassMatrix::zeros(), JointVector::zeros());
        for i in 0..7 {
            let joint = element(text, "joint", &format!("joint{}", i + 1));
            let xyz = attribute(joint, "origin", "xyz");
            let rpy = attribute(joint, "origin", "rpy");
            let origin = Isometry3::from_parts(
                Translation3::new(xyz[0], xyz[1], xyz[2]),
                UnitQuaternion::from_euler_angles(rpy[0], rpy[1], rpy[2]),
            );
            pose = pose * origin * UnitQuaternion::from_euler_angles(0.0, 0.0, q[i]);
            axes.push((pose * Vector3::z(), pose.translation.vector));

            let link = element(text, "link", &format!("link{}", i + 1));
            let com = attribute(link, "origin", "xyz");
            let com = (pose * nalgebra::Point3::new(com[0], com[1], com[2])).coords;
            let m = attribute(link, "mass", "value")[0];
            let part = |name| attribute(link, "inertia", name)[0];
            let (xy, xz, yz) = (part("ixy"), part("ixz"), part("iyz"));
            #[rustfmt::skip]
            let inertia = Matrix3::new(
                part("ixx"), xy, xz,
                xy, part("iyy"), yz,
                xz, yz, part("izz"),
            );
            let r = pose.rotation.to_rotation_matrix();
            let inertia = r.matrix() * inertia * r.matrix().transpose();
            let linear = |k: usize| axes[k].0.cross(&(com - axes[k].1));
            for a in 0..=i {
                gravity[a] -= m * linear(a).dot(&GRAVITY_EARTH);
                for b in 0..=i {
                    mass[(a, b)] +=
                        m * linear(a).dot(&linear(b)) + axes[a].0.dot(&(inertia * axes[b].0));
                }
            }
        }
        (mass, gravity)
    }

    #[test]
    fn the_text_describes_the_model_of_the_clients() {
        let text = text();
        let q = READY + JointVector::from([0.3, -0.2, 0.5, 0.1, -0.4, 0.2, 0.7]);
        let (mass, gravity) = dynamics_of_text(&text, &q);
        let model = Model::fr3();
        assert!((mass - model.mass(&q, &Load::NONE)).amax() < 1e-13);
        assert!((gravity - model.gravity(&q, &Load::NONE, &GRAVITY_EARTH)).amax() < 1e-12);
    }

    #[test]
    fn limits_read_back_as_the_same_numbers() {
        let text = text();
        let limits = Model::fr3().joint_limits();
        for i in 0..7 {
            let joint = element(&text, "joint", &format!("joint{}", i + 1));
            let number = |name| attribute(joint, "limit", name)[0];
            assert_eq!(number("lower"), limits.hard_lower[i]);
            assert_eq!(number("upper"), limits.hard_upper[i]);
            assert_eq!(number("velocity"), limits.velocity[i]);
            assert_eq!(number("effort"), limits.torque[i]);
            let number = |name| attribute(joint, "position_based_velocity_limits", name)[0];
            let envelope = limits.envelope.expect("the robot serves one");
            assert_eq!(number("velocity_offset"), envelope.offset[i]);
            assert_eq!(number("deceleration_limit"), envelope.deceleration[i]);
        }
    }

    #[test]
    fn names_are_those_that_clients_look_for() {
        let text = text();
        assert_eq!(text.matches("type=\"revolute\"").count(), 7);
        assert_eq!(text.matches("<joint ").count(), 8);
        assert_eq!(text.matches("<link name=\"link8\"").count(), 1);
        assert!(!text.contains("tmr") && !text.contains("finger"));
        assert!(text.ends_with("</robot>\n"));
    }
}
