//! The capsules that cover the arm against points of the vendor's meshes.

use franka_model::collision::{Body, Capsule, Shape};
use franka_model::{EndEffector, Frame, JointVector, Model, READY, RobotKind, transform};
use nalgebra::{Isometry3, Point3};

use super::{Malformed, Node, Report};

/// Unit of the file, `[m]`.
const UNIT: f64 = 1e-5;

/// Checks `link_surfaces.json`: each point is inside a capsule of its own link. A case is a link.
pub(super) fn covered(root: &Node<'_>) -> Result<Report, Malformed> {
    let mut report = Report::default();
    for (kind, name) in [(RobotKind::Fr3, "fr3"), (RobotKind::Fer, "fer")] {
        let links = root.get(name)?.list()?;
        if links.len() != 8 {
            return Err(root.malformed("links 0 to 7"));
        }
        for (link, node) in (0..).zip(&links) {
            check(&mut report, node, kind, Body::Link(link))?;
        }
        check(&mut report, &root.get("hand")?, kind, Body::Tool)?;
    }
    Ok(report)
}

fn check(
    report: &mut Report,
    node: &Node<'_>,
    kind: RobotKind,
    body: Body,
) -> Result<(), Malformed> {
    let placed = Shape::covering(kind).with_hand().at(&READY);
    let capsules: Vec<Capsule> = placed
        .capsules()
        .filter_map(|(of, capsule)| (of == body).then_some(capsule))
        .collect();
    let frame = frame_of(body, kind, &READY);
    let mut outermost = f64::NEG_INFINITY;
    for point in node.list()? {
        let point = frame * Point3::from(point.numbers::<3>()?.map(|x| x * UNIT));
        let outside = capsules.iter().map(|capsule| outside(capsule, &point));
        outermost = outermost.max(outside.fold(f64::INFINITY, f64::min));
    }
    report.case(format!("{kind:?} {body:?}"), |case| {
        case.near("sticks out", &[outermost.max(0.0)], &[0.0], 0.0);
    });
    Ok(())
}

/// The frame of a body in the base frame.
fn frame_of(body: Body, kind: RobotKind, q: &JointVector) -> Isometry3<f64> {
    let frame = match body {
        Body::Link(0) => return Isometry3::identity(),
        Body::Link(link) => Frame::ALL[usize::from(link) - 1],
        Body::Tool => Frame::Flange,
    };
    let pose = Model::of(kind).pose(frame, q, &EndEffector::default());
    transform::isometry(&pose).expect("the pose of a frame is rigid")
}

/// How far a point is outside of a capsule, `[m]`; negative inside.
fn outside(capsule: &Capsule, point: &Point3<f64>) -> f64 {
    let axis = capsule.end - capsule.start;
    let along = (point.coords - capsule.start).dot(&axis) / axis.norm_squared();
    let nearest = capsule.start + axis * along.clamp(0.0, 1.0);
    (point.coords - nearest).norm() - capsule.radius
}
