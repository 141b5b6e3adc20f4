//! The state of a robot as a text page.

use std::fmt::Write as _;

use anstyle::Style;
use franka_async::model::Model;
use franka_async::realtime::Stats;
use franka_async::state::{RobotMode, RobotState};
use franka_async::{Pose, Robot};
use serde_json::{Value, json};

use crate::connection::{Place, kind_name};
use crate::output::{BAD, BOLD, DIM, GOOD, WARN, unsigned_zero};

/// Returns the newest state and all other known data as JSON.
pub(super) fn value(robot: &Robot, place: &Place) -> Value {
    let stats = robot.stats();
    let microseconds = |quantile| {
        let time = stats.interval.quantile(quantile);
        time.map(|time| time.as_micros() as u64)
    };
    json!({
        "robot": place.to_string(),
        "address": robot.address(),
        "kind": kind_name(robot.model().kind()),
        "protocol": robot.version().number(),
        "state": robot.state(),
        "link": {
            "received": stats.states.get(),
            "lost": stats.lost.get(),
            "skipped": stats.skipped.get(),
            "interval_us": { "p50": microseconds(0.5), "p99": microseconds(0.99), "max": microseconds(1.0) },
        },
    })
}

/// Returns the newest state as lines of at most 80 columns.
pub(super) fn text(robot: &Robot, place: &Place) -> String {
    let state = robot.state();
    let mut text = String::new();
    let (style, mode) = mode(&state);
    let about = format!(
        "{}  {place}  protocol {}",
        kind_name(robot.model().kind()),
        robot.version().number()
    );
    let _ = writeln!(text, "{BOLD}{about}{BOLD:#}  {style}{mode}{style:#}");
    if !state.errors.is_empty() {
        let _ = writeln!(text, "{BAD}errors {}{BAD:#}", state.errors);
    } else if !state.reflex_reason.is_empty() {
        let _ = writeln!(
            text,
            "{DIM}last motion ended by {}{DIM:#}",
            state.reflex_reason
        );
    }
    let _ = writeln!(text);
    joints(&mut text, &state, robot.model());
    let _ = writeln!(text);
    hand(&mut text, &state, &robot.pose());
    let _ = writeln!(text);
    link(&mut text, &state, &robot.stats());
    text
}

fn mode(state: &RobotState) -> (Style, String) {
    let style = match state.robot_mode {
        RobotMode::Idle => GOOD,
        RobotMode::Move | RobotMode::Guiding | RobotMode::AutomaticErrorRecovery => WARN,
        RobotMode::Reflex | RobotMode::UserStopped | RobotMode::Other => BAD,
    };
    let text = match state.robot_mode {
        RobotMode::Other => "not ready: the brakes are closed, or the robot is starting".to_owned(),
        mode => mode.to_string().to_lowercase(),
    };
    (style, text)
}

fn joints(text: &mut String, state: &RobotState, model: &Model) {
    let limits = model.joint_limits();
    let _ = writeln!(
        text,
        "{BOLD}joint   from                            to      now   speed  torque external{BOLD:#}\n\
         {DIM}         deg                           deg      deg   deg/s     N m      N m{DIM:#}"
    );
    let shown = |value| unsigned_zero(value, 2);
    for i in 0..7 {
        let (lower, upper, q) = (limits.lower[i], limits.upper[i], state.q[i]);
        let share = ((q - lower) / (upper - lower)).clamp(0.0, 1.0);
        let distance = (q - lower).min(upper - q).to_degrees();
        let style = match distance {
            near if near < 2.0 => BAD,
            near if near < 10.0 => WARN,
            _ => GOOD,
        };
        let touched = match state.joint_contact[i] + state.joint_collision[i] {
            0.0 => "",
            _ => " touched",
        };
        let _ = writeln!(
            text,
            "{:>3}   {:>6.1} {} {:<6.1} {:>7.2} {:>7.2} {:>7.2}  {:>7.2}{WARN}{touched}{WARN:#}",
            i + 1,
            lower.to_degrees(),
            bar(share, style),
            upper.to_degrees(),
            shown(q.to_degrees()),
            shown(state.dq[i].to_degrees()),
            shown(state.tau_J[i]),
            shown(state.tau_ext_hat_filtered[i]),
        );
    }
}

fn bar(share: f64, style: Style) -> String {
    let at = (share * (BAR - 1) as f64).round() as usize;
    let (before, after) = ("─".repeat(at), "─".repeat(BAR - 1 - at));
    format!("├{before}{style}●{style:#}{after}┤")
}

fn hand(text: &mut String, state: &RobotState, pose: &Pose) {
    let shown = |value| unsigned_zero(value, 1);
    let position = (pose.translation.vector * 1e3).map(shown);
    let (roll, pitch, yaw) = pose.rotation.euler_angles();
    let [roll, pitch, yaw] = [roll, pitch, yaw].map(|angle| shown(angle.to_degrees()));
    let [fx, fy, fz, tx, ty, tz] = state.wrench_at_stiffness_frame().map(shown);
    let _ = writeln!(
        text,
        "{BOLD}hand{BOLD:#}    x {:>7.1}  y {:>7.1}  z {:>7.1}  mm   r {:>6.1}  p {:>6.1}  y {:>6.1}  deg\n\
         {BOLD}force{BOLD:#}   x {fx:>7.1}  y {fy:>7.1}  z {fz:>7.1}  N    x {tx:>6.1}  y {ty:>6.1}  z {tz:>6.1}  N m",
        position.x, position.y, position.z, roll, pitch, yaw,
    );
    let _ = writeln!(
        text,
        "{BOLD}load{BOLD:#}    end effector {:.3} kg, declared load {:.3} kg",
        state.m_ee, state.m_load
    );
}

fn link(text: &mut String, state: &RobotState, stats: &Stats) {
    let milliseconds = |quantile| {
        let time = stats.interval.quantile(quantile);
        time.unwrap_or_default().as_secs_f64() * 1e3
    };
    let (received, lost, skipped) = (stats.states.get(), stats.lost.get(), stats.skipped.get());
    let style = if lost > 0 { WARN } else { GOOD };
    let _ = write!(
        text,
        "{BOLD}link{BOLD:#}    {received} states, {style}{lost} lost{style:#}, {skipped} skipped\n        between them p50 {:.2}, p99 {:.2}, max {:.2} ms",
        milliseconds(0.5),
        milliseconds(0.99),
        milliseconds(1.0),
    );
    if state.motion_running() {
        let _ = write!(
            text,
            "\n        success rate {:.2}",
            state.control_command_success_rate
        );
    }
    let _ = writeln!(text);
}

/// Number of columns of a bar between its ends.
const BAR: usize = 24;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_has_its_mark_where_the_joint_is() {
        let plain = |share| bar(share, Style::new());
        assert!(plain(0.0).starts_with("├●─"));
        assert!(plain(1.0).ends_with("─●┤"));
        assert_eq!(plain(0.5).chars().count(), BAR + 2);
    }
}
