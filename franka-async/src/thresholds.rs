//! Compares the collision thresholds of this program with the forces of compliant control.

use std::sync::{Arc, Mutex, PoisonError};

use franka_proto::CollisionBehavior;
use franka_rt::session::ForceCap;

/// Largest force that friction alone adds to the robot's estimate of external forces, `[N]`.
/// Source: the book's chapter "Target control on arms that stick".
const FRICTION: f64 = 10.0;

/// The thresholds that were set over one connection. Robots do not report their thresholds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Thresholds(Arc<Mutex<Option<CollisionBehavior>>>);

impl Thresholds {
    pub(crate) fn note(&self, behavior: CollisionBehavior) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(behavior);
    }

    /// Returns the robot's threshold, and the largest force, friction included, that the robot may
    /// estimate under this force cap, both in `[N]`. Returns `None` unless that force exceeds the
    /// threshold.
    pub(crate) fn within(&self, cap: ForceCap) -> Option<(f64, f64)> {
        let most = match cap {
            ForceCap::Default => ForceCap::DEFAULT_NEWTONS,
            ForceCap::Newtons(newtons) => newtons,
            ForceCap::Off => f64::INFINITY,
        };
        let noted = *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let least = noted?.least_force();
        (least < most + FRICTION).then_some((least, most + FRICTION))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_below_the_force_cap_are_told() {
        let thresholds = Thresholds::default();
        assert_eq!(thresholds.within(ForceCap::Off), None, "not known");
        thresholds.note(CollisionBehavior::careful());
        assert_eq!(thresholds.within(ForceCap::Default), Some((10.0, 40.0)));
        thresholds.note(CollisionBehavior::compliant());
        assert_eq!(thresholds.within(ForceCap::Default), None);
        let stiff = thresholds.within(ForceCap::Newtons(80.0));
        assert_eq!(stiff, Some((60.0, 90.0)));
        thresholds.note(CollisionBehavior::insensitive());
        assert_eq!(thresholds.within(ForceCap::Newtons(80.0)), None);
        assert_eq!(
            thresholds.within(ForceCap::Off),
            Some((100.0, f64::INFINITY))
        );
    }
}
