//! Hand guiding: the reference follows the arm, except along the fixed axes.

use franka_model::{JointVector, Twist, rotation};
use nalgebra::{Isometry3, Matrix6, Vector3};

use super::goal::Free;
use super::guard::leash::Leash;
use super::running::Measured;
use crate::law::Gains;
use crate::session::joints::JointGenerator;
use crate::session::reference::Reference;

/// Number of cycles over which the spring of the previous goal is released.
const LET_GO: u32 = 300;

/// Square of the damping in the inverse of the Jacobian. Near a singular posture, it limits the
/// offset of a joint to about fifty times the offset of the end effector.
const SQUARED_DAMPING: f64 = 1e-4;

impl Gains {
    /// Returns gains for hand guiding. On the axes that are not free, the end effector has springs
    /// as in [`Self::cartesian`]. The joints have light damping, and nothing is compensated.
    pub fn guiding(free: Free) -> Self {
        let preset = Self::cartesian();
        let locked =
            |gains: [f64; 6]| core::array::from_fn(|i| if free.axes[i] { 0.0 } else { gains[i] });
        Self {
            cartesian_stiffness: locked(preset.cartesian_stiffness),
            cartesian_damping: locked(preset.cartesian_damping),
            joint_damping: [1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5],
            compensation: [0.0; 7],
            ..preset
        }
    }
}

/// Brakes the reference, and then lets it follow the arm.
#[derive(Debug)]
pub(super) struct Guide {
    free: Free,
    stage: GuideStage,
}

#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per session, inside its box; a box in here would allocate"
)]
enum GuideStage {
    Braking(JointGenerator),
    Floating(Floating),
}

#[derive(Debug)]
struct Floating {
    /// Pose at which the fixed axes are held.
    pose: Isometry3<f64>,
    /// Positions at which the joints are held, to the extent that the end effector allows.
    q: JointVector,
    /// Offset of the joints, and of the end effector, between reference and arm at the release.
    offset: JointVector,
    offset_at_ee: Twist,
    cycle: u32,
}

impl Guide {
    /// Creates the guide, which first stops the arm with `brake`.
    pub(super) fn new(free: Free, brake: JointGenerator) -> Self {
        Self {
            free,
            stage: GuideStage::Braking(brake),
        }
    }

    /// Frees these axes instead of the previous ones. The other axes are held where the arm is now.
    pub(super) fn free(&mut self, free: Free) {
        if free != self.free {
            self.free = free;
            if let GuideStage::Floating(floating) = &mut self.stage {
                floating.cycle = u32::MAX;
            }
        }
    }

    /// Advances by one nominal millisecond. Also returns true if the arm was pushed off a held axis
    /// by more than the leash.
    pub(super) fn step(
        &mut self,
        reference: &Reference,
        arm: &Measured,
        leash: &Leash,
    ) -> (Reference, bool) {
        let (away, leashed) = match &mut self.stage {
            GuideStage::Braking(generator) if !generator.is_done() => {
                return (generator.step(), false);
            }
            GuideStage::Floating(floating) if floating.cycle < u32::MAX => {
                floating.step(self.free, leash, arm)
            }
            GuideStage::Braking(_) | GuideStage::Floating(_) => {
                let mut floating = Floating::begin(reference, arm);
                let stepped = floating.step(self.free, leash, arm);
                self.stage = GuideStage::Floating(floating);
                stepped
            }
        };
        (Reference::at_rest(arm.q + away), leashed)
    }
}

impl Floating {
    fn begin(reference: &Reference, arm: &Measured) -> Self {
        let offset = reference.q - arm.q;
        let offset_at_ee = arm.jacobian * offset;
        let ahead = Vector3::new(offset_at_ee[0], offset_at_ee[1], offset_at_ee[2]);
        let turn = Vector3::new(offset_at_ee[3], offset_at_ee[4], offset_at_ee[5]);
        Self {
            pose: Isometry3::from_parts(
                (arm.pose.translation.vector + ahead).into(),
                rotation::exp(&turn) * arm.pose.rotation,
            ),
            q: reference.q,
            offset,
            offset_at_ee,
            cycle: 0,
        }
    }

    /// Returns the difference between reference and arm, and true if the leash held the reference.
    fn step(&mut self, free: Free, leash: &Leash, arm: &Measured) -> (JointVector, bool) {
        let remaining = 1.0 - f64::from(self.cycle.min(LET_GO)) / f64::from(LET_GO);
        self.cycle = (self.cycle + 1).min(LET_GO);
        let leash = &self.slack(leash, remaining);
        let (at_ee, mut leashed) = self.at_end_effector(free, leash, arm, remaining);
        let inverse = Inverse::of(arm);
        let along = inverse.solve(arm, &at_ee);
        let elbow = if free.elbow {
            self.offset * remaining
        } else {
            let away = self.q - arm.q;
            let held = away.map(|away| away.clamp(-leash.joints, leash.joints));
            // As with the leash: if the elbow is pushed further, it stays where it was pushed to.
            self.q = arm.q + held;
            leashed |= held != away;
            held
        };
        let away = along + elbow - inverse.solve(arm, &(arm.jacobian * elbow));
        // Near a singular posture, a small displacement of the end effector corresponds to a large
        // displacement of the joints.
        let held = away.map(|away| away.clamp(-leash.joints, leash.joints));
        (held, leashed || held != away)
    }

    /// Returns the leash, made at least as long as `remaining` times the offset between reference
    /// and arm at the release. The previous goal may have had another leash, or no leash at the end
    /// effector.
    fn slack(&self, leash: &Leash, remaining: f64) -> Leash {
        let at_ee = |part| remaining * self.offset_at_ee.fixed_rows::<3>(part).norm();
        Leash {
            translation: leash.translation.max(at_ee(0)),
            rotation: leash.rotation.max(at_ee(3)),
            joints: leash.joints.max(remaining * self.offset.amax()),
        }
    }

    /// Returns the difference at the end effector, and true if the leash held it. Fixed axes are
    /// held within the leash.
    fn at_end_effector(
        &mut self,
        free: Free,
        leash: &Leash,
        arm: &Measured,
        remaining: f64,
    ) -> (Twist, bool) {
        let away = self.pose.translation.vector - arm.pose.translation.vector;
        let turned = rotation::error(&self.pose.rotation, &arm.pose.rotation);
        let mut offset = Twist::zeros();
        for axis in 0..6 {
            offset[axis] = match (free.axes[axis], axis) {
                (true, _) => self.offset_at_ee[axis] * remaining,
                (false, 0..3) => away[axis],
                (false, _) => turned[axis - 3],
            };
        }
        let mut leashed = false;
        for (part, most) in [(0, leash.translation), (3, leash.rotation)] {
            let length = offset.fixed_rows::<3>(part).norm();
            if length > most {
                leashed = true;
                offset.fixed_rows_mut::<3>(part).scale_mut(most / length);
            }
        }
        let (ahead, turn) = (offset.fixed_rows::<3>(0), offset.fixed_rows::<3>(3));
        self.pose = Isometry3::from_parts(
            (arm.pose.translation.vector + ahead).into(),
            rotation::exp(&turn.into_owned()) * arm.pose.rotation,
        );
        (offset, leashed)
    }
}

/// Damped inverse of the Jacobian. It returns the smallest change of the joints for a change of the
/// end effector.
struct Inverse(Option<nalgebra::Cholesky<f64, nalgebra::U6>>);

impl Inverse {
    fn of(arm: &Measured) -> Self {
        let square = arm.jacobian * arm.jacobian.transpose();
        Self((square + Matrix6::identity() * SQUARED_DAMPING).cholesky())
    }

    /// Returns zero if a number is not finite, because then there is no inverse.
    fn solve(&self, arm: &Measured, change: &Twist) -> JointVector {
        let solved = self.0.as_ref().map(|square| square.solve(change));
        solved.map_or_else(JointVector::zeros, |solved| arm.jacobian.tr_mul(&solved))
    }
}
