//! A model from the description that a robot serves: URDF.
//!
//! Robots that speak FCI version 10 give this text to a client that asks for it (`GetRobotModel`).
//! It holds what may differ from one arm to the next: masses, position limits, speeds, torques, and
//! the velocity envelope, which is an element of the vendor's own.
//!
//! # What is read, and what is not
//!
//! | of the text | becomes |
//! |---|---|
//! | `inertial` of the links | [`Model::links`]; everything fixed to a link is part of it, as for libfranka |
//! | `limit`, `position_based_velocity_limits` | position, velocity, torque and envelope of [`Model::joint_limits`] |
//! | `origin`, `axis` of the joints, `link8` | [`Model::lengths`]; checked against the [geometry](crate::geometry) |
//!
//! The geometry is that of the crate, with one of the sets of lengths that robots are
//! [known](crate::geometry::Lengths::KNOWN) to have: inverse kinematics and capsules are made for
//! it. A text with another one is refused rather than computed with half of it. Up to 1 µm and
//! 10 µrad, which is what rounded numbers may be off, the crate's numbers replace those of the
//! text.
//!
//! The text has no limits of acceleration, jerk and torque rate, and none for the end effector:
//! those of the FR3 are taken. Nor has it the positions to command
//! ([`lower`](crate::limits::JointLimits::lower), [`upper`](crate::limits::JointLimits::upper)).
//! They are as far inside the text's limits as the documented ones are inside the vendor's, in a
//! range that is wider as well as in a narrower one.
//!
//! # What is refused
//!
//! [`UrdfError`] has the list. The vendor's parsers let some of it pass: an inertia that cannot be
//! read makes a link without mass there, and the last of two joints with one name counts. Numbers
//! have to be numbers to their end. Inertias have to be positive; that the largest moment is at
//! most the sum of the others is not asked for, as the vendor's own descriptions of other arms
//! break it.
//!
//! # Example
//!
//! ```
//! use franka_model::urdf::UrdfError;
//! use franka_model::Model;
//!
//! let error = Model::from_urdf("<robot name=\"fr3\"/>").unwrap_err();
//! assert!(matches!(error, UrdfError::MissingJoints { .. }));
//! ```

mod body;
mod element;
mod error;
#[cfg(test)]
mod tests;
mod tree;

pub use error::UrdfError;

use roxmltree::{Document, ParsingOptions};
use std::borrow::ToOwned;
use std::string::{String, ToString};

use crate::limits::{BrakingEnvelope, JointLimits};
use crate::merge::Merge;
use crate::{JointVector, Model, RobotKind};
use element::Element;
use tree::Tree;

/// How far a frame may be from its place in the [geometry](crate::geometry), `[m]`.
pub const TRANSLATION_OFF: f64 = 1e-6;

/// How far a frame may be turned against the [geometry](crate::geometry), `[rad]`.
pub const ROTATION_OFF: f64 = 1e-5;

/// Elements and attributes' texts beyond this are refused: the vendor's description has a few
/// hundred.
const NODES_MAX: u32 = 100_000;

impl Model {
    /// A model from the URDF that a Franka Research 3 serves. Needs the feature `urdf`.
    ///
    /// The text of an arm with the vendor's numbers gives a model that equals
    /// [`Model::fr3`] to the last bit. See [`urdf`](crate::urdf) for what is read.
    ///
    /// # Errors
    /// [`UrdfError`].
    pub fn from_urdf(text: &str) -> Result<Self, UrdfError> {
        // The robot may send a byte order mark, and its client a terminator.
        let text = text.trim_start_matches('\u{feff}').trim_start();
        let text = text.trim_end_matches('\0');
        let options = ParsingOptions {
            nodes_limit: NODES_MAX,
            ..ParsingOptions::default()
        };
        let document =
            Document::parse_with_options(text, options).map_err(|error| UrdfError::Xml {
                reason: error.to_string(),
            })?;
        let robot = document.root_element();
        if !robot.has_tag_name("robot") {
            return Err(UrdfError::Root {
                got: robot.tag_name().name().to_owned(),
            });
        }
        let name = robot.attribute("name").unwrap_or_default();
        if name.starts_with(MOBILE) {
            return Err(UrdfError::MobileRobot {
                name: name.to_owned(),
            });
        }
        let tree = Tree::read(robot)?;
        let joints = joint_limits(&tree)?;
        let [base, links @ ..] = body::bodies(&tree)?;
        Ok(Self {
            // The only kind of arm that serves a description.
            kind: RobotKind::Fr3,
            base,
            links,
            merge: Merge::Rigid,
            joints,
            lengths: tree.lengths,
            origins: None,
        })
    }
}

/// What the names of the vendor's mobile robots begin with (libfranka 0.21).
const MOBILE: &str = "tmr";

fn joint_limits(tree: &Tree<'_, '_>) -> Result<JointLimits, UrdfError> {
    let mut limits = *JointLimits::of(RobotKind::Fr3);
    let nominal = limits;
    let mut envelope = BrakingEnvelope {
        deceleration: JointVector::zeros(),
        offset: JointVector::zeros(),
    };
    for (i, joint) in tree.joints.iter().enumerate() {
        // In the order in which the vendor's client looks.
        let braking = Element::child(joint.node, "position_based_velocity_limits", &joint.owner)?;
        let limit = Element::child(joint.node, "limit", &joint.owner)?;
        limits.velocity[i] = limit.number_where("velocity", POSITIVE, |x| x > 0.0)?;
        envelope.offset[i] =
            braking.number_where("velocity_offset", "a number not below 0", |x| x >= 0.0)?;
        envelope.deceleration[i] =
            braking.number_where("deceleration_limit", BRAKING, |x| x >= BRAKING_LEAST)?;
        let (upper, lower) = (limit.number("upper")?, limit.number("lower")?);
        if lower >= upper {
            return Err(UrdfError::LimitsCrossed {
                joint: String::from(joint.name),
                lower,
                upper,
            });
        }
        limits.torque[i] = limit.number_where("effort", POSITIVE, |x| x > 0.0)?;
        (limits.hard_lower[i], limits.hard_upper[i]) = (lower, upper);
        // In this order nominal limits keep every bit.
        limits.lower[i] = nominal.lower[i] + (lower - nominal.hard_lower[i]);
        limits.upper[i] = nominal.upper[i] + (upper - nominal.hard_upper[i]);
        // The envelope allows no speed within this distance from an end.
        let still = 0.5 * envelope.offset[i] * envelope.offset[i] / envelope.deceleration[i];
        let margins = (limits.lower[i] - lower) + (upper - limits.upper[i]);
        let least = ROOM_LEAST + margins.max(2.0 * still);
        if upper - lower < least {
            return Err(UrdfError::RangeTooNarrow {
                joint: String::from(joint.name),
                lower,
                upper,
                least,
            });
        }
    }
    limits.envelope = Some(envelope);
    Ok(limits)
}

const POSITIVE: &str = "a number above 0";

/// Least deceleration of an envelope, `[rad/s²]`. Controllers brake with half of what the vendor's
/// gentlest joint has (2.585), or more gently near the ends of a range, never with nothing.
const BRAKING_LEAST: f64 = 1.2;
const BRAKING: &str = "a number of at least 1.2";

/// Least range between the margins, `[rad]`. Controllers keep 0.05 rad from both ends of it.
const ROOM_LEAST: f64 = 0.2;
