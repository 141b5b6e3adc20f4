//! Lead: a streamed target that is far ahead of the arm is moved closer, so that a single wrong
//! target cannot move the arm far after the stream stops.

use franka_model::JointVector;
use nalgebra::Isometry3;

use crate::session::Target;
use crate::session::guard::leash;

/// Greatest distance that a target may be ahead of the measured position.
///
/// A target that is further ahead is moved closer on the straight line to it. This is repeated in
/// every cycle while targets arrive: until [`Self::FRESH_MS`] after the newest target, even if that
/// target only repeats the previous one. After that, the target stays where it is. Therefore the
/// arm moves at most this distance after targets stop arriving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lead {
    /// Translation of the end effector, for pose targets, `[m]`.
    pub translation: f64,
    /// Rotation of the end effector, for pose targets, `[rad]`.
    pub rotation: f64,
    /// Distance of each joint, for joint targets, `[rad]`.
    pub joints: f64,
}

impl Lead {
    /// Time after the newest target during which the target is moved closer in every cycle, `[ms]`.
    /// Therefore the arm follows a stream of 5 Hz without a pause.
    pub const FRESH_MS: u64 = 200;

    /// Returns the place to which `target` is moved, for an arm at `q` and `measured`. Returns
    /// `None` if the target is near enough.
    pub(crate) fn drawn(
        &self,
        target: &Target,
        q: &JointVector,
        measured: &Isometry3<f64>,
    ) -> Option<Target> {
        match target {
            Target::Joints(target) => {
                let ahead = JointVector::from(*target) - q;
                let most = ahead.amax();
                (most > self.joints)
                    .then(|| Target::Joints((q + ahead * (self.joints / most)).into()))
            }
            Target::Pose(pose) => {
                leash::within(pose, measured, self.translation, self.rotation).map(Target::Pose)
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::READY;
    use nalgebra::{Translation3, Vector3};

    const LEAD: Lead = Lead {
        translation: 0.05,
        rotation: 0.2,
        joints: 0.1,
    };

    #[test]
    fn a_target_far_ahead_is_drawn_nearer_on_the_straight_line() {
        let measured = Isometry3::translation(0.3, 0.0, 0.5);
        let way = Vector3::new(0.0, 0.3, -0.4);
        let far = Target::Pose(Translation3::from(way) * measured);
        let Some(Target::Pose(near)) = LEAD.drawn(&far, &READY, &measured) else {
            panic!("half a metre is too far");
        };
        assert!((near.translation.vector - measured.translation.vector - way * 0.1).norm() < 1e-15);

        let mut q = READY;
        q[0] += 0.4;
        q[1] -= 0.2;
        let Some(Target::Joints(near)) = LEAD.drawn(&Target::Joints(q.into()), &READY, &measured)
        else {
            panic!("0.4 rad is too far");
        };
        assert!((JointVector::from(near) - (READY + (q - READY) * 0.25)).amax() < 1e-15);
    }

    #[test]
    fn a_target_within_the_lead_is_left_alone() {
        let measured = Isometry3::translation(0.3, 0.0, 0.5);
        let near = Target::Pose(Translation3::new(0.0, 0.049, 0.0) * measured);
        for target in [near, Target::Joints(READY.into()), Target::Rest] {
            assert_eq!(LEAD.drawn(&target, &READY, &measured), None);
        }
    }
}
