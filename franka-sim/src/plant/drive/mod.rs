//! The drive train of an arm. It converts motor torques to the torques on the links.
//!
//! ```text
//!  command ── − offset ──> torque loop, rotor ──> spring, damper ──┬──> link (the plant)
//!                          ripple, friction       T: tau_J reads   └ friction, torque by pose
//! ```
//!
//! The plant solves `(M + inertia + dt·damping + slope) q̈ = torque + external − bias − stops` with
//! the torque, inertia and damping of [`LinkTorque`], and the torque and slope of [`External`].
//!
//! With rigid joints, the apparent rotor inertia `B` and all friction act on the link. With elastic
//! joints of stiffness `K` and damping `D`, the step is implicit. Over a step of `h` seconds, with
//! `s = h·D + h²·K` and `T0 = K (θ − q + h (θ̇ − q̇)) + D (θ̇ − q̇)`, the torque between gear and
//! link is
//!
//! ```text
//! T = T0 + s (τ − f − T0)/(B + s) − (s B/(B + s)) q̈
//! ```
//!
//! for a motor torque `τ` minus its friction `f`. For the plant, the drive is therefore a known
//! torque and an inertia, which is `B` for a stiff spring. The acceleration of the plant then
//! determines the acceleration of the rotor.
//!
//! The torque loop makes `T` follow the command. It has a proportional gain `k` and a sensor
//! without delay. The apparent rotor inertia is then `B/(1 + k)`, and the loop reduces disturbances
//! of the rotor by the same factor. The parameters of friction and ripple already include this
//! reduction.

mod friction;
#[cfg(test)]
mod tests;

use franka_model::JointVector;

use super::{External, Plant};
use crate::arm::{Arm, Drive};
use friction::{Contact, Tangent};

/// Effect of the drives on the links in one step: `torque − (inertia + dt·damping) · q̈`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkTorque {
    /// Torque on the links, `[N·m]`.
    pub torque: JointVector,
    /// Inertia that turns with the links, `[kg·m²]`.
    pub inertia: JointVector,
    /// Resistance to the change of the links' velocities in the step, `[N·m·s/rad]`.
    pub damping: JointVector,
}

/// The drives of the seven joints, and the friction on both sides of their torque sensors.
#[derive(Debug, Clone)]
pub struct DriveTrain {
    drive: Drive,
    felt_inertia: JointVector,
    torque_offset: JointVector,
    motor_contacts: [Option<Contact>; 7],
    link_contacts: [Option<Contact>; 7],
    /// Angle and velocity of the motors, as angles of the joints. For rigid joints, they equal the
    /// angle and velocity of the links.
    theta: JointVector,
    dtheta: JointVector,
    /// Torques between gears and links over the last step.
    torque: JointVector,
}

impl DriveTrain {
    /// Returns the drives of `arm` at rest, with links at `q`, `[rad]`. The torques `holding`,
    /// `[N·m]`, support the links.
    pub fn new(arm: &Arm, q: &JointVector, holding: &JointVector) -> Self {
        let contacts = |share: &dyn Fn(f64) -> f64| {
            std::array::from_fn(|i| {
                Contact::new(&arm.friction, i, share(arm.friction.link_share[i]))
            })
        };
        let mut train = Self {
            drive: arm.drive,
            felt_inertia: arm.drive.felt_inertia(),
            torque_offset: arm.sensors.torque_offset,
            motor_contacts: contacts(&|link_share| 1.0 - link_share),
            link_contacts: contacts(&|link_share| link_share),
            theta: *q,
            dtheta: JointVector::zeros(),
            torque: *holding,
        };
        train.rest(q, holding);
        train
    }

    /// Sets the drives to rest at `q`, with unloaded bristles.
    pub fn rest(&mut self, q: &JointVector, holding: &JointVector) {
        self.theta = q + self.deflection(holding);
        self.dtheta = JointVector::zeros();
        self.torque = *holding;
        let contacts = self
            .motor_contacts
            .iter_mut()
            .chain(&mut self.link_contacts);
        contacts.flatten().for_each(Contact::unload);
    }

    /// Torques between gears and links over the last step, gravity included, `[N·m]`.
    pub fn torque(&self) -> &JointVector {
        &self.torque
    }

    /// Angles of the motors after the gears, `[rad]`: the angles of the links plus the deflections
    /// of elastic joints.
    pub fn theta(&self) -> &JointVector {
        &self.theta
    }

    /// Velocities of the motors, `[rad/s]`.
    pub fn dtheta(&self) -> &JointVector {
        &self.dtheta
    }

    /// Apparent rotor inertia at the joints, `[kg·m²]`. Controllers must accelerate this inertia
    /// together with the links.
    pub fn felt_inertia(&self) -> &JointVector {
        &self.felt_inertia
    }

    /// Stiffness of the joints, `[N·m/rad]`; `None` if they are rigid.
    pub fn stiffness(&self) -> Option<JointVector> {
        self.drive.elasticity.map(|elasticity| elasticity.stiffness)
    }

    /// Deflection of the joints under a torque, `[rad]`.
    pub fn deflection(&self, torque: &JointVector) -> JointVector {
        let rigid = JointVector::zeros();
        self.stiffness()
            .map_or(rigid, |stiffness| torque.component_div(&stiffness))
    }

    /// Advances drives and plant (the physics of the links) by `dt` seconds. The commanded torques,
    /// `[N·m]`, include gravity. External torques are added.
    pub fn step(
        &mut self,
        plant: &mut dyn Plant,
        command: &JointVector,
        external: &External,
        dt: f64,
    ) {
        let motor = command - self.torque_offset - self.ripple();
        let before = *plant.dq();
        let by_pose = self.drive.pose_torque.at(plant.q());
        let mut link = LinkTorque::ZERO;
        let mut drives = [JointStep::default(); 7];
        for i in 0..7 {
            drives[i] = self.joint(i, motor[i], plant.q()[i], before[i], dt);
            link.torque[i] = drives[i].torque - drives[i].link_friction.torque - by_pose[i];
            link.inertia[i] = drives[i].inertia;
            link.damping[i] = drives[i].damping;
        }
        plant.step(&link, external, dt);
        for (i, joint) in drives.iter().enumerate() {
            let ddq = (plant.dq()[i] - before[i]) / dt;
            self.torque[i] = joint.torque - joint.sensed_inertia * ddq;
            if self.drive.elasticity.is_some() {
                let felt = self.felt_inertia[i] + dt * joint.motor_friction.slope;
                let free = motor[i] - joint.motor_friction.torque - self.torque[i];
                self.dtheta[i] += dt * free / felt;
                self.theta[i] += dt * self.dtheta[i];
            } else {
                self.dtheta[i] = plant.dq()[i];
                self.theta[i] = plant.q()[i];
            }
            if let Some(contact) = &mut self.motor_contacts[i] {
                contact.advance(self.dtheta[i], dt);
            }
            if let Some(contact) = &mut self.link_contacts[i] {
                contact.advance(plant.dq()[i], dt);
            }
        }
    }

    /// The values for the step of joint `i` that do not depend on the acceleration, under the motor
    /// torque `motor`.
    fn joint(&self, i: usize, motor: f64, q: f64, dq: f64, dt: f64) -> JointStep {
        let rotor = self.felt_inertia[i];
        let tangent = |contact: &Option<Contact>, v: f64, inertia: f64| {
            let of = |contact: &Contact| contact.tangent(v, inertia, dt);
            contact.as_ref().map_or(Tangent::default(), of)
        };
        let Some(elasticity) = &self.drive.elasticity else {
            let motor_friction = tangent(&self.motor_contacts[i], dq, rotor);
            let link_friction = tangent(&self.link_contacts[i], dq, rotor);
            return JointStep {
                torque: motor - motor_friction.torque,
                inertia: rotor,
                sensed_inertia: rotor + dt * motor_friction.slope,
                damping: motor_friction.slope + link_friction.slope,
                motor_friction,
                link_friction,
            };
        };
        let (stiffness, damping) = (elasticity.stiffness[i], elasticity.damping[i]);
        let (theta, dtheta) = (self.theta[i], self.dtheta[i]);
        let motor_friction = tangent(&self.motor_contacts[i], dtheta, rotor);
        let felt = rotor + dt * motor_friction.slope;
        let spring = dt * (damping + dt * stiffness);
        let held = stiffness * (theta - q + dt * (dtheta - dq)) + damping * (dtheta - dq);
        let inertia = spring * felt / (felt + spring);
        let link_friction = tangent(&self.link_contacts[i], dq, inertia);
        let free = motor - motor_friction.torque - held;
        JointStep {
            torque: held + spring * free / (felt + spring),
            inertia,
            sensed_inertia: inertia,
            damping: link_friction.slope,
            motor_friction,
            link_friction,
        }
    }

    fn ripple(&self) -> JointVector {
        let ripple = &self.drive.ripple;
        JointVector::from_fn(|i, _| match ripple.amplitude[i] {
            0.0 => 0.0,
            amplitude => amplitude * (ripple.order[i] * self.theta[i]).sin(),
        })
    }
}

/// One step of one joint. The torque between gear and link is `torque − sensed_inertia · q̈`.
#[derive(Debug, Clone, Copy, Default)]
struct JointStep {
    /// Torque between gear and link without acceleration, `[N·m]`.
    torque: f64,
    /// Inertia on the link, `[kg·m²]`.
    inertia: f64,
    /// Decrease of this torque per acceleration of the joint, `[kg·m²]`.
    sensed_inertia: f64,
    /// Damping on the link, `[N·m·s/rad]`.
    damping: f64,
    motor_friction: Tangent,
    link_friction: Tangent,
}

impl LinkTorque {
    /// Nothing acts on the links.
    pub const ZERO: Self = Self {
        torque: franka_model::joint_vector([0.0; 7]),
        inertia: franka_model::joint_vector([0.0; 7]),
        damping: franka_model::joint_vector([0.0; 7]),
    };
}
