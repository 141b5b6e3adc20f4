//! The settings of a client: frames, load, stiffnesses, thresholds.

use franka_model::{EndEffector, JointVector, Load, Twist, transform};
use franka_proto::{CollisionBehavior, Filters, Request, SetterStatus};
use nalgebra::{Matrix3, Matrix4, Vector3};

use crate::config::{SetterBounds, Tool, Unpublished};

/// Current settings. They persist after the client that set them disconnects, as on a real robot.
#[derive(Debug, Clone)]
pub(crate) struct Settings {
    pub(crate) tool: Tool,
    /// Pose of the end effector in the nominal end effector frame, `NE_T_EE`.
    pub(crate) ne_t_ee: Matrix4<f64>,
    /// Frames `F_T_EE` and `EE_T_K`.
    pub(crate) frames: EndEffector,
    /// Load that a client declared by `SetLoad`.
    pub(crate) load: Load,
    /// Stiffness of the joint impedance controller, `[N·m/rad]`.
    pub(crate) joint_stiffness: JointVector,
    /// Stiffness of the Cartesian impedance controller in stiffness-frame axes, `[N/m, N·m/rad]`.
    pub(crate) cartesian_stiffness: Twist,
    pub(crate) thresholds: CollisionBehavior,
    pub(crate) guiding: Guiding,
    /// Filters of commands; `None` for no filter.
    pub(crate) filters: Option<Filters>,
    bounds: SetterBounds,
}

/// The directions in which a person may guide the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Guiding {
    /// Translation along the axes of the end effector, and rotation about them.
    pub(crate) axes: [bool; 6],
    /// Motion of the elbow that does not move the end effector.
    pub(crate) elbow: bool,
}

impl Guiding {
    pub(crate) const FREE: Self = Self {
        axes: [true; 6],
        elbow: true,
    };
}

impl Settings {
    /// Factory settings with a tool mounted.
    pub(crate) fn new(tool: Tool, factory: &Unpublished) -> Self {
        Self {
            tool,
            ne_t_ee: Matrix4::identity(),
            frames: EndEffector {
                f_t_ee: tool.f_t_ne,
                ee_t_k: Matrix4::identity(),
            },
            load: Load::NONE,
            joint_stiffness: factory.joint_stiffness,
            cartesian_stiffness: factory.cartesian_stiffness,
            thresholds: factory.thresholds,
            guiding: Guiding::FREE,
            filters: factory.command_filter.map(Filters::uniform),
            bounds: factory.setter_bounds,
        }
    }

    /// Load on the flange that the controllers' model assumes.
    pub(crate) fn declared_load(&self) -> Load {
        self.tool.load.combine(&self.load)
    }

    /// Applies a setter (a request that changes a setting). Returns its status: success, or the
    /// reason for refusing it.
    pub(crate) fn apply(&mut self, request: &Request) -> SetterStatus {
        let applied = match request {
            Request::SetCollisionBehavior(thresholds) => {
                are_thresholds(thresholds).then(|| self.thresholds = *thresholds)
            }
            Request::SetJointImpedance(stiffness) => all_within(stiffness, 0.0, 14250.0)
                .then(|| self.joint_stiffness = JointVector::from(*stiffness)),
            Request::SetCartesianImpedance(stiffness) => {
                let (linear, angular) = stiffness.split_at(3);
                (all_within(linear, 10.0, 3000.0) && all_within(angular, 1.0, 300.0))
                    .then(|| self.cartesian_stiffness = Twist::from(*stiffness))
            }
            Request::SetGuidingMode {
                guiding_mode,
                nullspace,
            } => {
                self.guiding = Guiding {
                    axes: *guiding_mode,
                    elbow: *nullspace,
                };
                Some(())
            }
            Request::SetEEToK(matrix) => {
                rigid(matrix, &self.bounds).map(|m| self.frames.ee_t_k = m)
            }
            Request::SetNEToEE(matrix) => rigid(matrix, &self.bounds).map(|m| {
                self.ne_t_ee = m;
                self.frames.f_t_ee = self.tool.f_t_ne * m;
            }),
            Request::SetFilters(filters) => {
                are_filters(filters).then(|| self.filters = Some(*filters))
            }
            Request::SetLoad(load) => physical(load, &self.bounds).map(|load| self.load = load),
            _ => None,
        };
        match applied {
            Some(()) => SetterStatus::Success,
            None => SetterStatus::InvalidArgumentRejected,
        }
    }
}

fn all_within(values: &[f64], lower: f64, upper: f64) -> bool {
    values.iter().all(|value| (lower..=upper).contains(value))
}

/// Returns true if the cutoff frequencies are in their documented range, `[Hz]`.
fn are_filters(filters: &Filters) -> bool {
    let frequencies = [
        filters.joint_position_filter_frequency,
        filters.joint_velocity_filter_frequency,
        filters.cartesian_position_filter_frequency,
        filters.cartesian_velocity_filter_frequency,
        filters.controller_filter_frequency,
    ];
    all_within(&frequencies, 1.0, 1000.0)
}

/// Returns true if all thresholds are finite and not negative. A threshold of zero is always
/// reached. Upper thresholds below the lower thresholds are valid: a collision then occurs without
/// an earlier contact.
fn are_thresholds(thresholds: &CollisionBehavior) -> bool {
    let t = thresholds;
    let torques = [
        &t.lower_torque_thresholds_acceleration,
        &t.upper_torque_thresholds_acceleration,
        &t.lower_torque_thresholds_nominal,
        &t.upper_torque_thresholds_nominal,
    ];
    let forces = [
        &t.lower_force_thresholds_acceleration,
        &t.upper_force_thresholds_acceleration,
        &t.lower_force_thresholds_nominal,
        &t.upper_force_thresholds_nominal,
    ];
    torques
        .into_iter()
        .flatten()
        .chain(forces.into_iter().flatten())
        .all(|value| value.is_finite() && *value >= 0.0)
}

/// Returns the matrix if it is a rigid transform within the bounds.
fn rigid(column_major: &[f64; 16], bounds: &SetterBounds) -> Option<Matrix4<f64>> {
    let pose = transform::isometry_from_array(column_major)?;
    let is_near = pose.translation.vector.norm() <= bounds.translation;
    is_near.then(|| Matrix4::from_column_slice(column_major))
}

/// Returns the load if it is physically possible for a rigid body and within the bounds. The mass
/// must not be negative, and the inertia must be symmetric. No principal moment may be below zero
/// or, except for rounding, above the sum of the other two.
fn physical(load: &franka_proto::Load, bounds: &SetterBounds) -> Option<Load> {
    let inertia = Matrix3::from_column_slice(&load.I_load);
    let com = Vector3::from(load.F_x_Cload);
    let finite = load.m_load.is_finite()
        && com.iter().all(|x| x.is_finite())
        && inertia.iter().all(|x| x.is_finite());
    if !finite || !(0.0..=bounds.mass).contains(&load.m_load) || com.norm() > bounds.com {
        return None;
    }
    let tolerance = 1e-9 + 1e-6 * inertia.amax();
    let is_symmetric = (inertia - inertia.transpose()).amax() <= tolerance;
    if !is_symmetric || inertia.amax() > bounds.inertia {
        return None;
    }
    let moments = inertia.symmetric_eigenvalues();
    let is_of_a_body =
        moments.min() >= -tolerance && 2.0 * moments.max() <= moments.sum() + tolerance;
    (is_of_a_body && moments.max() <= bounds.inertia).then_some(Load {
        mass: load.m_load,
        com,
        inertia,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const INVALID: SetterStatus = SetterStatus::InvalidArgumentRejected;

    fn factory(tool: Tool) -> Settings {
        Settings::new(tool, &Unpublished::default())
    }

    fn identity() -> [f64; 16] {
        let mut matrix = [0.0; 16];
        for i in 0..4 {
            matrix[5 * i] = 1.0;
        }
        matrix
    }

    #[test]
    fn stiffnesses_have_the_documented_ranges() {
        let mut settings = factory(Tool::NONE);
        for (value, status) in [
            (0.0, SetterStatus::Success),
            (14250.0, SetterStatus::Success),
            (14250.1, INVALID),
            (-1.0, INVALID),
            (f64::NAN, INVALID),
        ] {
            let request = Request::SetJointImpedance([value; 7]);
            assert_eq!(settings.apply(&request), status, "{value}");
        }
        for (linear, angular, status) in [
            (10.0, 1.0, SetterStatus::Success),
            (3000.0, 300.0, SetterStatus::Success),
            (9.0, 1.0, INVALID),
            (10.0, 301.0, INVALID),
        ] {
            let (l, a) = (linear, angular);
            let request = Request::SetCartesianImpedance([l, l, l, a, a, a]);
            assert_eq!(settings.apply(&request), status);
        }
    }

    #[test]
    fn filters_have_the_documented_range() {
        let mut settings = factory(Tool::NONE);
        for (frequency, status) in [
            (1.0, SetterStatus::Success),
            (1000.0, SetterStatus::Success),
            (0.9, INVALID),
            (1000.1, INVALID),
            (f64::NAN, INVALID),
        ] {
            let mut filters = Filters::uniform(100.0);
            filters.controller_filter_frequency = frequency;
            let request = Request::SetFilters(filters);
            assert_eq!(settings.apply(&request), status, "{frequency}");
        }
    }

    #[test]
    fn a_refused_value_leaves_the_old_one() {
        let mut settings = factory(Tool::NONE);
        let before = settings.joint_stiffness;
        settings.apply(&Request::SetJointImpedance([1e6; 7]));
        assert_eq!(settings.joint_stiffness, before);
    }

    #[test]
    fn frames_have_to_be_rigid_transforms() {
        let mut settings = factory(Tool::hand());
        let mut shifted = identity();
        shifted[14] = 0.1;
        assert_eq!(
            settings.apply(&Request::SetNEToEE(shifted)),
            SetterStatus::Success
        );
        assert!((settings.frames.f_t_ee[(2, 3)] - 0.2034).abs() < 1e-12);
        let mut mirrored = identity();
        mirrored[0] = -1.0;
        assert_eq!(settings.apply(&Request::SetEEToK(mirrored)), INVALID);
        let mut projective = identity();
        projective[3] = 0.1;
        assert_eq!(settings.apply(&Request::SetNEToEE(projective)), INVALID);
    }

    #[test]
    fn loads_have_to_be_physical() {
        let mut settings = factory(Tool::NONE);
        let good = franka_proto::Load {
            m_load: 1.0,
            F_x_Cload: [0.0, 0.0, 0.1],
            I_load: [0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01],
        };
        assert_eq!(
            settings.apply(&Request::SetLoad(good)),
            SetterStatus::Success
        );
        assert_eq!(settings.declared_load().mass, 1.0);
        let mut light = good;
        light.m_load = -0.1;
        assert_eq!(settings.apply(&Request::SetLoad(light)), INVALID);
        let mut odd = good;
        odd.I_load[8] = -0.01;
        assert_eq!(settings.apply(&Request::SetLoad(odd)), INVALID);
        // This moment is larger than the sum of the other two.
        odd.I_load[8] = 0.03;
        assert_eq!(settings.apply(&Request::SetLoad(odd)), INVALID);
    }

    #[test]
    fn thresholds_must_be_finite_and_not_negative() {
        let mut settings = factory(Tool::NONE);
        let mut thresholds = settings.thresholds;
        thresholds.upper_force_thresholds_nominal[2] = f64::INFINITY;
        let request = Request::SetCollisionBehavior(thresholds);
        assert_eq!(settings.apply(&request), INVALID);
        thresholds.upper_force_thresholds_nominal[2] = 0.0;
        let request = Request::SetCollisionBehavior(thresholds);
        assert_eq!(settings.apply(&request), SetterStatus::Success);
    }
}
