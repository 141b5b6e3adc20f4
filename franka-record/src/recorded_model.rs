//! The model of a recorded robot, computed from the description in the file.

use core::fmt;
use std::collections::BTreeMap;

use franka_model::geometry::Lengths;
use franka_model::{Model, RobotKind};

/// The model of a recorded robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RecordedModel {
    /// Model with the limits and inertias of the robot's description, and with the link lengths
    /// that the driver used.
    pub model: Model,
    /// Reason why constants replace the description of a Franka Research 3; `None` if the model
    /// uses the description. It is also `None` for a Franka Emika Robot, which serves no
    /// description. The constants of this robot equal the values of its library.
    pub fallback: Option<ModelFallback>,
}

/// Reason why constants replace the description of a robot. The limits of the model are then the
/// limits of robot systems before 5.9.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ModelFallback {
    /// The file contains no description, or the attached description is damaged.
    Missing,
    /// The attached description does not describe this arm. The field contains the text of the
    /// error.
    Refused(String),
}

impl fmt::Display for ModelFallback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing => f.write_str("the file has no description of the robot"),
            Self::Refused(error) => write!(f, "the description of the robot is refused: {error}"),
        }
    }
}

impl RecordedModel {
    /// Returns the model of a robot of this kind. Uses the description `urdf` and the `lengths` of
    /// the driver if they are known.
    pub(crate) fn of(kind: RobotKind, urdf: Option<&str>, lengths: Option<Lengths>) -> Self {
        let described = match (kind, urdf.map(Model::from_urdf)) {
            (RobotKind::Fer, _) => Ok(Model::fer().clone()),
            (_, Some(Ok(model))) => Ok(model),
            (_, Some(Err(error))) => Err(ModelFallback::Refused(error.to_string())),
            (_, None) => Err(ModelFallback::Missing),
        };
        let (model, fallback) = match described {
            Ok(model) => (model, None),
            Err(fallback) => (Model::of(kind).clone(), Some(fallback)),
        };
        let model = match lengths {
            Some(lengths) if lengths != *model.lengths() => model.with_lengths(lengths),
            _ => model,
        };
        Self { model, fallback }
    }
}

/// Returns the label of a robot for file names: the robot's name, or the name of its arm if the
/// robot has no name.
pub(crate) fn label(name: &str, kind: RobotKind) -> &str {
    match name {
        "" => arm(kind),
        name => name,
    }
}

/// Returns the name of the arm in `franka_description`.
pub(crate) fn arm(kind: RobotKind) -> &'static str {
    match kind {
        RobotKind::Fer => "fer",
        _ => "fr3",
    }
}

/// Returns the name of the attachment that contains the robot's description.
pub(crate) fn description(name: &str, kind: RobotKind) -> String {
    format!("{}.urdf", label(name, kind))
}

pub(crate) fn write_lengths(lengths: &Lengths, metadata: &mut BTreeMap<String, String>) {
    let Lengths { upper_arm, forearm } = lengths;
    metadata.insert(UPPER_ARM.to_owned(), upper_arm.to_string());
    metadata.insert(FOREARM.to_owned(), forearm.to_string());
}

/// Reads the link lengths from the metadata of a robot; `None` if an earlier version made the
/// recording.
pub(crate) fn read_lengths(metadata: &BTreeMap<String, String>) -> Option<Lengths> {
    let length = |name| {
        let metres: f64 = metadata.get(name)?.parse().ok()?;
        (metres.is_finite() && metres > 0.0).then_some(metres)
    };
    Some(Lengths {
        upper_arm: length(UPPER_ARM)?,
        forearm: length(FOREARM)?,
    })
}

/// Metadata key of a link length, `[m]`.
const UPPER_ARM: &str = "upper_arm";
const FOREARM: &str = "forearm";
