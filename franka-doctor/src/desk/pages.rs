//! The pages of Desk that require no login, in all generations of its interface.
//!
//! The paths and fields come from existing clients of Desk, because the vendor does not document
//! the older generations.

use serde_json::Value;

use super::{DeskState, SelfTest};

/// An answer of Desk: the HTTP status, and the body if it is JSON.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Page {
    pub(crate) status: u16,
    pub(crate) json: Option<Value>,
}

/// Reads the state of Desk. `get` returns the answer for a path.
///
/// # Errors
/// Returns an error if the first path has no answer or an unknown answer. If a later path has no
/// answer, its fields stay `None`.
pub(crate) fn read(get: &mut dyn FnMut(&str) -> Result<Page, String>) -> Result<DeskState, String> {
    let first = get("/api/system")?;
    let mut statuses = vec![("/api/system", first.status)];
    let mut page = |path: &'static str| {
        let page = get(path).ok()?;
        statuses.push((path, page.status));
        page.json.filter(|_| page.status == 200)
    };
    let system = first.json.filter(|_| first.status == 200);
    if let Some(system) = system.filter(|system| system["status"].is_string()) {
        return Ok(DeskState {
            system: word(&system["status"]),
            mode: match word(&system["operatingMode"]["status"]) {
                Some(mode) => Some(mode),
                None => page("/api/system/operating-mode").and_then(|it| word(&it["status"])),
            },
            braked: page("/api/arm/joints").and_then(|joints| braked(&joints, "brakeStatus")),
            fci: page("/api/fci").and_then(|fci| Some(word(&fci["status"])? == "Active")),
            self_test: page("/api/safety/self-tests").and_then(|test| {
                let left = test["remaining"].as_f64();
                self_test(&word(&test["status"])?, left)
            }),
        });
    }
    if let Some(all) = page("/admin/api/system-status").filter(Value::is_object) {
        let safety = &all["safety"];
        let left = safety["timeToTd2"].as_f64();
        let overdue = safety["recoverableErrors"]["td2Timeout"] == true
            || left.is_some_and(|left| left <= 0.0);
        let test = match overdue {
            true => Some("Elapsed".into()),
            false => word(&all["derived"]["td2Tests"]["status"]),
        };
        return Ok(DeskState {
            system: word(&all["startup"]["tag"]),
            mode: word(&all["derived"]["operatingMode"]),
            braked: braked(&safety["brakeState"], ""),
            fci: all["controlToken"]["fciActive"].as_bool(),
            self_test: test.and_then(|test| self_test(&test, left)),
        });
    }
    if let Some(token) = page("/admin/api/control-token").filter(Value::is_object) {
        return Ok(DeskState {
            fci: token["fciActive"].as_bool(),
            ..DeskState::default()
        });
    }
    let closed = statuses
        .iter()
        .find(|(_, status)| matches!(status, 401 | 403));
    Err(match closed {
        Some((path, status)) => format!("Desk asks for a login ({path}: {status})"),
        None => {
            let statuses = statuses
                .iter()
                .map(|(path, status)| format!("{path}: {status}"));
            let statuses: Vec<String> = statuses.collect();
            format!(
                "the answer is not from a known version of Desk ({})",
                statuses.join(", ")
            )
        }
    })
}

/// Returns a word of Desk, made safe for a terminal.
fn word(value: &Value) -> Option<String> {
    let text = value.as_str()?;
    let shown: String = text.escape_debug().take(WORD_MAX).collect();
    Some(shown)
}

/// Returns the joints whose brakes are not open. `joints` is a list of words, or of objects whose
/// `field` contains such a word.
fn braked(joints: &Value, field: &str) -> Option<Vec<usize>> {
    let joints = joints.as_array().filter(|joints| joints.len() == 7)?;
    let mut braked = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        let state = match field {
            "" => joint,
            field => &joint[field],
        };
        match state.as_str()? {
            "Unlocked" => {}
            _ => braked.push(index + 1),
        }
    }
    Some(braked)
}

/// Converts Desk's word for the self-test and the number of seconds until the self-test is due.
fn self_test(word: &str, left: Option<f64>) -> Option<SelfTest> {
    let left = left.map(|left| left.max(0.0) as u64);
    match word {
        "OK" | "Ok" => Some(SelfTest::Done(left)),
        "Warning" => Some(SelfTest::Soon(left)),
        "Elapsed" => Some(SelfTest::Due),
        "Running" => Some(SelfTest::Running),
        _ => None,
    }
}

/// Largest number of characters shown from a word of Desk.
const WORD_MAX: usize = 40;

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Returns the state from a simulated Desk. It answers these paths, and 404 for all others.
    fn state(pages: &[(&str, u16, Value)]) -> Result<DeskState, String> {
        read(&mut |path| {
            let known = pages.iter().find(|(known, ..)| *known == path);
            Ok(match known {
                Some((_, status, json)) => Page {
                    status: *status,
                    json: Some(json.clone()),
                },
                None => Page {
                    status: 404,
                    json: None,
                },
            })
        })
    }

    fn joints(locked: usize) -> Value {
        let joint = |joint: usize| {
            let status = if joint == locked {
                "Locked"
            } else {
                "Unlocked"
            };
            json!({ "joint": joint, "brakeStatus": status })
        };
        (1..=7).map(joint).collect()
    }

    #[test]
    fn the_newest_generation_is_read() {
        let system = json!({
            "status": "Started",
            "operatingMode": { "status": "Programming" },
            "controlSerialNumber": "123456-7654321",
        });
        let read = state(&[
            ("/api/system", 200, system),
            ("/api/arm/joints", 200, joints(3)),
            ("/api/fci", 200, json!({ "status": "Inactive" })),
            (
                "/api/safety/self-tests",
                200,
                json!({ "status": "Warning", "remaining": 7200.5 }),
            ),
        ]);
        let expected = DeskState {
            system: Some("Started".into()),
            mode: Some("Programming".into()),
            braked: Some(vec![3]),
            fci: Some(false),
            self_test: Some(SelfTest::Soon(Some(7200))),
        };
        assert_eq!(read, Ok(expected));
    }

    #[test]
    fn desk_answers_missing_or_behind_a_login_stay_open() {
        let read = state(&[
            ("/api/system", 200, json!({ "status": "Started" })),
            (
                "/api/system/operating-mode",
                200,
                json!({ "status": "Execution" }),
            ),
            ("/api/fci", 200, json!({ "status": "Active" })),
            ("/api/arm/joints", 200, json!([{ "brakeStatus": "Locked" }])),
            (
                "/api/safety/self-tests",
                401,
                json!({ "code": "Unauthorized" }),
            ),
        ]);
        let read = read.expect("a state");
        assert_eq!(read.mode.as_deref(), Some("Execution"));
        assert_eq!(
            (read.fci, read.braked, read.self_test),
            (Some(true), None, None)
        );
    }

    #[test]
    fn older_generations_are_read() {
        let status = json!({
            "startup": { "tag": "Started" },
            "derived": { "operatingMode": "Execution", "td2Tests": { "status": "OK" } },
            "safety": { "brakeState": vec!["Locked"; 7], "timeToTd2": 0 },
            "controlToken": { "fciActive": true },
        });
        let read = state(&[("/admin/api/system-status", 200, status)]).expect("a state");
        assert_eq!(read.braked, Some((1..=7).collect()));
        assert_eq!(
            (read.fci, read.self_test),
            (Some(true), Some(SelfTest::Due))
        );
        let token = json!({ "activeToken": null, "fciActive": false });
        let read = state(&[("/admin/api/control-token", 200, token)]).expect("a state");
        assert_eq!((read.fci, read.mode), (Some(false), None));
    }

    #[test]
    fn unknown_desk_is_reported_with_the_reason() {
        let login = state(&[("/api/system", 401, json!({}))]);
        assert_eq!(
            login,
            Err("Desk asks for a login (/api/system: 401)".into())
        );
        let other = state(&[("/api/system", 200, json!("hello"))]).expect_err("no Desk");
        assert!(
            other.contains("not from a known version of Desk (/api/system: 200"),
            "{other}"
        );
        let silent = read(&mut |_| Err("no connection".into()));
        assert_eq!(silent, Err("no connection".into()));
    }

    #[test]
    fn words_from_the_network_are_fit_for_a_terminal() {
        let system = json!({ "status": format!("\u{1b}[2J{}", "x".repeat(900)) });
        let read = state(&[("/api/system", 200, system)]).expect("a state");
        let shown = read.system.expect("a word");
        assert!(
            shown.chars().count() <= WORD_MAX && !shown.contains('\u{1b}'),
            "{shown:?}"
        );
    }
}
