//! The speed cap: in every posture, limits the speed with which all joints, the flange and the end
//! effector move through space.
//!
//! On the way to a pose, the reference stays below the cap by a reserve. If one of its points would
//! be faster, all joints are slowed by the same factor. The pose that they follow is also slowed,
//! so that the hand stays on its line and arrives later. Above [`ONSET`] of the reference's highest
//! speed, the limit sets in smoothly:
//!
//! ```text
//! speed' = onset + (most - onset) (1 - exp(-(speed - onset) / (most - onset)))
//! ```
//!
//! The arm may still exceed the cap on a path of the joints, along a chunk, or because something
//! pushes it. Then its goal is given up and the arm brakes.

use franka_model::{EndEffector, Jacobian, JointVector, Model};

/// Share of the cap that the reference may use on the way to a pose. The rest is a reserve for the
/// arm, which oscillates about its reference.
const SHARE: f64 = 0.94;

/// Least reserve for the arm, `[m/s]`. It is needed because an arm with friction breaks loose with
/// a jolt, even at low speeds.
const RESERVE: f64 = 0.03;

/// Share of the reference's highest speed above which the reference is slowed.
const ONSET: f64 = 0.9;

/// The lowest accepted cap, `[m/s]`. Lower values are not useful, because measured joint velocities
/// have noise.
pub(crate) const LEAST: f64 = 0.1;

/// The highest accepted cap, `[m/s]`: the robot's own limit for the end effector.
pub(crate) const MOST: f64 = 3.0;

#[derive(Clone, Copy, Debug)]
pub(crate) struct SpeedCap<'a> {
    /// Cap, `[m/s]`.
    pub(crate) speed: f64,
    /// The hand in the robot's state.
    pub(crate) hand: &'a EndEffector,
}

impl SpeedCap<'_> {
    /// Returns the factor by which the velocities `dq`, `[rad/s]`, must be reduced for joints at
    /// `q`. Returns `None` if they may stay. `jacobian` belongs to the frame that follows a pose:
    /// the hand, or an object in the hand. That frame also stays below the cap.
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

    /// Returns the reduced speed, `[m/s]`, under a cap of 0.5 m/s.
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
    fn slow_joints_stay_as_they_are_and_fast_ones_are_capped() {
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
            // The greatest curvature is the inverse of the room.
            assert!(slope - next < 1.1 * step / (0.1 * SHARE * 0.5), "{i}");
        }
    }
}
