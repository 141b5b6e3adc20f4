//! The arm from the side and from above, with the place of the contact.

use franka_model::JointVector;
use franka_model::Model;
use franka_model::collision::Body;
use nalgebra::Vector3;
use svg::Node;
use svg::node::element::{Circle, Group, Line};

use super::figure::{INK, line, text};
use super::{Explanation, place};

/// Direction of view: the signed coordinates that point right and up.
struct View {
    name: &'static str,
    right: fn(&Vector3<f64>) -> f64,
    up: fn(&Vector3<f64>) -> f64,
}

const VIEWS: [View; 2] = [
    View {
        name: "from the side (x, z)",
        right: |p| p.x,
        up: |p| p.z,
    },
    View {
        name: "from above (x, y)",
        right: |p| p.x,
        up: |p| p.y,
    },
];

/// Draws two squares of `size` pixels, one below the other.
pub(super) fn draw(explanation: &Explanation, left: f64, top: f64, size: f64) -> Group {
    let mut group = Group::new();
    let Some(place) = &explanation.contact else {
        return group;
    };
    let model = Model::physically_consistent(explanation.robot);
    let shape = place::shape(model, place.has_hand);
    let q = JointVector::from(place.q);
    let placed = shape.at(&q);
    let touched = place.contact.map(|contact| contact.body);
    for (i, view) in VIEWS.iter().enumerate() {
        let top = top + i as f64 * (size + 28.0);
        group.append(text(left, top - 5.0, view.name));
        // Everything must fit into the picture at the same scale.
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for (_, capsule) in placed.capsules() {
            for point in [capsule.start, capsule.end] {
                for (axis, value) in [(view.right)(&point), (view.up)(&point)]
                    .into_iter()
                    .enumerate()
                {
                    low[axis] = low[axis].min(value - capsule.radius);
                    high[axis] = high[axis].max(value + capsule.radius);
                }
            }
        }
        let wide = (high[0] - low[0]).max(high[1] - low[1]) + 2.0 * MARGIN;
        if !wide.is_finite() {
            continue;
        }
        let scale = size / wide;
        let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
        let to = |p: &Vector3<f64>| {
            (
                left + 0.5 * size + ((view.right)(p) - middle[0]) * scale,
                top + 0.5 * size - ((view.up)(p) - middle[1]) * scale,
            )
        };
        // The parts form one group with one opacity, so that overlapping parts have the same
        // colour.
        let mut arm = Group::new().set("opacity", 0.35);
        let mut hit = Group::new().set("opacity", 0.55);
        for (body, capsule) in placed.capsules() {
            let (from, until) = (to(&capsule.start), to(&capsule.end));
            let stroke = stroke(from, until, 2.0 * capsule.radius * scale);
            if Some(body) == touched && body != Body::Link(0) {
                hit.append(stroke.set("stroke", HIT));
            } else {
                arm.append(stroke);
            }
        }
        group.append(arm);
        group.append(hit);
        if let Some(contact) = &place.contact {
            let point = Vector3::from(contact.point);
            let force = Vector3::from(contact.force);
            let size = contact.size();
            if size > 0.0 {
                let at = to(&point);
                let tail = to(&(point - force / size * ARROW));
                group.append(arrow(tail, at));
                group.append(
                    Circle::new()
                        .set("cx", at.0)
                        .set("cy", at.1)
                        .set("r", (contact.spread * scale).max(3.0))
                        .set("fill", "none")
                        .set("stroke", HIT)
                        .set("stroke-dasharray", "3 2"),
                );
            }
        }
    }
    let below = top + 2.0 * size + 28.0 + 14.0;
    let caption = match (&place.contact, &place.unknown) {
        (Some(contact), None) => format!(
            "{}, {:.1} N, within {:.0} mm",
            place::name(contact.body),
            contact.size(),
            1e3 * contact.spread
        ),
        (Some(contact), Some(_)) => format!(
            "perhaps {} ({:.0} %), {:.1} N",
            place::name(contact.body),
            100.0 * contact.probability,
            contact.size()
        ),
        _ => "place of the contact unknown".to_owned(),
    };
    group.append(text(left, below, &caption));
    group
}

fn stroke(from: (f64, f64), until: (f64, f64), width: f64) -> Line {
    // Some viewers draw no caps on a line without length.
    line(from.0, from.1, until.0 + 0.01, until.1)
        .set("stroke-width", (width * 10.0).round() / 10.0)
        .set("stroke-linecap", "round")
        .set("stroke", INK)
}

fn arrow(tail: (f64, f64), head: (f64, f64)) -> Group {
    let (dx, dy) = (head.0 - tail.0, head.1 - tail.1);
    let length = dx.hypot(dy).max(1e-6);
    let (ux, uy) = (dx / length, dy / length);
    let mut group = Group::new().set("stroke-linecap", "round");
    let mut part = |a: (f64, f64)| {
        group.append(
            line(a.0, a.1, head.0, head.1)
                .set("stroke", HIT)
                .set("stroke-width", 2.4),
        );
    };
    part(tail);
    for side in [-1.0, 1.0] {
        let back = (8.0 * ux, 8.0 * uy);
        part((
            head.0 - back.0 - side * 4.5 * uy,
            head.1 - back.1 + side * 4.5 * ux,
        ));
    }
    group
}

/// Margin around the arm, `[m]`.
const MARGIN: f64 = 0.12;

/// Length of the arrow in the sketch, `[m]`.
const ARROW: f64 = 0.2;

/// Colour of the touched body, and of the force.
const HIT: &str = "#d64550";
