//! Tests of the drive train together with plants.

use franka_model::{GRAVITY_EARTH, JointVector, Load, Model, READY, RobotKind};
use nalgebra::Vector3;

use super::DriveTrain;
use crate::Tool;
use crate::arm::{Arm, EndStops, Friction, PoseTorque, Ripple, Sensors};
use crate::plant::{External, Plant, RigidArm};

/// The robots' step, `[s]`.
const STEP: f64 = 0.000_25;
const KIND: RobotKind = RobotKind::Fer;

/// An arm of the realistic family, without disturbances that would affect measurements of its
/// drives.
fn steady(friction: Friction) -> Arm {
    let realistic = Arm::realistic(KIND);
    let mut arm = Arm {
        friction,
        sensors: Sensors::PERFECT,
        ..Arm::ideal(KIND)
    };
    arm.drive = realistic.drive;
    arm.drive.ripple = Ripple::NONE;
    arm
}

struct Bench {
    plant: Box<dyn Plant>,
    train: DriveTrain,
}

impl Bench {
    /// Returns the arm on every plant, at rest in the ready pose.
    fn each(arm: &Arm) -> Vec<(&'static str, Self)> {
        let on = |mut plant: Box<dyn Plant>| {
            let holding = plant.place(&READY);
            let train = DriveTrain::new(arm, &READY, &holding);
            Self { plant, train }
        };
        vec![
            (
                "rigid",
                on(Box::new(RigidArm::new(KIND, arm, READY, Load::NONE))),
            ),
            #[cfg(feature = "mujoco")]
            ("MuJoCo", {
                use crate::plant::{MujocoArm, Scene};
                let mut plant = MujocoArm::new(KIND, Scene::empty()).expect("an empty scene");
                plant.fit(KIND, arm);
                on(Box::new(plant))
            }),
        ]
    }

    fn step(&mut self, command: &JointVector) {
        let none = External::NONE;
        self.train.step(self.plant.as_mut(), command, &none, STEP);
    }

    /// Takes a step under the torques that support the arm, and an additional torque on one joint.
    fn push(&mut self, joint: usize, torque: f64) {
        let model = Model::physically_consistent(KIND);
        let mut command = model.gravity(self.plant.q(), &Load::NONE, &GRAVITY_EARTH);
        command[joint] += torque;
        self.step(&command);
    }
}

fn for_rigid_and_elastic_joints(friction: Friction, test: impl Fn(&str, &Arm)) {
    let elastic = steady(friction);
    let mut rigid = elastic.clone();
    rigid.drive.elasticity = None;
    test("rigid joints", &rigid);
    test("elastic joints", &elastic);
}

#[test]
fn every_joint_breaks_away_at_its_static_torque_and_not_below() {
    let friction = Arm::realistic(KIND).friction;
    for_rigid_and_elastic_joints(friction, |joints, arm| {
        for (name, mut bench) in Bench::each(arm) {
            for joint in 0..7 {
                let holding = bench.plant.place(&READY);
                bench.train.rest(&READY, &holding);
                let static_torque = friction.static_torque[joint];
                let least = 0.8 * static_torque;
                for step in 0..16_000 {
                    bench.push(joint, least * (f64::from(step) / 6000.0).min(1.0));
                }
                assert!(
                    bench.plant.dq().amax() < 1e-4,
                    "{joints}, {name}: {joint} slips"
                );
                let mut torque = least;
                // The torque rises slowly enough to make the inertia negligible.
                while bench.plant.dq()[joint] < 4e-4 {
                    torque += 0.05 * STEP;
                    bench.push(joint, torque);
                    assert!(
                        torque < 1.1 * static_torque,
                        "{joints}, {name}: {joint} stuck"
                    );
                }
                let ratio = torque / static_torque;
                println!("{joints}, {name}: joint {joint} at {ratio}");
                assert!(
                    (ratio - 1.0).abs() < 0.02,
                    "{joints}, {name}, {joint}: {ratio}"
                );
            }
        }
    });
}

#[test]
fn a_stuck_arm_does_not_creep() {
    for_rigid_and_elastic_joints(Arm::realistic(KIND).friction, |joints, arm| {
        for (name, mut bench) in Bench::each(arm) {
            let model = Model::physically_consistent(KIND);
            let command = model.gravity(&READY, &Load::NONE, &GRAVITY_EARTH)
                + arm.friction.static_torque * 0.7;
            for ramp in 0..8000 {
                let hold = model.gravity(&READY, &Load::NONE, &GRAVITY_EARTH);
                bench.step(&(hold + (command - hold) * (f64::from(ramp) / 8000.0)));
            }
            for _ in 0..40_000 {
                bench.step(&command);
            }
            let (from, mut fastest) = (*bench.plant.q(), 0.0_f64);
            for _ in 0..60 * 4000 {
                bench.step(&command);
                fastest = fastest.max(bench.plant.dq().amax());
            }
            println!("{joints}, {name}: {fastest:e} rad/s");
            assert!(fastest < 1e-9, "{joints}, {name}: {fastest} rad/s");
            assert!((bench.plant.q() - from).amax() < 1e-9);
        }
    });
}

#[test]
fn sensed_torque_shows_friction_of_the_link_side_only() {
    for share in [0.0, 0.4, 1.0] {
        let mut friction = Arm::realistic(KIND).friction;
        friction.link_share = JointVector::repeat(share);
        let mut arm = steady(friction);
        arm.drive.elasticity = None;
        for (name, mut bench) in Bench::each(&arm) {
            let holding = *bench.train.torque();
            for ramp in 0..12_000 {
                bench.push(0, 0.5 * (f64::from(ramp) / 8000.0).min(1.0));
            }
            let seen = bench.train.torque()[0] - holding[0];
            assert!((seen - 0.5 * share).abs() < 1e-3, "{name}, {share}: {seen}");
        }
    }
}

/// Returns the frequency of the measured torque of a joint after an impact, `[Hz]`.
fn ringing(bench: &mut Bench, joint: usize) -> f64 {
    let holding = bench.plant.place(&READY);
    bench.train.rest(&READY, &holding);
    let samples: Vec<f64> = (0..2000)
        .map(|step| {
            let mut command = holding;
            command[joint] += if step < 4 { 2.0 } else { 0.0 };
            bench.step(&command);
            bench.train.torque()[joint] - holding[joint]
        })
        .collect();
    let power = |frequency: f64| {
        let wave = |(n, sample): (usize, &f64)| {
            let phase = core::f64::consts::TAU * frequency * n as f64 * STEP;
            (sample * phase.cos(), sample * phase.sin())
        };
        let waves = samples.iter().enumerate().map(wave);
        let (re, im) = waves.fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d));
        re * re + im * im
    };
    let frequencies = (60..1500).map(|n| f64::from(n) / 4.0);
    let mut best = (0.0, 0.0);
    for frequency in frequencies {
        let power = power(frequency);
        if power > best.1 {
            best = (frequency, power);
        }
    }
    best.0
}

#[test]
fn elastic_joints_ring_at_the_published_resonances() {
    let mut free = steady(Friction::NONE);
    free.drive.torque_loop_gain = 0.0;
    // These are the frequencies of rotor against link, with a Hand, computed from the rotor
    // inertias and stiffnesses of this family. The published 105 Hz of joint 5 is close to its
    // frequency with free neighbouring joints. With blocked neighbours, its frequency is 91 Hz.
    let published = [36.0, 29.0, 34.0, 34.0, 91.0, 79.0];
    for (joint, expected) in published.into_iter().enumerate() {
        let mut arm = free.clone();
        let elasticity = arm.drive.elasticity.as_mut().expect("elastic joints");
        elasticity.damping /= 10.0;
        for other in (0..7).filter(|other| *other != joint) {
            // A huge rotor inertia blocks the other joints.
            arm.drive.rotor_inertia[other] = 1e6;
            elasticity.stiffness[other] = 1e9;
        }
        for (name, mut bench) in Bench::each(&arm) {
            bench.plant.attach(Tool::hand().load);
            let frequency = ringing(&mut bench, joint);
            println!("{name}: joint {joint} rings at {frequency} Hz");
            assert!(
                (frequency / expected - 1.0).abs() < 0.1,
                "{name}: joint {joint} rings at {frequency} Hz instead of {expected}"
            );
        }
    }
}

#[test]
fn an_arm_that_only_its_joints_damp_loses_energy_and_gains_none() {
    let mut arm = steady(Friction::NONE);
    arm.body.gravity_earth = Vector3::zeros();
    arm.body.stops = EndStops::NONE;
    let model = Model::physically_consistent(KIND);
    let elasticity = arm.drive.elasticity.expect("elastic joints");
    for (name, mut bench) in Bench::each(&arm) {
        let blow = JointVector::from([20.0, -20.0, 15.0, 20.0, 3.0, -3.0, 2.0]);
        for _ in 0..40 {
            bench.step(&blow);
        }
        let energy = |bench: &Bench| {
            let (q, dq) = (bench.plant.q(), bench.plant.dq());
            let (theta, dtheta) = (bench.train.theta(), bench.train.dtheta());
            let stretch = theta - q;
            let links = dq.dot(&(model.mass(q, &Load::NONE) * dq));
            let rotors = dtheta.component_mul(dtheta).dot(bench.train.felt_inertia());
            let springs = stretch.component_mul(&stretch).dot(&elasticity.stiffness);
            0.5 * (links + rotors + springs)
        };
        let start = energy(&bench);
        let mut least = start;
        for _ in 0..4000 {
            bench.step(&JointVector::zeros());
            let now = energy(&bench);
            // The tolerance is the error of a step, which moves the links by less than a degree.
            assert!(
                now < least + 1e-4 * start,
                "{name}: {now} J after {least} J"
            );
            least = least.min(now);
        }
        println!("{name}: {least} J of {start} J");
        assert!(
            least < 0.99 * start && least > 0.1 * start,
            "{name}: {least} J of {start} J"
        );
    }
}

#[test]
fn an_offset_of_the_sensor_lowers_the_torque_on_the_link() {
    let mut arm = steady(Friction::NONE);
    arm.sensors.torque_offset = JointVector::repeat(0.2);
    for (name, mut bench) in Bench::each(&arm) {
        let hold = *bench.train.torque();
        for _ in 0..4 {
            bench.step(&hold);
        }
        assert!(bench.plant.dq().iter().any(|dq| *dq < -1e-6), "{name}");
        let model = Model::physically_consistent(KIND);
        let mut rest = Bench::each(&arm).remove(0).1;
        for _ in 0..400 {
            let gravity = model.gravity(rest.plant.q(), &Load::NONE, &GRAVITY_EARTH);
            rest.step(&gravity.add_scalar(0.2));
        }
        assert!(rest.plant.dq().amax() < 1e-9, "{name}: {}", rest.plant.dq());
    }
}

#[test]
fn a_torque_by_pose_pulls_the_link_and_shows_in_the_sensed_torque() {
    let mut arm = steady(Friction::NONE);
    arm.drive.pose_torque = PoseTorque {
        sine: JointVector::repeat(0.2),
        cosine: JointVector::repeat(-0.3),
    };
    let pull = READY.map(|angle| 0.2 * angle.sin() - 0.3 * angle.cos());
    for (name, mut bench) in Bench::each(&arm) {
        let before = *bench.train.torque();
        for _ in 0..400 {
            let model = Model::physically_consistent(KIND);
            let gravity = model.gravity(bench.plant.q(), &Load::NONE, &GRAVITY_EARTH);
            bench.step(&(gravity + pull));
        }
        let (dq, sensed) = (bench.plant.dq(), bench.train.torque() - before);
        assert!(dq.amax() < 2e-3, "{name}: {dq}");
        assert!((sensed - pull).amax() < 0.01, "{name}: {sensed}");
    }
}
