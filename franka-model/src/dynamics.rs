//! Mass matrix, bias torques, inverse and forward dynamics.
//!
//! The mass matrix and gravity are computed with composite rigid bodies, and the other quantities
//! with recursive Newton-Euler (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 5 and
//! 6). All vectors are in base axes, with the shoulder as reference point. Forces and momenta of
//! different links therefore add up directly, and the torque of a joint is `axis · torque + moment
//! · force`.

use nalgebra::{Cholesky, Matrix4, Vector3};

use crate::bodies::{Composite, com, placed};
use crate::chain::Chain;
use crate::frame::{EndEffector, Frame};
use crate::inertia::{RigidBody, cross, dot};
use crate::jacobian::{Placement, zero_jacobian};
use crate::{Jacobian, JointVector, MassMatrix, Twist};

/// All quantities that a control law needs at one state of the arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dynamics {
    /// Pose of the end effector in the base frame.
    pub pose: Matrix4<f64>,
    /// Zero Jacobian of the end effector.
    pub jacobian: Jacobian,
    /// Joint-space inertia, `[kg·m²]`.
    pub mass: MassMatrix,
    /// Torques of Coriolis and centrifugal forces, `[N·m]`.
    pub coriolis: JointVector,
    /// Torques that hold the arm still against gravity, `[N·m]`.
    pub gravity: JointVector,
    /// `dJ/dt · dq`: the end effector's acceleration while the joints keep their velocity,
    /// `[m/s², rad/s²]`, in base axes.
    pub jdot_dq: Twist,
}

impl Dynamics {
    #[inline(always)]
    pub(crate) fn of(
        chain: &Chain,
        links: &[RigidBody; 7],
        dq: &JointVector,
        ee: &EndEffector,
        gravity_earth: &Vector3<f64>,
    ) -> Self {
        let bodies = placed(chain, links);
        let placement = Placement::of(chain, Frame::EndEffector, ee);
        let (mass, gravity) = mass_and_gravity(chain, &bodies, gravity_earth);
        let motion = LinkMotions::of(chain, dq, None, &Vector3::zeros());
        let tip =
            motion.accelerations[6] + motion.spin[6].times(&(placement.origin - chain.origin[6]));
        let turn = motion.spin[6].angular_acceleration;
        Self {
            pose: placement.pose(),
            jacobian: zero_jacobian(chain, 7, &placement.origin),
            mass,
            coriolis: motion.torques(chain, &bodies),
            gravity,
            jdot_dq: Twist::new(tip.x, tip.y, tip.z, turn.x, turn.y, turn.z),
        }
    }
}

#[inline(always)]
pub(crate) fn mass(chain: &Chain, links: &[RigidBody; 7]) -> MassMatrix {
    mass_and_gravity(chain, &placed(chain, links), &Vector3::zeros()).0
}

#[inline(always)]
fn mass_and_gravity(
    chain: &Chain,
    bodies: &[RigidBody; 7],
    gravity_earth: &Vector3<f64>,
) -> (MassMatrix, JointVector) {
    let mut mass = MassMatrix::zeros();
    let mut gravity = JointVector::zeros();
    let mut outer = Composite::EMPTY;
    for j in (0..7).rev() {
        outer.add(&bodies[j]);
        let (axis, moment) = (&chain.axis[j], &chain.moment[j]);
        let (linear, angular) = outer.momentum(axis, moment);
        for i in 0..=j {
            let shared = dot(&chain.axis[i], &angular) + dot(&chain.moment[i], &linear);
            mass[(i, j)] = shared;
            mass[(j, i)] = shared;
        }
        gravity[j] = -dot(&linear, gravity_earth);
    }
    (mass, gravity)
}

#[inline(always)]
pub(crate) fn gravity(
    chain: &Chain,
    links: &[RigidBody; 7],
    gravity_earth: &Vector3<f64>,
) -> JointVector {
    let mut gravity = JointVector::zeros();
    let mut mass = 0.0;
    let mut first_moment = Vector3::zeros();
    for j in (0..7).rev() {
        mass += links[j].mass;
        first_moment += com(chain, links, j) * links[j].mass;
        // The power of gravity at unit joint velocity: momentum times acceleration.
        let linear = chain.moment[j] * mass + cross(&chain.axis[j], &first_moment);
        gravity[j] = -dot(&linear, gravity_earth);
    }
    gravity
}

#[inline(always)]
pub(crate) fn coriolis(chain: &Chain, links: &[RigidBody; 7], dq: &JointVector) -> JointVector {
    LinkMotions::of(chain, dq, None, &Vector3::zeros()).torques(chain, &placed(chain, links))
}

#[inline(always)]
pub(crate) fn inverse_dynamics(
    chain: &Chain,
    links: &[RigidBody; 7],
    dq: &JointVector,
    ddq: &JointVector,
    gravity_earth: &Vector3<f64>,
) -> JointVector {
    LinkMotions::of(chain, dq, Some(ddq), gravity_earth).torques(chain, &placed(chain, links))
}

pub(crate) fn forward_dynamics(
    chain: &Chain,
    links: &[RigidBody; 7],
    dq: &JointVector,
    tau: &JointVector,
    gravity_earth: &Vector3<f64>,
    armature: &MassMatrix,
) -> Option<JointVector> {
    let bodies = placed(chain, links);
    let (mass, gravity) = mass_and_gravity(chain, &bodies, gravity_earth);
    let coriolis = LinkMotions::of(chain, dq, None, &Vector3::zeros()).torques(chain, &bodies);
    let factor = Cholesky::new(mass + armature)?;
    Some(factor.solve(&(tau - coriolis - gravity)))
}

/// Rotation of a body: maps a vector that is fixed in the body to the acceleration of the vector's
/// tip.
#[derive(Clone, Copy)]
struct Spin {
    angular_acceleration: Vector3<f64>,
    angular_velocity: Vector3<f64>,
}

impl Spin {
    /// Returns `α × r + ω × (ω × r)`.
    #[inline(always)]
    fn times(&self, r: &Vector3<f64>) -> Vector3<f64> {
        let w = &self.angular_velocity;
        cross(&self.angular_acceleration, r) + cross(w, &cross(w, r))
    }
}

/// Velocities and accelerations of the seven link frames, in base axes.
struct LinkMotions {
    /// Acceleration of each frame's origin, minus gravity.
    accelerations: [Vector3<f64>; 7],
    spin: [Spin; 7],
}

impl LinkMotions {
    /// Runs the outward recursion; `ddq` is zero if it is `None`.
    #[inline(always)]
    fn of(
        chain: &Chain,
        dq: &JointVector,
        ddq: Option<&JointVector>,
        gravity_earth: &Vector3<f64>,
    ) -> Self {
        let zero = Vector3::zeros();
        let mut spin = Spin {
            angular_acceleration: zero,
            angular_velocity: zero,
        };
        let mut acceleration = -gravity_earth;
        let mut origin = zero;
        let mut motion = Self {
            accelerations: [zero; 7],
            spin: [spin; 7],
        };
        for i in 0..7 {
            acceleration += spin.times(&(chain.origin[i] - origin));
            origin = chain.origin[i];
            let rate = chain.axis[i] * dq[i];
            spin.angular_acceleration += cross(&spin.angular_velocity, &rate);
            if let Some(ddq) = ddq {
                spin.angular_acceleration += chain.axis[i] * ddq[i];
            }
            spin.angular_velocity += rate;
            motion.accelerations[i] = acceleration;
            motion.spin[i] = spin;
        }
        motion
    }

    /// Runs the inward recursion, and returns the joint torques for this motion.
    #[inline(always)]
    fn torques(&self, chain: &Chain, bodies: &[RigidBody; 7]) -> JointVector {
        let mut torques = JointVector::zeros();
        let mut force = Vector3::zeros();
        let mut torque = Vector3::zeros();
        for i in (0..7).rev() {
            let (body, spin) = (&bodies[i], &self.spin[i]);
            let w = &spin.angular_velocity;
            let inertial =
                (self.accelerations[i] + spin.times(&(body.com - chain.origin[i]))) * body.mass;
            force += inertial;
            torque += cross(&body.com, &inertial)
                + body.inertia.times(&spin.angular_acceleration)
                + cross(w, &body.inertia.times(w));
            torques[i] = dot(&chain.axis[i], &torque) + dot(&chain.moment[i], &force);
        }
        torques
    }
}
