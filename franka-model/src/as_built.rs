//! An arm as built, with deviations from its model.

use nalgebra::{Isometry3, Matrix4, Vector3};

use crate::chain::Chain;
use crate::dynamics;
use crate::frame::{EndEffector, Frame};
use crate::inertia::RigidBody;
use crate::jacobian::{self, Placement};
use crate::load::Load;
use crate::model::Model;
use crate::{Jacobian, JointVector, MassMatrix};

/// The true arm of a simulated robot. Its links and joint axes can deviate from the [`Model`] that
/// the robot's controllers use.
///
/// Units, frames and loads are the same as in [`Model`].
#[derive(Debug, Clone, PartialEq)]
pub struct AsBuilt {
    model: Model,
}

impl AsBuilt {
    /// Returns an arm that matches `model` exactly.
    pub fn exactly(model: &Model) -> Self {
        Self {
            model: model.clone(),
        }
    }

    /// Replaces links 1 to 7 with these bodies, each in the axes of its own link.
    #[must_use]
    pub fn with_links(mut self, links: [RigidBody; 7]) -> Self {
        self.model.links = links;
        self
    }

    /// Displaces the joint frames, as [`Model::with_deviations`] does.
    #[must_use]
    pub fn with_deviations(mut self, deviations: &[Isometry3<f64>; 7]) -> Self {
        self.model = self.model.with_deviations(deviations);
        self
    }

    /// Returns links 1 to 7 without a load, each in the axes of its own link.
    pub fn links(&self) -> &[RigidBody; 7] {
        self.model.links()
    }

    /// Returns the pose of each joint's frame, with the joint at zero, in the frame of the previous
    /// link.
    pub fn joint_origins(&self) -> [Isometry3<f64>; 7] {
        self.model.joint_origins()
    }

    /// Returns the pose of `frame` in the base frame.
    pub fn pose(&self, frame: Frame, q: &JointVector, ee: &EndEffector) -> Matrix4<f64> {
        Placement::of(&self.chain(q), frame, ee).pose()
    }

    /// Returns a frame's pose and zero Jacobian; see [`Model::pose_and_jacobian`].
    pub fn pose_and_jacobian(
        &self,
        frame: Frame,
        q: &JointVector,
        ee: &EndEffector,
    ) -> (Matrix4<f64>, Jacobian) {
        let chain = self.chain(q);
        let placement = Placement::of(&chain, frame, ee);
        let jacobian = jacobian::zero_jacobian(&chain, frame.joints(), &placement.origin);
        (placement.pose(), jacobian)
    }

    /// Returns the joint-space inertia; see [`Model::mass`].
    pub fn mass(&self, q: &JointVector, load: &Load) -> MassMatrix {
        dynamics::mass(&self.chain(q), &self.model.links_with(load))
    }

    /// Returns the torques against gravity; see [`Model::gravity`].
    pub fn gravity(
        &self,
        q: &JointVector,
        load: &Load,
        gravity_earth: &Vector3<f64>,
    ) -> JointVector {
        dynamics::gravity(&self.chain(q), &self.model.links_with(load), gravity_earth)
    }

    /// Returns the joint accelerations; see [`Model::forward_dynamics`]. The armature is symmetric
    /// and can couple the joints.
    #[allow(clippy::too_many_arguments)] // the terms of the equation of motion
    pub fn forward_dynamics(
        &self,
        q: &JointVector,
        dq: &JointVector,
        tau: &JointVector,
        load: &Load,
        gravity_earth: &Vector3<f64>,
        armature: &MassMatrix,
    ) -> Option<JointVector> {
        dynamics::forward_dynamics(
            &self.chain(q),
            &self.model.links_with(load),
            dq,
            tau,
            gravity_earth,
            armature,
        )
    }

    fn chain(&self, q: &JointVector) -> Chain {
        self.model.chain(q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::{GRAVITY_EARTH, RobotKind};
    use nalgebra::UnitQuaternion;

    fn deviations() -> [Isometry3<f64>; 7] {
        core::array::from_fn(|i| {
            let i = i as f64;
            let shift = Vector3::new(1e-3, -2e-3 * i, 5e-4);
            Isometry3::new(shift, Vector3::new(2e-3, 1e-3 * i, -3e-3))
        })
    }

    #[test]
    fn an_exact_arm_is_the_model_whichever_chain_it_takes() {
        let mut random = Random::new(5);
        for kind in RobotKind::ALL {
            let model = Model::physically_consistent(kind);
            let exact = AsBuilt::exactly(model);
            let origins = model.joint_origins().map(|origin| {
                let turn = origin.rotation.to_rotation_matrix().into_inner();
                (turn, origin.translation.vector)
            });
            let mut chained = exact.clone();
            chained.model.origins = Some(origins);
            for _ in 0..50 {
                let q = random.posture(model);
                let ee = EndEffector::default();
                let load = Load::NONE;
                for arm in [&exact, &chained] {
                    let pose = arm.pose(Frame::EndEffector, &q, &ee);
                    let expected = model.pose(Frame::EndEffector, &q, &ee);
                    assert!((pose - expected).amax() < 1e-14);
                    let mass = arm.mass(&q, &load) - model.mass(&q, &load);
                    assert!(mass.amax() < 1e-13);
                    let gravity = arm.gravity(&q, &load, &GRAVITY_EARTH);
                    let expected = model.gravity(&q, &load, &GRAVITY_EARTH);
                    assert!((gravity - expected).amax() < 1e-12);
                }
            }
        }
        let exact = AsBuilt::exactly(Model::fr3());
        let still = exact.clone().with_deviations(&[Isometry3::identity(); 7]);
        assert_eq!(still, exact);
    }

    #[test]
    fn jacobian_of_deviating_arm_matches_its_chained_origins() {
        let mut random = Random::new(6);
        let arm = AsBuilt::exactly(Model::fr3()).with_deviations(&deviations());
        let ee = EndEffector::default();
        for _ in 0..20 {
            let q = random.posture(Model::fr3());
            let mut flange = Isometry3::identity();
            for (i, origin) in arm.joint_origins().iter().enumerate() {
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), q[i]);
                flange = flange * origin * turn;
            }
            flange *= Isometry3::translation(0.0, 0.0, crate::geometry::FLANGE);
            let (pose, jacobian) = arm.pose_and_jacobian(Frame::Flange, &q, &ee);
            assert!((pose - flange.to_homogeneous()).amax() < 1e-14);
            let nominal = Model::fr3().pose(Frame::Flange, &q, &ee);
            assert!((pose - nominal).amax() > 1e-3, "hardly a deviation");
            let step = 1e-6;
            for i in 0..7 {
                let mut moved = q;
                moved[i] += step;
                let ahead = arm.pose(Frame::Flange, &moved, &ee);
                for axis in 0..3 {
                    let rate = (ahead[(axis, 3)] - pose[(axis, 3)]) / step;
                    assert!((rate - jacobian[(axis, i)]).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn gravity_of_a_deviating_arm_is_the_slope_of_its_potential() {
        let mut random = Random::new(7);
        let mut links = *Model::fr3().links();
        links[3].mass *= 1.2;
        links[5].com.x += 0.01;
        let arm = AsBuilt::exactly(Model::fr3())
            .with_deviations(&deviations())
            .with_links(links);
        let potential = |q: &JointVector| -> f64 {
            let ee = EndEffector::default();
            let height = |i: usize| {
                let pose = arm.pose(Frame::ALL[i], q, &ee);
                pose.transform_point(&arm.links()[i].com.into()).z
            };
            (0..7).map(|i| 9.81 * arm.links()[i].mass * height(i)).sum()
        };
        for _ in 0..20 {
            let q = random.posture(Model::fr3());
            let gravity = arm.gravity(&q, &Load::NONE, &Vector3::new(0.0, 0.0, -9.81));
            for i in 0..7 {
                let (mut above, mut below) = (q, q);
                above[i] += 1e-5;
                below[i] -= 1e-5;
                let slope = (potential(&above) - potential(&below)) / 2e-5;
                assert!((slope - gravity[i]).abs() < 1e-6, "{slope} {}", gravity[i]);
            }
        }
    }
}
