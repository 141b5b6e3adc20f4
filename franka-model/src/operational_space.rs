//! The apparent inertia at the end effector, or at another point of the arm.
//!
//! The apparent mass at a point of the arm depends on the posture and on the direction of a push.
//! The operational space formulation (Khatib, IEEE Journal on Robotics and Automation 3(1), 1987;
//! effective mass: Khatib, International Journal of Robotics Research 14(1), 1995) describes this
//! mass with the Jacobian `J` of the point and the joint-space inertia `M`:
//!
//! - `J M⁻¹ Jᵀ` is the **mobility**: the acceleration of the point per wrench. The mobility exists
//!   at every posture.
//! - Its inverse is the **operational-space inertia** `Λ`: the wrench per acceleration, if the
//!   point has *exactly* this acceleration in all six components. `Λ` does not exist in a
//!   singularity.
//! - The **effective mass** along a direction `u` is `1 / (uᵀ J M⁻¹ Jᵀ u)`. It is the inertia that
//!   a force along `u` feels while the point is free to move in every direction. The effective mass
//!   never exceeds the value of `Λ` in the same direction.

use nalgebra::{Cholesky, Matrix3, SMatrix, UnitVector3, Vector3};

use crate::{Dynamics, EndEffector, Frame, Jacobian, JointVector, Load, MassMatrix, Model, Twist};

/// A 6×6 matrix. Rows and columns are ordered `[linear; angular]`.
pub type Matrix6 = SMatrix<f64, 6, 6>;

/// Response of a point of the arm to wrenches, in the axes of the point's Jacobian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperationalSpace {
    mobility: Matrix6,
}

impl OperationalSpace {
    /// Creates the operational space of a point from its Jacobian and from the arm's joint-space
    /// inertia.
    ///
    /// The point is the origin of the Jacobian's frame. All results are in the axes of the
    /// Jacobian, which are base axes for a zero Jacobian. For another point of the last link,
    /// change [`EndEffector::f_t_ee`].
    ///
    /// Returns `None` if `mass` is not positive definite. The matrix of a physical arm always is.
    pub fn new(jacobian: &Jacobian, mass: &MassMatrix) -> Option<Self> {
        // With M = L Lᵀ, the mobility is a product of a matrix and its transpose, so it is
        // symmetric to the last digit.
        let factor = Cholesky::new(*mass)?;
        let root = factor
            .l_dirty()
            .solve_lower_triangular(&jacobian.transpose())?;
        Some(Self {
            mobility: root.tr_mul(&root),
        })
    }

    /// Returns `J M⁻¹ Jᵀ`: acceleration `[m/s², rad/s²]` per wrench `[N, N·m]`, if no other joint
    /// torques act.
    pub fn mobility(&self) -> &Matrix6 {
        &self.mobility
    }

    /// Returns `Λ`, the inverse of the mobility: the wrench per acceleration if all six components
    /// are prescribed. Returns `None` in a singularity.
    pub fn inertia(&self) -> Option<Matrix6> {
        Cholesky::new(self.mobility).map(|factor| factor.inverse())
    }

    /// Returns `(Jv M⁻¹ Jvᵀ)⁻¹`, `[kg]`: the force per acceleration of the point, if the body may
    /// rotate freely. Returns `None` if the point cannot move in some direction.
    pub fn translational_inertia(&self) -> Option<Matrix3<f64>> {
        let block: Matrix3<f64> = self.mobility.fixed_view::<3, 3>(0, 0).into();
        Cholesky::new(block).map(|factor| factor.inverse())
    }

    /// Returns `(Jw M⁻¹ Jwᵀ)⁻¹`, `[kg·m²]`: the torque per angular acceleration, if the point may
    /// move freely. Returns `None` if the body cannot turn about some axis.
    pub fn rotational_inertia(&self) -> Option<Matrix3<f64>> {
        let block: Matrix3<f64> = self.mobility.fixed_view::<3, 3>(3, 3).into();
        Cholesky::new(block).map(|factor| factor.inverse())
    }

    /// Returns the effective mass along `direction`, `[kg]`: a force along `direction` divided by
    /// the point's acceleration along `direction`. The mass is infinite if the point cannot move in
    /// this direction.
    pub fn effective_mass(&self, direction: &UnitVector3<f64>) -> f64 {
        self.effective_inertia(&Self::twist(direction, &Vector3::zeros()))
    }

    /// Returns the effective moment of inertia about `axis` through the point, `[kg·m²]`.
    pub fn effective_moment(&self, axis: &UnitVector3<f64>) -> f64 {
        self.effective_inertia(&Self::twist(&Vector3::zeros(), axis))
    }

    /// Returns the effective inertia along a unit twist `u`, such as a screw motion: `1 / (uᵀ J M⁻¹
    /// Jᵀ u)`.
    pub fn effective_inertia(&self, unit: &Twist) -> f64 {
        unit.dot(&(self.mobility * unit)).recip()
    }

    fn twist(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Twist {
        Twist::new(
            linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
        )
    }
}

impl Model {
    /// Returns the operational space of the origin of `frame`, in base axes. Returns `None` if the
    /// load is not physical; see [`OperationalSpace::new`].
    pub fn operational_space(
        &self,
        frame: Frame,
        q: &JointVector,
        ee: &EndEffector,
        load: &Load,
    ) -> Option<OperationalSpace> {
        OperationalSpace::new(&self.zero_jacobian(frame, q, ee), &self.mass(q, load))
    }
}

impl Dynamics {
    /// Returns the operational space of the end effector, in base axes.
    pub fn operational_space(&self) -> Option<OperationalSpace> {
        OperationalSpace::new(&self.jacobian, &self.mass)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::known_numbers::{hand, hand_load};
    use crate::merge::Merge;
    use crate::random::Random;
    use crate::{GRAVITY_EARTH, READY, Wrench};

    /// Effective inertias along and about x, y and z, the diagonal of the translational inertia,
    /// and the diagonal of Λ.
    type Row = ([f64; 6], [f64; 3], [f64; 6]);

    #[track_caller]
    fn assert_row(model: &Model, frame: Frame, load: &Load, (along, translational, full): Row) {
        let space = model.operational_space(frame, &READY, &hand(), load);
        let space = space.expect("a physical arm");
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let diagonals = (
            space.translational_inertia().expect("regular").diagonal(),
            space.inertia().expect("regular").diagonal(),
        );
        // The expected values have only six digits.
        for i in 0..3 {
            assert!((space.effective_mass(&axes[i]) - along[i]).abs() < 6e-7);
            assert!((space.effective_moment(&axes[i]) - along[3 + i]).abs() < 6e-7);
            assert!((diagonals.0[i] - translational[i]).abs() < 6e-7);
        }
        for (got, want) in diagonals.1.iter().zip(full) {
            assert!((got - want).abs() < 6e-7, "{got} is not {want}");
        }
    }

    /// The values were computed from the same parameters with Pinocchio 4.1.
    #[test]
    fn the_fr3_at_the_ready_posture() {
        let (model, none, payload) = (Model::fr3(), &Load::NONE, &hand_load());
        assert_row(
            model,
            Frame::Flange,
            none,
            (
                [1.861148, 1.807234, 2.903331, 0.025363, 0.024392, 0.000113],
                [2.429741, 1.816110, 3.806606],
                [10.686688, 3.866975, 4.641605, 0.054992, 0.166566, 0.000119],
            ),
        );
        assert_row(
            model,
            Frame::EndEffector,
            none,
            (
                [0.539740, 0.596159, 2.903331, 0.025363, 0.024392, 0.000113],
                [0.772415, 0.602225, 4.190225],
                [10.686688, 3.866975, 4.641605, 0.165734, 0.523342, 0.000119],
            ),
        );
        assert_row(
            model,
            Frame::Flange,
            payload,
            (
                [3.112750, 2.852305, 3.971772, 0.035463, 0.039900, 0.001857],
                [3.561205, 2.859148, 4.551361],
                [11.416688, 4.596975, 5.371605, 0.057436, 0.169009, 0.001892],
            ),
        );
        assert_row(
            model,
            Frame::EndEffector,
            payload,
            (
                [0.919318, 0.951865, 3.971772, 0.035463, 0.039900, 0.001857],
                [1.135479, 0.958419, 4.929448],
                [11.416688, 4.596975, 5.371605, 0.171453, 0.529062, 0.001892],
            ),
        );
    }

    /// The values were computed in the same way, with the rigid composition of link and load, which
    /// the vendor's library does not use.
    #[test]
    fn the_fer_at_the_ready_posture() {
        let rigid = Model {
            merge: Merge::Rigid,
            ..Model::fer().clone()
        };
        assert_row(
            &rigid,
            Frame::Flange,
            &Load::NONE,
            (
                [1.172155, 0.447401, 2.728217, 0.003623, 0.014359, 0.000674],
                [1.866250, 0.578262, 3.580085],
                [10.308394, 3.511746, 4.342777, 0.034234, 0.154752, 0.001272],
            ),
        );
        assert_row(
            &rigid,
            Frame::EndEffector,
            &hand_load(),
            (
                [0.746214, 0.448110, 3.798984, 0.014423, 0.031945, 0.002587],
                [0.954371, 0.486957, 4.641412],
                [11.038394, 4.241746, 5.072777, 0.140338, 0.505455, 0.003045],
            ),
        );
    }

    #[test]
    fn a_wrench_accelerates_the_arm_as_the_mobility_says() {
        let mut random = Random::new(61);
        let model = Model::fr3();
        for _ in 0..1000 {
            let (q, load, ee) = (random.posture(model), random.load(), hand());
            let still = JointVector::zeros();
            let wrench = Wrench::from_fn(|_, _| random.uniform(-10.0, 10.0));
            let jacobian = model.zero_jacobian(Frame::EndEffector, &q, &ee);
            let held = model.gravity(&q, &load, &GRAVITY_EARTH);
            let pushed = held + jacobian.tr_mul(&wrench);
            let ddq = model
                .forward_dynamics(&q, &still, &pushed, &load, &GRAVITY_EARTH, &still)
                .expect("a physical arm");
            let space = model.operational_space(Frame::EndEffector, &q, &ee, &load);
            let expected = space.expect("a physical arm").mobility() * wrench;
            let error = (jacobian * ddq - expected).norm();
            assert!(error < 1e-10 * expected.norm(), "{error}");
        }
    }

    #[test]
    fn the_effective_mass_is_at_most_what_the_inertia_says() {
        let mut random = Random::new(62);
        for _ in 0..1000 {
            let q = random.posture(Model::fr3());
            let none = EndEffector::default();
            let dynamics = Model::fr3().dynamics(
                &q,
                &JointVector::zeros(),
                &none,
                &random.load(),
                &GRAVITY_EARTH,
            );
            let space = dynamics.operational_space().expect("a physical arm");
            let direction = UnitVector3::new_normalize(random.vector3(1.0));
            let mass = space.effective_mass(&direction);
            let free = space.translational_inertia().expect("regular");
            let full = space.inertia().expect("regular");
            let full = full.fixed_view::<3, 3>(0, 0) * direction.into_inner();
            let along = |force: Vector3<f64>| direction.dot(&force);
            assert!(mass <= along(free * direction.into_inner()) * (1.0 + 1e-9));
            assert!(along(free * direction.into_inner()) <= along(full) * (1.0 + 1e-9));
        }
    }

    #[test]
    fn effective_mass_is_infinite_along_a_lost_direction() {
        // Joint 1 turns its frame about z and does not move its origin.
        let still = EndEffector::default();
        let space = Model::fr3()
            .operational_space(Frame::Joint1, &READY, &still, &Load::NONE)
            .expect("a physical arm");
        assert_eq!(space.effective_mass(&Vector3::x_axis()), f64::INFINITY);
        assert!(space.effective_moment(&Vector3::z_axis()).is_finite());
        assert_eq!(
            (space.inertia(), space.translational_inertia()),
            (None, None)
        );
        assert_eq!(space.rotational_inertia(), None);
    }

    #[test]
    fn a_mass_matrix_that_is_none_has_no_operational_space() {
        let jacobian = Jacobian::zeros();
        assert!(OperationalSpace::new(&jacobian, &-MassMatrix::identity()).is_none());
        assert!(OperationalSpace::new(&jacobian, &(MassMatrix::identity() * f64::NAN)).is_none());
    }
}
