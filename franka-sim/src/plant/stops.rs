//! Mechanical end stops of the joints.

use franka_model::{JointVector, joint_vector};

/// A stiff spring and damper beyond each end of a joint's range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStops {
    /// Where the lower stops begin, `[rad]`.
    pub lower: JointVector,
    /// Where the upper stops begin, `[rad]`.
    pub upper: JointVector,
    /// Stiffness beyond them, `[N·m/rad]`.
    pub stiffness: f64,
    /// Damping beyond them, `[N·m·s/rad]`.
    pub damping: f64,
}

/// How far the mechanical stops stand outside the limits that the interface enforces, `[rad]`.
const CLEARANCE: f64 = 0.04;

impl EndStops {
    /// Stops for an arm whose interface enforces `lower` and `upper`, `[rad]`.
    ///
    /// Clearance, stiffness and damping are choices of this simulator: 87 N·m press the strongest
    /// joint 0.03 rad into its stop.
    pub fn around(lower: &JointVector, upper: &JointVector) -> Self {
        Self {
            lower: lower.add_scalar(-CLEARANCE),
            upper: upper.add_scalar(CLEARANCE),
            stiffness: 3000.0,
            damping: 30.0,
        }
    }

    /// No stops: the joints turn freely.
    pub const NONE: Self = Self {
        lower: joint_vector([f64::NEG_INFINITY; 7]),
        upper: joint_vector([f64::INFINITY; 7]),
        stiffness: 0.0,
        damping: 0.0,
    };

    /// How deep joint `i` at `q` is in a stop: negative in the lower, positive in the upper one,
    /// `[rad]`.
    pub(super) fn depth(&self, i: usize, q: f64) -> f64 {
        (q - self.upper[i]).max(0.0) + (q - self.lower[i]).min(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_act_outside_the_enforced_range_only() {
        let stops = EndStops::around(&JointVector::repeat(-1.0), &JointVector::repeat(1.0));
        assert_eq!(stops.depth(0, 1.03), 0.0);
        assert_eq!(stops.depth(0, -1.03), 0.0);
        assert!((stops.depth(0, 1.05) - 0.01).abs() < 1e-12);
        assert!((stops.depth(0, -1.05) + 0.01).abs() < 1e-12);
        assert_eq!(EndStops::NONE.depth(3, 100.0), 0.0);
    }
}
