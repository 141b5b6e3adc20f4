//! Plots the response of the trajectory generator as an SVG. The target moves in steps, then in
//! bursts, and then its updates stop.
//!
//! `cargo run --release -p franka-otg --example plot [FILE]`

use std::error::Error;
use std::fmt::Write as _;

use franka_otg::{CYCLE, Generator, Limits, State};

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1);
    let file = file.unwrap_or_else(|| "generator.svg".to_owned());
    let mut generator = Generator::new(
        State::at_rest([0.0]),
        Limits::from_arrays([VELOCITY], [ACCELERATION], [JERK])?,
    )?;
    let mut rows = Vec::new();
    let mut shown = 0.0;
    for cycle in 0..(END / CYCLE) as usize {
        if let Some(target) = target(cycle) {
            generator.set_moving_target(&target)?;
            shown = target.position[0];
        }
        let before = generator.state().acceleration[0];
        let state = *generator.step();
        let jerk = (state.acceleration[0] - before) / CYCLE;
        let [p, v, a] = [state.position[0], state.velocity[0], state.acceleration[0]];
        rows.push([shown, p, v, a, jerk]);
    }
    std::fs::write(&file, draw(&rows))?;
    println!("{file}: {} cycles", rows.len());
    Ok(())
}

/// Returns the new target in a cycle, if any. The targets are first steps, then bursts of noisy
/// values, and finally a moving target whose updates stop.
fn target(cycle: usize) -> Option<State<1>> {
    let t = cycle as f64 * CYCLE;
    let at = |position: f64, velocity: f64| State {
        position: [position],
        velocity: [velocity],
        acceleration: [0.0],
    };
    match cycle {
        100 => Some(at(0.5, 0.0)),
        500 => Some(at(0.1, 0.0)),
        1200..1500 if cycle.is_multiple_of(15) => {
            Some(at(0.4 + 0.05 * (0.9 * cycle as f64).sin(), 0.0))
        }
        1800..2400 if cycle.is_multiple_of(100) => Some(at(0.7 - 0.5 * (t + 0.1 - 1.8), -0.5)),
        3000 => Some(at(0.6, 0.0)),
        _ => None,
    }
}

fn draw(rows: &[[f64; 5]]) -> String {
    let height = PANELS.len() as f64 * PANEL + 30.0;
    let mut svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 800 {height}' font-family='sans-serif' font-size='11'>\n\
         <rect width='800' height='{height}' fill='white'/>\n"
    );
    for (i, (name, columns, limit)) in PANELS.iter().enumerate() {
        let middle = 15.0 + PANEL * (i as f64 + 0.5);
        let y = |value: f64| middle - value / limit * 0.42 * PANEL;
        let _ = writeln!(
            svg,
            "<text x='8' y='{:.0}'>{name}</text>",
            middle - 0.4 * PANEL
        );
        for level in [-1.0, 0.0, 1.0] {
            let (y, label) = (y(level * limit), level * limit);
            let _ = writeln!(
                svg,
                "<path d='M150 {y:.1}H790' stroke='#ccc'/><text x='144' y='{:.1}' text-anchor='end'>{label}</text>",
                y + 4.0
            );
        }
        for (&column, colour) in columns.iter().zip(["#1f5fa8", "#d9822b"]) {
            let mut path = String::new();
            for (k, row) in rows.iter().enumerate().step_by(4) {
                let x = 150.0 + 640.0 * k as f64 / rows.len() as f64;
                let _ = write!(
                    path,
                    "{}{x:.1} {:.1}",
                    if k == 0 { 'M' } else { 'L' },
                    y(row[column])
                );
            }
            let _ = writeln!(
                svg,
                "<path d='{path}' fill='none' stroke='{colour}' stroke-width='1.3'/>"
            );
        }
    }
    let _ = writeln!(
        svg,
        "<text x='790' y='{}' text-anchor='end'>0 to {END} s</text></svg>",
        height - 6.0
    );
    svg
}

const VELOCITY: f64 = 1.0;
const ACCELERATION: f64 = 8.0;
const JERK: f64 = 200.0;
/// Length of the plot, `[s]`.
const END: f64 = 3.8;
/// Height of a panel, in pixels.
const PANEL: f64 = 120.0;
/// Panels of the plot: title, columns to draw, and value at the upper line. This value is the
/// limit, except for the position.
const PANELS: [(&str, &[usize], f64); 4] = [
    ("position, m", &[1, 0], 0.8),
    ("velocity, m/s", &[2], VELOCITY),
    ("acceleration, m/s²", &[3], ACCELERATION),
    ("jerk, m/s³", &[4], JERK),
];
