//! The capsules that cover the arm against points of the vendor's meshes.

use franka_model::collision::{Body, Capsule, Shape};
use franka_model::{EndEffector, Frame, JointVector, Model, READY, RobotKind, transform};
use nalgebra::{Isometry3, Point3};
use serde::Deserialize;

use super::Report;

/// Unit of the file, `[m]`.
const UNIT: f64 = 1e-5;

/// Points in the frames of links 0 to 7, and of the Hand in the flange frame.
#[derive(Deserialize)]
struct File {
    fr3: [Vec<[f64; 3]>; 8],
    fer: [Vec<[f64; 3]>; 8],
    hand: Vec<[f64; 3]>,
}

/// Checks `link_surfaces.json`: each point is inside a capsule of its link. A case is a link.
pub(super) fn covered(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: File = serde_json::from_slice(text)?;
    for (kind, links) in [(RobotKind::Fr3, &file.fr3), (RobotKind::Fer, &file.fer)] {
        let links = (0..).map(Body::Link).zip(links);
        for (body, points) in links.chain([(Body::Tool, &file.hand)]) {
            report.case(format!("{kind:?} {body:?}"), |case| {
                let outermost = outermost(kind, body, points);
                case.near("sticks out", &[outermost.max(0.0)], &[0.0], 0.0);
            });
        }
    }
    Ok(report)
}

/// Distance of the outermost point from the capsules of its body, `[m]`; negative inside.
fn outermost(kind: RobotKind, body: Body, points: &[[f64; 3]]) -> f64 {
    let placed = Shape::covering(kind).with_hand().at(&READY);
    let own = placed.capsules().filter(|(of, _)| *of == body);
    let capsules: Vec<Capsule> = own.map(|(_, capsule)| capsule).collect();
    let frame = frame_of(body, kind, &READY);
    let outside = points.iter().map(|point| {
        let point = frame * Point3::from(point.map(|x| x * UNIT));
        let outside = capsules.iter().map(|capsule| outside(capsule, &point));
        outside.fold(f64::INFINITY, f64::min)
    });
    outside.fold(f64::NEG_INFINITY, f64::max)
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

/// Distance of a point from a capsule, `[m]`; negative inside.
fn outside(capsule: &Capsule, point: &Point3<f64>) -> f64 {
    let axis = capsule.end - capsule.start;
    let along = (point.coords - capsule.start).dot(&axis) / axis.norm_squared();
    let nearest = capsule.start + axis * along.clamp(0.0, 1.0);
    (point.coords - nearest).norm() - capsule.radius
}
