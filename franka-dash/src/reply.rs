//! What viewers are told, as JSON. State frames are binary: [`frame`](crate::frame).

use franka_async::state::WrenchTare;
use serde::Serialize;

use crate::authority;
use crate::contact::Contact;
use crate::fingers::FingerState;
use crate::plan::Plan;
use crate::recording::Progress;
use crate::request::Tuning;
use crate::simulated::Setting;
use crate::statistics::Statistics;

/// To a viewer.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Reply {
    /// A request that had no effect, and why.
    Refused {
        why: String,
        /// As in `Status`, when the request was refused.
        begun: u64,
    },
    /// Who may command, and what is going on.
    Status {
        #[serde(flatten)]
        status: Status,
        /// Requests of this viewer to begin a hold that had been handled by then. A page tells by
        /// it whether a message is about its newest hold or about an earlier one.
        begun: u64,
    },
    /// A stop of this viewer has been received.
    Stopping {},
    /// Something that happened.
    Event(News),
    /// Events that this viewer was too slow for.
    Missed { events: u64 },
    /// How punctual control is.
    Statistics(Statistics),
    /// The fingers of the gripper.
    Gripper(FingerState),
    /// The recording that goes on.
    Recording { recording: Option<Progress> },
    /// What the motion of a question would do, or why it would be refused.
    Preview {
        /// Of the question.
        number: u32,
        way: Option<Plan>,
        refused: Option<String>,
    },
    /// What the motion of the hold that goes on does; nothing if none goes on, or it has no end.
    Heading { way: Option<Plan> },
    /// Where something touches the arm, as far as its torques tell; nothing if nothing seems to.
    Contact { contact: Option<Contact> },
    /// What is taken off the wrench of a frame; nothing without a tare.
    Tare { tare: Option<TareShown> },
}

/// What is taken off the wrench, and where it holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct TareShown {
    /// Force, then torque about the stiffness frame, in base axes, `[N, N m]`.
    wrench: [f64; 6],
    /// Standard deviation of each of its numbers.
    deviation: [f64; 6],
    /// Joint positions in which it was taken, `[rad]`.
    q: [f64; 7],
    /// It is taken to hold within so much of them, `[rad]` of any joint.
    near: f64,
}

impl From<WrenchTare> for TareShown {
    fn from(tare: WrenchTare) -> Self {
        Self {
            wrench: tare.wrench,
            deviation: tare.deviation,
            q: tare.q,
            near: WrenchTare::NEAR,
        }
    }
}

impl Reply {
    /// The answer to a question of this number.
    pub(crate) fn preview(number: u32, planned: Result<Plan, String>) -> Self {
        let (way, refused) = match planned {
            Ok(plan) => (Some(plan), None),
            Err(why) => (None, Some(why)),
        };
        Self::Preview {
            number,
            way,
            refused,
        }
    }

    /// What the motion of a hold does, without the number of the hold.
    pub(crate) fn heading(heading: Option<(u64, Plan)>) -> Self {
        let way = heading.map(|(_, plan)| plan);
        Self::Heading { way }
    }
}

/// What goes on, and what is set.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Status {
    #[serde(flatten)]
    pub(crate) authority: authority::Status,
    /// How stiff the arm is while it is held.
    pub(crate) tuning: Tuning,
    /// `None` for a robot that viewers cannot disturb.
    pub(crate) simulation: Option<Setting>,
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
