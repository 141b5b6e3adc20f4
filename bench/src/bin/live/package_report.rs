//! The table of the packages for Python: a row per measurement, a column per package.

use serde_json::Value;

/// Returns the text of a cell for a step.
type Cell = fn(&Value) -> Option<String>;

/// Returns the table, followed by the missing features and the failures of each package, with the
/// reasons.
pub(crate) fn markdown(packages: &[Value]) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = line(
        std::iter::once(String::new())
            .chain(packages.iter().map(title))
            .collect(),
    );
    text += &format!("|---|{}\n", "---|".repeat(packages.len()));
    for (name, step, cell) in ROWS {
        let cells = packages.iter().map(|package| {
            let step = &package["steps"][step];
            let is = |key| step.get(key).is_some();
            match cell(step) {
                Some(text) if is("failed") => format!("{text}, failed"),
                Some(text) => text,
                None if is("failed") => "failed".to_owned(),
                None => "–".to_owned(),
            }
        });
        text += &line(std::iter::once(name.to_owned()).chain(cells).collect());
    }
    let imports = packages.iter().map(|package| {
        let milliseconds = package["import_ms"].as_f64();
        milliseconds.map_or("–".to_owned(), |value| format!("{value:.0}"))
    });
    let imports = std::iter::once("import, ms".to_owned()).chain(imports);
    text += &line(imports.collect());
    text += "\n";
    for package in packages {
        text += &reasons(package);
    }
    text
}

fn title(package: &Value) -> String {
    let text = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
    format!("{} {}", text("package"), text("version"))
        .trim()
        .to_owned()
}

/// Returns a line for each step that is absent or failed, and for the package if it is.
fn reasons(package: &Value) -> String {
    let name = package["package"].as_str().unwrap_or_default();
    let mut text = String::new();
    if let Some(why) = package["absent"].as_str() {
        text += &format!("- {name} is not measured: {why}\n");
    }
    let steps = package["steps"].as_object();
    for (step, content) in steps.into_iter().flatten() {
        for kind in ["absent", "failed"] {
            if let Some(why) = content[kind].as_str() {
                text += &format!("- {name}, {step}: {kind}: {why}\n");
            }
        }
    }
    text
}

/// Returns the wake-ups of the other thread in a second, and the gaps between them.
fn ticks(step: &Value) -> Option<String> {
    let value = |key: &str| step["values"][key].as_f64();
    let (rate, p99, max) = (
        value("ticks_per_s")?,
        value("gap_p99_ms")?,
        value("gap_max_ms")?,
    );
    Some(format!("{rate:.0}; {p99:.1} / {max:.1}"))
}

fn micros(step: &Value) -> Option<String> {
    let value = step["values"]["p50_us"].as_f64()?;
    Some(if value < 10.0 {
        format!("{value:.2}")
    } else {
        format!("{value:.0}")
    })
}

fn millis(step: &Value) -> Option<String> {
    let value = step["values"]["p50_us"].as_f64()?;
    Some(format!("{:.2}", value / 1e3))
}

fn turnaround(step: &Value) -> Option<String> {
    let value = |key: &str| Some(step["turnaround"][key].as_f64()? / 1e3);
    Some(format!("{:.0} / {:.0}", value("p50")?, value("p99")?))
}

fn late(step: &Value) -> Option<String> {
    let commands = &step["commands"];
    let (late, states) = (commands["late"].as_u64()?, commands["states"].as_u64()?);
    let reflex = commands["reflex"].as_bool()?;
    let end = if reflex { ", then a reflex" } else { "" };
    Some(format!("{late} of {states}{end}"))
}

/// The subject of each row, its step, and its cells.
const ROWS: [(&str, &str, Cell); 19] = [
    ("wake-ups per s; gap p99 / max, ms: idle", "idle", ticks),
    ("homing the hand", "homing", ticks),
    ("moving the fingers", "fingers", ticks),
    ("reading states", "reading", ticks),
    ("a motion", "motion", ticks),
    ("`state()` at rest, µs", "state", micros),
    ("`state()` while controlled, µs", "state_held", micros),
    ("`pose(q)`, µs", "pose", micros),
    ("1000 inverse kinematics, ms", "inverse", millis),
    (
        "active control: turnaround p50 / p99, µs",
        "active",
        turnaround,
    ),
    ("its commands late", "active", late),
    ("compiled law: turnaround p50 / p99, µs", "law", turnaround),
    ("its commands late", "law", late),
    (
        "late in a second before: event loop",
        "event_loop_before",
        late,
    ),
    ("late: event loop blocked for 300 ms", "event_loop", late),
    (
        "late in a second before: interpreter",
        "interpreter_before",
        late,
    ),
    ("late: interpreter held for 300 ms", "interpreter", late),
    ("late in a second before: threads", "threads_before", late),
    ("late: 4 threads compute", "threads", late),
];

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn each_package_has_a_column_and_a_reason_for_what_is_not_in_it() {
        let commands = json!({ "states": 900, "late": 21, "reflex": true });
        let ours = json!({
            "package": "ours", "version": "1.0", "import_ms": 41.4,
            "steps": {
                "idle": { "values": { "ticks_per_s": 930.2, "gap_p99_ms": 1.24, "gap_max_ms": 3.0 } },
                "law": { "commands": commands, "turnaround": { "p50": 31_400, "p99": 99_000 } },
                "threads": { "commands": commands, "failed": "reflex" },
            },
        });
        let theirs = json!({
            "package": "theirs", "version": "2.0", "import_ms": 3.0,
            "steps": { "pose": { "absent": "no model" }, "state": { "values": { "p50_us": 0.5 } } },
        });
        let none = json!({ "package": "none", "absent": "no wheel" });
        let text = markdown(&[ours, theirs, none]);
        for line in [
            "|  | ours 1.0 | theirs 2.0 | none |",
            "| wake-ups per s; gap p99 / max, ms: idle | 930; 1.2 / 3.0 | – | – |",
            "| `state()` at rest, µs | – | 0.50 | – |",
            "| compiled law: turnaround p50 / p99, µs | 31 / 99 | – | – |",
            "| late: 4 threads compute | 21 of 900, then a reflex, failed | – | – |",
            "| import, ms | 41 | 3 | – |",
            "- ours, threads: failed: reflex",
            "- theirs, pose: absent: no model",
            "- none is not measured: no wheel",
        ] {
            assert!(text.lines().any(|got| got == line), "{line}\n{text}");
        }
    }
}
