//! The arm in its ready pose, and the model's frames.

use franka_model::{EndEffector, Frame, Model, READY, transform};
use nalgebra::{Isometry3, Vector3};
use svg::Node as _;
use svg::node::element::Group;

use crate::canvas::{BLUE, GREEN, GREY, INK, arrow, file, line, paper, text};
use crate::view::View;

pub(crate) fn draw() -> String {
    let view = View {
        origin: (150.0, 440.0),
        scale: 520.0,
        azimuth: 0.5,
    };
    let document = paper(
        560.0,
        530.0,
        "A Franka Research 3 with its Hand in the ready pose, and its frames",
    );
    let mut body = Group::new().set("opacity", 0.22);
    for stroke in view.capsules(&READY) {
        body.append(
            line(stroke.from, (stroke.to.0 + 0.1, stroke.to.1), INK)
                .set("stroke-width", stroke.width.round())
                .set("stroke-linecap", "round"),
        );
    }
    let hand = EndEffector {
        f_t_ee: transform::matrix(&Isometry3::from_parts(
            Vector3::new(0.0, 0.0, 0.1034).into(),
            nalgebra::UnitQuaternion::from_axis_angle(
                &Vector3::z_axis(),
                -std::f64::consts::FRAC_PI_4,
            ),
        )),
        ..EndEffector::default()
    };
    let model = Model::fr3();
    let mut frames = vec![triad(
        &view,
        &Isometry3::identity(),
        "O, the base",
        (-64.0, 34.0),
    )];
    for (frame, name, label) in FRAMES {
        let pose = model.pose(frame, &READY, &hand);
        let pose = transform::isometry(&pose).expect("a rigid frame");
        frames.push(triad(&view, &pose, name, label));
    }
    let legend = Group::new()
        .add(text(330.0, 440.0, "x").set("fill", RED))
        .add(text(346.0, 440.0, "y").set("fill", GREEN))
        .add(text(362.0, 440.0, "z: the axis of the joint").set("fill", BLUE))
        .add(text(330.0, 464.0, "O_T_EE is the pose of EE in O.").set("fill", GREY))
        .add(text(330.0, 484.0, "q turns frame i about its z.").set("fill", GREY));
    file(document, [body].into_iter().chain(frames).chain([legend]))
}

/// The axes of a frame, with its name at an offset.
fn triad(view: &View, pose: &Isometry3<f64>, name: &str, label: (f64, f64)) -> Group {
    let origin = view.at(&pose.translation.vector);
    let mut group = Group::new();
    for (axis, colour) in [
        (Vector3::x(), RED),
        (Vector3::y(), GREEN),
        (Vector3::z(), BLUE),
    ] {
        let tip = pose * nalgebra::Point3::from(axis * AXIS);
        group.append(arrow(origin, view.at(&tip.coords), colour));
    }
    let at = (origin.0 + label.0, origin.1 + label.1);
    group.append(text(at.0, at.1, name).set("font-weight", "bold"));
    group
}

/// Frames, their names, and the offsets of the names from the origins.
const FRAMES: [(Frame, &str, (f64, f64)); 8] = [
    (Frame::Joint2, "1, 2", (-52.0, 0.0)),
    (Frame::Joint3, "3", (-30.0, 0.0)),
    (Frame::Joint4, "4", (-34.0, -6.0)),
    (Frame::Joint5, "5", (8.0, -34.0)),
    (Frame::Joint6, "6", (26.0, -8.0)),
    (Frame::Joint7, "7", (16.0, 16.0)),
    (Frame::Flange, "F, the flange", (50.0, 8.0)),
    (Frame::EndEffector, "EE, the end effector", (56.0, 14.0)),
];

/// Length of an axis, `[m]`.
const AXIS: f64 = 0.1;

const RED: &str = "#c2453d";
