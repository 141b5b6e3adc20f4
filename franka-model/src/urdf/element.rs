//! Elements of the text, and the numbers in their attributes.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use roxmltree::Node;
use std::borrow::ToOwned;
use std::string::String;

use super::UrdfError;

/// An XML element, and the joint or link that contains it. Error messages name both.
#[derive(Clone, Copy)]
pub(super) struct Element<'a, 'n> {
    node: Node<'a, 'n>,
    name: &'static str,
    owner: &'a str,
}

impl<'a, 'n> Element<'a, 'n> {
    /// Returns the direct child named `name` of the joint or link `owner`.
    pub(super) fn child(
        parent: Node<'a, 'n>,
        name: &'static str,
        owner: &'a str,
    ) -> Result<Self, UrdfError> {
        Self::find(parent, name, owner).ok_or_else(|| UrdfError::MissingElement {
            element: name,
            owner: owner.to_owned(),
        })
    }

    /// Returns the direct child named `name`, or `None` if the child does not exist.
    pub(super) fn find(parent: Node<'a, 'n>, name: &'static str, owner: &'a str) -> Option<Self> {
        let node = parent.children().find(|node| node.has_tag_name(name))?;
        Some(Self { node, name, owner })
    }

    /// Returns the direct child named `name` of this element.
    pub(super) fn inner(&self, name: &'static str) -> Result<Self, UrdfError> {
        Self::child(self.node, name, self.owner)
    }

    pub(super) fn node(&self) -> Node<'a, 'n> {
        self.node
    }

    pub(super) fn text(&self, attribute: &'static str) -> Result<&'a str, UrdfError> {
        self.node
            .attribute(attribute)
            .ok_or_else(|| UrdfError::MissingAttribute {
                attribute,
                element: self.name,
                owner: self.owner.to_owned(),
            })
    }

    /// Returns a [plausible](plausible) number.
    pub(super) fn number(&self, attribute: &'static str) -> Result<f64, UrdfError> {
        let text = self.text(attribute)?;
        plausible(text.trim()).ok_or_else(|| self.unexpected(attribute, text, ONE_NUMBER))
    }

    /// Returns a number that meets a condition. `expected` describes the condition.
    pub(super) fn number_where(
        &self,
        attribute: &'static str,
        expected: &'static str,
        condition: impl Fn(f64) -> bool,
    ) -> Result<f64, UrdfError> {
        let number = self.number(attribute)?;
        if condition(number) {
            Ok(number)
        } else {
            Err(self.unexpected(attribute, self.text(attribute)?, expected))
        }
    }

    pub(super) fn vector(&self, attribute: &'static str) -> Result<[f64; 3], UrdfError> {
        let text = self.text(attribute)?;
        let mut numbers = text.split_whitespace().map(plausible);
        match std::array::from_fn(|_| numbers.next().flatten()) {
            [Some(x), Some(y), Some(z)] if numbers.next().is_none() => Ok([x, y, z]),
            _ => Err(self.unexpected(attribute, text, THREE_NUMBERS)),
        }
    }

    fn unexpected(&self, attribute: &'static str, got: &str, expected: &'static str) -> UrdfError {
        UrdfError::Value {
            attribute,
            element: self.name,
            owner: self.owner.to_owned(),
            got: got.to_owned(),
            expected,
        }
    }
}

const ONE_NUMBER: &str = "a number of at most 1e6 in size";
const THREE_NUMBERS: &str = "three numbers of at most 1e6 in size";

/// Returns a number whose absolute value is at most 1e6. A robot in SI units has no larger values,
/// and products of such numbers stay finite.
fn plausible(text: &str) -> Option<f64> {
    let number: f64 = text.parse().ok()?;
    // The comparison is false for NaN.
    (number.abs() <= 1e6).then_some(number)
}

/// Returns the pose in the direct child `origin`: a translation `xyz`, and `rpy` about the fixed
/// axes x, y and z in this order. Missing attributes count as zero.
pub(super) fn origin(parent: Node<'_, '_>, owner: &str) -> Result<Isometry3<f64>, UrdfError> {
    let Some(element) = Element::find(parent, "origin", owner) else {
        return Ok(Isometry3::identity());
    };
    let vector = |attribute| match element.node.has_attribute(attribute) {
        true => element.vector(attribute),
        false => Ok([0.0; 3]),
    };
    let ([x, y, z], [roll, pitch, yaw]) = (vector("xyz")?, vector("rpy")?);
    Ok(Isometry3::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    ))
}

pub(super) fn name<'a>(node: Node<'a, '_>, element: &'static str) -> Result<&'a str, UrdfError> {
    node.attribute("name")
        .ok_or_else(|| UrdfError::MissingAttribute {
            attribute: "name",
            element,
            owner: String::from("the robot"),
        })
}
