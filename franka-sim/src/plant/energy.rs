//! Tests of the energy balance of every plant: motors, friction, and the arm's energy.

use franka_model::{GRAVITY_EARTH, JointVector, Load, Model, READY, RobotKind};

use super::{DriveTrain, External, Plant, RigidArm};
use crate::Tool;
use crate::arm::{Arm, EndStops, Friction};

/// The robots' step, `[s]`.
const STEP: f64 = 0.000_25;

/// Plants without surroundings, with this load on the flange.
fn plants(kind: RobotKind, arm: &Arm, load: Load) -> Vec<Box<dyn Plant>> {
    vec![
        Box::new(RigidArm::new(kind, arm, READY, load)),
        #[cfg(feature = "mujoco")]
        Box::new({
            let scene = super::Scene::empty();
            let mut plant = super::MujocoArm::new(kind, scene).expect("an empty scene");
            plant.fit(kind, arm);
            plant.attach(load);
            plant
        }),
    ]
}

/// Every kind of arm on every plant, without and with a Hand. `test` also receives a description of
/// the case.
fn for_each(friction: Option<Friction>, test: impl Fn(&str, &mut Book)) {
    for kind in RobotKind::ALL {
        let mut arm = Arm::ideal(kind);
        arm.friction = friction.unwrap_or(arm.friction);
        arm.body.stops = EndStops::NONE;
        for (load, with) in [(Load::NONE, "bare"), (Tool::hand().load, "Hand")] {
            for (mut plant, on) in plants(kind, &arm, load)
                .into_iter()
                .zip(["rigid", "MuJoCo"])
            {
                let holding = plant.place(&READY);
                let mut book = Book {
                    model: Model::physically_consistent(kind),
                    load,
                    train: DriveTrain::new(&arm, &READY, &holding),
                    plant,
                    potential: 0.0,
                    work: 0.0,
                    turnover: 0.0,
                };
                test(&format!("{kind:?} {with}, {on}"), &mut book);
            }
        }
    }
}

/// An arm and its energy balance, `[J]`.
struct Book {
    model: &'static Model,
    load: Load,
    train: DriveTrain,
    plant: Box<dyn Plant>,
    /// Change of the potential energy since the start, at which the arm was at rest.
    potential: f64,
    /// Work that the motors have done.
    work: f64,
    /// The largest kinetic energy so far.
    turnover: f64,
}

impl Book {
    fn step(&mut self, motor: &JointVector, dt: f64) {
        let before = *self.plant.q();
        let none = External::NONE;
        self.train.step(self.plant.as_mut(), motor, &none, dt);
        let way = self.plant.q() - before;
        let middle = before + way / 2.0;
        let gravity = self.model.gravity(&middle, &self.load, &GRAVITY_EARTH);
        self.potential += gravity.dot(&way);
        self.work += motor.dot(&way);
        self.turnover = self.turnover.max(self.kinetic());
    }

    /// Kinetic energy of links and rotors.
    fn kinetic(&self) -> f64 {
        let (q, dq) = (self.plant.q(), self.plant.dq());
        let links = dq.dot(&(self.model.mass(q, &self.load) * dq));
        let rotors = dq.component_mul(dq).dot(self.train.felt_inertia());
        0.5 * (links + rotors)
    }

    /// Torques that support the arm against gravity in its position, `[N·m]`.
    fn weight(&self) -> JointVector {
        self.model
            .gravity(self.plant.q(), &self.load, &GRAVITY_EARTH)
    }

    /// True if the arm touches itself, which a rigid arm cannot do.
    fn is_touching(&self) -> bool {
        #[cfg(feature = "mujoco")]
        {
            let plant: &dyn std::any::Any = self.plant.as_ref();
            if let Some(arm) = plant.downcast_ref::<super::MujocoArm>() {
                return arm.contact_torque() != JointVector::zeros();
            }
        }
        false
    }

    /// Energy of the arm minus the energy that it received.
    fn surplus(&self) -> f64 {
        self.kinetic() + self.potential - self.work
    }
}

/// Returns torques that support the arm and swing every joint about the ready pose. Each joint
/// swings a little faster than the previous joint.
fn swing(book: &Book, time: f64) -> JointVector {
    let strength = JointVector::from([6.0, 6.0, 6.0, 6.0, 1.0, 1.0, 0.5]);
    let phase = JointVector::from_fn(|i, _| (time * (2.0 + i as f64)).cos());
    let (q, dq) = (book.plant.q(), book.plant.dq());
    let back = (READY - q) * 5.0 - dq * 2.0;
    book.weight() + strength.component_mul(&(phase + back))
}

#[test]
fn a_fall_turns_potential_into_kinetic_energy_and_loses_none() {
    for_each(Some(Friction::NONE), |name, book| {
        let (mut worst, mut steps) = (0.0_f64, 0);
        // The loop runs for two seconds, or until the arm hits itself.
        while steps < 8000 && !book.is_touching() {
            worst = worst.max(book.surplus().abs());
            book.step(&JointVector::zeros(), STEP);
            steps += 1;
        }
        let turnover = book.turnover;
        println!("{name}: {worst} J of {turnover} J in {steps} steps");
        assert!(turnover > 5.0, "{name}: hardly a fall, {turnover} J");
        assert!(worst < 0.01 * turnover, "{name}: {worst} J of {turnover} J");
    });
}

#[test]
fn energy_surplus_shrinks_with_the_steps() {
    for_each(Some(Friction::NONE), |name, book| {
        let errors = [STEP, STEP / 2.0].map(|dt| {
            let holding = book.plant.place(&READY);
            book.train.rest(&READY, &holding);
            (book.potential, book.work) = (0.0, 0.0);
            let mut worst = 0.0_f64;
            for step in 0..(5.0 / dt).round() as u32 {
                let motor = swing(book, f64::from(step) * dt);
                book.step(&motor, dt);
                worst = worst.max(book.surplus().abs());
                assert!(!book.is_touching(), "{name}: the arm has hit itself");
            }
            worst
        });
        let turnover = book.turnover;
        println!("{name}: {errors:?} J of {turnover} J");
        // The motors supply and absorb several times this energy in the five seconds.
        assert!(turnover > 0.3, "{name}: {turnover} J");
        assert!(errors[0] < 0.03 * turnover, "{name}: {errors:?} J");
        // The integration rule has first order.
        let ratio = errors[0] / errors[1];
        assert!((1.5..2.5).contains(&ratio), "{name}: {errors:?} J");
    });
}

#[test]
fn friction_takes_energy_and_gives_none() {
    for_each(None, |name, book| {
        for _ in 0..800 {
            let motor = swing(book, 0.2);
            book.step(&motor, STEP);
        }
        let mut least = book.surplus();
        assert!(least < 0.0, "{name}: friction has given {least} J");
        for _ in 0..2000 {
            let weight = book.weight();
            book.step(&weight, STEP);
            let surplus = book.surplus();
            // The tolerance is the integration error of one step.
            assert!(
                surplus < least + 1e-4 * book.turnover,
                "{name}: {surplus} J after {least} J"
            );
            least = least.min(surplus);
        }
    });
}
