//! Messages to viewers, as JSON. State frames are binary: [`frame`](crate::frame).

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

/// A message to a viewer.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Reply {
    /// A request had no effect. The message contains the reason.
    Refused {
        why: String,
        /// The same number as in `Status`, at the time of the refusal.
        begun: u64,
    },
    /// The current commander and its hold.
    Status {
        #[serde(flatten)]
        status: Status,
        /// Number of this viewer's requests to begin a hold that have been processed. With this
        /// number, a page decides whether a message belongs to its newest hold.
        begun: u64,
    },
    /// The server has received this viewer's stop.
    Stopping {},
    /// An event.
    Event(News),
    /// Number of events that this viewer missed because it was too slow.
    Missed { events: u64 },
    /// The punctuality of control.
    Statistics(Statistics),
    /// The fingers of the gripper.
    Gripper(FingerState),
    /// The current recording.
    Recording { recording: Option<Progress> },
    /// The preview for a question, or the reason why it is refused.
    Preview {
        /// Number of the question.
        number: u32,
        way: Option<Plan>,
        refused: Option<String>,
    },
    /// The plan of the active hold; `null` without a hold, or if its motion has no end.
    Heading { way: Option<Plan> },
    /// The estimated contact on the arm; `null` without a contact.
    Contact { contact: Option<Contact> },
    /// The tare of the wrench in frames; `null` without a tare.
    Tare { tare: Option<TareShown> },
}

/// The tare (the zero) of the wrench, and the range in which it is valid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct TareShown {
    /// Force, then torque about the stiffness frame, in base axes, `[N, N m]`.
    wrench: [f64; 6],
    /// Standard deviation of each of the six numbers.
    deviation: [f64; 6],
    /// Joint positions at the time of the tare, `[rad]`.
    q: [f64; 7],
    /// Largest distance of any joint from these positions at which the tare is valid, `[rad]`.
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
    /// Returns the answer to the question with this number.
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

    /// Returns the message about the plan of a hold, without the number of the hold.
    pub(crate) fn heading(heading: Option<(u64, Plan)>) -> Self {
        let way = heading.map(|(_, plan)| plan);
        Self::Heading { way }
    }
}

/// The current commander, hold and settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Status {
    #[serde(flatten)]
    pub(crate) authority: authority::Status,
    /// The stiffness of the arm during a hold.
    pub(crate) tuning: Tuning,
    /// Settings of the simulation; `None` for a robot that viewers cannot disturb.
    pub(crate) simulation: Option<Setting>,
}

/// The severity of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Level {
    Info,
    Warning,
    Error,
}

/// An event.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct News {
    /// Time of the server, `[ms]`.
    pub(crate) server_ms: u64,
    pub(crate) level: Level,
    /// Text of one line.
    pub(crate) text: String,
    /// Reason and recommended change, in several lines.
    pub(crate) detail: Option<String>,
}
