//! The shared parts of the pictures: paper, text, lines and arrows.

use svg::Document;
use svg::Node as _;
use svg::node::element::{Group, Line, Path, Rectangle, Text, Title};

/// Colour of text and lines.
pub(crate) const INK: &str = "#23303b";
/// Colour of less important parts.
pub(crate) const GREY: &str = "#8895a1";
/// Colour of targets, and of data from a program.
pub(crate) const ORANGE: &str = "#d9822b";
/// Colour of the driver's output.
pub(crate) const BLUE: &str = "#1f5fa8";
/// Colour of measured values, and of the robot.
pub(crate) const GREEN: &str = "#3b8f5a";

/// Returns an empty picture of this size, white also on a dark page, with a title for screen
/// readers.
pub(crate) fn paper(width: f64, height: f64, title: &str) -> Document {
    Document::new()
        .set("viewBox", format!("0 0 {width} {height}"))
        .set("font-family", "sans-serif")
        .set("font-size", 13)
        .set("fill", INK)
        .add(Title::new(title))
        .add(
            rectangle(0.0, 0.0, width, height)
                .set("rx", 6)
                .set("fill", "white"),
        )
}

/// Rounds to one decimal.
pub(crate) fn short(value: f64) -> f64 {
    let rounded = (10.0 * value).round() / 10.0;
    // A zero has no sign in a picture.
    if rounded == 0.0 { 0.0 } else { rounded }
}

pub(crate) fn text(x: f64, y: f64, content: &str) -> Text {
    Text::new(content).set("x", short(x)).set("y", short(y))
}

/// Returns text whose middle is at `x`.
pub(crate) fn centred(x: f64, y: f64, content: &str) -> Text {
    text(x, y, content).set("text-anchor", "middle")
}

pub(crate) fn line(from: (f64, f64), to: (f64, f64), colour: &str) -> Line {
    Line::new()
        .set("x1", short(from.0))
        .set("y1", short(from.1))
        .set("x2", short(to.0))
        .set("y2", short(to.1))
        .set("stroke", colour)
}

pub(crate) fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Rectangle {
    Rectangle::new()
        .set("x", short(x))
        .set("y", short(y))
        .set("width", short(width))
        .set("height", short(height))
}

/// Returns a box with text in its middle.
pub(crate) fn labelled(
    x: f64,
    y: f64,
    width: f64,
    height: f64,
    colour: &str,
    content: &str,
) -> Group {
    Group::new()
        .add(
            rectangle(x, y, width, height)
                .set("rx", 4)
                .set("fill", colour)
                .set("fill-opacity", 0.14)
                .set("stroke", colour),
        )
        .add(centred(x + 0.5 * width, y + 0.5 * height + 4.5, content))
}

/// Returns a line with a head at its end.
pub(crate) fn arrow(from: (f64, f64), to: (f64, f64), colour: &str) -> Group {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy).max(1e-6);
    let (ux, uy) = (dx / length, dy / length);
    let base = (to.0 - 9.0 * ux, to.1 - 9.0 * uy);
    let side = |sign: f64| (base.0 - sign * 4.0 * uy, base.1 + sign * 4.0 * ux);
    let (one, other) = (side(1.0), side(-1.0));
    let head = format!(
        "M{} {}L{} {}L{} {}Z",
        short(to.0),
        short(to.1),
        short(one.0),
        short(one.1),
        short(other.0),
        short(other.1)
    );
    Group::new()
        .add(line(from, base, colour).set("stroke-width", 1.6))
        .add(Path::new().set("d", head).set("fill", colour))
}

/// Returns a polyline through these points.
pub(crate) fn curve(points: impl IntoIterator<Item = (f64, f64)>, colour: &str) -> Path {
    let mut data = String::new();
    for (x, y) in points {
        let verb = if data.is_empty() { 'M' } else { 'L' };
        data += &format!("{verb}{} {}", short(x), short(y));
    }
    Path::new()
        .set("d", data)
        .set("fill", "none")
        .set("stroke", colour)
        .set("stroke-width", 1.6)
        .set("stroke-linejoin", "round")
}

/// Returns the picture as a file.
pub(crate) fn file(mut document: Document, parts: impl IntoIterator<Item = Group>) -> String {
    for part in parts {
        document.append(part);
    }
    document.to_string() + "\n"
}
