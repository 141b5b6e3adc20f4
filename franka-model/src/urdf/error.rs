//! What can be wrong with a description.

use std::string::String;
use std::vec::Vec;

/// Why a text is not accepted as a description of the arm. Each variant holds what was found, its
/// text says what was expected.
///
/// Where libfranka has a text for the case (its velocity-limit parser, 0.21), the text begins with
/// it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// It is not XML.
    #[error("Failed to parse URDF: {reason}; expected an XML document")]
    Xml {
        /// What the parser says, and where.
        reason: String,
    },
    /// It is another kind of document.
    #[error("Failed to parse URDF: no <robot> element exists; the root element is <{got}>")]
    Root {
        /// Name of the root element.
        got: String,
    },
    /// It describes a mobile robot, by its name.
    #[error(
        "the URDF describes the mobile robot '{name}', expected an arm; \
         libfranka: loadModel() is not available for mobile robots. \
         Use franka::MobileModel with the URDF from getRobotModel() instead."
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
        /// Which, of `joint1` to `joint7`.
        missing: Vec<&'static str>,
        /// The names of all joints that there are.
        got: Vec<String>,
    },
    /// A joint of the arm is not a hinge with limits.
    #[error("joint {joint} is of type '{got}', expected 'revolute'")]
    JointType {
        /// Its name.
        joint: String,
        /// Its type.
        got: String,
    },
    /// There is a movable joint besides the seven of the arm, such as that of a finger.
    #[error(
        "joint {joint} of type '{got}' is one too many, expected seven movable joints, joint1 to joint7"
    )]
    ExtraJoint {
        /// Its name.
        joint: String,
        /// Its type.
        got: String,
    },
    /// An element is missing.
    #[error("Missing <{element}> element for {owner}")]
    MissingElement {
        /// Its name.
        element: &'static str,
        /// Which joint or link lacks it, such as `joint: joint3`.
        owner: String,
    },
    /// An attribute is missing.
    #[error("Missing '{attribute}' attribute in <{element}> for {owner}")]
    MissingAttribute {
        /// Its name.
        attribute: &'static str,
        /// The element that should have it.
        element: &'static str,
        /// Where the element is.
        owner: String,
    },
    /// Two joints or two links have one name.
    #[error("two elements <{element}> have the name '{name}', expected one")]
    Duplicate {
        /// `joint` or `link`.
        element: &'static str,
        /// The name.
        name: String,
    },
    /// A value is not what it should be a list of.
    #[error("'{attribute}' in <{element}> for {owner} is '{got}', expected {expected}")]
    Value {
        /// Name of the attribute.
        attribute: &'static str,
        /// The element that has it.
        element: &'static str,
        /// Where the element is.
        owner: String,
        /// The value.
        got: String,
        /// What it should be.
        expected: &'static str,
    },
    /// The lower position limit is not below the upper one.
    #[error("the limits of joint {joint} are {lower} to {upper} rad, expected the lower one first")]
    LimitsCrossed {
        /// Its name.
        joint: String,
        /// `lower`, `[rad]`.
        lower: f64,
        /// `upper`, `[rad]`.
        upper: f64,
    },
    /// The margins at both ends of a joint's range leave no room to move.
    #[error(
        "the limits of joint {joint} are {lower} to {upper} rad, a range of {:.4} rad; \
         expected {least:.4} rad or more, since margins are kept at both ends", .upper - .lower
    )]
    RangeTooNarrow {
        /// Its name.
        joint: String,
        /// `lower`, `[rad]`.
        lower: f64,
        /// `upper`, `[rad]`.
        upper: f64,
        /// The least range that is accepted, `[rad]`.
        least: f64,
    },
    /// No body has such an inertia.
    #[error(
        "the inertia of link {link} has principal moments of {} {} {} kg m^2, expected {expected}",
        .moments[0], .moments[1], .moments[2]
    )]
    Inertia {
        /// Its name.
        link: String,
        /// In ascending order, `[kg·m²]`.
        moments: [f64; 3],
        /// What they should be.
        expected: &'static str,
    },
    /// A joint names a link that is not there.
    #[error("joint {joint} has the {role} '{got}', expected the name of a <link>")]
    UnknownLink {
        /// Name of the joint.
        joint: String,
        /// `parent` or `child`.
        role: &'static str,
        /// The name given.
        got: String,
    },
    /// A link hangs on two joints.
    #[error("link {link} is the child of the joints {first} and {second}, expected one of them")]
    TwoParents {
        /// Name of the link.
        link: String,
        /// The joint that comes first in the text.
        first: String,
        /// The other.
        second: String,
    },
    /// There is not one link that carries all others.
    #[error("the links without a joint above are: {}; expected one", .got.join(" "))]
    Roots {
        /// Their names: none, or several.
        got: Vec<String>,
    },
    /// Joints run in a circle.
    #[error("link {link} does not hang on {root}, expected every link to")]
    Circle {
        /// Name of a link in the circle, or behind it.
        link: String,
        /// Name of the root.
        root: String,
    },
    /// The joints do not follow one another.
    #[error(
        "joint {joint} has the parent {got}, which {} moves, expected a link that {} moves",
        mover(*.moved_by),
        mover(*.expected)
    )]
    Order {
        /// Name of the joint.
        joint: String,
        /// Name of its parent.
        got: String,
        /// Number of the joint that moves the parent; 0 is the base.
        moved_by: usize,
        /// Number of the joint that should.
        expected: usize,
    },
    /// A joint is not where the arm has it.
    #[error("the frame of {owner} is {:?} m with rpy {:?} rad off its place, expected less than {} and {}",
        .translation, .rotation, super::TRANSLATION_OFF, super::ROTATION_OFF)]
    Origin {
        /// Which joint, or the flange.
        owner: String,
        /// From where it should be to where it is, `[m]`.
        translation: [f64; 3],
        /// Likewise, as roll, pitch and yaw, `[rad]`.
        rotation: [f64; 3],
    },
    /// A joint does not turn about z.
    #[error("joint {joint} has the axis {got:?}, expected [0, 0, 1]")]
    Axis {
        /// Its name.
        joint: String,
        /// Its axis.
        got: [f64; 3],
    },
    /// There is no flange.
    #[error("there is no link 'link8', expected one fixed to link 7; the links are: {}", .got.join(" "))]
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
