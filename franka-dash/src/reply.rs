//! Messages to viewers, in JSON. State frames are binary (see [`frame`](crate::frame)).

use franka_async::state::WrenchTare;
use serde::Serialize;

use crate::contact::Contact;
use crate::fingers::FingerState;
use crate::plan::Plan;
use crate::recording::Progress;
use crate::request::Tuning;
use crate::simulated::Setting;
use crate::statistics::Statistics;
use crate::viewer_lease;

/// A message to a viewer.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Reply {
    /// A request had no effect. The message states the reason.
    Refused {
        why: String,
        /// Value of `begun` in `Status` at the time of the refusal.
        begun: u64,
    },
    /// The current commander and its hold.
    Status {
        #[serde(flatten)]
        status: Status,
        /// Number of this viewer's processed requests to begin a hold. From this number, the page
        /// recognises whether a message belongs to its newest hold.
        begun: u64,
    },
    /// The server has received this viewer's stop.
    Stopping {},
    /// An event.
    Event(News),
    /// Number of events that this viewer lost because it was too slow.
    Missed { events: u64 },
    /// The punctuality of the control thread.
    Statistics(Statistics),
    /// The fingers of the gripper.
    Gripper(FingerState),
    /// The current recording.
    Recording { recording: Option<Progress> },
    /// The preview that answers a question, or the reason for a refusal.
    Preview {
        /// Number of the question.
        number: u32,
        way: Option<Plan>,
        refused: Option<String>,
    },
    /// The plan of the active hold; `null` if no hold is active or its motion has no target.
    Heading { way: Option<Plan> },
    /// The estimated contact on the arm; `null` without a contact.
    Contact { contact: Option<Contact> },
    /// The tare that is applied to the wrench in frames; `null` without a tare.
    Tare { tare: Option<TareShown> },
}

/// The tare (the zero) of the wrench, and the range in which it is valid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct TareShown {
    /// Force and torque in base axes, the torque about the stiffness frame, `[N, N m]`.
    wrench: [f64; 6],
    /// Standard deviation of each of the six numbers.
    deviation: [f64; 6],
    /// Joint positions at the time of the tare, `[rad]`.
    q: [f64; 7],
    /// Largest distance of any joint from `q` at which the tare is valid, `[rad]`.
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

    /// Returns the message with the plan of a hold. The message does not contain the hold's number.
    pub(crate) fn heading(heading: Option<(u64, Plan)>) -> Self {
        let way = heading.map(|(_, plan)| plan);
        Self::Heading { way }
    }
}

/// The current commander, hold and settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Status {
    #[serde(flatten)]
    pub(crate) viewer_lease: viewer_lease::Status,
    /// The stiffness of the arm during a hold.
    pub(crate) tuning: Tuning,
    /// Settings of the simulation; `None` if viewers cannot disturb the robot.
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
