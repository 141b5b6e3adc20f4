//! Parameters of the arm's self-motion: the vendor's elbow, and the swivel angle.

use crate::JointVector;
use crate::chain::Chain;
use crate::geometry::Lengths;
use crate::inertia::dot;
use crate::scalar::{atan2, sqrt};

/// Angle of joint 4, `[rad]`, at which the arm is stretched and the elbow flips.
///
/// The angle is `atan2(-a (d3 + d5), d3 d5 - a²)` (libfranka 0.21, `robot_state.h`). Here `a` is
/// the elbow offset, `d3` is the length of the upper arm, and `d5` is the length of the forearm. On
/// an arm with other [lengths](crate::geometry::Lengths::flip_angle), the angle differs by less
/// than a milliradian.
pub const FLIP_ANGLE: f64 = -0.467002423653011;

/// Returns `[angle of joint 3 [rad], side of joint 4]`, as in the state's `elbow`. The side is +1
/// if joint 4 is above [`FLIP_ANGLE`], −1 below, and 0 at this angle.
pub fn elbow(q: &JointVector) -> [f64; 2] {
    let side = match q[3].partial_cmp(&FLIP_ANGLE) {
        Some(core::cmp::Ordering::Greater) => 1.0,
        Some(core::cmp::Ordering::Less) => -1.0,
        _ => 0.0,
    };
    [q[2], side]
}

/// Returns the swivel (arm) angle, `[rad]`: the position of the elbow on its circle about the line
/// from shoulder to wrist.
///
/// The elbow is the origin of frame 4; the wrist is the origin of frame 5. The angle turns the
/// vertical half plane above the line into the half plane of the elbow, about the direction from
/// the shoulder to the wrist. It is in `(−π, π]`, and zero if the elbow is on top (Kreutz-Delgado,
/// Long and Seraji, 1992, with the base's z axis as reference). Returns `None` if the wrist is on
/// the axis of joint 1, or if the elbow is on the line, within rounding.
pub fn swivel(lengths: &Lengths, q: &JointVector) -> Option<f64> {
    let chain = Chain::at(lengths, q);
    let (e, w) = (&chain.origin[3], &chain.origin[4]);
    let squared = dot(w, w);
    let turned = e.x * w.y - e.y * w.x;
    let up = (e.z * squared - dot(e, w) * w.z) / sqrt(squared);
    // The size is a product: the wrist's distance from axis 1 times the elbow's distance from the
    // line.
    let size = sqrt(turned * turned + up * up);
    (size > UNDEFINED).then(|| atan2(turned, up))
}

/// Product of two distances, `[m²]`, below which the product is rounding error.
const UNDEFINED: f64 = 1e-16;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{ELBOW, FOREARM, UPPER_ARM};
    use crate::random::Random;
    use crate::{Model, READY};
    use nalgebra::{Rotation3, Unit, Vector3};

    #[test]
    fn the_flip_angle_is_that_of_the_stretched_arm() {
        let stretched = atan2(
            -ELBOW * (UPPER_ARM + FOREARM),
            UPPER_ARM * FOREARM - ELBOW * ELBOW,
        );
        assert!((FLIP_ANGLE - stretched).abs() < 1e-14);
        assert_eq!(Lengths::DESCRIBED.flip_angle(), stretched);
        let recorded = Lengths::RECORDED_FR3.flip_angle();
        assert!((FLIP_ANGLE - recorded).abs() < 1e-3);
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

    #[test]
    fn swivel_is_zero_at_the_top_and_the_turn_from_there() {
        assert_eq!(swivel(&Lengths::DESCRIBED, &READY), Some(0.0));
        let mut random = Random::new(11);
        for _ in 0..1000 {
            let q = random.posture(Model::fr3());
            let chain = Chain::at(&Lengths::DESCRIBED, &q);
            let (elbow, wrist) = (&chain.origin[3], &chain.origin[4]);
            let line = Unit::new_normalize(*wrist);
            let across = |v: &Vector3<f64>| (v - line.scale(line.dot(v))).normalize();
            let angle = swivel(&Lengths::DESCRIBED, &q).expect("defined");
            let turned = Rotation3::from_axis_angle(&line, angle) * across(&Vector3::z());
            assert!((turned - across(elbow)).norm() < 1e-9);
        }
    }

    #[test]
    fn swivel_is_undefined_overhead_and_at_stretched_elbow() {
        assert_eq!(swivel(&Lengths::DESCRIBED, &JointVector::zeros()), None);
        let mut q = READY;
        q[3] = FLIP_ANGLE;
        assert_eq!(swivel(&Lengths::DESCRIBED, &q), None);
    }
}
