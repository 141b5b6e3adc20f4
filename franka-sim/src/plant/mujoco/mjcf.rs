//! MJCF text of an arm, with the parameters of [`franka_model`].

use std::collections::BTreeSet;
use std::fmt::{Display, Write as _};

use franka_model::collision::{Body, Capsule, Shape};
use franka_model::geometry::FLANGE;
use franka_model::{EndEffector, Frame, JointVector, Load, Model, RobotKind};
use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use super::{fingers, joint_name};
use crate::arm;

/// MJCF text of an arm with the base frame `base` in the world and with `load` on the flange.
pub(super) fn arm(
    kind: RobotKind,
    body: &arm::Body,
    armature: &JointVector,
    load: &Load,
    has_hand: bool,
    base: &Isometry3<f64>,
) -> String {
    let built = body.as_built(kind);
    let shapes = Shapes::of(kind, has_hand);
    let mut text = String::new();
    // The moments of inertia of a load may be impossible; MuJoCo then uses the nearest possible
    // moments.
    text.push_str(
        "<mujoco><compiler angle='radian' balanceinertia='true'/><default>\
         <geom contype='2' conaffinity='1' mass='0'/></default><worldbody>",
    );
    let place = numbers(&base.translation.vector);
    let turn = quaternion(&base.rotation);
    add(
        &mut text,
        format_args!("<body name='link0' pos='{place}' quat='{turn}'>"),
    );
    shapes.write(&mut text, Body::Link(0));
    for (i, (origin, link)) in built.joint_origins().iter().zip(built.links()).enumerate() {
        let position = numbers(&origin.translation.vector);
        let turn = quaternion(&origin.rotation);
        let number = i + 1;
        add(
            &mut text,
            format_args!("<body name='link{number}' pos='{position}' quat='{turn}'>"),
        );
        inertial(&mut text, link.mass, &link.com, &link.inertia.matrix());
        let (name, armature) = (joint_name(i), armature[i]);
        add(
            &mut text,
            format_args!("<joint name='{name}' axis='0 0 1' armature='{armature}'/>"),
        );
        shapes.write(&mut text, Body::Link(number as u8));
    }
    add(
        &mut text,
        format_args!("<body name='flange' pos='0 0 {FLANGE}'>"),
    );
    if load.mass != 0.0 {
        inertial(&mut text, load.mass, &load.com, &load.inertia);
    }
    if has_hand {
        fingers::write_hand(&mut text);
    }
    text.push_str(&"</body>".repeat(9));
    text.push_str("</worldbody><actuator>");
    for i in 0..7 {
        let name = joint_name(i);
        add(
            &mut text,
            format_args!("<damper name='{name}' joint='{name}' kv='1' ctrlrange='0 1e9'/>"),
        );
    }
    text.push_str("</actuator><contact>");
    shapes.write_pairs(&mut text);
    text.push_str("</contact>");
    if has_hand {
        fingers::write_coupling(&mut text);
    }
    text.push_str("</mujoco>");
    text
}

/// The capsules of the links, each in the frame of its link.
struct Shapes {
    capsules: Vec<(Body, Capsule)>,
    /// Pairs of links that can touch each other.
    pairs: BTreeSet<(Body, Body)>,
}

impl Shapes {
    /// Shapes of the links, and of the hand if the scene has one.
    fn of(kind: RobotKind, has_hand: bool) -> Self {
        let shape = Shape::covering(kind);
        let zero = JointVector::zeros();
        let placed = shape.at(&zero);
        let mut capsules: Vec<_> = placed
            .capsules()
            .map(|(body, capsule)| (body, moved(&capsule, &frame(kind, body).inverse())))
            .collect();
        if has_hand {
            capsules.push((Body::Tool, fingers::HAND));
        }
        let with_hand = shape.with_hand();
        let pairs = with_hand
            .at(&zero)
            .pairs()
            .map(|pair| pair.bodies)
            .collect();
        Self { capsules, pairs }
    }

    fn write(&self, text: &mut String, body: Body) {
        for (n, (_, capsule)) in self.all_of(body) {
            let name = geom(body, n);
            write_capsule(text, &name, capsule);
        }
    }

    /// Writes every shape of one body of a pair with every shape of the other.
    fn write_pairs(&self, text: &mut String) {
        for &(inner, outer) in &self.pairs {
            for (a, _) in self.all_of(inner) {
                for (b, _) in self.all_of(outer) {
                    let (inner, outer) = (geom(inner, a), geom(outer, b));
                    add(
                        text,
                        format_args!("<pair geom1='{inner}' geom2='{outer}' condim='3'/>"),
                    );
                }
            }
        }
    }

    fn all_of(&self, body: Body) -> impl Iterator<Item = (usize, &(Body, Capsule))> {
        let own = self.capsules.iter().filter(move |(of, _)| *of == body);
        own.enumerate()
    }
}

/// Pose of a link at the joint positions zero.
fn frame(kind: RobotKind, body: Body) -> Isometry3<f64> {
    let Body::Link(link @ 1..) = body else {
        return Isometry3::identity();
    };
    let joint = Frame::ALL[usize::from(link) - 1];
    let pose = Model::of(kind).pose(joint, &JointVector::zeros(), &EndEffector::default());
    franka_model::transform::isometry(&pose).expect("the frame of a link is rigid")
}

fn moved(capsule: &Capsule, by: &Isometry3<f64>) -> Capsule {
    let place = |point: &Vector3<f64>| by.transform_point(&(*point).into()).coords;
    Capsule {
        start: place(&capsule.start),
        end: place(&capsule.end),
        radius: capsule.radius,
    }
}

/// The name of the `n`th shape of a body.
pub(super) fn geom(body: Body, n: usize) -> String {
    match body {
        Body::Link(link) => format!("link{link}_{n}"),
        Body::Tool => format!("hand_{n}"),
    }
}

pub(super) fn write_capsule(text: &mut String, name: &str, capsule: &Capsule) {
    let (start, end) = (numbers(&capsule.start), numbers(&capsule.end));
    let radius = capsule.radius;
    add(
        text,
        format_args!("<geom name='{name}' type='capsule' fromto='{start} {end}' size='{radius}'/>"),
    );
}

/// Writes the mass and the principal moments, because MuJoCo itself finds the principal axes with
/// only eight accurate digits.
fn inertial(text: &mut String, mass: f64, com: &Vector3<f64>, inertia: &Matrix3<f64>) {
    let symmetric = (inertia + inertia.transpose()) / 2.0;
    let principal = symmetric.symmetric_eigen();
    let mut axes = principal.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    let turn = UnitQuaternion::from_matrix_eps(&axes, 1e-16, 100, UnitQuaternion::identity());
    // The matrix is semidefinite, except for rounding.
    let moments = principal.eigenvalues.map(|moment| moment.max(0.0));
    let (position, turn, moments) = (numbers(com), quaternion(&turn), numbers(&moments));
    add(
        text,
        format_args!(
            "<inertial pos='{position}' quat='{turn}' mass='{mass}' diaginertia='{moments}'/>"
        ),
    );
}

/// Numbers in MJCF format, with all digits that are needed to read the same number again.
pub(super) fn numbers(vector: &Vector3<f64>) -> impl Display + use<> {
    let Vector3 { data, .. } = vector;
    let [[x, y, z]] = data.0;
    format!("{x} {y} {z}")
}

pub(super) fn quaternion(turn: &UnitQuaternion<f64>) -> impl Display + use<> {
    format!("{} {} {} {}", turn.w, turn.i, turn.j, turn.k)
}

pub(super) fn add(text: &mut String, part: std::fmt::Arguments<'_>) {
    text.write_fmt(part).expect("a string takes everything");
}
