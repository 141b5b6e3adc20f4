//! The vendor's elbow parameter: which of the arm's self-motions a pose is taken with.

use crate::JointVector;

/// Angle of joint 4, `[rad]`, at which the arm is stretched and the elbow flips over.
///
/// `atan2(-a (d3 + d5), d3 d5 - a²)` with the elbow offset `a` and the lengths `d3`, `d5` of upper
/// arm and forearm; libfranka 0.21 documents it in `robot_state.h`.
pub const FLIP_ANGLE: f64 = -0.467002423653011;

/// `[angle of joint 3 [rad], side of joint 4]`, as in the state's `elbow`: the side is +1 above
/// [`FLIP_ANGLE`], −1 below, 0 on it.
pub fn elbow(q: &JointVector) -> [f64; 2] {
    let side = match q[3].partial_cmp(&FLIP_ANGLE) {
        Some(core::cmp::Ordering::Greater) => 1.0,
        Some(core::cmp::Ordering::Less) => -1.0,
        _ => 0.0,
    };
    [q[2], side]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::READY;
    use crate::geometry::{ELBOW, FOREARM, UPPER_ARM};
    use crate::scalar::atan2;

    #[test]
    fn the_flip_angle_is_that_of_the_stretched_arm() {
        let stretched = atan2(
            -ELBOW * (UPPER_ARM + FOREARM),
            UPPER_ARM * FOREARM - ELBOW * ELBOW,
        );
        assert!((FLIP_ANGLE - stretched).abs() < 1e-14);
    }

    #[test]
    fn the_side_tells_on_which_side_of_the_flip_joint_4_is() {
        let mut q = READY;
        q[2] = 0.3;
        assert_eq!(elbow(&q), [0.3, -1.0]);
        q[3] = FLIP_ANGLE;
        assert_eq!(elbow(&q), [0.3, 0.0]);
        q[3] = -0.2;
        assert_eq!(elbow(&q), [0.3, 1.0]);
    }
}
