//! The speed cap: no joint, flange or end effector goes faster, wherever the arm is.
//!
//! On the way to a pose the reference keeps below it by a reserve: all its joints are slowed alike
//! where one of its points would be faster, and with them the pose that they follow, so that the
//! hand stays on its line and comes later. From [`ONSET`] of that on, what is asked for is
//! approached without a corner:
//!
//! ```text
//! speed' = onset + (most - onset) (1 - exp(-(speed - onset) / (most - onset)))
//! ```
//!
//! An arm that is faster than the cap all the same, on its way over joints or along a chunk, or
//! because something throws it, gives up its goal and is braked.

use franka_model::{EndEffector, Jacobian, JointVector, Model};

/// Share of the cap that the reference keeps on the way to a pose. The rest is for the arm, which
/// swings about it.
const SHARE: f64 = 0.94;

/// What that leaves to the arm at least, `[m/s]`: one that sticks comes loose with a jolt, however
/// slow it is to go.
const RESERVE: f64 = 0.03;

/// Share of what the reference keeps from which on it is slowed.
const ONSET: f64 = 0.9;

/// The least that is accepted, `[m/s]`: measured joint velocities have noise.
pub(crate) const LEAST: f64 = 0.1;

/// The greatest that is accepted, `[m/s]`: the robot's own limit of the end effector.
pub(crate) const MOST: f64 = 3.0;

/// The speed cap of a session.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpeedCap<'a> {
    /// `[m/s]`
    pub(crate) speed: f64,
    /// As the robot's state has it.
    pub(crate) hand: &'a EndEffector,
}

impl SpeedCap<'_> {
    /// Share of the velocities `dq`, `[rad/s]`, that joints at `q` may have; `None` if they may
    /// have all. `jacobian` is that of what follows a pose: the hand, or an object in it, which
    /// keeps to the cap, too.
    pub(crate) fn share(
        self,
        model: &Model,
        q: &JointVector,
        dq: &JointVector,
        jacobian: &Jacobian,
    ) -> Option<f64> {
        let most = (SHARE * self.speed).min(self.speed - RESERVE);
        let onset = ONSET * most;
        let object = (jacobian.fixed_rows::<3>(0) * dq).norm();
        let speed = model.fastest_point(q, dq, self.hand).max(object);
        if speed <= onset {
            return None;
        }
        let room = most - onset;
        let kept = most - room * (-(speed - onset) / room).exp();
        Some(kept / speed)
    }
}

#[cfg(test)]
mod tests {
    use franka_model::{Frame, READY};

    use super::*;

    /// The speed that is kept of one, `[m/s]`, under a cap of 0.5 m/s.
    fn kept(speed: f64) -> f64 {
        let (model, hand) = (Model::fr3(), EndEffector::default());
        let jacobian = model.zero_jacobian(Frame::EndEffector, &READY, &hand);
        let along = JointVector::from([0.3, 0.2, 0.0, -0.4, 0.1, 0.3, 1.0]);
        let dq = along * (speed / model.fastest_point(&READY, &along, &hand));
        let cap = SpeedCap {
            speed: 0.5,
            hand: &hand,
        };
        speed * cap.share(model, &READY, &dq, &jacobian).unwrap_or(1.0)
    }

    #[test]
    fn slow_joints_are_left_alone_and_nothing_is_faster_than_the_share() {
        for speed in [0.0, 0.2, 0.42] {
            assert_eq!(kept(speed), speed);
        }
        for speed in [0.43, 0.5, 1.0, 10.0] {
            let kept = kept(speed);
            assert!(kept < speed && kept <= SHARE * 0.5 + 1e-12, "{kept}");
        }
    }

    #[test]
    fn speed_and_its_slope_are_continuous() {
        let step = 1e-4;
        let at = |i: i32| kept(0.4 + step * f64::from(i));
        for i in 1..1000 {
            let (slope, next) = ((at(i) - at(i - 1)) / step, (at(i + 1) - at(i)) / step);
            assert!(next <= slope + 1e-6, "{i}");
            // Greatest curvature: one over the room.
            assert!(slope - next < 1.1 * step / (0.1 * SHARE * 0.5), "{i}");
        }
    }
}
