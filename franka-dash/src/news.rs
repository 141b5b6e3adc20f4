//! Events as lines for people.

use franka_async::diagnosis::Diagnose;
use franka_async::state::RobotState;
use franka_async::supervision::EventKind;

use crate::reply::Level;

/// Level, line and explanation of an event; `None` for what the page shows anyway.
pub(crate) fn of_event(kind: &EventKind) -> Option<(Level, String, Option<String>)> {
    use Level::{Error, Info, Warning};
    let plain = |level, text: &str| Some((level, text.to_owned(), None));
    match kind {
        EventKind::Connected { .. } => plain(Info, "Connected"),
        EventKind::RealtimeRefused { refusals } => {
            let refusals: Vec<_> = refusals.iter().map(ToString::to_string).collect();
            let text = "The control thread runs without real-time scheduling".to_owned();
            Some((Warning, text, Some(refusals.join("\n"))))
        }
        EventKind::Lost { reason } => Some((Error, format!("Connection lost: {reason}"), None)),
        EventKind::Silent { silence } => Some((Error, format!("No state for {silence:.0?}"), None)),
        EventKind::Resumed { after } => {
            Some((Info, format!("States come again, after {after:.1?}"), None))
        }
        EventKind::Reflex(reflex) => {
            let why = reflex.diagnose().map(|diagnosis| diagnosis.to_string());
            Some((Error, format!("Reflex: {}", reflex.errors), why))
        }
        EventKind::NotRecovered { why, .. } => {
            Some((Warning, format!("Not recovered: {why}"), None))
        }
        EventKind::Recovered { after, .. } => {
            Some((Info, format!("Recovered after {after:.1?}"), None))
        }
        EventKind::UserStop { pressed: true } => plain(Warning, "User stop pressed"),
        EventKind::UserStop { pressed: false } => plain(Info, "User stop released"),
        EventKind::Guiding { active: true } => plain(Info, "Guided by hand"),
        EventKind::Guiding { active: false } => plain(Info, "No longer guided"),
        EventKind::Brakes { closed: true } => plain(Warning, "Brakes closed"),
        EventKind::Brakes { closed: false } => plain(Info, "Brakes open"),
        EventKind::LoadChanged { load } => {
            Some((Info, format!("The load is {:.2} kg", load.m_load), None))
        }
        EventKind::Closed { reason } => Some((Error, format!("Closed: {reason}"), None)),
        _ => None,
    }
}

/// What a watched robot's states tell of its mode and errors between two samples.
pub(crate) fn of_states(
    before: &RobotState,
    state: &RobotState,
) -> Option<(Level, String, Option<String>)> {
    if !state.errors.is_empty() && state.errors != before.errors {
        let explained: Vec<_> = state.errors.iter().map(|error| error.to_string()).collect();
        let text = format!("Reflex: {}", explained.join(", "));
        return Some((Level::Error, text, None));
    }
    (state.robot_mode != before.robot_mode)
        .then(|| (Level::Info, format!("Mode: {}", state.robot_mode), None))
}
