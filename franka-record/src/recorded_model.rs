//! The model of a recorded robot: from the description that it served.

use core::fmt;
use std::collections::BTreeMap;

use franka_model::geometry::Lengths;
use franka_model::{Model, RobotKind};

/// The model of a recorded robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RecordedModel {
    /// Limits and inertias of the robot's description, with the lengths that the driver used.
    pub model: Model,
    /// Reason why constants replace the description of a Franka Research 3; `None` if they do not.
    /// A Franka Emika Robot describes nothing: its constants equal the values of the robot's
    /// library.
    pub fallback: Option<ModelFallback>,
}

/// Reason why constants replace the description of a robot. The limits are then the limits of
/// systems before 5.9.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ModelFallback {
    /// The file has no description, or it is damaged.
    Missing,
    /// The description is not one of this arm. Has the text of the error.
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
    /// Returns the model of a robot of this kind with the description `urdf`, if known, and with
    /// the lengths that the driver used, if known.
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

/// Returns the label of a robot in names of files: its name, or else the name of its kind of arm.
pub(crate) fn label(name: &str, kind: RobotKind) -> &str {
    match name {
        "" => arm(kind),
        name => name,
    }
}

/// Returns the name of a kind of arm in `franka_description`.
pub(crate) fn arm(kind: RobotKind) -> &'static str {
    match kind {
        RobotKind::Fer => "fer",
        _ => "fr3",
    }
}

/// Returns the name of the attachment with the description of a robot.
pub(crate) fn description(name: &str, kind: RobotKind) -> String {
    format!("{}.urdf", label(name, kind))
}

/// Writes the lengths to the metadata of a robot.
pub(crate) fn write_lengths(lengths: &Lengths, metadata: &mut BTreeMap<String, String>) {
    let Lengths { upper_arm, forearm } = lengths;
    metadata.insert(UPPER_ARM.to_owned(), upper_arm.to_string());
    metadata.insert(FOREARM.to_owned(), forearm.to_string());
}

/// Reads the lengths from the metadata of a robot; `None` for a recording of an earlier version.
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

/// Metadata of a robot: its lengths, `[m]`.
const UPPER_ARM: &str = "upper_arm";
const FOREARM: &str = "forearm";
