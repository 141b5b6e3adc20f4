//! Actions of a Franka Hand's fingers.

use serde::Deserialize;

use super::within;

/// An action of a Franka Hand's fingers.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum GripperAction {
    /// Home the fingers, which measures the largest opening.
    Home {},
    /// Move to a width, `[m]`, at a speed, `[m/s]`.
    Move { width: f64, speed: f64 },
    /// Close at a speed, `[m/s]`, on an object of a width, `[m]`, and hold the object with a force,
    /// `[N]`. The object's width may differ by `tolerance`.
    Grasp {
        width: f64,
        tolerance: f64,
        speed: f64,
        force: f64,
    },
    /// Stop, and release the object.
    Stop {},
}

impl GripperAction {
    pub(super) fn check(&self) -> Result<(), String> {
        let width = |width: f64| within("the width", " m", width, 0.0..=0.2);
        let speed = |speed: f64| within("the speed of the fingers", " m/s", speed, 0.001..=0.2);
        match *self {
            Self::Home {} | Self::Stop {} => Ok(()),
            Self::Move { width: w, speed: v } => width(w).and(speed(v)),
            Self::Grasp {
                width: w,
                tolerance,
                speed: v,
                force,
            } => {
                width(w).and(speed(v))?;
                within("the tolerance", " m", tolerance, 0.0..=0.2)?;
                within("the force of the fingers", " N", force, 1.0..=140.0)
            }
        }
    }
}
