//! Compares the robot's joint limits with known limits.

use franka_async::model::limits::JointLimits;
use franka_async::model::{JointVector, RobotKind};

type Table = (&'static str, &'static JointLimits);

fn tables(kind: RobotKind) -> Vec<Table> {
    match kind {
        RobotKind::Fr3 => vec![
            ("systems before 5.9", JointLimits::of(kind)),
            ("systems from 5.9 on", JointLimits::fr3_system_5_9()),
        ],
        kind => vec![("the vendor's documentation", JointLimits::of(kind))],
    }
}

/// Returns the closest table, and the largest difference from this table, if there is any.
pub(super) fn nearest(kind: RobotKind, served: &JointLimits) -> (&'static str, Option<String>) {
    let compared = tables(kind).into_iter().map(|(name, table)| {
        let most = differences(served, table)
            .max_by(|one, other| one.0.total_cmp(&other.0))
            .filter(|(difference, _)| difference.is_nan() || *difference > SAME);
        (name, most)
    });
    let size = |most: &Option<(f64, String)>| most.as_ref().map_or(0.0, |(size, _)| *size);
    let nearest = compared.min_by(|one, other| size(&one.1).total_cmp(&size(&other.1)));
    let (name, most) = nearest.expect("every kind has a table");
    (name, most.map(|(_, text)| text))
}

/// Returns the difference for each limit, with a text that describes the difference.
fn differences(served: &JointLimits, table: &JointLimits) -> impl Iterator<Item = (f64, String)> {
    let (of_served, of_table) = (columns(served), columns(table));
    of_served
        .into_iter()
        .zip(of_table)
        .flat_map(|((name, unit, served), (_, _, known))| {
            (0..7).map(move |i| {
                let (got, expected) = (served[i], known[i]);
                let text = format!(
                    "{name} of joint {} is {got:.4} {unit} instead of {expected:.4}",
                    i + 1
                );
                ((got - expected).abs(), text)
            })
        })
}

/// Returns the limits that a robot description contains.
pub(super) fn columns(limits: &JointLimits) -> [(&'static str, &'static str, JointVector); 7] {
    let (deceleration, offset) = match &limits.envelope {
        Some(envelope) => (envelope.deceleration, envelope.offset),
        None => Default::default(),
    };
    [
        ("lower", "rad", limits.lower),
        ("upper", "rad", limits.upper),
        ("hard_lower", "rad", limits.hard_lower),
        ("hard_upper", "rad", limits.hard_upper),
        ("velocity", "rad/s", limits.velocity),
        ("envelope_deceleration", "rad/s2", deceleration),
        ("envelope_offset", "rad/s", offset),
    ]
}

/// Largest difference that rounding in a text can cause.
const SAME: f64 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_table_is_found_and_a_difference_named() {
        for kind in [RobotKind::Fr3, RobotKind::Fer] {
            for (name, table) in tables(kind) {
                assert_eq!(nearest(kind, table), (name, None));
            }
        }
        let mut limits = *JointLimits::fr3_system_5_9();
        limits.hard_upper[3] += 0.02;
        let (name, difference) = nearest(RobotKind::Fr3, &limits);
        assert_eq!(name, "systems from 5.9 on");
        let expected = "hard_upper of joint 4 is -0.0909 rad instead of -0.1109";
        assert_eq!(difference.as_deref(), Some(expected));
        limits.velocity[0] = f64::NAN;
        let (_, difference) = nearest(RobotKind::Fr3, &limits);
        assert!(difference.is_some_and(|text| text.contains("velocity of joint 1")));
    }
}
