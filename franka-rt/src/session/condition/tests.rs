use core::time::Duration;

use franka_model::{Jacobian, JointVector};
use franka_proto::RobotState;
use nalgebra::Isometry3;
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::*;
use crate::session::running::Measured;

struct Arm {
    state: RobotState,
    measured: Measured,
}

impl Arm {
    fn new() -> Self {
        let q = [0.1, 0.2, 0.3, -2.0, 0.5, 1.6, 0.7];
        let mut jacobian = Jacobian::zeros();
        // Joint i moves the end effector only along or about axis i.
        jacobian.fill_diagonal(1.0);
        Self {
            state: RobotState {
                q,
                ..RobotState::default()
            },
            measured: Measured {
                time: 1000,
                q: q.into(),
                dq: JointVector::zeros(),
                modelled: Isometry3::translation(0.3, -0.1, 0.5),
                reported: RobotState::default().O_T_EE,
                pose: Isometry3::translation(0.3, -0.1, 0.5),
                object: Isometry3::translation(0.3, -0.1, 0.5),
                jacobian,
            },
        }
    }

    /// True if a condition is true in the first state that is passed to it.
    fn meets(&self, condition: Condition) -> bool {
        assert_eq!(condition.check(), Ok(()));
        Watch::new(condition, self.measured.time).is_met(&self.observed(), &self.measured)
    }

    fn observed(&self) -> Observed {
        Observed::of(&self.state)
    }
}

const MS: Duration = Duration::from_millis(1);

#[test]
fn every_quantity_is_the_number_of_the_state_that_it_names() {
    let mut arm = Arm::new();
    // The torque is about the stiffness frame. Here, that frame is rotated by half a turn about z
    // against the base axes.
    arm.state.O_F_ext_hat_K = [3.0, -4.0, 12.0, 5.0, 6.0, 7.0];
    arm.state.K_F_ext_hat_K = [-3.0, 4.0, 12.0, -0.3, 0.4, 1.2];
    (arm.state.EE_T_K[0], arm.state.EE_T_K[5]) = (-1.0, -1.0);
    arm.state.tau_ext_hat_filtered = [1.0, 2.0, -8.0, 4.0, 5.0, 6.0, 7.0];
    arm.state.dq = [0.3, -0.4, 1.2, 0.6, 0.8, 2.4, 0.9];
    let [x, y, z] = [Axis::X, Axis::Y, Axis::Z];
    let all = [
        (Quantity::Force(x), 3.0),
        (Quantity::Force(y), -4.0),
        (Quantity::Force(z), 12.0),
        (Quantity::ForceNorm, 13.0),
        (Quantity::Torque(x), 0.3),
        (Quantity::Torque(y), -0.4),
        (Quantity::Torque(z), 1.2),
        (Quantity::TorqueNorm, 1.3),
        (Quantity::JointTorque(1), 1.0),
        (Quantity::JointTorque(7), 7.0),
        (Quantity::LargestJointTorque, 8.0),
        (Quantity::Position(x), 0.3),
        (Quantity::Position(y), -0.1),
        (Quantity::Position(z), 0.5),
        (Quantity::Velocity(x), 0.3),
        (Quantity::Velocity(y), -0.4),
        (Quantity::Velocity(z), 1.2),
        (Quantity::Speed, 1.3),
        (Quantity::AngularVelocity(x), 0.6),
        (Quantity::AngularVelocity(y), 0.8),
        (Quantity::AngularVelocity(z), 2.4),
        (Quantity::AngularSpeed, 2.6),
        (Quantity::JointPosition(4), -2.0),
        (Quantity::JointVelocity(2), -0.4),
    ];
    for (quantity, value) in all {
        for (condition, met) in [
            (quantity.above(value - 1e-9), true),
            (quantity.above(value + 1e-9), false),
            (quantity.below(value + 1e-9), true),
            (quantity.below(value - 1e-9), false),
            (quantity.beyond(value.abs() - 1e-9), true),
            (quantity.beyond(value.abs() + 1e-9), false),
        ] {
            assert_eq!(arm.meets(condition), met, "{quantity:?} of {value}");
        }
    }
    let shorthands = [
        (force_x(3.0), force_x(3.1)),
        (force_y(4.0), force_y(4.1)),
        (force_z(12.0), force_z(12.1)),
        (force(13.0 - 1e-9), force(13.1)),
        (torque(1.3 - 1e-9), torque(1.31)),
        (joint_torques(8.0), joint_torques(8.1)),
    ];
    for (met, not) in shorthands {
        assert!(arm.meets(met) && !arm.meets(not), "{met:?}");
    }
}

#[test]
fn a_number_at_its_threshold_fulfils_the_comparison() {
    let arm = Arm::new();
    let y = Quantity::Position(Axis::Y);
    for met in [y.above(-0.1), y.below(-0.1), y.beyond(0.1)] {
        assert!(arm.meets(met), "{met:?}");
    }
    for beside in [y.above(-0.0999), y.below(-0.1001), y.beyond(0.1001)] {
        assert!(!arm.meets(beside), "{beside:?}");
    }
}

#[test]
fn flags_are_what_the_robot_reports() {
    let mut arm = Arm::new();
    let all = [
        contact(),
        joint_contact(3),
        cartesian_contact(),
        collision(),
    ];
    let seen = |arm: &Arm| all.map(|condition| arm.meets(condition));
    assert_eq!(seen(&arm), [false; 4]);
    arm.state.joint_contact[2] = 1.0;
    assert_eq!(seen(&arm), [true, true, false, false]);
    arm.state.joint_contact = [1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    assert_eq!(seen(&arm), [true, false, false, false]);
    arm.state.joint_contact = [0.0; 7];
    arm.state.cartesian_contact[5] = 1.0;
    assert_eq!(seen(&arm), [true, false, true, false]);
    arm.state.joint_collision[6] = 1.0;
    arm.state.cartesian_contact = [0.0; 6];
    assert_eq!(seen(&arm), [false, false, false, true]);
}

/// Returns a random condition with at most this number of nodes, and its expected result. The
/// result is computed by recursion from operands that evaluate to `values`.
fn random_condition(
    random: &mut SmallRng,
    nodes: usize,
    values: &[Option<bool>; 7],
) -> (Condition, Option<bool>) {
    if nodes < 3 || random.random_bool(0.2) {
        let joint = random.random_range(0..7);
        let above = Quantity::JointTorque(joint as u8 + 1).above(0.5);
        return (above, values[joint]);
    }
    match random.random_range(0..3) {
        0 => {
            let (condition, value) = random_condition(random, nodes - 1, values);
            (!condition, value.map(|value| !value))
        }
        kind => {
            let first = random.random_range(1..nodes - 1);
            let (a, a_is) = random_condition(random, first, values);
            let (b, b_is) = random_condition(random, nodes - 1 - first, values);
            // Value with which one operand alone decides the result.
            let decisive = kind == 1;
            let joined = if decisive { a | b } else { a & b };
            let value = match (a_is, b_is) {
                (Some(value), _) | (_, Some(value)) if value == decisive => Some(decisive),
                (Some(_), Some(_)) => Some(!decisive),
                _ => None,
            };
            (joined, value)
        }
    }
}

#[test]
fn operators_join_what_is_true_false_and_unknown() {
    let mut random = SmallRng::seed_from_u64(5);
    let (mut met, mut unknown) = (0, 0);
    for _ in 0..20_000 {
        let values = core::array::from_fn(|_| match random.random_range(0..5) {
            0 => None,
            value => Some(value % 2 == 0),
        });
        let nodes = random.random_range(1..=Condition::ROOM);
        let (condition, expected) = random_condition(&mut random, nodes, &values);
        let mut arm = Arm::new();
        arm.state.tau_ext_hat_filtered = values.map(|value| match value {
            Some(true) => 1.0,
            Some(false) => 0.0,
            None => f64::NAN,
        });
        assert_eq!(
            arm.meets(condition),
            expected == Some(true),
            "{condition:?}"
        );
        met += u32::from(expected == Some(true));
        unknown += u32::from(expected.is_none());
    }
    assert!(met > 5000 && unknown > 1000, "{met} {unknown}");
}

#[test]
fn numbers_that_are_not_finite_fulfil_nothing() {
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut arm = Arm::new();
        arm.state.O_F_ext_hat_K = [number; 6];
        arm.state.K_F_ext_hat_K = [number; 6];
        arm.state.tau_ext_hat_filtered[3] = number;
        arm.state.dq[0] = number;
        for quantity in [
            Quantity::Force(Axis::X),
            Quantity::ForceNorm,
            Quantity::TorqueNorm,
            Quantity::LargestJointTorque,
            Quantity::Speed,
            Quantity::JointVelocity(1),
        ] {
            for condition in [
                quantity.above(1.0),
                quantity.below(1.0),
                quantity.beyond(1.0),
            ] {
                for condition in [
                    condition,
                    condition.relative(),
                    condition.held_for(Duration::ZERO),
                ] {
                    assert!(!arm.meets(condition), "{quantity:?}");
                    assert!(!arm.meets(!condition), "{quantity:?}");
                    assert!(arm.meets(condition | elapsed(Duration::ZERO)));
                    assert!(!arm.meets(condition & elapsed(Duration::ZERO)));
                }
            }
        }
    }
    let mut arm = Arm::new();
    arm.state.joint_contact[0] = f64::NAN;
    assert!(!arm.meets(contact()) && !arm.meets(!contact()));
    arm.state.cartesian_contact[0] = 1.0;
    assert!(arm.meets(contact()));
}

#[test]
fn time_counts_by_the_clock_of_the_robot_across_lost_states() {
    let mut arm = Arm::new();
    let mut watch = Watch::new(elapsed(100 * MS), 1000);
    for (time, met) in [(1000, false), (1099, false), (1100, true), (2500, true)] {
        arm.measured.time = time;
        assert_eq!(watch.is_met(&arm.observed(), &arm.measured), met, "{time}");
    }
    // The goal begins between two states.
    let mut watch = Watch::new(elapsed(Duration::ZERO), 5000);
    assert!(watch.is_met(&arm.observed(), &arm.measured));
}

#[test]
fn a_condition_that_has_to_hold_begins_anew_after_each_break() {
    let mut arm = Arm::new();
    let mut watch = Watch::new(force_z(5.0).held_for(10 * MS), 1000);
    let mut at = |time: u64, force: f64| {
        arm.measured.time = time;
        arm.state.O_F_ext_hat_K[2] = force;
        watch.is_met(&arm.observed(), &arm.measured)
    };
    for time in 1000..1010 {
        assert!(!at(time, -6.0), "{time}");
    }
    assert!(at(1010, -6.0));
    assert!(at(1011, 6.0));
    assert!(!at(1012, 4.0));
    assert!(!at(1013, 6.0));
    assert!(!at(1022, 6.0));
    assert!(at(1023, 6.0), "nine states are lost before it");
    assert!(!at(1024, f64::NAN));
    assert!(!at(1025, 6.0));
}

#[test]
fn changes_count_from_the_first_state_that_is_finite() {
    let mut arm = Arm::new();
    arm.state.O_F_ext_hat_K = [3.0, 0.0, f64::NAN, 0.0, 0.0, 0.0];
    let along_x = force_x(5.0).relative();
    let along_z = force_z(5.0).relative();
    let norm = force(5.0).relative();
    let mut watches = [along_x, along_z, norm].map(|condition| Watch::new(condition, 1000));
    let mut see = |force: [f64; 3]| {
        arm.state.O_F_ext_hat_K[..3].copy_from_slice(&force);
        watches
            .each_mut()
            .map(|watch| watch.is_met(&arm.observed(), &arm.measured))
    };
    assert_eq!(see([3.0, 0.0, f64::NAN]), [false; 3]);
    assert_eq!(see([7.9, 0.0, 20.0]), [false; 3]);
    assert_eq!(see([8.0, 0.0, 20.0]), [true, false, true]);
    assert_eq!(see([-2.0, 0.0, 20.0]), [true, false, true]);
    assert_eq!(see([6.0, 0.0, 16.0]), [false, false, true]);
    assert_eq!(see([3.0, 0.0, 15.0]), [false, true, true]);
}

#[test]
fn impossible_condition_is_refused() {
    let nan = Quantity::Speed.below(f64::NAN).check().unwrap_err();
    assert!(matches!(nan, ConditionError::Threshold { .. }), "{nan}");
    for wrong in [f64::NAN, f64::INFINITY, 0.0, -5.0] {
        let condition = elapsed(MS) & !(contact() | force_z(wrong));
        let error = condition.check().unwrap_err();
        let of_force = matches!(
            error,
            ConditionError::Threshold {
                quantity: Quantity::Force(Axis::Z),
                ..
            }
        );
        assert!(of_force, "{error}");
    }
    assert_eq!(Quantity::Force(Axis::Z).below(-5.0).check(), Ok(()));
    for (condition, got) in [
        (Quantity::JointPosition(0).above(0.0), 0),
        (Quantity::JointTorque(8).beyond(1.0), 8),
        (joint_contact(255), 255),
    ] {
        assert_eq!(condition.check(), Err(ConditionError::Joint { got }));
        let arm = Arm::new();
        let mut watch = Watch::new(condition | !condition, 1000);
        assert!(!watch.is_met(&arm.observed(), &arm.measured));
    }
}

#[test]
fn a_condition_that_outgrows_its_room_is_refused_with_its_size() {
    let twelve = (1..12).fold(contact(), |all, _| all | force_z(5.0));
    assert_eq!(twelve.check(), Ok(()));
    let full = !twelve;
    assert_eq!(full.length, Condition::ROOM);
    assert_eq!(full.check(), Ok(()));
    for (condition, got) in [
        (!full, Condition::ROOM + 1),
        (full & full, 2 * Condition::ROOM + 1),
        (full & full & full, 3 * Condition::ROOM + 2),
        (full.held_for(MS), Condition::ROOM + 1),
        (full.relative() | force_x(-1.0), Condition::ROOM + 2),
    ] {
        assert_eq!(condition.check(), Err(ConditionError::TooLong { got }));
    }
}

/// Uses an arm whose stiffness frame is rotated by half a turn about x against the base.
#[test]
fn tared_comparisons_are_of_what_has_changed_since_the_tare() {
    let mut arm = Arm::new();
    (arm.state.EE_T_K[5], arm.state.EE_T_K[10]) = (-1.0, -1.0);
    arm.state.O_F_ext_hat_K = [1.0, 2.0, -4.0, 9.0, 9.0, 9.0];
    arm.state.K_F_ext_hat_K = [1.0, -2.0, 4.0, 0.3, -0.2, -0.1];
    arm.state.tau_ext_hat_filtered = [0.5; 7];
    let tare = WrenchTare {
        wrench: [1.5, 2.0, 1.0, 0.3, 0.0, 0.0],
        joint_torques: [0.5; 7],
        ..WrenchTare::default()
    };
    let position = Quantity::Position(Axis::Z);
    for (condition, met) in [
        (force_z(4.9), true),
        (force_z(5.1), false),
        (force_x(0.45), true),
        (force_y(0.1), false),
        (force(5.0), true),
        (force(5.1), false),
        // This is the moment about the stiffness frame, not about the base.
        (torque(0.2), true),
        (torque(0.25), false),
        (Quantity::Torque(Axis::Y).above(0.19), true),
        (joint_torques(0.1), false),
        // These quantities have no tare.
        (position.above(0.49), true),
        (position.above(0.51), false),
    ] {
        assert_eq!(arm.meets(condition.tared(&tare)), met, "{condition:?}");
    }
    // A change has no tare, in either order of the calls.
    let (change, tared) = (force_z(1.0).relative(), force_z(1.0).tared(&tare));
    assert_eq!(change.tared(&tare), tared.relative());
    assert!(arm.meets(tared) && !arm.meets(tared.relative()));
    // The tared comparison is joined with other comparisons, which use the whole wrench.
    let both = force_z(4.9).tared(&tare) & force_z(3.9) & !force_z(4.1);
    assert!(arm.meets(both));
    assert!(arm.meets(!force_z(5.1) & force_z(4.9).tared(&tare)));
    let other = WrenchTare::default();
    let two = force_z(1.0).tared(&tare) | force_z(1.0).tared(&other);
    assert_eq!(two.check(), Err(ConditionError::Tare));
    // Near a singularity the robot reports zeros, so the arm counts neither as touched nor as
    // untouched.
    arm.state.O_F_ext_hat_K = [0.0; 6];
    arm.state.K_F_ext_hat_K = [0.0; 6];
    for condition in [force_z(0.5), !force_z(0.5), torque(0.1), !force(0.1)] {
        assert!(!arm.meets(condition.tared(&tare)), "{condition:?}");
    }
    assert!(!arm.meets(joint_torques(0.1).tared(&tare)));
    assert!(arm.meets(!joint_torques(0.1).tared(&tare)));
}
