//! Events as lines of text.

use franka_async::diagnosis::Diagnose;
use franka_async::state::RobotState;
use franka_async::supervision::EventKind;

use crate::reply::Level;

/// Returns the level, the line and the explanation of an event; `None` for events that the page
/// shows in a different way.
pub(crate) fn of_event(kind: &EventKind) -> Option<(Level, String, Option<String>)> {
    let level = match kind {
        EventKind::MotionBegun { .. } | EventKind::MotionEnded { .. } => return None,
        EventKind::Lost { .. }
        | EventKind::Silent { .. }
        | EventKind::Reflex(_)
        | EventKind::NotConfigured { .. }
        | EventKind::Closed { .. } => Level::Error,
        EventKind::RealtimeRefused { .. }
        | EventKind::Unrecognised { .. }
        | EventKind::StopLatch { latched: true }
        | EventKind::NotRecovered { .. }
        | EventKind::UserStop { pressed: true }
        | EventKind::Brakes { closed: true } => Level::Warning,
        _ => Level::Info,
    };
    let why = match kind {
        EventKind::Reflex(reflex) => reflex.diagnose().map(|diagnosis| diagnosis.to_string()),
        _ => None,
    };
    let mut text = kind.to_string();
    text[..1].make_ascii_uppercase();
    Some((level, text, why))
}

/// Returns the changes of the mode and the errors of a watched robot between two samples.
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
