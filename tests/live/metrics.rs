//! The metrics of connections: each line of their text keeps to the format, and its numbers match
//! the handles.

use std::collections::{BTreeMap, HashSet};
use std::time::Duration;

use franka_async::control::{Finish, JointVelocities};
use franka_async::metrics::Exporter;
use franka_async::state::{RobotError, RobotMode};
use franka_async::supervision::Policy;
use franka_async::{MotionError, Realtime, Robot};
use franka_sim::{Sim, Tool};
use franka_tests::PATIENCE;

use crate::{alone, at_the_clients_pace, simulated, until};

/// Each sample of a text by its name with its labels, and its value.
type Samples = BTreeMap<String, f64>;

/// A metric family as its lines of meta data say.
#[derive(Default)]
struct Family {
    name: String,
    kind: Option<String>,
    unit: Option<String>,
}

/// Reads OpenMetrics text 1.0.0.
///
/// # Panics
/// If a line violates the format.
fn parse(text: &str) -> Samples {
    let body = text.strip_suffix("# EOF\n").expect("the end is marked");
    let (mut samples, mut family) = (Samples::new(), Family::default());
    let mut families = HashSet::new();
    for line in body.lines() {
        assert!(!line.is_empty() && line.trim() == line, "{line:?}");
        let Some(meta) = line.strip_prefix("# ") else {
            let (series, value) = line.rsplit_once(' ').expect("a value");
            check_name(&family, series);
            let value: f64 = value.parse().expect("a number");
            assert!(value.is_finite(), "{line}");
            let before = samples.insert(series.to_owned(), value);
            assert_eq!(before, None, "{line}: twice");
            continue;
        };
        let mut words = meta.splitn(3, ' ');
        let mut word = || words.next().expect("three words").to_owned();
        let (keyword, name, rest) = (word(), word(), word());
        if name != family.name {
            assert!(families.insert(name.clone()), "{name} comes twice");
            family = Family {
                name,
                ..Family::default()
            };
        }
        let slot = match keyword.as_str() {
            "HELP" => continue,
            "TYPE" => &mut family.kind,
            "UNIT" => &mut family.unit,
            other => panic!("unknown: {other}"),
        };
        assert_eq!(slot.replace(rest), None, "{line}: twice");
    }
    check_histograms(&samples);
    samples
}

/// A series belongs to the family above it, by the suffix that its type has, and its labels are
/// written as labels are.
fn check_name(family: &Family, series: &str) {
    let (name, labels) = series
        .split_once('{')
        .expect("every sample here has labels");
    let suffix = name
        .strip_prefix(&family.name)
        .expect("it is of the family");
    let suffixes: &[_] = match family.kind.as_deref() {
        Some("gauge") => &[""],
        Some("counter") => &["_total"],
        Some("info") => &["_info"],
        Some("histogram") => &["_bucket", "_sum", "_count"],
        other => panic!("{name}: type {other:?}"),
    };
    assert!(suffixes.contains(&suffix), "{series}");
    assert!(
        name.chars().all(|c| c.is_ascii_lowercase() || c == '_'),
        "{name}"
    );
    if let Some(unit) = &family.unit {
        assert!(family.name.ends_with(&format!("_{unit}")), "{name}: {unit}");
    }
    let labels = labels.strip_suffix('}').expect("the labels end");
    for label in labels.split(',') {
        let (key, value) = label.split_once("=\"").expect("a label");
        assert!(
            !key.is_empty() && key.chars().all(|c| c.is_ascii_lowercase()),
            "{series}"
        );
        let value = value.strip_suffix('"').expect("a quoted value");
        assert!(!value.contains(['"', '\\']), "{series}");
    }
}

/// The buckets of a histogram add up to its count, and their bounds rise to infinity.
fn check_histograms(samples: &Samples) {
    for (series, &count) in samples {
        let Some((name, robot)) = series.split_once("_count{") else {
            continue;
        };
        let (family, robot) = (format!("{name}_bucket{{"), robot.trim_end_matches('}'));
        let of_it = |bucket: &str| bucket.starts_with(&family) && bucket.contains(robot);
        let buckets = samples.iter().filter(|(bucket, _)| of_it(bucket));
        let mut buckets: Vec<(f64, f64)> = buckets
            .map(|(bucket, &count)| {
                let (_, bound) = bucket.split_once("le=\"").expect("a bound");
                let (bound, _) = bound.split_once('"').expect("a quoted value");
                (bound.parse().expect("a number, or +Inf"), count)
            })
            .collect();
        buckets.sort_by(|one, other| one.0.total_cmp(&other.0));
        assert!(
            buckets.is_sorted_by(|one, other| one.1 <= other.1),
            "{buckets:?}"
        );
        assert_eq!(buckets.last(), Some(&(f64::INFINITY, count)), "{name}");
    }
}

/// The value of one sample of a robot.
fn sample(samples: &Samples, name: &str, robot: &str, labels: &str) -> f64 {
    let series = format!("{name}{{robot=\"{robot}\"{labels}}}");
    let value = samples.get(&series);
    *value.unwrap_or_else(|| panic!("no {series} in {samples:#?}"))
}

#[tokio::test]
async fn metrics_show_counts_of_the_handle_and_mode_of_the_state() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let label = robot.address().to_string();
    robot.move_joints(robot.state().q_d).await.unwrap();
    let counts = |robot: &Robot| {
        let stats = robot.stats();
        [
            ("franka_cycles_total", stats.states.get()),
            ("franka_commands_total", stats.commands.get()),
            ("franka_commands_late_total", stats.overrun.count()),
            ("franka_states_lost_total", stats.lost.get()),
            ("franka_states_skipped_total", stats.skipped.get()),
            (
                "franka_state_interval_seconds_count",
                stats.interval.count(),
            ),
            (
                "franka_cycle_turnaround_seconds_count",
                stats.turnaround.count(),
            ),
        ]
    };
    // The thread continues to count: the text lies between the counts before and after it.
    let before = counts(&robot);
    let text = robot.metrics();
    let after = counts(&robot);
    let samples = parse(&text);
    for ((name, before), (_, after)) in before.into_iter().zip(after) {
        let value = sample(&samples, name, &label, "");
        let range = before as f64..=after as f64;
        assert!(
            range.contains(&value),
            "{name}: {value}, expected {range:?}"
        );
    }
    assert!(
        sample(&samples, "franka_commands_total", &label, "") > 250.0,
        "{text}"
    );
    let sum = sample(&samples, "franka_cycle_turnaround_seconds_sum", &label, "");
    assert!(sum > 0.0, "{text}");
    for mode in RobotMode::ALL {
        let name = mode.to_string().to_lowercase().replace(' ', "_");
        let value = sample(
            &samples,
            "franka_robot_mode",
            &label,
            &format!(",mode=\"{name}\""),
        );
        assert_eq!(
            value,
            f64::from(u8::from(mode == RobotMode::Idle)),
            "{name}"
        );
    }
    assert_eq!(sample(&samples, "franka_connected", &label, ""), 1.0);
    assert_eq!(sample(&samples, "franka_ready", &label, ""), 1.0);
    let motions = |samples: &Samples, outcome| {
        let outcome = format!(",outcome=\"{outcome}\"");
        sample(samples, "franka_motions_total", &label, &outcome)
    };
    assert_eq!(motions(&samples, "done"), 1.0);
    assert_eq!(motions(&samples, "stopped"), 0.0);

    robot.shutdown().await;
    let samples = parse(&robot.metrics());
    assert_eq!(sample(&samples, "franka_connected", &label, ""), 0.0);
    sim.stop().await;
}

#[tokio::test]
async fn metrics_of_robots_share_families_and_name_a_reflex() {
    let _alone = alone();
    let (left, _left) = simulated().await;
    let (right, _right) = at_the_clients_pace(Sim::fer().ideal().tool(Tool::hand())).await;
    let exporter = Exporter::new([("left", left.clone()), ("right", right.clone())]);
    let step = left.control_joint_velocities(|_, _| JointVelocities([0.5; 7]).finish_if(false));
    let outcome = step.limit_rate(false).cutoff_frequency(1000.0).await;
    assert!(
        matches!(outcome, Err(MotionError::Control(_))),
        "{outcome:?}"
    );
    until(&left, |state| state.robot_mode == RobotMode::Reflex).await;
    let samples = parse(&exporter.text());
    let error = "joint_motion_generator_acceleration_discontinuity";
    for (robot, reflex) in [("left", 1.0), ("right", 0.0)] {
        for (name, label, value) in [
            ("franka_error_active", "error", error),
            ("franka_robot_mode", "mode", "reflex"),
            ("franka_reflexes_total", "reason", error),
            ("franka_motions_total", "outcome", "reflex"),
        ] {
            let label = format!(",{label}=\"{value}\"");
            assert_eq!(sample(&samples, name, robot, &label), reflex, "{name}");
        }
        assert_eq!(sample(&samples, "franka_ready", robot, ""), 1.0 - reflex);
    }
    left.shutdown().await;
    right.shutdown().await;
}

#[tokio::test]
async fn recoveries_of_a_supervised_robot_are_counted_and_timed() {
    let _alone = alone();
    let sim = Sim::fr3().ideal().virtual_time(PATIENCE).start().await;
    let sim = sim.expect("a simulator starts");
    let policy = Policy::default().recover(1, Duration::from_secs(60));
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = builder.supervise(policy).connect().await.unwrap();
    let label = robot.address().to_string();
    let before = parse(&robot.metrics());
    assert_eq!(sample(&before, "franka_recoveries_total", &label, ""), 0.0);
    let timed = |samples: &Samples| {
        let name = "franka_recovery_seconds{";
        samples.iter().any(|(series, _)| series.starts_with(name))
    };
    assert!(!timed(&before), "{before:#?}");
    sim.with(|robot| robot.trip(RobotError::CartesianReflex))
        .await
        .unwrap();
    let mut health = robot.health();
    let recovered = health.wait_for(|health| health.recoveries == 1).await;
    recovered.expect("the connection stands");
    let after = parse(&robot.metrics());
    assert_eq!(sample(&after, "franka_recoveries_total", &label, ""), 1.0);
    assert_eq!(sample(&after, "franka_reconnects_total", &label, ""), 0.0);
    assert!(timed(&after), "{after:#?}");
    robot.shutdown().await;
}
