use franka_model::RobotKind;

use super::*;

const KIND: RobotKind = RobotKind::Fer;

fn families() -> [(&'static str, Family); 3] {
    [
        ("nominal", Family::nominal()),
        ("realistic", Family::realistic()),
        ("bad", Family::bad()),
    ]
}

#[test]
fn embedded_families_survive_a_json_round_trip() {
    for (name, family) in families() {
        let again = Family::from_json(&family.to_json()).expect("what was written");
        assert_eq!(again, family, "{name}");
    }
}

#[test]
fn a_seed_gives_the_same_arm_and_another_one_another() {
    for (name, family) in families() {
        let arm = Arm::sample(KIND, 7, &family);
        assert_eq!(arm, Arm::sample(KIND, 7, &family), "{name}");
        assert_ne!(arm, Arm::sample(KIND, 8, &family), "{name}");
    }
}

#[test]
fn samples_fill_their_distributions_and_stay_within() {
    let family = Family::realistic();
    let arms: Vec<_> = (0..2000)
        .map(|seed| Arm::sample(KIND, seed, &family))
        .collect();
    let range = |value: &dyn Fn(&Arm) -> f64| {
        let values = arms.iter().map(value);
        values.fold((f64::MAX, f64::MIN), |(low, high), v| {
            (low.min(v), high.max(v))
        })
    };
    let spans = |(low, high): (f64, f64), from: f64, to: f64| {
        let margin = 0.05 * (to - from);
        low >= from && low < from + margin && high <= to && high > to - margin
    };
    let ratio = |arm: &Arm| arm.friction.kinetic_torque[2] / arm.friction.static_torque[2];
    assert!(spans(range(&ratio), 0.6, 0.95));
    assert!(spans(range(&|arm| arm.friction.viscous[6]), 0.0, 0.4));
    assert!(spans(range(&|arm| arm.friction.link_share[0]), 0.3, 0.7));
    assert!(spans(range(&|arm| arm.drive.torque_lag), 0.002, 0.005));
    assert!(spans(range(&|arm| arm.body.mass_error[4]), -0.03, 0.03));
    assert!(spans(range(&|arm| arm.body.com_error[4].y), -0.005, 0.005));
    assert!(spans(range(&|arm| arm.body.undeclared_mass), 0.0, 0.1));
    // The product of two factors reaches its ends rarely.
    let (low, high) = range(&|arm| arm.friction.static_torque[3]);
    assert!(
        low > 0.8 - 1e-9 && high < 1.2 * 1.495 + 1e-9,
        "{low} {high}"
    );
    assert!(low < 0.86 && high > 1.73, "{low} {high}");

    let share = |delay: u32| {
        arms.iter()
            .filter(|arm| arm.drive.command_delay == delay)
            .count()
    };
    let shares = [share(1), share(2)];
    assert_eq!(shares.iter().sum::<usize>(), arms.len());
    assert!(shares.iter().all(|&count| count > 900), "{shares:?}");

    let rms = |value: &dyn Fn(&Arm) -> f64| {
        let squares: f64 = arms.iter().map(|arm| value(arm).powi(2)).sum();
        (squares / arms.len() as f64).sqrt()
    };
    assert!((rms(&|arm| arm.sensors.torque_offset[1]) - 0.3).abs() < 0.02);
    assert!((rms(&|arm| arm.drive.pose_torque.cosine[1]) - 0.15).abs() < 0.01);
    let turn = |arm: &Arm| arm.body.kinematic_error[5].rotation.scaled_axis().x;
    assert!((rms(&turn) - 0.004).abs() < 2e-4);
    let tilt = |arm: &Arm| arm.body.gravity_earth.x / 9.81;
    assert!((rms(&tilt) - 0.00436).abs() < 3e-4);
}

#[test]
fn a_central_arm_is_the_middle_and_only_an_fer_stalls() {
    let arm = Arm::realistic(KIND);
    assert!((arm.drive.torque_lag - 0.0035).abs() < 1e-12);
    assert_eq!(arm.drive.command_delay, 1);
    assert_eq!(arm.sensors.torque_offset, JointVector::zeros());
    assert_eq!(arm.drive.pose_torque, PoseTorque::NONE);
    assert_eq!(arm.body.kinematic_error, [Isometry3::identity(); 7]);
    assert!((arm.friction.static_torque[0] - 1.0325).abs() < 1e-12);
    assert_eq!(arm.stalls, Some(Stalls::FER));
    assert_eq!(Arm::realistic(RobotKind::Fr3).stalls, None);
    assert_eq!(Arm::nominal(KIND).stalls, None);
}

#[test]
fn invalid_family_names_the_field_and_the_expectation() {
    let text = Family::realistic().to_json();
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let error = |field: &str, json: &str| {
        let mut changed = value.clone();
        changed[field] = serde_json::from_str(json).expect("JSON");
        let refused = Family::from_json(&changed.to_string());
        refused.expect_err("no family").to_string()
    };
    for (field, json, expected) in [
        ("torque_lag", r#"{"constant": "long"}"#, "torque_lag"),
        (
            "torque_lag",
            r#"{"constant": "long"}"#,
            "expected a number, or seven numbers",
        ),
        ("torque_lag", r#"{"constant": [1, 2]}"#, "invalid length 2"),
        ("torque_lag", r#"{"exact": 1}"#, "unknown variant `exact`"),
        (
            "torque_lag",
            r#"{"uniform": {"low": 1}}"#,
            "missing field `high`",
        ),
        (
            "torque_lag",
            r#"{"constant": -0.001}"#,
            "torque_lag: -0.001, expected 0 to 0.1",
        ),
        (
            "torque_lag",
            r#"{"constant": [0, 0, 0, 0, 0, 0, 0]}"#,
            "torque_lag: seven numbers, expected one number for the whole arm",
        ),
        (
            "stribeck_speed",
            r#"{"constant": 0}"#,
            "stribeck_speed: 0, expected more than 0",
        ),
        (
            "link_share",
            r#"{"uniform": {"low": 0.5, "high": 1.5}}"#,
            "link_share: 1.5, expected 0 to 1",
        ),
        (
            "link_share",
            r#"{"uniform": {"low": 0.5, "high": 0.4}}"#,
            "link_share: low 0.5, high 0.4, expected low at most as large as high",
        ),
        (
            "static_friction",
            r#"{"normal": {"mean": 1, "rms": 0.1}}"#,
            "static_friction: a normal distribution, which has no bounds, expected a constant or \
             uniform distribution",
        ),
        (
            "torque_offset",
            r#"{"normal": {"mean": 0, "rms": -1}}"#,
            "torque_offset: rms -1, expected an rms of 0 or more",
        ),
        (
            "command_delay",
            r#"{"constant": 0}"#,
            "command_delay: 0, expected a whole number, 1 to 20",
        ),
        (
            "command_delay",
            r#"{"uniform": {"low": 1, "high": 2.5}}"#,
            "command_delay: 2.5, expected a whole number",
        ),
        ("wobble", r#"{"constant": 0}"#, "unknown field `wobble`"),
        (
            "elasticity",
            r#"{"stiffness": {"constant": 0}, "damping": {"constant": 1}}"#,
            "elasticity.stiffness: 0, expected more than 0",
        ),
    ] {
        let error = error(field, json);
        assert!(error.contains(expected), "{field} {json}: {error}");
    }
    for field in ["torque_lag", "elasticity"] {
        let mut less = value.clone();
        less.as_object_mut().expect("an object").remove(field);
        let error = Family::from_json(&less.to_string()).expect_err("too little");
        assert!(
            error
                .to_string()
                .contains(&format!("missing field `{field}`")),
            "{error}"
        );
    }
    assert!(Family::from_json(&format!("{text} more")).is_err());
    assert!(Family::from_json("").is_err());
}
