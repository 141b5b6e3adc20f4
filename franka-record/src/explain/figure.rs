//! SVG figure of the last second before the end.

use svg::node::element::path::Data;
use svg::node::element::{Group, Line, Path, Rectangle, Text, Title};
use svg::{Document, Node};

use super::polyline::thinned;
use super::report::NO_END;
use super::{Explanation, MomentKind, Trace, sketch};

/// Position of a panel in the figure, and the range of its values.
struct Panel {
    top: f64,
    height: f64,
    /// Values at the lower and the upper edge of the panel.
    low: f64,
    high: f64,
    /// Milliseconds before the end at the left edge of the panel.
    span: f64,
}

/// A curve: a function that returns one number per cycle.
type Curve<'a> = &'a dyn Fn(&Trace) -> f64;

pub(super) fn draw(explanation: &Explanation) -> String {
    let mut document = Document::new()
        .set("viewBox", (0, 0, WIDTH as i64, HEIGHT as i64))
        .set("font-family", "sans-serif")
        .set("font-size", 12)
        .set("fill", INK)
        .add(Title::new("The last second before the end of a motion"));
    document.append(heading(explanation));
    let traces = &explanation.last_second;
    if traces.is_empty() {
        document.append(text(LEFT, 80.0, "no cycles"));
        return document.to_string();
    }
    let span = (explanation.end - traces[0].time).max(20) as f64;
    let joints = |of: fn(&Trace) -> &[f64; 7]| {
        traces
            .iter()
            .flat_map(of)
            .fold(0.0, |most: f64, value| most.max(value.abs()))
    };
    let force = traces.iter().fold(0.0, |most: f64, t| most.max(t.force));
    let external = rounded(joints(|t| &t.external).max(0.5));
    let speed = rounded(joints(|t| &t.speed).max(0.05));
    let torque = rounded(joints(|t| &t.torque).max(0.05));
    let panels = [
        (
            "external torque minus its value at rest [N·m]",
            -external,
            external,
        ),
        (
            "external force at the end effector [N]",
            0.0,
            rounded(force.max(1.0)),
        ),
        ("velocity over its limit", -speed, speed),
        ("torque over its limit", -torque, torque),
    ];
    let each: [fn(&Trace) -> &[f64; 7]; 4] = [
        |t| &t.external,
        |t| &t.external,
        |t| &t.speed,
        |t| &t.torque,
    ];
    for (i, (name, low, high)) in panels.into_iter().enumerate() {
        let panel = Panel {
            top: TOP + i as f64 * (PANEL + GAP),
            height: PANEL,
            low,
            high,
            span,
        };
        document.append(panel.frame(name));
        if i == 1 {
            document.append(panel.curve(explanation, &|t| t.force, INK));
            continue;
        }
        for (joint, color) in COLORS.into_iter().enumerate() {
            let of = each[i];
            document.append(panel.curve(explanation, &|t| of(t)[joint], color));
        }
    }
    document.append(marks(explanation, span));
    document.append(time_axis(span));
    document.append(legend());
    document.append(sketch::draw(explanation, SKETCH_LEFT, TOP, SKETCH_SIZE));
    document.to_string()
}

impl Panel {
    fn x(&self, before: f64) -> f64 {
        x(self.span, before)
    }

    fn y(&self, value: f64) -> f64 {
        let share = (value.clamp(self.low, self.high) - self.low) / (self.high - self.low);
        self.top + self.height * (1.0 - share)
    }

    fn frame(&self, name: &str) -> Group {
        let mut group = Group::new()
            .add(
                Rectangle::new()
                    .set("x", LEFT)
                    .set("y", self.top)
                    .set("width", CURVES)
                    .set("height", self.height)
                    .set("fill", "none")
                    .set("stroke", INK)
                    .set("stroke-opacity", 0.5),
            )
            .add(text(LEFT, self.top - 5.0, name));
        for value in [self.low, 0.5 * (self.low + self.high), self.high] {
            let y = self.y(value);
            group.append(line(LEFT, y, LEFT + CURVES, y).set("stroke-opacity", 0.25));
            let label = text(LEFT - 5.0, y + 4.0, &number(value)).set("text-anchor", "end");
            group.append(label);
        }
        group
    }

    /// Returns the points of a curve as separate runs, with a gap where states are missing.
    fn runs(&self, explanation: &Explanation, of: Curve<'_>) -> Vec<Vec<(f64, f64)>> {
        let mut runs = vec![Vec::new()];
        for trace in &explanation.last_second {
            let value = of(trace);
            if trace.lost > 0 || !value.is_finite() {
                runs.push(Vec::new());
            }
            if value.is_finite() {
                let before = (explanation.end - trace.time.min(explanation.end)) as f64;
                let run = runs.last_mut().expect("there is one from the beginning");
                run.push((self.x(before), self.y(value)));
            }
        }
        runs.retain(|run| !run.is_empty());
        runs
    }

    fn curve(&self, explanation: &Explanation, of: Curve<'_>, color: &str) -> Path {
        let mut data = Data::new();
        for run in self.runs(explanation, of) {
            for (index, (x, y)) in thinned(&run, TOLERANCE).into_iter().enumerate() {
                let point = (short(x), short(y));
                data = match index {
                    0 => data.move_to(point),
                    _ => data.line_to(point),
                };
            }
        }
        Path::new()
            .set("d", data)
            .set("fill", "none")
            .set("stroke", color)
            .set("stroke-width", 1.4)
            .set("stroke-linejoin", "round")
    }
}

/// Returns the heading of the figure, with the first lines of the cause.
fn heading(explanation: &Explanation) -> Group {
    let mut group = Group::new();
    let cause = explanation.cause.as_ref().map(|cause| cause.text.as_str());
    let lines = cause.unwrap_or(NO_END);
    for (i, content) in lines.lines().take(2).enumerate() {
        let line = text(LEFT, 22.0 + 17.0 * i as f64, &shortened(content, 130));
        group.append(match i {
            0 => line.set("font-weight", "bold"),
            _ => line,
        });
    }
    group
}

/// Returns vertical lines at the first contact, the first collision and the end, and ticks at lost
/// states.
fn marks(explanation: &Explanation, span: f64) -> Group {
    let bottom = TOP + 4.0 * PANEL + 3.0 * GAP;
    let mut group = Group::new();
    let before = |time: u64| explanation.end as f64 - time as f64;
    let inside = |time: u64| (0.0..=span).contains(&before(time));
    let first = |kind: MomentKind| {
        let mut moments = explanation.timeline.iter();
        moments.find(|moment| moment.kind == kind && inside(moment.time))
    };
    for (kind, name, row) in [
        (MomentKind::Contact, "contact", 0.0),
        (MomentKind::Collision, "collision", 1.0),
    ] {
        let Some(moment) = first(kind) else {
            continue;
        };
        let at = x(span, before(moment.time));
        group.append(
            line(at, TOP, at, bottom)
                .set("stroke-dasharray", "4 3")
                .set("stroke-width", 1.2),
        );
        let label = format!("{name} {} ms", 0.0 - before(moment.time));
        group.append(text(at - 4.0, TOP + 14.0 + 14.0 * row, &label).set("text-anchor", "end"));
    }
    for trace in explanation.last_second.iter().filter(|t| t.lost > 0) {
        let at = x(span, before(trace.time));
        group.append(line(at, bottom, at, bottom + 7.0).set("stroke-width", 2));
    }
    if explanation.last_second.iter().any(|trace| trace.lost > 0) {
        let label = text(LEFT + CURVES, bottom + 38.0, "ticks: lost states");
        group.append(label.set("text-anchor", "end"));
    }
    group
}

fn time_axis(span: f64) -> Group {
    let bottom = TOP + 4.0 * PANEL + 3.0 * GAP;
    let mut group = Group::new();
    for i in 0..=4 {
        let before = span * (1.0 - 0.25 * f64::from(i));
        let at = x(span, before);
        let label = number(-before.round());
        group.append(text(at, bottom + 20.0, &label).set("text-anchor", "middle"));
    }
    let middle = LEFT + 0.5 * CURVES;
    group.append(text(middle, bottom + 38.0, "ms before the end").set("text-anchor", "middle"));
    group
}

fn legend() -> Group {
    let mut group = Group::new();
    for (joint, color) in COLORS.into_iter().enumerate() {
        let y = TOP + SKETCH_SIZE * 2.0 + 60.0 + 18.0 * joint as f64;
        let sample = line(SKETCH_LEFT, y, SKETCH_LEFT + 24.0, y)
            .set("stroke", color)
            .set("stroke-width", 2.5);
        group.append(sample);
        group.append(text(
            SKETCH_LEFT + 32.0,
            y + 4.0,
            &format!("joint {}", joint + 1),
        ));
    }
    group
}

pub(super) fn text(x: f64, y: f64, content: &str) -> Text {
    Text::new(content).set("x", short(x)).set("y", short(y))
}

pub(super) fn line(x1: f64, y1: f64, x2: f64, y2: f64) -> Line {
    Line::new()
        .set("x1", short(x1))
        .set("y1", short(y1))
        .set("x2", short(x2))
        .set("y2", short(y2))
        .set("stroke", INK)
}

fn x(span: f64, before: f64) -> f64 {
    LEFT + CURVES * (1.0 - before / span)
}

/// Returns the next larger number of the series 1, 2, 5, 10, ...
fn rounded(value: f64) -> f64 {
    let power = 10.0_f64.powf(value.log10().floor());
    let steps = [1.0, 1.5, 2.0, 3.0, 5.0, 7.5, 10.0].map(|step| step * power);
    steps
        .into_iter()
        .find(|step| *step >= value)
        .unwrap_or(10.0 * power)
}

fn number(value: f64) -> String {
    let value = (value * 1000.0).round() / 1000.0;
    format!("{}", value + 0.0)
}

/// Rounds to tenths of a pixel.
fn short(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

fn shortened(content: &str, most: usize) -> String {
    if content.chars().count() <= most {
        return content.to_owned();
    }
    let mut text: String = content.chars().take(most - 3).collect();
    text.push_str("...");
    text
}

const WIDTH: f64 = 1040.0;
const HEIGHT: f64 = 720.0;
const LEFT: f64 = 60.0;
const TOP: f64 = 72.0;
const CURVES: f64 = 660.0;
const PANEL: f64 = 120.0;
const GAP: f64 = 28.0;

/// Largest deviation of a drawn curve, in pixels. It is too small to see.
const TOLERANCE: f64 = 0.2;

const SKETCH_LEFT: f64 = 770.0;
const SKETCH_SIZE: f64 = 220.0;

/// Colour of text and lines, halfway between white and black.
pub(super) const INK: &str = "#808080";

/// Colours of the joints, after Okabe and Ito, with medium brightness.
const COLORS: [&str; 7] = [
    "#0b84d8", "#d9660a", "#12a37a", "#cc6fa5", "#8b74e8", "#a98b00", "#d64550",
];
