//! Where something touched the arm as the motion ended.

use franka_model::collision::{Body, Shape};
use franka_model::contact::{Contact, TorqueError, Unknown, locate};
use franka_model::{JointVector, Model};

use super::Trace;

/// Where and when something touched the arm, or why that is not known.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Place {
    /// The cycle whose torques tell: the one with the strongest of the last 100 ms.
    pub time: u64,
    /// Joint positions then, `[rad]`.
    pub q: [f64; 7],
    /// External torques then, less the tare, on the arm, `[N·m]`.
    pub torque: [f64; 7],
    /// Over how long the tare was learned, `[s]`. With little, what the torques read without any
    /// contact is in the estimate.
    pub tared: f64,
    /// True if the flange was taken to carry a Hand.
    pub has_hand: bool,
    /// Whether the robot itself noticed a contact or collision in the last 100 ms, or since the
    /// end. Without that and without a stop, the estimate is of an untouched arm.
    pub noticed: bool,
    /// The contact, as far as the torques tell.
    pub contact: Option<Placed>,
    /// Why the body is not known for sure, or nothing is; `None` if it is known.
    pub unknown: Option<String>,
}

/// A contact; see [`franka_model::contact`]. In the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Placed {
    /// The link, or the tool.
    pub body: Body,
    /// `[m]`
    pub point: [f64; 3],
    /// On the arm, `[N]`.
    pub force: [f64; 3],
    /// Of the places that explain the torques as well, `[m]`.
    pub spread: f64,
    /// Torques that are not explained, `[N·m]`.
    pub residual: [f64; 7],
    /// That it is this body, 0 to 1.
    pub probability: f64,
    /// The next likely body, and its probability.
    pub next: Option<(Body, f64)>,
}

impl From<Contact> for Placed {
    fn from(contact: Contact) -> Self {
        Self {
            body: contact.body,
            point: contact.point.into(),
            force: contact.force.into(),
            spread: contact.spread,
            residual: contact.residual.into(),
            probability: contact.probability,
            next: contact.next,
        }
    }
}

impl Placed {
    /// The size of the force, `[N]`.
    pub fn size(&self) -> f64 {
        nalgebra::Vector3::from(self.force).norm()
    }
}

/// The arm as the estimate takes it to be.
pub(super) fn shape(model: &Model, has_hand: bool) -> Shape<'static> {
    let shape = Shape::covering(model.kind()).with_lengths(*model.lengths());
    if has_hand { shape.with_hand() } else { shape }
}

/// The contact at the end of `traces`, before which the robot last noticed one at `noticed`.
pub(super) fn of(
    model: &Model,
    has_hand: bool,
    traces: &[Trace],
    tared: f64,
    noticed: Option<u64>,
) -> Option<Place> {
    let end = traces.last()?.time;
    let near = traces.iter().filter(|trace| end - trace.time < NEAR_END);
    let strength = |trace: &&Trace| -> f64 {
        let errors = TorqueError::IN_MOTION.floor;
        (0..7)
            .map(|i| (trace.external[i] / errors[i]).powi(2))
            .sum()
    };
    let at = near.max_by(|a, b| strength(a).total_cmp(&strength(b)))?;
    let error = if at.fastest > STILL {
        TorqueError::IN_MOTION
    } else {
        TorqueError::AT_REST
    };
    let torque = JointVector::from(at.external);
    let result = locate(&shape(model, has_hand).at(&at.q.into()), &torque, &error);
    let (contact, unknown) = match result {
        Ok(contact) => (Some(contact.into()), None),
        Err(unknown) => {
            let (contact, text) = said(unknown);
            (contact, Some(text))
        }
    };
    Some(Place {
        time: at.time,
        q: at.q,
        torque: at.external,
        tared,
        has_hand,
        noticed: noticed.is_some_and(|time| end.saturating_sub(time) < NEAR_END),
        contact,
        unknown,
    })
}

/// What is known all the same, and why no more.
fn said(unknown: Unknown) -> (Option<Placed>, String) {
    match unknown {
        Unknown::Weak { .. } => (
            None,
            "no external torque beyond what an arm reads that nothing touches".to_owned(),
        ),
        Unknown::Base { body, .. } => (
            None,
            format!(
                "something touches {} or a link beside it: one or two joints show it, which tells \
                 neither place nor force",
                name(body)
            ),
        ),
        Unknown::Tie { likeliest } => {
            let next = likeliest.next.map_or(String::new(), |(body, _)| name(body));
            let text = format!(
                "{} and {next} explain the torques about as well",
                name(likeliest.body)
            );
            (Some(likeliest.into()), text)
        }
        Unknown::Unexplained { .. } => (
            None,
            "no force at one point explains the torques: several contacts, a grip that turns, or \
             the arm's own acceleration"
                .to_owned(),
        ),
        Unknown::NotFinite => (None, "the external torques are not finite".to_owned()),
        _ => (None, "not known".to_owned()),
    }
}

/// `link 5`, or `the tool`.
pub(super) fn name(body: Body) -> String {
    match body {
        Body::Link(link) => format!("link {link}"),
        Body::Tool => "the tool".to_owned(),
    }
}

/// How long before the end the contact is looked for, `[ms]`.
const NEAR_END: u64 = 100;

/// Joint velocity above which friction is that of sliding, `[rad/s]`.
const STILL: f64 = 0.02;
