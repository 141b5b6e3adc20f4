//! Gains as the cycle uses them. They are all numbers, so that values between two goals exist.

use crate::law::fade::{Blend, mix};
use crate::law::{Gains, Law};
use crate::shaping::{CYCLE, MAX_CUTOFF_FREQUENCY, filter};

/// Gains and force cap as numbers. A choice becomes a weight between 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BlendedGains {
    pub(crate) cartesian_stiffness: [f64; 6],
    pub(crate) cartesian_damping: [f64; 6],
    pub(crate) joint_stiffness: [f64; 7],
    pub(crate) joint_damping: [f64; 7],
    pub(crate) feedforward: f64,
    /// Share of the newest reference velocity in the filtered velocity; 1 if the filter is off.
    pub(crate) feedforward_share: f64,
    /// Weight of the null-space projection of the joints' gains.
    pub(crate) projection: f64,
    /// Weight of the operational-space law; the rest is the weight of the hybrid law.
    pub(crate) operational: f64,
    /// Inverse of the force cap, `[1/N]`. Without a cap it is 0, so that a cap can fade out
    /// continuously.
    pub(crate) inverse_force_cap: f64,
    pub(crate) compensation: [f64; 7],
    pub(crate) torque_limits: [f64; 7],
    /// Share of the newest torque in the filtered torque; 1 if the filter is off.
    pub(crate) torque_share: f64,
}

impl BlendedGains {
    pub(crate) fn new(gains: &Gains, force_cap: Option<f64>) -> Self {
        let operational = gains.law == Law::OperationalSpace;
        let share = |cutoff: f64| {
            if cutoff < MAX_CUTOFF_FREQUENCY {
                filter::gain(CYCLE, cutoff)
            } else {
                1.0
            }
        };
        Self {
            cartesian_stiffness: gains.cartesian_stiffness,
            cartesian_damping: gains.cartesian_damping,
            joint_stiffness: gains.joint_stiffness,
            joint_damping: gains.joint_damping,
            feedforward: gains.feedforward,
            feedforward_share: share(gains.feedforward_cutoff),
            projection: f64::from(u8::from(operational || gains.project_joint_gains)),
            operational: f64::from(u8::from(operational)),
            inverse_force_cap: force_cap.map_or(0.0, f64::recip),
            compensation: gains.compensation,
            torque_limits: gains.torque_limits,
            torque_share: share(gains.torque_cutoff),
        }
    }

    /// True if the inertia at the end effector is needed.
    pub(crate) fn needs_task_space(&self) -> bool {
        self.projection > 0.0 || self.operational > 0.0 || self.inverse_force_cap > 0.0
    }

    /// Returns the force cap, `[N]`; `None` without a cap.
    pub(crate) fn force_cap(&self) -> Option<f64> {
        (self.inverse_force_cap > 0.0).then(|| self.inverse_force_cap.recip())
    }
}

impl Blend for BlendedGains {
    fn blend(&self, other: &Self, share: f64) -> Self {
        let mix = |from, to| mix(from, to, share);
        macro_rules! each {
            ($array:ident) => {
                core::array::from_fn(|i| mix(self.$array[i], other.$array[i]))
            };
        }
        Self {
            cartesian_stiffness: each!(cartesian_stiffness),
            cartesian_damping: each!(cartesian_damping),
            joint_stiffness: each!(joint_stiffness),
            joint_damping: each!(joint_damping),
            feedforward: mix(self.feedforward, other.feedforward),
            feedforward_share: mix(self.feedforward_share, other.feedforward_share),
            projection: mix(self.projection, other.projection),
            operational: mix(self.operational, other.operational),
            inverse_force_cap: mix(self.inverse_force_cap, other.inverse_force_cap),
            compensation: each!(compensation),
            torque_limits: each!(torque_limits),
            torque_share: mix(self.torque_share, other.torque_share),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::fade::{CROSS_FADE, Fade};

    fn soft() -> BlendedGains {
        BlendedGains::new(&Gains::cartesian(), None)
    }

    fn other() -> BlendedGains {
        let gains = Gains {
            law: Law::OperationalSpace,
            feedforward_cutoff: 20.0,
            ..Gains::droid()
        };
        BlendedGains::new(&gains, Some(10.0))
    }

    #[test]
    fn every_number_goes_evenly_from_one_goal_to_the_next() {
        let mut fade = Fade::at(soft());
        assert_eq!(fade.step(), soft());
        fade.towards(other());
        let mut last = soft();
        for cycle in 1..=CROSS_FADE {
            let now = fade.step();
            let step = 1.0 / f64::from(CROSS_FADE);
            let moved = now.operational - last.operational;
            assert!((moved - step).abs() < 1e-12, "cycle {cycle}");
            let moved = now.inverse_force_cap - last.inverse_force_cap;
            assert!((moved - 0.1 * step).abs() < 1e-12, "cycle {cycle}");
            let moved = last.cartesian_damping[2] - now.cartesian_damping[2];
            assert!((moved - 53.0 * step).abs() < 1e-9, "cycle {cycle}");
            last = now;
        }
        assert_eq!(last, other());
        assert_eq!(fade.step(), other());
    }

    #[test]
    fn a_filter_at_the_greatest_cutoff_is_off() {
        assert_eq!(
            soft().torque_share,
            0.385_869_545_095_037_5,
            "libfranka's at 100 Hz"
        );
        assert_eq!(soft().feedforward_share, 1.0);
        assert_eq!(other().feedforward_share, filter::gain(CYCLE, 20.0));
        assert_eq!(soft().force_cap(), None);
        assert_eq!(other().force_cap(), Some(10.0));
    }
}
