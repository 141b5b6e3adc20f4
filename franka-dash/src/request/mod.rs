//! Requests of viewers, in JSON, and checks of their ranges.

mod disturbance;
mod gripper;
mod motion;
mod tuning;

use std::fmt::Display;
use std::ops::RangeInclusive;

use serde::Deserialize;

pub(crate) use disturbance::{ArmKind, Conditions, Disturbance, PUSH_MS};
pub(crate) use gripper::GripperAction;
pub(crate) use motion::{Axes, Motion, SPEED_MAX, SPEED_MIN};
pub(crate) use tuning::Tuning;

/// A message from a viewer.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Request {
    /// Acknowledges the state frame with this server time, `[ms]`. The server may then send the
    /// next frame.
    Seen { server_ms: u64 },
    /// Requests the lease. The other viewers see `name`.
    Take { name: String },
    /// Renews the lease.
    Alive {},
    /// Releases the lease.
    Release {},
    /// Begins a hold. The arm moves as long as `Hold` messages follow.
    Begin {
        motion: Motion,
        /// Largest speed of any point of the arm, `[m/s]`.
        speed: f64,
    },
    /// Requests a preview of a motion that has a target. The arm does not move.
    Preview {
        /// Number of the question, which the answer repeats.
        number: u32,
        motion: Motion,
        /// Largest speed, as for `Begin`.
        speed: f64,
    },
    /// Continues the hold. `seq` counts the messages from 1, without a gap.
    Hold { seq: u32 },
    /// Ends the hold, because the pointer or key was released.
    End {},
    /// Brakes any motion. Every viewer may send this.
    Stop {},
    /// Recovers the robot from a reflex. The robot does not move.
    Recover {},
    /// Sets the stiffness of the arm for the active hold and all later holds.
    Tune { tuning: Tuning },
    /// Takes or clears the tare (the zero) of the displayed wrench. The robot must be at rest, and
    /// does not move.
    Tare { on: bool },
    /// Sets the largest speed of any point of the arm in the active hold, `[m/s]`.
    Speed { speed: f64 },
    /// Starts an action of the fingers.
    Gripper { action: GripperAction },
    /// Begins or ends a recording.
    Record { on: bool },
    /// Disturbs a simulated robot.
    Disturb { disturbance: Disturbance },
}

impl Request {
    /// Checks that all numbers are in range. The error states the received value and the valid
    /// range.
    pub(crate) fn check(&self) -> Result<(), String> {
        match self {
            Self::Begin { motion, speed } | Self::Preview { motion, speed, .. } => {
                motion.check().and(check_speed(*speed))
            }
            Self::Speed { speed } => check_speed(*speed),
            Self::Tune { tuning } => tuning.check(),
            Self::Gripper { action } => action.check(),
            Self::Disturb { disturbance } => disturbance.check(),
            Self::Take { name } => match name.chars().count() {
                1..=NAME_MAX if !name.trim().is_empty() => Ok(()),
                got => Err(format!(
                    "got a name of {got} characters, expected 1 to {NAME_MAX}, and not only spaces"
                )),
            },
            Self::Seen { .. }
            | Self::Alive {}
            | Self::Release {}
            | Self::Hold { .. }
            | Self::End {}
            | Self::Stop {}
            | Self::Recover {}
            | Self::Tare { .. }
            | Self::Record { .. } => Ok(()),
        }
    }
}

fn check_speed(speed: f64) -> Result<(), String> {
    within("the speed", " m/s", speed, SPEED_MIN..=SPEED_MAX)
}

/// Checks that `got` is in a range. Otherwise returns an error text. `what` is the name of the
/// number. `unit` is empty or begins with a space.
fn within<T: PartialOrd + Display>(
    what: &str,
    unit: &str,
    got: T,
    range: RangeInclusive<T>,
) -> Result<(), String> {
    match range.contains(&got) {
        true => Ok(()),
        false => Err(format!(
            "{what} is {got}{unit}, expected {} to {}{unit}",
            range.start(),
            range.end()
        )),
    }
}

/// Largest number of characters of a name.
const NAME_MAX: usize = 40;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::any_messages::REQUESTS;

    fn read(text: &str) -> Request {
        serde_json::from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[test]
    fn requests_are_read_as_documented() {
        for text in REQUESTS {
            read(text)
                .check()
                .unwrap_or_else(|why| panic!("{text}: {why}"));
        }
        assert_eq!(read(r#"{"type":"hold","seq":4}"#), Request::Hold { seq: 4 });
    }

    #[test]
    fn malformed_request_is_not_read() {
        for text in [
            "",
            "null",
            "{}",
            r#"{"type":"hold"}"#,
            r#"{"type":"hold","seq":-1}"#,
            r#"{"type":"hold","seq":4294967296}"#,
            r#"{"type":"hold","seq":1,"also":2}"#,
            r#"{"type":"stop","also":2}"#,
            r#"{"type":"begin","motion":{"kind":"joints","q":[1,2]},"speed":0.1}"#,
            r#"{"type":"begin","motion":{"kind":"ready"},"speed":"fast"}"#,
            r#"{"type":"fly"}"#,
            r#"{"type":"record"}"#,
            r#"{"type":"record","on":true,"file":"/etc/passwd"}"#,
            r#"{"type":"tare"}"#,
            r#"{"type":"tare","on":true,"wrench":[0,0,0,0,0,0]}"#,
            r#"{"type":"gripper","action":{"kind":"home","width":0.1}}"#,
            r#"{"type":"gripper","action":{"kind":"crush"}}"#,
            r#"{"type":"tune","tuning":{"end_effector":1}}"#,
            r#"{"type":"disturb","disturbance":{"kind":"arm","arm":"perfect"}}"#,
            r#"{"type":"disturb","disturbance":{"kind":"load","mass":null}}"#,
        ] {
            assert!(serde_json::from_str::<Request>(text).is_err(), "{text}");
        }
    }

    #[test]
    fn out_of_range_request_is_refused_with_its_value() {
        for (text, got) in [
            (
                r#"{"type":"take","name":"  "}"#,
                "got a name of 2 characters",
            ),
            (
                r#"{"type":"begin","motion":{"kind":"ready"},"speed":0.2501}"#,
                "is 0.2501 m/s, expected 0.001 to 0.25 m/s",
            ),
            (
                r#"{"type":"begin","motion":{"kind":"joint","joint":8,"up":true},"speed":0.1}"#,
                "is 8, expected 1 to 7",
            ),
            (
                r#"{"type":"preview","number":1,"motion":{"kind":"pose","position":[0,0,9],"orientation":[0,0,0,1]},"speed":0.1}"#,
                "is 9 m, expected -2 to 2 m",
            ),
            (
                r#"{"type":"begin","motion":{"kind":"pose","position":[0,0,1],"orientation":[0,0,0,0]},"speed":0.1}"#,
                "is 0, expected 0.001 to 1000",
            ),
            (
                r#"{"type":"disturb","disturbance":{"kind":"push","link":0,"offset":[0,0,0],"force":[0,0,0]}}"#,
                "the link to push is 0, expected 1 to 7",
            ),
            (
                r#"{"type":"disturb","disturbance":{"kind":"push","link":1,"offset":[0,2,0],"force":[0,0,0]}}"#,
                "is 2 m, expected -1 to 1 m",
            ),
            (
                r#"{"type":"disturb","disturbance":{"kind":"push","link":1,"offset":[0,0,0],"force":[0,0,-201]}}"#,
                "is -201",
            ),
            (
                r#"{"type":"disturb","disturbance":{"kind":"network","conditions":{"loss":0.6,"burst":1,"delay_ms":0,"jitter_ms":0,"stalls_per_second":0,"stall_ms":0}}}"#,
                "the share of lost datagrams is 0.6, expected 0 to 0.5",
            ),
            (
                r#"{"type":"disturb","disturbance":{"kind":"cut","milliseconds":0}}"#,
                "is 0 ms, expected 1 to 10000 ms",
            ),
            (
                r#"{"type":"disturb","disturbance":{"kind":"object","width":0.081}}"#,
                "is 0.081 m, expected 0.001 to 0.08 m",
            ),
            (
                r#"{"type":"disturb","disturbance":{"kind":"load","mass":-1}}"#,
                "is -1 kg, expected 0 to 5 kg",
            ),
            (
                r#"{"type":"tune","tuning":{"end_effector":4.1,"joints":1,"damping":1,"force_cap":30,"compensation":true}}"#,
                "is 4.1, expected 0.1 to 4",
            ),
            (
                r#"{"type":"tune","tuning":{"end_effector":1,"joints":1,"damping":2,"force_cap":30,"compensation":true}}"#,
                "is 2, expected 0.5 to 1.3",
            ),
            (
                r#"{"type":"tune","tuning":{"end_effector":1,"joints":1,"damping":1,"force_cap":0,"compensation":true}}"#,
                "is 0 N, expected 5 to 60 N",
            ),
            (r#"{"type":"speed","speed":0}"#, "is 0"),
            (
                r#"{"type":"gripper","action":{"kind":"move","width":0.3,"speed":0.1}}"#,
                "is 0.3 m, expected 0 to 0.2 m",
            ),
            (
                r#"{"type":"gripper","action":{"kind":"grasp","width":0.03,"tolerance":0.01,"speed":0.1,"force":1000}}"#,
                "is 1000 N, expected 1 to 140 N",
            ),
        ] {
            let why = read(text).check().expect_err(text);
            assert!(why.contains(got), "{why}");
        }
    }
}
