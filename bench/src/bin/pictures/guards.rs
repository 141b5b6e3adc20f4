//! The stages from a goal to torques, and the stages of other control modes.

use svg::Node as _;
use svg::node::element::Group;

use crate::canvas::{BLUE, GREY, INK, ORANGE, arrow, centred, file, labelled, line, paper, text};

/// The name of each stage, its purpose, and true for a guard, which acts only at its limit.
const STAGES: [(&str, &str, bool); 13] = [
    (
        "watchdog, deadman, lead",
        "a program that is silent or gone; a target that is far away",
        true,
    ),
    ("course", "jerk-limited motion to the target", false),
    (
        "speed cap",
        "joints, flange and end effector on the way to a pose",
        true,
    ),
    (
        "clearance",
        "the arm's distance to itself and to regions to keep out of",
        true,
    ),
    (
        "leash",
        "how far the reference may be ahead of the arm",
        true,
    ),
    (
        "deviation",
        "how far the arm may be pushed off its way",
        true,
    ),
    (
        "law",
        "springs and dampers at the end effector and the joints",
        false,
    ),
    (
        "force cap",
        "the most that the hand presses with, 30 N",
        true,
    ),
    (
        "inertia, coriolis",
        "torques that the reference's own motion takes",
        false,
    ),
    (
        "velocity barrier",
        "joints that come near their velocity limit",
        true,
    ),
    ("clamp", "torques beyond the limits of the gains", true),
    ("low-pass", "noise of the torques, above 100 Hz", false),
    ("torque rate", "1000 N m/s, as the robot demands", true),
];

pub(crate) fn draw() -> String {
    let bottom = TOP + STAGES.len() as f64 * ROW;
    let document = paper(
        WIDTH,
        bottom + 52.0,
        "The guards between a goal and the torques that leave",
    );
    let mut rows = Group::new();
    rows.append(labelled(BOX, 12.0, BOX_WIDTH, 28.0, ORANGE, "goal"));
    rows.append(arrow((MIDDLE, 41.0), (MIDDLE, TOP + 2.0), INK));
    for (i, (name, about, is_guard)) in STAGES.into_iter().enumerate() {
        let y = TOP + i as f64 * ROW + 3.0;
        let colour = if is_guard { GREY } else { BLUE };
        rows.append(labelled(BOX, y, BOX_WIDTH, ROW - 8.0, colour, name));
        rows.append(text(BOX + BOX_WIDTH + 16.0, y + 0.5 * ROW + 1.0, about).set("fill", INK));
        if i + 1 < STAGES.len() {
            rows.append(line((MIDDLE, y + ROW - 8.0), (MIDDLE, y + ROW), INK));
        }
    }
    rows.append(arrow((MIDDLE, bottom - 4.0), (MIDDLE, bottom + 13.0), INK));
    rows.append(labelled(
        BOX,
        bottom + 14.0,
        BOX_WIDTH,
        28.0,
        ORANGE,
        "torques to the robot",
    ));
    let legend = Group::new()
        .add(labelled(
            BOX + BOX_WIDTH + 16.0,
            14.0,
            88.0,
            24.0,
            BLUE,
            "always",
        ))
        .add(labelled(
            BOX + BOX_WIDTH + 112.0,
            14.0,
            168.0,
            24.0,
            GREY,
            "where it binds, noted",
        ));
    let spans = Group::new()
        .add(span(24.0, 0, STAGES.len(), "goals"))
        .add(span(
            64.0,
            11,
            STAGES.len(),
            "a control function, with limiter",
        ));
    file(document, [rows, legend, spans])
}

/// Returns a bracket next to the stages of a control mode, with its name along it.
fn span(x: f64, first: usize, end: usize, name: &str) -> Group {
    let (from, to) = (TOP + first as f64 * ROW + 3.0, TOP + end as f64 * ROW - 5.0);
    let name_end = from - 10.0;
    let mut group = Group::new();
    group.append(line((x, from), (x, to), ORANGE).set("stroke-width", 2));
    for y in [from, to] {
        group.append(line((x, y), (x + 8.0, y), ORANGE).set("stroke-width", 2));
    }
    let (at, anchor) = match first {
        0 => (0.5 * (from + to), "middle"),
        _ => (name_end, "start"),
    };
    let turned = format!("rotate(-90 {} {at})", x - 7.0);
    group.append(
        centred(x - 7.0, at, name)
            .set("text-anchor", anchor)
            .set("transform", turned),
    );
    group
}

const WIDTH: f64 = 780.0;
const TOP: f64 = 58.0;
const ROW: f64 = 36.0;
const BOX: f64 = 92.0;
const BOX_WIDTH: f64 = 214.0;
const MIDDLE: f64 = BOX + 0.5 * BOX_WIDTH;
