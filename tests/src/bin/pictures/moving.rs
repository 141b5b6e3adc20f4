//! The arm as it follows a target that jumps: an animated picture.

use franka_rt::session::{OnArrival, Target};
use franka_tests::lockstep::Lockstep;
use nalgebra::{Isometry3, Translation3};
use svg::Node as _;
use svg::node::element::{Animate, Circle, Group};

use crate::canvas::{BLUE, GREY, INK, ORANGE, curve, file, line, paper, short, text};
use crate::view::{Stroke, View};

/// What is shown at one moment.
struct Frame {
    strokes: Vec<Stroke>,
    target: (f64, f64),
    hand: (f64, f64),
}

pub(crate) fn draw() -> String {
    let frames = frames();
    let seconds = frames.len() as f64 * EVERY as f64 / 1000.0;
    let animate = |attribute: &str, of: &dyn Fn(&Frame) -> f64, steps: bool| {
        let values: Vec<String> = frames
            .iter()
            .map(|frame| short(of(frame)).to_string())
            .collect();
        Animate::new()
            .set("attributeName", attribute)
            .set("values", values.join(";"))
            .set("dur", format!("{seconds}s"))
            .set("repeatCount", "indefinite")
            .set("calcMode", if steps { "discrete" } else { "linear" })
    };
    let document = paper(
        520.0,
        380.0,
        "A simulated arm that follows a target which jumps",
    );
    let mut arm = Group::new()
        .set("opacity", 0.45)
        .set("stroke-linecap", "round");
    for (i, stroke) in frames[0].strokes.iter().enumerate() {
        let mut part = line(stroke.from, stroke.to, INK).set("stroke-width", stroke.width.round());
        let moves = frames.iter().any(|frame| {
            let other = frame.strokes[i];
            let apart = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).hypot(a.1 - b.1);
            apart(other.from, stroke.from) + apart(other.to, stroke.to) > 0.3
        });
        if moves {
            part.append(animate("x1", &|frame| frame.strokes[i].from.0, false));
            part.append(animate("y1", &|frame| frame.strokes[i].from.1, false));
            part.append(animate("x2", &|frame| frame.strokes[i].to.0 + 0.1, false));
            part.append(animate("y2", &|frame| frame.strokes[i].to.1, false));
        }
        arm.append(part);
    }
    let path = curve(frames.iter().map(|frame| frame.hand), BLUE).set("opacity", 0.6);
    let mut target = Circle::new()
        .set("r", 9)
        .set("fill", "none")
        .set("stroke", ORANGE)
        .set("stroke-width", 3);
    target.append(animate("cx", &|frame| frame.target.0, true));
    target.append(animate("cy", &|frame| frame.target.1, true));
    let mut hand = Circle::new().set("r", 4.5).set("fill", BLUE);
    hand.append(animate("cx", &|frame| frame.hand.0, false));
    hand.append(animate("cy", &|frame| frame.hand.1, false));
    let marks = Group::new().add(path).add(target).add(hand);
    let legend = Group::new()
        .add(
            Circle::new()
                .set("cx", 26)
                .set("cy", 28)
                .set("r", 7)
                .set("fill", "none")
                .set("stroke", ORANGE)
                .set("stroke-width", 3),
        )
        .add(text(42.0, 32.5, "target: jumps when the program says so"))
        .add(
            Circle::new()
                .set("cx", 26)
                .set("cy", 52)
                .set("r", 4.5)
                .set("fill", BLUE),
        )
        .add(text(
            42.0,
            56.5,
            "hand: a command every millisecond, within every limit",
        ))
        .add(
            text(506.0, 366.0, "simulated")
                .set("text-anchor", "end")
                .set("fill", GREY),
        );
    file(document, [arm, marks, legend])
}

/// Runs the motion, the last target of which is the first one.
fn frames() -> Vec<Frame> {
    let view = View {
        origin: (130.0, 330.0),
        scale: 330.0,
        azimuth: 0.4,
    };
    let mut lockstep = Lockstep::ready();
    let engaged = lockstep.engage();
    lockstep.run(400);
    let start = lockstep.reference_pose();
    let place = |pose: &Isometry3<f64>| view.at(&pose.translation.vector);
    let mut target = start;
    let mut frames = Vec::new();
    for cycle in 0..LENGTH {
        if let Some((_, way)) = JUMPS.iter().find(|(at, _)| *at == cycle) {
            target = Translation3::from(*way) * start;
            let goal = lockstep.within(engaged, Target::Pose(target), OnArrival::Hold);
            goal.expect("the target can be reached");
        }
        lockstep.tick();
        if cycle % EVERY == 0 {
            frames.push(Frame {
                strokes: view.capsules(lockstep.robot.q()),
                target: place(&target),
                hand: place(&lockstep.arm_pose()),
            });
        }
    }
    frames
}

/// Cycles in which the target jumps, and where it is from the start then, `[m]`.
const JUMPS: [(usize, [f64; 3]); 6] = [
    (400, [0.25, -0.2, 0.1]),
    (2200, [0.3, 0.1, -0.3]),
    (3000, [0.05, -0.1, -0.3]),
    (4800, [0.3, 0.2, 0.0]),
    (5500, [0.1, -0.2, 0.15]),
    (7000, [0.0, 0.0, 0.0]),
];

/// Cycles in all, and from one frame to the next.
const LENGTH: usize = 8500;
const EVERY: usize = 60;
