//! What goes over the socket as JSON. State frames are binary: [`frame`](crate::frame).

use serde::{Deserialize, Serialize};

use crate::disturbance::Disturbance;

/// From a viewer.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Request {
    /// Acknowledges the state frame of this time of the server, `[ms]`: the next one may be sent.
    Seen { server_ms: u64 },
    /// Asks for the lease, under a name that the others see.
    Take { name: String },
    /// Keeps the lease.
    Alive {},
    /// Gives the lease back.
    Release {},
    /// Begins a hold: the arm moves while `Hold` follows.
    Begin {
        motion: Motion,
        /// Greatest speed of any point of the arm, `[m/s]`.
        speed: f64,
    },
    /// Goes on with the hold; counts from 1 without a gap.
    Hold { seq: u32 },
    /// The pointer or key was let go.
    End {},
    /// Brakes whatever moves. Open to every viewer.
    Stop {},
    /// Recovers the robot from a reflex; moves nothing.
    Recover {},
    /// Disturbs a simulated robot.
    Disturb { disturbance: Disturbance },
}

/// Axes that a direction is given in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Axes {
    Base,
    Tool,
}

/// What moves while a hold goes on.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Motion {
    /// The end effector along a direction.
    Translate { direction: [f64; 3], axes: Axes },
    /// The end effector about an axis through its origin.
    Rotate { direction: [f64; 3], axes: Axes },
    /// One joint, 0 to 6, up or down, as far as its range.
    Joint { joint: usize, up: bool },
    /// All joints to these positions, `[rad]`.
    Joints { q: [f64; 7] },
    /// All joints to the ready pose.
    Ready {},
}

impl Motion {
    /// Whether the numbers make a motion; otherwise what is wrong with them.
    pub(crate) fn check(&self) -> Result<(), &'static str> {
        match self {
            Self::Translate { direction, .. } | Self::Rotate { direction, .. } => {
                let norm = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
                match norm.is_finite() && norm > 1e-6 {
                    true => Ok(()),
                    false => Err("a direction has three finite numbers, not all zero"),
                }
            }
            Self::Joint { joint, .. } if *joint > 6 => Err("an arm has joints 0 to 6"),
            Self::Joints { q } if !q.iter().all(|x| x.is_finite()) => {
                Err("joint positions are finite numbers")
            }
            Self::Joint { .. } | Self::Joints { .. } | Self::Ready {} => Ok(()),
        }
    }
}

/// To a viewer.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Reply {
    /// A request that had no effect, and why.
    Refused { why: String },
    /// Who may command, and what is going on.
    Status(Status),
    /// Something that happened.
    Event(News),
    /// Events that this viewer was too slow for.
    Missed { events: u64 },
    /// How punctual control is.
    Statistics(crate::statistics::Statistics),
}

/// Who may command, and what is going on.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Status {
    /// Number of the viewer that has the lease.
    pub(crate) commander: Option<u64>,
    /// The name that it gave.
    pub(crate) name: Option<String>,
    /// Whether a hold goes on.
    pub(crate) holding: bool,
}

/// How much an event asks for attention.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Level {
    Info,
    Warning,
    Error,
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct News {
    /// Time of the server, `[ms]`.
    pub(crate) server_ms: u64,
    pub(crate) level: Level,
    /// One line.
    pub(crate) text: String,
    /// Why, and what to change; several lines.
    pub(crate) detail: Option<String>,
}

#[cfg(test)]
mod tests {
    use rand::rngs::SmallRng;
    use rand::{Rng, SeedableRng};

    use super::*;

    const REQUESTS: [&str; 9] = [
        r#"{"type":"seen","server_ms":12}"#,
        r#"{"type":"take","name":"Ada"}"#,
        r#"{"type":"begin","motion":{"kind":"joint","joint":3,"up":true},"speed":0.05}"#,
        r#"{"type":"begin","motion":{"kind":"rotate","direction":[0,0,1],"axes":"tool"},"speed":0.05}"#,
        r#"{"type":"hold","seq":4}"#,
        r#"{"type":"stop"}"#,
        r#"{"type":"recover"}"#,
        r#"{"type":"disturb","disturbance":{"kind":"user_stop","pressed":true}}"#,
        r#"{"type":"begin","motion":{"kind":"ready"},"speed":0.25}"#,
    ];

    #[test]
    fn requests_are_read_as_documented() {
        for text in REQUESTS {
            serde_json::from_str::<Request>(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        }
        let read = serde_json::from_str::<Request>(REQUESTS[4]).expect("a request");
        assert_eq!(read, Request::Hold { seq: 4 });
    }

    #[test]
    fn what_is_missing_unknown_or_out_of_range_is_refused() {
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
        ] {
            assert!(serde_json::from_str::<Request>(text).is_err(), "{text}");
        }
    }

    /// Requests with bytes changed, cut and repeated: each is read or refused, and what is read
    /// passes the checks without a panic.
    #[test]
    fn any_bytes_are_read_or_refused() {
        let seed: u64 = rand::rng().random();
        println!("seed {seed}");
        let mut random = SmallRng::seed_from_u64(seed);
        let mut read = 0;
        for k in 0..100_000 {
            let mut bytes = REQUESTS[k % REQUESTS.len()].as_bytes().to_vec();
            for _ in 0..random.random_range(0..4) {
                let at = random.random_range(0..bytes.len());
                match random.random_range(0..3) {
                    0 => bytes[at] = random.random(),
                    1 => bytes.insert(at, bytes[at]),
                    _ => bytes.truncate(at.max(1)),
                }
            }
            match serde_json::from_slice::<Request>(&bytes) {
                Ok(Request::Begin { motion, .. }) => drop(motion.check()),
                Ok(Request::Disturb { disturbance }) => drop(disturbance.check()),
                Ok(_) => {}
                Err(_) => continue,
            }
            read += 1;
        }
        assert!(read > 10_000, "{read}");
    }
}
