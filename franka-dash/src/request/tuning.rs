//! The stiffness of the arm while a button is held.

use serde::{Deserialize, Serialize};

use super::within;

/// The stiffness of the arm while a button is held: the force limit, and factors on the driver's
/// gains for this kind of motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Tuning {
    /// Factor on the stiffness at the end effector. The damping is scaled by the square root of
    /// this factor.
    pub(crate) end_effector: f64,
    /// Factor on the stiffness at the joints. The damping is scaled by the square root of this
    /// factor.
    pub(crate) joints: f64,
    /// Additional factor on all damping.
    pub(crate) damping: f64,
    /// Largest force of springs and dampers, `[N]`.
    pub(crate) force_cap: f64,
    /// True if the driver compensates friction and undeclared loads.
    pub(crate) compensation: bool,
}

impl Default for Tuning {
    /// Returns the setting that leaves the driver's gains unchanged.
    fn default() -> Self {
        Self {
            end_effector: 1.0,
            joints: 1.0,
            damping: 1.0,
            force_cap: 30.0,
            compensation: true,
        }
    }
}

impl Tuning {
    /// Returns the page's stiffness settings and their names. Stiffer settings were not stable on
    /// all simulated arms. See the table in the book's chapter on arms that stick.
    pub(crate) fn presets() -> [(&'static str, Self); 4] {
        let default = Self::default();
        let soft = Self {
            end_effector: 0.25,
            joints: 0.25,
            force_cap: 15.0,
            ..default
        };
        let springs = Self {
            compensation: false,
            ..soft
        };
        let stiff = Self {
            end_effector: 2.0,
            joints: 1.5,
            ..default
        };
        [
            ("springs alone", springs),
            ("soft", soft),
            ("default", default),
            ("stiff", stiff),
        ]
    }

    pub(super) fn check(&self) -> Result<(), String> {
        let end_effector = self.end_effector;
        within(
            "the factor of the end effector",
            "",
            end_effector,
            0.1..=4.0,
        )?;
        within("the factor of the joints", "", self.joints, 0.1..=2.0)?;
        within("the factor of the damping", "", self.damping, 0.5..=1.3)?;
        within("the force cap", " N", self.force_cap, 5.0..=60.0)
    }
}
