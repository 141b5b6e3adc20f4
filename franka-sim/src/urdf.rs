//! The description that the robot serves: a URDF text.
//!
//! Clients read two things from it: the velocity envelope, from the joints' limits and a vendor
//! element, and the rigid-body model. What both parsers of libfranka 0.21 insist on, and trip over:
//!
//! - all of `joint1` to `joint7`, each with `limit` (lower, upper, velocity, effort) and
//!   `position_based_velocity_limits` as direct children; no other joint whose name contains one
//!   of these (fingers do);
//! - exactly seven movable joints, a link named `link8`, an `axis` for each joint;
//! - nothing fixed behind link 7 that has mass: a hand is part of `m_ee`.
//!
//! Numbers are written with the fewest digits that read back as the same value.

use core::fmt::Write;

use franka_model::limits::JointLimits;

/// The URDF text of a Franka Research 3 with these limits.
pub(crate) fn fr3(limits: &JointLimits) -> String {
    let mut text = String::from("<?xml version=\"1.0\" ?>\n<robot name=\"fr3\">\n");
    write_robot(&mut text, limits).expect("writing to a string cannot fail");
    text
}

fn write_robot(text: &mut String, limits: &JointLimits) -> core::fmt::Result {
    for (i, link) in LINKS.iter().enumerate() {
        write_link(text, i, link)?;
    }
    writeln!(text, "  <link name=\"link8\"/>")?;
    for i in 0..7 {
        write_joint(text, i, limits)?;
    }
    writeln!(
        text,
        "  <joint name=\"joint8\" type=\"fixed\">\n    \
         <origin rpy=\"0 0 0\" xyz=\"0 0 {FLANGE}\"/>\n    \
         <parent link=\"link7\"/>\n    <child link=\"link8\"/>\n  </joint>\n</robot>"
    )
}

fn write_link(text: &mut String, i: usize, link: &Inertial) -> core::fmt::Result {
    let [x, y, z] = link.com;
    let [xx, xy, xz, yy, yz, zz] = link.inertia;
    writeln!(
        text,
        "  <link name=\"link{i}\">\n    <inertial>\n      \
         <origin rpy=\"0 0 0\" xyz=\"{x} {y} {z}\"/>\n      <mass value=\"{}\"/>\n      \
         <inertia ixx=\"{xx}\" ixy=\"{xy}\" ixz=\"{xz}\" iyy=\"{yy}\" iyz=\"{yz}\" izz=\"{zz}\"/>\n    \
         </inertial>\n  </link>",
        link.mass
    )
}

fn write_joint(text: &mut String, i: usize, limits: &JointLimits) -> core::fmt::Result {
    let (roll, [x, y, z]) = JOINTS[i];
    let (parent, child) = (i, i + 1);
    writeln!(
        text,
        "  <joint name=\"joint{child}\" type=\"revolute\">\n    \
         <origin rpy=\"{roll} 0 0\" xyz=\"{x} {y} {z}\"/>\n    \
         <parent link=\"link{parent}\"/>\n    <child link=\"link{child}\"/>\n    \
         <axis xyz=\"0 0 1\"/>\n    \
         <limit effort=\"{}\" lower=\"{}\" upper=\"{}\" velocity=\"{}\"/>\n    \
         <position_based_velocity_limits deceleration_limit=\"{}\" velocity_offset=\"{}\"/>\n  \
         </joint>",
        limits.torque[i],
        limits.hard_lower[i],
        limits.hard_upper[i],
        limits.velocity[i],
        limits.envelope_deceleration[i],
        limits.velocity_offset[i],
    )
}

/// Mass, centre of mass and inertia about it (xx xy xz yy yz zz) of a link, in its axes.
struct Inertial {
    mass: f64,
    com: [f64; 3],
    inertia: [f64; 6],
}

/// Height of the flange above link 7, `[m]`.
const FLANGE: f64 = 0.107;

const QUARTER: f64 = core::f64::consts::FRAC_PI_2;

/// Roll `[rad]` and position `[m]` of each joint in the link before: libfranka 0.21,
/// `test/fr3.urdf`.
const JOINTS: [(f64, [f64; 3]); 7] = [
    (0.0, [0.0, 0.0, 0.333]),
    (-QUARTER, [0.0, 0.0, 0.0]),
    (QUARTER, [0.0, -0.316, 0.0]),
    (QUARTER, [0.0825, 0.0, 0.0]),
    (-QUARTER, [-0.0825, 0.384, 0.0]),
    (QUARTER, [0.0, 0.0, 0.0]),
    (QUARTER, [0.088, 0.0, 0.0]),
];

/// Links 0 to 7, from the same file. `franka_model` has 1 to 7 inside; the test holds both together.
const LINKS: [Inertial; 8] = [
    Inertial {
        mass: 2.3966,
        com: [-0.0172, 0.0004, 0.0745],
        inertia: [0.009, 0.0, 0.002, 0.0115, 0.0, 0.0085],
    },
    Inertial {
        mass: 2.9274653454,
        com: [4.128e-07, -0.0181251324, -0.038603597],
        inertia: [
            0.023927316485107913,
            1.3317903455714081e-05,
            -0.00011404774918616684,
            0.0224821613275756,
            -0.0019950320628240115,
            0.006350098258530016,
        ],
    },
    Inertial {
        mass: 2.9355370338,
        com: [0.0031828864, -0.0743221644, 0.0088146084],
        inertia: [
            0.041938946257609425,
            0.00020257331521090626,
            0.004077784227179924,
            0.02514514885014724,
            -0.0042252158006570156,
            0.06170214472888839,
        ],
    },
    Inertial {
        mass: 2.2449013699,
        com: [0.0407015686, -0.0048200565, -0.0289730823],
        inertia: [
            0.02410142547240885,
            0.002404694559042109,
            -0.002856269270114313,
            0.01974053266708178,
            -0.002104212683891874,
            0.019044494482244823,
        ],
    },
    Inertial {
        mass: 2.6155955791,
        com: [-0.0459100965, 0.063049296, -0.0085187868],
        inertia: [
            0.03452998321913202,
            0.01322552265982813,
            0.01015142998484113,
            0.028881621933049058,
            -0.0009762833870704552,
            0.04125471171146641,
        ],
    },
    Inertial {
        mass: 2.3271207594,
        com: [-0.0016039605, 0.0292536262, -0.097296599],
        inertia: [
            0.051610278463662895,
            -0.005715173387783472,
            -0.0035673167625872135,
            0.04787729713371481,
            0.010673985108535986,
            0.016423625579357254,
        ],
    },
    Inertial {
        mass: 1.8170376524,
        com: [0.0597131221, -0.0410294666, -0.0101692726],
        inertia: [
            0.005412333594383447,
            0.006193456360285834,
            0.0014219289306117652,
            0.014058329545509979,
            -0.0013140753741120031,
            0.016080817924212554,
        ],
    },
    Inertial {
        mass: 0.6271432862,
        com: [0.0045225817, 0.0086261921, -0.0161633251],
        inertia: [
            0.00021092389150104718,
            -2.433299114461931e-05,
            4.564480393778983e-05,
            0.00017718568002411474,
            8.744070223226438e-05,
            5.993190599659971e-05,
        ],
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::{GRAVITY_EARTH, JointVector, Load, MassMatrix, Model, READY};
    use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

    fn text() -> String {
        fr3(Model::fr3().joint_limits())
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

    /// Mass matrix and gravity torque, summed body by body from what the text says.
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
            assert_eq!(number("velocity_offset"), limits.velocity_offset[i]);
            assert_eq!(
                number("deceleration_limit"),
                limits.envelope_deceleration[i]
            );
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
