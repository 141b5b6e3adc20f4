//! The state of Desk, the robot's web interface. It is read without a login, and can explain why
//! the robot refuses a session.
//!
//! ```text
//! Desk --GET--> pages (v1 of its interface, or an older one) --> DeskState --> robot.web
//! ```

mod client;
mod pages;

use crate::finding::{About, Finding, Judged, Purpose};

pub use client::ask_desk;
pub(crate) use pages::{Page, read};

/// State of the robot, as Desk reports it without a login. A field is `None` if Desk does not
/// report its value.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct DeskState {
    /// State of the system: `Started`, or another word that Desk uses.
    pub system: Option<String>,
    /// Operating mode: `Execution`, `Programming`, or another word that Desk uses.
    pub mode: Option<String>,
    /// The joints whose brakes are closed, counted from 1.
    pub braked: Option<Vec<usize>>,
    /// True if FCI (the interface for clients) is active.
    pub fci: Option<bool>,
    /// State of the daily self-test.
    pub self_test: Option<SelfTest>,
}

/// State of the daily self-test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SelfTest {
    /// The self-test is not due yet. The value is the remaining time in seconds, if Desk reports
    /// it.
    Done(Option<u64>),
    /// The self-test is due soon. The value is the remaining time in seconds, if Desk reports it.
    Soon(Option<u64>),
    /// The self-test is due. The robot does not move until the self-test has run.
    Due,
    /// The self-test is running.
    Running,
}

/// Returns the finding about the state of Desk (`robot.web`). This function performs no I/O.
pub fn web(asked: &Result<DeskState, String>, purpose: Purpose) -> Finding {
    let about = About::robot(
        "robot.web",
        "the system started, mode Execution, all brakes open, FCI active, no self-test due",
        "Otherwise the robot refuses FCI connections or motions.",
        "vendor: FCI documentation; the pages of Desk: other clients, not verified on an arm",
    );
    let judged = match asked {
        Ok(state) => judge(state),
        Err(why) => Judged::unknown(format!("unknown: {why}")),
    };
    about.finding(Ok(judged), purpose)
}

fn judge(state: &DeskState) -> Judged {
    let reasons = reasons(state);
    if !reasons.is_empty() {
        return Judged::failure(reasons.join("; "));
    }
    let soon = match state.self_test {
        Some(SelfTest::Soon(left)) => Some(match left {
            Some(left) => format!("the self-test is due in {}", hours(left)),
            None => "the self-test is due soon".into(),
        }),
        _ => None,
    };
    let missing: Vec<&str> = [
        (state.system.is_none(), "system"),
        (state.mode.is_none(), "mode"),
        (state.braked.is_none(), "brakes"),
        (state.fci.is_none(), "FCI"),
    ]
    .into_iter()
    .filter_map(|(is_missing, what)| is_missing.then_some(what))
    .collect();
    let read = match missing.as_slice() {
        [] => "started, mode Execution, brakes open, FCI active".to_owned(),
        [_, _, _, _] => return Judged::unknown("unknown: Desk requires a login for these states"),
        missing => format!(
            "no obstacle found, but Desk reports nothing about {}",
            missing.join(", ")
        ),
    };
    match (soon, missing.is_empty()) {
        (Some(soon), _) => Judged::warning(format!("{read}; {soon}: run it in Desk")),
        (None, true) => Judged::good(read),
        (None, false) => Judged::info(read),
    }
}

/// Returns the reasons why the robot refuses a session or a motion. Each text names the necessary
/// action in Desk.
fn reasons(state: &DeskState) -> Vec<String> {
    let mut reasons = Vec::new();
    match state.system.as_deref() {
        None | Some("Started") => {}
        Some("RebootRequired") => {
            reasons.push("the system requires a restart: restart it in Desk".into())
        }
        Some(other) => reasons.push(format!("the system is not started: {other}")),
    }
    match state.self_test {
        Some(SelfTest::Due) => reasons.push("the daily self-test is due: run it in Desk".into()),
        Some(SelfTest::Running) => {
            reasons.push("the self-test is running: wait for its end".into())
        }
        Some(SelfTest::Done(_) | SelfTest::Soon(_)) | None => {}
    }
    match state.braked.as_deref() {
        None | Some([]) => {}
        Some(joints) if joints.len() >= 7 => {
            reasons.push("the brakes are closed: open them in Desk".into());
        }
        Some(joints) => {
            let joints: Vec<String> = joints.iter().map(ToString::to_string).collect();
            let joints = joints.join(", ");
            reasons.push(format!(
                "the brakes of joints {joints} are closed: open them in Desk"
            ));
        }
    }
    match state.mode.as_deref() {
        None | Some("Execution") => {}
        Some("SafetyRecovery") => reasons.push(
            "mode SafetyRecovery: the user stop is pressed, or Desk requires a recovery".into(),
        ),
        Some(other) => reasons.push(format!("mode {other}: choose Execution in Desk")),
    }
    if state.fci == Some(false) {
        reasons.push("FCI is not active: activate it in Desk".into());
    }
    reasons
}

/// Formats a time in hours. A time of less than one hour is in minutes.
fn hours(seconds: u64) -> String {
    match seconds {
        3600.. => format!("{} h", seconds / 3600),
        _ => format!("{} min", seconds / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Verdict;

    fn ready() -> DeskState {
        DeskState {
            system: Some("Started".into()),
            mode: Some("Execution".into()),
            braked: Some(Vec::new()),
            fci: Some(true),
            self_test: Some(SelfTest::Done(Some(80_000))),
        }
    }

    #[test]
    fn each_obstacle_has_its_reason() {
        use Verdict::{Failure, Good, Info, Unknown, Warning};
        type Change = fn(&mut DeskState);
        let cases: [(Change, Verdict, &str); 13] = [
            (|_| (), Good, "started, mode Execution"),
            (
                |state| state.system = Some("Starting".into()),
                Failure,
                "not started: Starting",
            ),
            (
                |state| state.system = Some("RebootRequired".into()),
                Failure,
                "restart",
            ),
            (
                |state| state.mode = Some("Programming".into()),
                Failure,
                "choose Execution",
            ),
            (
                |state| state.mode = Some("SafetyRecovery".into()),
                Failure,
                "user stop",
            ),
            (
                |state| state.braked = Some((1..=7).collect()),
                Failure,
                "the brakes are closed",
            ),
            (
                |state| state.braked = Some(vec![2, 5]),
                Failure,
                "joints 2, 5",
            ),
            (
                |state| state.fci = Some(false),
                Failure,
                "FCI is not active",
            ),
            (
                |state| state.self_test = Some(SelfTest::Due),
                Failure,
                "self-test is due",
            ),
            (
                |state| state.self_test = Some(SelfTest::Running),
                Failure,
                "self-test is running",
            ),
            (
                |state| state.self_test = Some(SelfTest::Soon(Some(7300))),
                Warning,
                "due in 2 h",
            ),
            (
                |state| state.mode = None,
                Info,
                "reports nothing about mode",
            ),
            (
                |state| *state = DeskState::default(),
                Unknown,
                "requires a login",
            ),
        ];
        for (change, verdict, text) in cases {
            let mut state = ready();
            change(&mut state);
            let finding = web(&Ok(state.clone()), Purpose::Move);
            assert_eq!(finding.verdict, verdict, "{state:?}: {}", finding.read);
            assert!(finding.read.contains(text), "{}", finding.read);
        }
        let silent = web(&Err("no Desk".into()), Purpose::Move);
        assert_eq!(
            (silent.verdict, silent.read.as_str()),
            (Unknown, "unknown: no Desk")
        );
    }

    #[test]
    fn all_obstacles_are_named_at_once() {
        let cold = DeskState {
            braked: Some((1..=7).collect()),
            fci: Some(false),
            mode: Some("Programming".into()),
            ..ready()
        };
        let read = web(&Ok(cold), Purpose::Read).read;
        assert_eq!(read.matches("; ").count(), 2, "{read}");
    }
}
