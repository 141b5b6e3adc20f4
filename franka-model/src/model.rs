//! The constants of one kind of robot, and the functions that use them.

use core::fmt;

use nalgebra::{Isometry3, Matrix3, Matrix4, UnitQuaternion, Vector3};

use crate::chain::Chain;
use crate::dynamics::{self, Dynamics};
use crate::frame::{EndEffector, Frame};
use crate::geometry::Lengths;
use crate::inertia::RigidBody;
use crate::jacobian::{self, Placement};
use crate::kind::RobotKind;
use crate::limits::JointLimits;
use crate::load::Load;
use crate::merge::Merge;
use crate::{Jacobian, JointVector, MassMatrix};

/// A robot's constants: kinematics, bodies and limits.
///
/// Models with the vendor's numbers are static values ([`of`](Self::of),
/// [`physically_consistent`](Self::physically_consistent)). The description (URDF) of a connected
/// robot can be read into a separate model. All models have the same functions, with the same run
/// time.
///
/// In all functions, `q` are joint positions `[rad]`, `dq` are joint velocities `[rad/s]`, and
/// `ddq` are joint accelerations `[rad/s²]`. Torques are in `[N·m]`. `gravity_earth` is the
/// gravitational acceleration in the base frame `[m/s²]` ([`GRAVITY_EARTH`](crate::GRAVITY_EARTH)
/// for an upright robot). If an argument is not finite, the result is not finite.
#[derive(Clone, PartialEq)]
pub struct Model {
    pub(crate) kind: RobotKind,
    pub(crate) base: RigidBody,
    pub(crate) links: [RigidBody; 7],
    pub(crate) merge: Merge,
    pub(crate) joints: JointLimits,
    pub(crate) lengths: Lengths,
    /// Joint frames of a simulated robot that deviate from `lengths`, as rotation and translation
    /// in the frame of the previous link.
    pub(crate) origins: Option<[(Matrix3<f64>, Vector3<f64>); 7]>,
}

/// Prints only the kind. Some errors contain a model, and its numbers would hide the text of the
/// error.
impl fmt::Debug for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut model = f.debug_struct("Model");
        model.field("kind", &self.kind).finish_non_exhaustive()
    }
}

impl Model {
    /// Returns the kind of robot.
    pub fn kind(&self) -> RobotKind {
        self.kind
    }

    /// Returns the fixed body (link 0), in the base frame. The dynamics do not depend on this body.
    pub fn base(&self) -> &RigidBody {
        &self.base
    }

    /// Returns links 1 to 7 without a load, each in the axes of its own link.
    pub fn links(&self) -> &[RigidBody; 7] {
        &self.links
    }

    /// Returns the limits of the joints.
    pub fn joint_limits(&self) -> &JointLimits {
        &self.joints
    }

    /// Returns the same robot with these joint limits.
    #[must_use]
    pub fn with_joint_limits(self, limits: JointLimits) -> Self {
        Self {
            joints: limits,
            ..self
        }
    }

    /// Returns the lengths of the upper arm and the forearm.
    pub fn lengths(&self) -> &Lengths {
        &self.lengths
    }

    /// Returns the same robot with an upper arm and a forearm of these lengths, and with the
    /// corresponding joint frames.
    #[must_use]
    pub fn with_lengths(self, lengths: Lengths) -> Self {
        Self {
            lengths,
            origins: None,
            ..self
        }
    }

    /// Returns the same robot with joint frames displaced by `deviations`. Entry `i` is the pose of
    /// the new frame of joint `i + 1` in its current frame, at joint position zero. The deviation
    /// of a joint also moves all later frames.
    ///
    /// Use this function for simulation. Kinematics and dynamics use the displaced frames.
    /// [Analytic IK](crate::analytic_ik) and [capsules](crate::collision) ignore the deviations and
    /// use the [`lengths`](Self::lengths).
    #[must_use]
    pub fn with_deviations(mut self, deviations: &[Isometry3<f64>; 7]) -> Self {
        if deviations.iter().any(|d| *d != Isometry3::identity()) {
            let origins = self.joint_origins();
            self.origins = Some(core::array::from_fn(|i| {
                let origin = origins[i] * deviations[i];
                let turn = origin.rotation.to_rotation_matrix().into_inner();
                (turn, origin.translation.vector)
            }));
        }
        self
    }

    /// Returns the pose of each joint's frame, with the joint at zero, in the frame of the previous
    /// link.
    pub fn joint_origins(&self) -> [Isometry3<f64>; 7] {
        match &self.origins {
            None => self.lengths.joint_origins().map(|origin| {
                let roll = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), origin.roll);
                Isometry3::from_parts(origin.translation.into(), roll)
            }),
            Some(origins) => origins.map(|(turn, shift)| {
                let turn = UnitQuaternion::from_matrix(&turn);
                Isometry3::from_parts(shift.into(), turn)
            }),
        }
    }

    #[inline]
    pub(crate) fn chain(&self, q: &JointVector) -> Chain {
        match &self.origins {
            None => Chain::at(&self.lengths, q),
            Some(origins) => Chain::through(origins, q),
        }
    }

    /// Returns the pose of `frame` in the base frame.
    pub fn pose(&self, frame: Frame, q: &JointVector, ee: &EndEffector) -> Matrix4<f64> {
        Placement::of(&self.chain(q), frame, ee).pose()
    }

    /// Returns the Jacobian of `frame`, in base axes: the velocity of its origin and its angular
    /// velocity, per joint velocity. Columns of joints that do not move the frame are zero.
    pub fn zero_jacobian(&self, frame: Frame, q: &JointVector, ee: &EndEffector) -> Jacobian {
        let chain = self.chain(q);
        let placement = Placement::of(&chain, frame, ee);
        jacobian::zero_jacobian(&chain, frame.joints(), &placement.origin)
    }

    /// Returns the [`pose`](Self::pose) and the [`zero_jacobian`](Self::zero_jacobian), computed in
    /// one pass along the chain.
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

    /// Returns the speed of the fastest of nine points, `[m/s]`: the origins of the seven joint
    /// frames, of the flange and of the end effector.
    pub fn fastest_point(&self, q: &JointVector, dq: &JointVector, ee: &EndEffector) -> f64 {
        jacobian::fastest_point(&self.chain(q), dq, ee)
    }

    /// Returns the [`zero_jacobian`](Self::zero_jacobian) in the frame's own axes.
    pub fn body_jacobian(&self, frame: Frame, q: &JointVector, ee: &EndEffector) -> Jacobian {
        let chain = self.chain(q);
        let placement = Placement::of(&chain, frame, ee);
        let zero = jacobian::zero_jacobian(&chain, frame.joints(), &placement.origin);
        jacobian::body_jacobian(&zero, &placement.rotation)
    }

    /// Returns the joint-space inertia, `[kg·m²]`. Rotor inertias are not included.
    pub fn mass(&self, q: &JointVector, load: &Load) -> MassMatrix {
        dynamics::mass(&self.chain(q), &self.links_with(load))
    }

    /// Returns the torques of Coriolis and centrifugal forces, `C(q, dq) dq`.
    pub fn coriolis(&self, q: &JointVector, dq: &JointVector, load: &Load) -> JointVector {
        dynamics::coriolis(&self.chain(q), &self.links_with(load), dq)
    }

    /// Returns the torques that hold the arm still against gravity.
    pub fn gravity(
        &self,
        q: &JointVector,
        load: &Load,
        gravity_earth: &Vector3<f64>,
    ) -> JointVector {
        dynamics::gravity(&self.chain(q), &self.links_with(load), gravity_earth)
    }

    /// Returns the torques for the acceleration `ddq`: `M ddq + C dq + g`, by recursive
    /// Newton-Euler.
    pub fn inverse_dynamics(
        &self,
        q: &JointVector,
        dq: &JointVector,
        ddq: &JointVector,
        load: &Load,
        gravity_earth: &Vector3<f64>,
    ) -> JointVector {
        dynamics::inverse_dynamics(
            &self.chain(q),
            &self.links_with(load),
            dq,
            ddq,
            gravity_earth,
        )
    }

    /// Returns the accelerations that the torques `tau` cause: the solution of `(M +
    /// diag(armature)) ddq = tau − C dq − g`.
    ///
    /// `armature` is the reflected rotor inertia of each joint `[kg·m²]`. Returns `None` if the
    /// matrix `M + diag(armature)` is not positive definite. Causes are a number that is not
    /// finite, a negative armature, or a load that is not physical.
    #[allow(clippy::too_many_arguments)] // the terms of the equation of motion
    pub fn forward_dynamics(
        &self,
        q: &JointVector,
        dq: &JointVector,
        tau: &JointVector,
        load: &Load,
        gravity_earth: &Vector3<f64>,
        armature: &JointVector,
    ) -> Option<JointVector> {
        dynamics::forward_dynamics(
            &self.chain(q),
            &self.links_with(load),
            dq,
            tau,
            gravity_earth,
            &MassMatrix::from_diagonal(armature),
        )
    }

    /// Returns all quantities that a control law needs in one cycle, computed in one pass.
    pub fn dynamics(
        &self,
        q: &JointVector,
        dq: &JointVector,
        ee: &EndEffector,
        load: &Load,
        gravity_earth: &Vector3<f64>,
    ) -> Dynamics {
        Dynamics::of(
            &self.chain(q),
            &self.links_with(load),
            dq,
            ee,
            gravity_earth,
        )
    }

    #[inline]
    pub(crate) fn links_with(&self, load: &Load) -> [RigidBody; 7] {
        let mut links = self.links;
        if let Some(load) = load.on_link_7() {
            links[6] = self.merge.join(&links[6], &load);
        }
        links
    }
}
