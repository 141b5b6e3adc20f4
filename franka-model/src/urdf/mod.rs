//! A model from the robot's own description (URDF).
//!
//! Robots with FCI version 10 send this text on request (`GetRobotModel`). The text contains the
//! values that can differ between arms: masses, position limits, speeds, torques, and the velocity
//! envelope, a vendor-specific element.
//!
//! # What is read, and what is not
//!
//! | part of the text | becomes |
//! |---|---|
//! | `inertial` of the links | [`Model::links`]; all links fixed to a link are part of it, as in libfranka |
//! | `limit`, `position_based_velocity_limits` | position, velocity, torque and envelope of [`Model::joint_limits`] |
//! | `origin`, `axis` of the joints, `link8` | [`Model::lengths`]; checked against the [geometry](crate::geometry) |
//!
//! The model uses the crate's own geometry with one of the [known](crate::geometry::Lengths::KNOWN)
//! sets of lengths, because inverse kinematics and capsules depend on this geometry. The parser
//! refuses a text with another geometry. Frames may deviate by rounding errors, 1 µm and 10 µrad;
//! the crate's numbers then replace the numbers of the text.
//!
//! The text has no limits of acceleration, jerk and torque rate, and no end-effector limits; the
//! model then uses the limits of the FR3. The text has no commanded position range either
//! ([`lower`](crate::limits::JointLimits::lower), [`upper`](crate::limits::JointLimits::upper)).
//! The model's range keeps the same distance from the limits in the text as the documented range
//! keeps from the vendor's limits.
//!
//! # What is refused
//!
//! [`UrdfError`] lists the errors. The vendor's parsers accept some of these texts: they treat an
//! unreadable inertia as a link without mass, and use the last of two joints with the same name.
//! This parser requires complete numbers and positive inertias. It does not check the triangle
//! inequality of the moments, because the vendor's own descriptions of other arms violate it.
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

/// Largest accepted distance of a frame from its position in the [geometry](crate::geometry),
/// `[m]`.
pub const TRANSLATION_OFF: f64 = 1e-6;

/// Largest accepted rotation of a frame from its orientation in the [geometry](crate::geometry),
/// `[rad]`.
pub const ROTATION_OFF: f64 = 1e-5;

/// Largest number of XML nodes that the parser accepts. The vendor's description has a few hundred.
const NODES_MAX: u32 = 100_000;

impl Model {
    /// Creates a model from the URDF of a Franka Research 3. Requires the feature `urdf`.
    ///
    /// If the text contains the vendor's numbers, the model equals [`Model::fr3`] to the last bit.
    /// See [`urdf`](crate::urdf) for the parts that are read.
    ///
    /// # Errors
    /// Returns [`UrdfError`] if the text is not a valid description of the arm.
    pub fn from_urdf(text: &str) -> Result<Self, UrdfError> {
        // The robot may add a byte order mark, and the client may add a terminator.
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
            // Only this kind of arm provides a description.
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

/// Prefix of the names of the vendor's mobile robots (libfranka 0.21).
const MOBILE: &str = "tmr";

fn joint_limits(tree: &Tree<'_, '_>) -> Result<JointLimits, UrdfError> {
    let mut limits = *JointLimits::of(RobotKind::Fr3);
    let nominal = limits;
    let mut envelope = BrakingEnvelope {
        deceleration: JointVector::zeros(),
        offset: JointVector::zeros(),
    };
    for (i, joint) in tree.joints.iter().enumerate() {
        // Checks both elements in the same order as the vendor's client.
        let braking = Element::child(joint.node, "position_based_velocity_limits", &joint.owner)?;
        let limit = Element::child(joint.node, "limit", &joint.owner)?;
        limits.velocity[i] = limit.number_where("velocity", POSITIVE, |x| x > 0.0)?;
        envelope.offset[i] =
            braking.number_where("velocity_offset", "a number of 0 or more", |x| x >= 0.0)?;
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
        // This order of operations preserves every bit of nominal limits.
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

/// Smallest deceleration of an envelope, `[rad/s²]`. The vendor's smallest value is 2.585.
/// Controllers brake with half of that value, or with less near the ends of a range.
const BRAKING_LEAST: f64 = 1.2;
const BRAKING: &str = "a number of at least 1.2";

/// Smallest range between the margins, `[rad]`. Controllers keep 0.05 rad from both ends.
const ROOM_LEAST: f64 = 0.2;
