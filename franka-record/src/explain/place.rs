//! The contact at the end of the motion.

use franka_model::collision::{Body, Shape};
use franka_model::contact::{Contact, TorqueError, Unknown, locate};
use franka_model::{JointVector, Model};

use super::Trace;

/// Place and time of a contact. If the place is unknown, the reason.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Place {
    /// Time of the cycle whose torques were evaluated. It is the cycle with the largest torques in
    /// the last 100 ms.
    pub time: u64,
    /// Joint positions at that time, `[rad]`.
    pub q: [f64; 7],
    /// External torques on the arm at that time, minus their baseline without contact, `[N·m]`.
    pub torque: [f64; 7],
    /// Time over which the baseline was learned, `[s]`. If this time is short, the estimate
    /// includes torques that the sensors report without a contact.
    pub tared: f64,
    /// True if the estimate assumes a Hand on the flange.
    pub has_hand: bool,
    /// True if the robot itself detected a contact or a collision in the last 100 ms or after the
    /// end. If it did not, and no motion was stopped, the arm was probably not touched, and the
    /// estimate is meaningless.
    pub noticed: bool,
    /// The contact; `None` if the torques do not determine it.
    pub contact: Option<Placed>,
    /// Reason why the touched body is uncertain or unknown; `None` if it is known.
    pub unknown: Option<String>,
}

/// A contact in the base frame (see [`franka_model::contact`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Placed {
    /// The touched link, or the tool.
    pub body: Body,
    /// Position of the contact, `[m]`.
    pub point: [f64; 3],
    /// Force on the arm in base axes, `[N]`.
    pub force: [f64; 3],
    /// Size of the region whose points explain the torques equally well, `[m]`.
    pub spread: f64,
    /// Torques that the contact does not explain, `[N·m]`.
    pub residual: [f64; 7],
    /// Probability that the contact is on this body, in `[0, 1]`.
    pub probability: f64,
    /// The second most probable body and its probability.
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
    /// Returns the magnitude of the force, `[N]`.
    pub fn size(&self) -> f64 {
        nalgebra::Vector3::from(self.force).norm()
    }
}

/// Returns the shape of the arm that the estimate uses.
pub(super) fn shape(model: &Model, has_hand: bool) -> Shape<'static> {
    let shape = Shape::covering(model.kind()).with_lengths(*model.lengths());
    if has_hand { shape.with_hand() } else { shape }
}

/// Returns the contact at the end of `traces`. `noticed` is the time at which the robot last
/// detected a contact.
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

/// Returns the partial result and the reason why the result is partial.
fn said(unknown: Unknown) -> (Option<Placed>, String) {
    match unknown {
        Unknown::Weak { .. } => (
            None,
            "the external torques are no larger than on an untouched arm".to_owned(),
        ),
        Unknown::Base { body, .. } => (
            None,
            format!(
                "something touches {} or a neighbouring link: only one or two joints show it, so \
                 place and force are unknown",
                name(body)
            ),
        ),
        Unknown::Tie { likeliest } => {
            let next = likeliest.next.map_or(String::new(), |(body, _)| name(body));
            let text = format!(
                "contacts at {} and at {next} explain the torques about equally well",
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

/// Returns the name of a body, such as `link 5` or `the tool`.
pub(super) fn name(body: Body) -> String {
    match body {
        Body::Link(link) => format!("link {link}"),
        Body::Tool => "the tool".to_owned(),
    }
}

/// Period before the end in which the contact is searched, `[ms]`.
const NEAR_END: u64 = 100;

/// Joint velocity above which the friction is sliding friction, `[rad/s]`.
const STILL: f64 = 0.02;
