//! Errors of a robot description.

use std::string::String;
use std::vec::Vec;

/// Reason why a text is not a valid description of the arm. Each variant contains the value that
/// was found. The variant's text also states the expected value.
///
/// If libfranka 0.21 has a text for the same error in its velocity-limit parser, the variant's text
/// begins with that text.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// The text is not XML.
    #[error("Failed to parse URDF: {reason}; expected an XML document")]
    Xml {
        /// Message and position from the parser.
        reason: String,
    },
    /// The root element of the document is not `robot`.
    #[error("Failed to parse URDF: no <robot> element exists; the root element is <{got}>")]
    Root {
        /// Name of the root element.
        got: String,
    },
    /// The name indicates a mobile robot.
    #[error(
        "the URDF describes the mobile robot '{name}', expected an arm \
         (libfranka: loadModel() is not available for mobile robots. \
         Use franka::MobileModel with the URDF from getRobotModel() instead.)"
    )]
    MobileRobot {
        /// Name of the robot.
        name: String,
    },
    /// Joints are missing.
    #[error(
        "Missing required joints: {}; got {}",
        .missing.join(" "),
        if .got.is_empty() { String::from("none") } else { .got.join(" ") }
    )]
    MissingJoints {
        /// The missing names among `joint1` to `joint7`.
        missing: Vec<&'static str>,
        /// The names of all joints in the text.
        got: Vec<String>,
    },
    /// A joint of the arm is not a hinge with limits.
    #[error("joint {joint} is of type '{got}', expected 'revolute'")]
    JointType {
        /// Name of the joint.
        joint: String,
        /// Type of the joint.
        got: String,
    },
    /// The text has another movable joint besides the arm's seven joints, such as the joint of a
    /// finger.
    #[error(
        "got the additional joint {joint} of type '{got}', expected seven movable joints, joint1 \
         to joint7"
    )]
    ExtraJoint {
        /// Name of the joint.
        joint: String,
        /// Type of the joint.
        got: String,
    },
    /// An element is missing.
    #[error("Missing <{element}> element for {owner}")]
    MissingElement {
        /// Name of the element.
        element: &'static str,
        /// The joint or link without this element, such as `joint: joint3`.
        owner: String,
    },
    /// An attribute is missing.
    #[error("Missing '{attribute}' attribute in <{element}> for {owner}")]
    MissingAttribute {
        /// Name of the attribute.
        attribute: &'static str,
        /// The element without this attribute.
        element: &'static str,
        /// Owner of the element.
        owner: String,
    },
    /// Two joints or two links have the same name.
    #[error("two elements <{element}> have the name '{name}', expected one")]
    Duplicate {
        /// Kind of the duplicate elements: `joint` or `link`.
        element: &'static str,
        /// The duplicate name.
        name: String,
    },
    /// A value is invalid.
    #[error("'{attribute}' in <{element}> for {owner} is '{got}', expected {expected}")]
    Value {
        /// Name of the attribute.
        attribute: &'static str,
        /// The element with this attribute.
        element: &'static str,
        /// Owner of the element.
        owner: String,
        /// The value.
        got: String,
        /// Description of the expected value.
        expected: &'static str,
    },
    /// The lower position limit is not below the upper limit.
    #[error(
        "joint {joint} has the lower limit {lower} rad and the upper limit {upper} rad, \
        expected the lower limit below the upper limit"
    )]
    LimitsCrossed {
        /// Name of the joint.
        joint: String,
        /// Lower limit in the text, `[rad]`.
        lower: f64,
        /// Upper limit in the text, `[rad]`.
        upper: f64,
    },
    /// The margins at both ends of a joint's range leave no room to move.
    #[error(
        "the range of joint {joint}, from {lower} to {upper} rad, is {:.4} rad, expected {least:.4} \
         rad or more: the driver keeps a margin at both ends", .upper - .lower
    )]
    RangeTooNarrow {
        /// Name of the joint.
        joint: String,
        /// Lower limit in the text, `[rad]`.
        lower: f64,
        /// Upper limit in the text, `[rad]`.
        upper: f64,
        /// Smallest accepted range, `[rad]`.
        least: f64,
    },
    /// The inertia is not physical.
    #[error(
        "the inertia of link {link} has principal moments of {} {} {} kg m^2, expected {expected}",
        .moments[0], .moments[1], .moments[2]
    )]
    Inertia {
        /// Name of the link.
        link: String,
        /// Principal moments in ascending order, `[kg·m²]`.
        moments: [f64; 3],
        /// Description of the expected moments.
        expected: &'static str,
    },
    /// A joint names a link that does not exist.
    #[error("joint {joint} has the {role} '{got}', expected the name of a <link>")]
    UnknownLink {
        /// Name of the joint.
        joint: String,
        /// Role of the link in this joint: `parent` or `child`.
        role: &'static str,
        /// Name of the link.
        got: String,
    },
    /// A link is the child of two joints.
    #[error("link {link} is the child of two joints, {first} and {second}, expected one")]
    TwoParents {
        /// Name of the link.
        link: String,
        /// Name of the joint that comes first in the text.
        first: String,
        /// Name of the other joint.
        second: String,
    },
    /// The text does not have exactly one root link.
    #[error("got several links without a parent joint ({}), expected exactly one", .got.join(" "))]
    Roots {
        /// Names of the root links: none, or several.
        got: Vec<String>,
    },
    /// The joints form a loop.
    #[error(
        "no chain of joints connects link {link} to the root {root}, expected one for every \
        link"
    )]
    Circle {
        /// Name of a link in the loop, or of a link after the loop.
        link: String,
        /// Name of the root.
        root: String,
    },
    /// A joint is not at its place in the arm's sequence of joints.
    #[error(
        "joint {joint} has the parent {got}, which {} moves, expected a link that {} moves",
        mover(*.moved_by),
        mover(*.expected)
    )]
    Order {
        /// Name of the joint.
        joint: String,
        /// Name of the joint's parent link.
        got: String,
        /// Number of the joint that moves the parent; 0 is the base.
        moved_by: usize,
        /// Expected number of the joint.
        expected: usize,
    },
    /// A joint frame is not in its expected place.
    #[error("the frame of {owner} is off by {:?} m and {:?} rad (roll, pitch, yaw), expected less \
        than {} m and {} rad",
        .translation, .rotation, super::TRANSLATION_OFF, super::ROTATION_OFF)]
    Origin {
        /// Name of the joint, or the flange.
        owner: String,
        /// Vector from the expected to the actual place, `[m]`.
        translation: [f64; 3],
        /// Rotation from the expected to the actual orientation, as roll, pitch and yaw, `[rad]`.
        rotation: [f64; 3],
    },
    /// A joint does not turn about z.
    #[error("joint {joint} has the axis {got:?}, expected [0, 0, 1]")]
    Axis {
        /// Name of the joint.
        joint: String,
        /// Axis of the joint.
        got: [f64; 3],
    },
    /// The text has no flange.
    #[error("got no link 'link8', expected one fixed to link 7; the links are: {}", .got.join(" "))]
    NoFlange {
        /// Names of the links.
        got: Vec<String>,
    },
}

fn mover(joint: usize) -> String {
    match joint {
        0 => String::from("nothing"),
        joint => std::format!("joint {joint}"),
    }
}
