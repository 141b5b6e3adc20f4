//! Getters of a motion, and changes in the middle of a motion.

use crate::{CYCLE, Generator, Limits, PlanError, Quantity, State, Synchronisation};

fn limits() -> Limits<3> {
    Limits::from_arrays([1.0, 0.8, 0.5], [5.0, 4.0, 6.0], [900.0, 800.0, 700.0]).unwrap()
}

fn moving(limits: Limits<3>, synchronisation: Synchronisation) -> Generator<3> {
    let mut generator = Generator::new(State::at_rest([0.0; 3]), limits)
        .unwrap()
        .with_synchronisation(synchronisation);
    generator.set_target(&[0.3, -0.2, 0.1]).unwrap();
    for _ in 0..150 {
        generator.step();
    }
    generator
}

#[test]
fn a_target_in_motion_is_met_when_it_was_said_to_be() {
    let mut generator = moving(limits(), Synchronisation::Time);
    let target = State {
        position: [0.4, 0.4, 0.4],
        velocity: [0.2, 0.0, -0.1],
        acceleration: [0.0; 3],
    };
    generator.set_moving_target(&target).unwrap();
    assert_eq!(generator.target(), &target.position);
    let arrival = generator.time_to_target();
    let met = generator.sample(arrival);
    for i in 0..3 {
        assert!((met.position[i] - target.position[i]).abs() < 1e-12);
        assert!((met.velocity[i] - target.velocity[i]).abs() < 1e-11);
    }
    generator.step();
    assert!((generator.time_to_target() - (arrival - CYCLE)).abs() < 1e-12);
    while !generator.is_done() {
        generator.step();
    }
    assert_eq!(generator.time_to_target(), 0.0);
    assert_eq!(generator.state(), &State::at_rest(*generator.end()));
    assert!(
        generator.end()[0] > 0.4 && generator.end()[2] < 0.4,
        "behind it"
    );
}

#[test]
fn targets_that_the_limits_do_not_allow_are_refused() {
    let mut generator = moving(limits(), Synchronisation::Time);
    let motion = |velocity, acceleration| State {
        position: [0.4; 3],
        velocity: [0.0, velocity, 0.0],
        acceleration: [0.0, acceleration, 0.0],
    };
    let refused = Err(PlanError::TargetMotion { axis: 2 });
    assert_eq!(generator.set_moving_target(&motion(0.81, 0.0)), refused);
    assert_eq!(generator.set_moving_target(&motion(0.0, -4.1)), refused);
    // A target at its velocity limit must not accelerate, because its velocity would exceed the
    // limit shortly before or afterwards.
    assert_eq!(generator.set_moving_target(&motion(0.8, 1.0)), refused);
    assert_eq!(
        generator.set_moving_target(&motion(f64::NAN, 0.0)),
        Err(PlanError::NotFinite {
            quantity: Quantity::TargetVelocity,
            axis: 2
        })
    );
    assert_eq!(generator.target(), &[0.3, -0.2, 0.1]);
    generator.set_moving_target(&motion(0.8, 0.0)).unwrap();
    let slow = Limits::from_arrays([0.5; 3], [5.0; 3], [900.0; 3]).unwrap();
    assert_eq!(generator.set_limits(slow), refused);
    assert_eq!(generator.limits(), &limits());
}
