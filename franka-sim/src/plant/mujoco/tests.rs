use franka_model::collision::Shape;
use franka_model::{JointVector, Load, Model, READY, RobotKind};
use nalgebra::{Matrix3, SMatrix, Vector3};

use super::*;
use crate::Tool;
use crate::noise::Random;
use crate::plant::{DriveTrain, External, RigidArm};

const STEP: f64 = 0.000_25;

fn loads() -> [Load; 3] {
    let odd = Load {
        mass: 1.3,
        com: Vector3::new(0.02, -0.05, 0.11),
        inertia: Matrix3::new(
            0.004, 0.001, -0.0005, //
            0.001, 0.005, 0.0007, //
            -0.0005, 0.0007, 0.003,
        ),
    };
    [Load::NONE, Tool::hand().load, odd]
}

fn arm(kind: RobotKind, load: Load) -> MujocoArm {
    arm_in(Scene::empty(), kind, load)
}

fn arm_in(scene: Scene, kind: RobotKind, load: Load) -> MujocoArm {
    let mut arm = MujocoArm::new(kind, scene).expect("a scene");
    arm.attach(load);
    arm
}

/// Returns arms of every kind with every load, each without a Hand and with a Hand in the scene.
/// The text describes the case.
fn arms() -> impl Iterator<Item = (String, RobotKind, Load, MujocoArm)> {
    let scenes = [Scene::empty(), Scene::empty().with_hand()];
    RobotKind::ALL.into_iter().flat_map(move |kind| {
        let scenes = scenes.clone();
        scenes.into_iter().flat_map(move |scene| {
            loads().into_iter().map(move |load| {
                let fingers = if scene == Scene::empty() {
                    "no"
                } else {
                    "with"
                };
                let name = format!("{kind:?}, {fingers} fingers, {} kg", load.mass);
                (name, kind, load, arm_in(scene.clone(), kind, load))
            })
        })
    })
}

/// Returns the mass matrix, including the rotors, and the bias torques.
fn dynamics(arm: &MujocoArm) -> (SMatrix<f64, 7, 7>, JointVector) {
    let count = arm.data.qvel().len();
    let mut whole = vec![0.0; count * count];
    arm.data.full_m(&mut whole).expect("room for all");
    let dof = arm.places.dof;
    let bias = arm.data.qfrc_bias();
    (
        SMatrix::from_fn(|i, j| whole[dof[i] * count + dof[j]]),
        dof.map(|dof| bias[dof]).into(),
    )
}

/// Random positions and velocities within the limits.
fn random_motion(random: &mut Random, model: &Model) -> (JointVector, JointVector) {
    let limits = model.joint_limits();
    let part = |random: &mut Random| {
        random
            .joints(&JointVector::repeat(1.0))
            .map(|x| 0.5 + 0.5 * x.sin())
    };
    let range = limits.hard_upper - limits.hard_lower;
    let q = limits.hard_lower + part(random).component_mul(&range);
    let dq = (part(random).map(|x| 2.0 * x - 1.0)).component_mul(&limits.velocity);
    (q, dq)
}

#[test]
fn inertia_and_bias_are_those_of_the_rigid_arm() {
    let mut random = Random::new(7);
    for (name, kind, load, mut arm) in arms() {
        let model = Model::physically_consistent(kind);
        let ideal = Arm::ideal(kind);
        let (mut worst_mass, mut worst_bias) = (0.0_f64, 0.0_f64);
        for _ in 0..100 {
            let (q, dq) = random_motion(&mut random, model);
            arm.place(&q);
            for i in 0..7 {
                arm.data.qvel_mut()[arm.places.dof[i]] = dq[i];
            }
            arm.data.forward();
            let (mass, bias) = dynamics(&arm);
            let rotors = SMatrix::from_diagonal(&ideal.drive.rotor_inertia);
            let expected = model.mass(&q, &load) + rotors;
            let rest = JointVector::zeros();
            let gravity = &ideal.body.gravity_earth;
            let torque = model.inverse_dynamics(&q, &dq, &rest, &load, gravity);
            worst_mass = worst_mass.max((mass - expected).amax());
            worst_bias = worst_bias.max((bias - torque).amax());
        }
        println!("{name}: {worst_mass:e} kg m², {worst_bias:e} N m");
        // The largest entries are 3 kg·m² and 100 N·m.
        assert!(worst_mass < 1e-9, "{name}: {worst_mass} kg·m²");
        assert!(worst_bias < 1e-9, "{name}: {worst_bias} N·m");
    }
}

#[test]
fn five_seconds_of_torques_move_both_arms_alike() {
    for (name, kind, load, mut mujoco) in arms() {
        let model = Model::physically_consistent(kind);
        let ideal = Arm::ideal(kind);
        let mut rigid = RigidArm::new(kind, &ideal, READY, load);
        let holding = rigid.place(&READY);
        let mut trains = [(); 2].map(|()| DriveTrain::new(&ideal, &READY, &holding));
        let (mut apart, mut travel) = (0.0_f64, 0.0_f64);
        let none = External::NONE;
        for step in 0..20_000 {
            // The torques of the motors do not depend on the resulting motion.
            let time = f64::from(step) * STEP;
            let swing = JointVector::from_fn(|i, _| (time * (2.0 + i as f64)).sin());
            let strength = JointVector::from([3.0, 3.0, 3.0, 3.0, 0.8, 0.8, 0.4]);
            let hold = model.gravity(&READY, &load, &franka_model::GRAVITY_EARTH);
            let motor = hold + strength.component_mul(&swing);
            trains[0].step(&mut mujoco, &motor, &none, STEP);
            trains[1].step(&mut rigid, &motor, &none, STEP);
            apart = apart.max((mujoco.q() - rigid.q()).amax());
            travel = travel.max((rigid.q() - READY).amax());
        }
        println!("{name}: {apart:e} rad apart, {travel} rad from the start");
        assert!(travel > 0.1, "{name}: hardly a motion, {travel} rad");
        assert!(apart < 1e-4, "{name}: {apart} rad apart");
        assert!((trains[0].torque() - trains[1].torque()).amax() < 1e-2);
    }
}

#[test]
fn the_ready_pose_touches_nothing() {
    for kind in RobotKind::ALL {
        for scene in [Scene::table(), Scene::table().with_hand()] {
            let arm = MujocoArm::new(kind, scene).expect("a scene");
            assert_eq!(arm.data.ncon(), 0, "{kind:?}");
        }
    }
}

#[test]
fn the_arm_touches_itself_where_the_model_says_so() {
    let mut random = Random::new(11);
    for kind in RobotKind::ALL {
        let mut arm = arm(kind, Load::NONE);
        let mut touching = 0;
        for _ in 0..500 {
            let (q, _) = random_motion(&mut random, Model::of(kind));
            let distance = Shape::covering(kind).at(&q).nearest_pair().distance;
            arm.place(&q);
            let contacts = arm.data.contact().iter().map(|contact| contact.dist);
            match contacts.reduce(f64::min) {
                Some(deepest) => {
                    assert!(
                        (deepest - distance).abs() < 1e-6,
                        "{q}: {deepest} m, {distance} m"
                    );
                    touching += 1;
                }
                None => assert!(distance > -1e-9, "{q}: {distance} m unnoticed"),
            }
        }
        assert!((10..250).contains(&touching), "{kind:?}: {touching} of 500");
    }
}

#[test]
fn a_load_can_change_while_the_arm_moves() {
    let mut arm = arm(RobotKind::Fr3, Load::NONE);
    let push = LinkTorque {
        torque: JointVector::repeat(1.0),
        ..LinkTorque::ZERO
    };
    arm.step(&push, &External::NONE, 0.01);
    let (q, dq) = (*arm.q(), *arm.dq());
    arm.attach(Tool::hand().load);
    assert_eq!((*arm.q(), *arm.dq()), (q, dq));
    let gravity = franka_model::GRAVITY_EARTH;
    let model = Model::physically_consistent(RobotKind::Fr3);
    let load = Tool::hand().load;
    let holding = arm.place(&q);
    let expected = model.gravity(&q, &load, &gravity);
    assert!((holding - expected).amax() < 1e-9);
}

#[test]
fn a_scene_that_is_none_says_why() {
    let error = |scene| MujocoArm::new(RobotKind::Fr3, scene).expect_err("no scene");
    let text = error(Scene::mjcf(
        "<mujoco><worldbody><box/></worldbody></mujoco>",
    ))
    .to_string();
    assert!(text.contains("box"), "{text}");
    let text = error(Scene::file("/no/such/scene.xml")).to_string();
    assert!(text.contains("/no/such/scene.xml"), "{text}");
    let theirs = "<mujoco><worldbody><body name='franka_link3'/></worldbody></mujoco>";
    assert!(matches!(
        error(Scene::mjcf(theirs)),
        SceneError::Conflict(_) | SceneError::Impossible(_)
    ));
}

#[test]
fn a_fall_is_the_rigid_arms_until_it_ends_on_the_table() {
    for kind in RobotKind::ALL {
        let ideal = Arm::ideal(kind);
        let mut arm = MujocoArm::new(kind, Scene::table()).expect("a scene");
        let mut free = RigidArm::new(kind, &ideal, READY, Load::NONE);
        let holding = free.place(&READY);
        let mut trains = [(); 2].map(|()| DriveTrain::new(&ideal, &READY, &holding));
        let (no_drive, none) = (JointVector::zeros(), External::NONE);
        let mut fall = 0;
        while arm.contact_torque() == none.torque {
            assert!((arm.q() - free.q()).amax() < 1e-9, "{kind:?}");
            trains[0].step(&mut arm, &no_drive, &none, STEP);
            trains[1].step(&mut free, &no_drive, &none, STEP);
            fall += 1;
            assert!(fall < 8000, "{kind:?}: nothing holds the arm up");
        }
        assert!(fall > 500, "{kind:?}: in contact from the start");
        let (mut contact, mut sensed) = (0.0_f64, 0.0_f64);
        for _ in 0..12_000 {
            contact = contact.max(arm.contact_torque().amax());
            sensed = sensed.max((trains[0].torque() - trains[1].torque()).amax());
            trains[0].step(&mut arm, &no_drive, &none, STEP);
            trains[1].step(&mut free, &no_drive, &none, STEP);
            for link in 1..=7 {
                let name = format!("franka_link{link}");
                let height = arm.body_pose(&name).expect("a link").translation.z;
                assert!(height > -0.01, "{kind:?}: {name} at {height} m");
            }
        }
        assert!(contact > 50.0, "{kind:?}: a gentle fall: {contact} N·m");
        assert!(
            sensed > 20.0,
            "{kind:?}: the sensors feel {sensed} N·m of it"
        );
    }
}
