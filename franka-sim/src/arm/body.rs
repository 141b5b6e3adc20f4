//! True links, axes, load and mounting.

use franka_model::{AsBuilt, JointVector, Load, RobotKind, joint_vector};
use nalgebra::{Isometry3, Vector3};

use super::{StateGeometry, SystemLimits};

/// Differences between the arm's body and the controllers' model, and between the controllers'
/// model and the clients' model. The robot computes its control and its state with
/// [`state_geometry`](Self::state_geometry). The physics and all touches use this geometry plus the
/// errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Relative error of each link's mass. The link's inertia has the same relative error. Source:
    /// a third to a half of the torque residuals at rest depends on the pose, because all robots
    /// share one averaged model (franka_ros issue 404).
    pub mass_error: [f64; 7],
    /// Error of each link's centre of mass in the link's axes, `[m]`. Source: see
    /// [`mass_error`](Self::mass_error).
    pub com_error: [Vector3<f64>; 7],
    /// Geometry that `O_T_EE`, the robot's controllers and the served description use.
    pub state_geometry: StateGeometry,
    /// Pose of each joint's true frame, relative to the joint's frame in `state_geometry`. `O_T_EE`
    /// does not show this error. Source: MUKCa (TU Delft), five Pandas: 1 to 5 mrad, 0.2 to 1 mm.
    /// The rotation about a joint's own axis is an error of its zero position.
    pub kinematic_error: [Isometry3<f64>; 7],
    /// Undeclared mass on the flange in addition to tool and payload, `[kg]`, at the centre of mass
    /// of the tool. Source: on two FERs, the sag at the start of a session is too small for 0.2 kg.
    pub undeclared_mass: f64,
    /// Error of the tool's centre of mass in the flange frame, `[m]`. The default is an estimate,
    /// not a measurement.
    pub load_com_error: Vector3<f64>,
    /// Gravitational acceleration in the base frame, `[m/s²]`. Only the physics uses it. The
    /// controllers' model and the state (`O_ddP_O`) assume an upright arm. With the gravity of
    /// another mounting, the controllers estimate a load that does not exist. See
    /// [`tilted`](Self::tilted).
    pub gravity_earth: Vector3<f64>,
    /// Mechanical end stops.
    pub stops: EndStops,
}

impl Body {
    /// An upright arm that equals its model.
    pub fn exact(kind: RobotKind) -> Self {
        // The mechanics do not depend on the system version, so the stops are outside the widest
        // limits.
        let limits = SystemLimits::default().joints(kind);
        Self {
            mass_error: [0.0; 7],
            com_error: [Vector3::zeros(); 7],
            state_geometry: StateGeometry::DESCRIBED,
            kinematic_error: [Isometry3::identity(); 7],
            undeclared_mass: 0.0,
            load_com_error: Vector3::zeros(),
            gravity_earth: franka_model::GRAVITY_EARTH,
            stops: EndStops::around(&limits.hard_lower, &limits.hard_upper),
        }
    }

    /// Tilts the base by this rotation vector from the upright position, `[rad]`. We estimate that
    /// real mountings tilt by 0.25 degrees about each horizontal axis.
    #[must_use]
    pub fn tilted(mut self, rotation: Vector3<f64>) -> Self {
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(rotation);
        self.gravity_earth = turn.inverse() * franka_model::GRAVITY_EARTH;
        self
    }

    /// Returns the geometry and inertia of the arm with these links and axes.
    pub fn as_built(&self, kind: RobotKind) -> AsBuilt {
        let exact = AsBuilt::exactly(&self.state_geometry.model(kind));
        let mut links = *exact.links();
        for ((link, error), shift) in links.iter_mut().zip(self.mass_error).zip(self.com_error) {
            *link = link.scaled(1.0 + error);
            link.com += shift;
        }
        exact
            .with_links(links)
            .with_deviations(&self.kinematic_error)
    }

    /// Returns the total load on the flange: this tool, this payload and the undeclared mass.
    pub(crate) fn load(&self, tool: &Load, payload: &Load) -> Load {
        let carried = Load {
            mass: tool.mass + self.undeclared_mass,
            com: tool.com + self.load_com_error,
            inertia: tool.inertia,
        };
        carried.combine(payload)
    }
}

/// A stiff spring and damper beyond each end of a joint's range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStops {
    /// Start of the lower stops, `[rad]`.
    pub lower: JointVector,
    /// Start of the upper stops, `[rad]`.
    pub upper: JointVector,
    /// Stiffness of the stops, `[N·m/rad]`.
    pub stiffness: f64,
    /// Damping of the stops, `[N·m·s/rad]`.
    pub damping: f64,
}

/// Distance of the mechanical stops outside the limits that the interface enforces, `[rad]`.
const CLEARANCE: f64 = 0.04;

impl EndStops {
    /// End stops of an arm whose interface enforces the joint limits `lower` and `upper`, `[rad]`.
    ///
    /// Clearance, stiffness and damping are choices of the simulator. The strongest joint moves
    /// 0.03 rad into its stop at 87 N·m.
    pub fn around(lower: &JointVector, upper: &JointVector) -> Self {
        Self {
            lower: lower.add_scalar(-CLEARANCE),
            upper: upper.add_scalar(CLEARANCE),
            stiffness: 3000.0,
            damping: 30.0,
        }
    }

    /// No stops. The joints turn without limits.
    pub const NONE: Self = Self {
        lower: joint_vector([f64::NEG_INFINITY; 7]),
        upper: joint_vector([f64::INFINITY; 7]),
        stiffness: 0.0,
        damping: 0.0,
    };

    /// Returns the stops' torques over a step of `dt` seconds that begins at `q`, `dq`, `[N·m]`.
    /// The caller subtracts them. The second value is the increase of these torques per velocity at
    /// the end of the step, `[N·m·s/rad]`.
    pub(crate) fn resistance(
        &self,
        q: &JointVector,
        dq: &JointVector,
        dt: f64,
    ) -> (JointVector, JointVector) {
        let (mut torque, mut slope) = (JointVector::zeros(), JointVector::zeros());
        for i in 0..7 {
            let depth = self.depth(i, q[i] + dt * dq[i]);
            if depth != 0.0 {
                torque[i] = self.stiffness * depth + self.damping * dq[i];
                slope[i] = self.damping + dt * self.stiffness;
            }
        }
        (torque, slope)
    }

    /// Depth of joint `i` at `q` in a stop: negative in the lower stop, positive in the upper stop,
    /// `[rad]`.
    fn depth(&self, i: usize, q: f64) -> f64 {
        (q - self.upper[i]).max(0.0) + (q - self.lower[i]).min(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_act_outside_the_enforced_range_only() {
        let stops = EndStops::around(&JointVector::repeat(-1.0), &JointVector::repeat(1.0));
        assert_eq!(stops.depth(0, 1.03), 0.0);
        assert_eq!(stops.depth(0, -1.03), 0.0);
        assert!((stops.depth(0, 1.05) - 0.01).abs() < 1e-12);
        assert!((stops.depth(0, -1.05) + 0.01).abs() < 1e-12);
        assert_eq!(EndStops::NONE.depth(3, 100.0), 0.0);
    }

    #[test]
    fn a_tilted_base_turns_gravity() {
        let body = Body::exact(RobotKind::Fr3).tilted(Vector3::new(0.1, 0.0, 0.0));
        let gravity = body.gravity_earth;
        let size = franka_model::GRAVITY_EARTH.norm();
        assert!((gravity.norm() - size).abs() < 1e-12);
        assert!(
            (gravity.y + size * 0.1_f64.sin()).abs() < 1e-12,
            "{gravity}"
        );
    }
}
