//! A target that steps, and the driver's response on a simulated arm.

use franka_lockstep::Lockstep;
use franka_rt::session::{OnArrival, Target};
use nalgebra::{Isometry3, Translation3};
use svg::Node as _;
use svg::node::element::Group;

use crate::canvas::{BLUE, GREEN, GREY, ORANGE, centred, curve, file, line, paper, text};

/// The values of a cycle along z: target, reference, arm, `[m]`.
type Row = [f64; 3];

pub(crate) fn draw() -> String {
    let rows = rows();
    let velocity = differences(&rows.iter().map(|row| row[1]).collect::<Vec<_>>());
    let acceleration = differences(&velocity);
    let column = |i: usize, factor: f64| rows.iter().map(|row| factor * row[i]).collect::<Vec<_>>();
    let document = paper(
        WIDTH,
        TOP + 3.0 * PANEL + 34.0,
        "A target that steps, and the smooth command that follows it",
    );
    let mut legend = Group::new();
    for (x, colour, name) in [
        (150.0, ORANGE, "target"),
        (240.0, BLUE, "command"),
        (350.0, GREEN, "arm"),
    ] {
        legend.append(line((x, 20.0), (x + 22.0, 20.0), colour).set("stroke-width", 3));
        legend.append(text(x + 28.0, 24.5, name));
    }
    legend.append(
        text(
            WIDTH - 14.0,
            24.5,
            "simulated Franka Research 3, default pace",
        )
        .set("text-anchor", "end")
        .set("fill", GREY),
    );
    let panels = [
        panel(
            0,
            "height of the hand, cm",
            0.0,
            10.0,
            &[
                (&column(0, 100.0), ORANGE),
                (&column(2, 100.0), GREEN),
                (&column(1, 100.0), BLUE),
            ],
        ),
        panel(1, "its velocity, m/s", -0.3, 0.3, &[(&velocity, BLUE)]),
        panel(
            2,
            "its acceleration, m/s²",
            -1.0,
            1.0,
            &[(&acceleration, BLUE)],
        ),
    ];
    let mut axis = Group::new();
    let bottom = TOP + 3.0 * PANEL;
    for second in 0..=(rows.len() / 1000) {
        let x = across(second * 1000, rows.len());
        axis.append(centred(x, bottom + 14.0, &format!("{second} s")).set("fill", GREY));
    }
    file(document, [legend].into_iter().chain(panels).chain([axis]))
}

/// Runs the motion: up, down, slightly up before it arrives, and up again in mid-motion.
fn rows() -> Vec<Row> {
    let mut lockstep = Lockstep::ready();
    let engaged = lockstep.engage();
    lockstep.run(400);
    let start = lockstep.reference_pose();
    let height = |pose: Isometry3<f64>| pose.translation.z - start.translation.z;
    let mut target = start;
    let mut rows = Vec::new();
    for cycle in 0..4000 {
        if let Some((_, up)) = STEPS.iter().find(|(at, _)| *at == cycle) {
            target = Translation3::new(0.0, 0.0, *up) * start;
            let goal = lockstep.within(engaged, Target::Pose(target), OnArrival::Hold);
            goal.expect("the target can be reached");
        }
        lockstep.tick();
        rows.push([
            height(target),
            height(lockstep.reference_pose()),
            height(lockstep.arm_pose()),
        ]);
    }
    rows
}

/// Cycles in which the target steps, and its height above the start, `[m]`.
const STEPS: [(usize, f64); 5] = [
    (300, 0.1),
    (1500, 0.0),
    (1900, 0.06),
    (2200, 0.02),
    (2500, 0.1),
];

/// Returns the differences per cycle of a millisecond.
fn differences(values: &[f64]) -> Vec<f64> {
    let after = values.windows(2).map(|pair| (pair[1] - pair[0]) * 1000.0);
    std::iter::once(0.0).chain(after).collect()
}

fn panel(i: usize, name: &str, low: f64, high: f64, curves: &[(&[f64], &str)]) -> Group {
    let top = TOP + i as f64 * PANEL;
    let y = |value: f64| top + (PANEL - GAP) * (1.0 - (value - low) / (high - low));
    let mut group = Group::new().add(text(14.0, top + 14.0, name));
    let levels = [low, 0.5 * (low + high), high];
    for level in levels {
        group.append(line((LEFT, y(level)), (WIDTH - 14.0, y(level)), "#d5dbe0"));
        let label = text(LEFT - 8.0, y(level) + 4.5, &format!("{level}"));
        group.append(label.set("text-anchor", "end").set("fill", GREY));
    }
    for (values, colour) in curves {
        let points = values.iter().enumerate().step_by(4);
        let points = points.map(|(cycle, value)| (across(cycle, values.len()), y(*value)));
        let path = curve(points, colour);
        // The measured curve is below the command, which would hide it.
        group.append(match *colour {
            GREEN => path.set("stroke-width", 6).set("opacity", 0.35),
            _ => path,
        });
    }
    group
}

fn across(cycle: usize, cycles: usize) -> f64 {
    LEFT + (WIDTH - 14.0 - LEFT) * cycle as f64 / cycles as f64
}

const WIDTH: f64 = 780.0;
const LEFT: f64 = 200.0;
const TOP: f64 = 44.0;
const PANEL: f64 = 118.0;
const GAP: f64 = 20.0;
