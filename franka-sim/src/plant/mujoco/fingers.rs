//! The Franka Hand in the scene: its shapes, the joints of its fingers, and the motor that drives
//! both fingers.

use franka_model::collision::{Body, Capsule};
use mujoco_rs::prelude::{MjData, MjModel};
use nalgebra::{UnitQuaternion, Vector3};

use super::mjcf::{add, geom, quaternion, write_capsule};
use super::scene::{SceneError, joint};
use crate::plant::FingerDrive;

/// The body of the Hand, in the frame of the Hand. Source: a fit to the vendor's collision mesh
/// (`franka_description` 1.0.1, `hand`). The mesh protrudes by up to 15 mm from this capsule.
pub(super) const HAND: Capsule =
    Capsule::new([-0.0007, -0.0702, 0.0228], [0.0001, 0.0673, 0.0254], 0.0363);

/// The hand body and both fingers, on the flange.
pub(super) fn write_hand(text: &mut String) {
    let turn = -core::f64::consts::FRAC_PI_4;
    let turn = quaternion(&UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn));
    add(text, format_args!("<body name='hand' quat='{turn}'>"));
    write_capsule(text, &geom(Body::Tool, 0), &HAND);
    // The right finger is the left finger, turned about the axis of the Hand. The positive
    // direction therefore opens both fingers.
    for (name, turn) in JOINTS.into_iter().zip(["1 0 0 0", "0 0 0 1"]) {
        let stroke = FingerDrive::STROKE / 2.0;
        add(
            text,
            format_args!(
                "<body name='{name}' pos='0 0 {FINGER_HEIGHT}' quat='{turn}'>\
                 <inertial pos='0 0 0' mass='{NEXT_TO_NOTHING}' diaginertia='{NEXT_TO_NOTHING} {NEXT_TO_NOTHING} {NEXT_TO_NOTHING}'/>\
                 <joint name='{name}' type='slide' axis='0 1 0' range='0 {stroke}' limited='true' \
                 armature='{FINGER_ARMATURE}'/>{BOXES}</body>"
            ),
        );
    }
    text.push_str("</body>");
}

/// Couples both fingers, because one motor opens both by the same distance.
pub(super) fn write_coupling(text: &mut String) {
    let [left, right] = JOINTS;
    add(
        text,
        format_args!(
            "<equality><joint joint1='{left}' joint2='{right}' solref='0.005 1' \
             solimp='0.95 0.99 0.001'/></equality>"
        ),
    );
}

/// The joints of the fingers and their motor: a speed controller with a force limit.
#[derive(Debug, Clone)]
pub(super) struct FingerJoints {
    qpos: [usize; 2],
    dof: [usize; 2],
    drive: FingerDrive,
    /// Integral part of the controller's force on each finger, `[N]`.
    push: f64,
}

impl FingerJoints {
    pub(super) fn of(model: &MjModel) -> Result<Self, SceneError> {
        let [left, right] = JOINTS;
        let (left, right) = (joint(model, left)?, joint(model, right)?);
        Ok(Self {
            qpos: [left.0, right.0],
            dof: [left.1, right.1],
            drive: FingerDrive {
                width: FingerDrive::STROKE,
                speed: FingerDrive::MAX_SPEED,
                force: FingerDrive::FORCE[0],
            },
            push: 0.0,
        })
    }

    pub(super) fn open(&self, data: &mut MjData<Box<MjModel>>) {
        for place in self.qpos {
            data.qpos_mut()[place] = FingerDrive::STROKE / 2.0;
        }
    }

    /// Sets the command for the next step and all later steps.
    pub(super) fn set(&mut self, drive: FingerDrive) {
        self.drive = drive;
    }

    /// Distance of the fingers, `[m]`.
    pub(super) fn width(&self, data: &MjData<Box<MjModel>>) -> f64 {
        self.qpos.iter().map(|place| data.qpos()[*place]).sum()
    }

    /// Sets the forces for a step of `dt` seconds.
    pub(super) fn drive(&mut self, data: &mut MjData<Box<MjModel>>, dt: f64) {
        let FingerDrive {
            width,
            speed,
            force,
        } = self.drive;
        // Each finger covers half of the distance.
        let way = (width - self.width(data)) / 2.0;
        let wanted = (way * APPROACH).clamp(-speed / 2.0, speed / 2.0);
        let rate = self
            .dof
            .iter()
            .map(|place| data.qvel()[*place])
            .sum::<f64>()
            / 2.0;
        let error = wanted - rate;
        self.push = (self.push + INTEGRAL * error * dt).clamp(-force, force);
        let push = (self.push + PROPORTIONAL * error).clamp(-force, force);
        for place in self.dof {
            data.qfrc_applied_mut()[place] = push;
        }
    }
}

const JOINTS: [&str; 2] = ["finger_left", "finger_right"];

/// Height at which the fingers slide, above the origin of the Hand, `[m]`. Source:
/// `franka_description` 1.0.1, `franka_hand.xacro`.
const FINGER_HEIGHT: f64 = 0.0584;

/// Mass of one finger, `[kg]`, and its moments of inertia, `[kg·m²]`: the smallest values that
/// MuJoCo accepts. The load of [`Tool::hand`](crate::Tool::hand) includes the weight of the
/// fingers. Nearly all inertia of the sliding fingers comes from the motor.
const NEXT_TO_NOTHING: f64 = 1e-12;

/// Inertia of the motor at each finger, `[kg]`. A choice of the simulator, without a source.
const FINGER_ARMATURE: f64 = 0.5;

/// The four boxes of a finger: screw mount, carriage, diagonal, rubber tip. Source:
/// `franka_description` 1.0.1, `franka_hand.xacro`. The tip is stiffer than MuJoCo's default
/// contacts: a force of 100 N compresses it by 0.2 mm.
const BOXES: &str = "\
    <geom type='box' size='0.011 0.0075 0.01' pos='0 0.0185 0.011'/>\
    <geom type='box' size='0.011 0.0044 0.0019' pos='0 0.0068 0.0022'/>\
    <geom type='box' size='0.00875 0.0035 0.01175' pos='0 0.0159 0.02835' \
    quat='0.9659258262890683 0.2588190451025207 0 0'/>\
    <geom type='box' size='0.00875 0.0076 0.00925' pos='0 0.00758 0.04525' condim='4' \
    friction='0 0.005 0.0001' solref='0.005 1' solimp='0.95 0.99 0.001' solmix='100'/>";

/// Gains of the motor's speed controller, chosen for the simulator: desired speed per remaining
/// distance, `[1/s]`; force per speed error, `[N·s/m]`; force per position error, `[N/m]`. The
/// force on a blocked finger reaches 70 N after 0.2 s.
const APPROACH: f64 = 30.0;
const PROPORTIONAL: f64 = 100.0;
const INTEGRAL: f64 = 6000.0;
