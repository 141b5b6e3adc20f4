//! Arms without contact, whose friction appears in the robot's estimate.

use franka_lockstep::Lockstep;
use franka_model::RobotKind;
use franka_rt::session::condition::{
    Condition, force, force_x, force_y, force_z, joint_torques, torque,
};
use franka_rt::session::{GoalId, OnArrival};
use franka_sim::Arm;
use franka_sim::arm::Family;
use franka_tests::thorough;
use nalgebra::{Translation3, Vector3};

use super::{at, goes_on, realistic, report, with_arm};

/// There and back, 10 cm each.
fn ways() -> [Vector3<f64>; 8] {
    let aslant = Vector3::new(0.5, 0.5, -0.7);
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    [-z, z, x, -x, y, -y, aslant, -aslant].map(|way| way * 0.1)
}

/// The thresholds that the book recommends: so much more at the default pace than up to 0.1 m/s.
fn recommended(velocity: f64) -> Condition {
    let more = if velocity > 0.1 { 1.25 } else { 1.0 };
    let axes = force_x(10.0 * more) | force_y(10.0 * more) | force_z(8.0 * more);
    let values = axes | force(10.0 * more) | torque(3.0 * more) | joint_torques(3.0 * more);
    values | (force_z(8.0 * more) | force(10.0 * more)).relative()
}

/// The largest values in a motion.
#[derive(Clone, Copy, Debug, Default)]
struct Most([f64; 7]);

impl Most {
    const NAMES: [&'static str; 7] = [
        "force along x",
        "y",
        "z",
        "force",
        "torque",
        "of a joint",
        "z, relative",
    ];

    /// Runs until the goal is resolved, and looks at each state.
    fn see(&mut self, lockstep: &mut Lockstep, goal: GoalId) {
        let mut first = None;
        while goes_on(lockstep, goal) {
            lockstep.tick();
            if lockstep.client.record.goal != goal.0 {
                continue;
            }
            let state = &lockstep.client.state;
            let [x, y, z, about @ ..] = state.wrench_at_stiffness_frame();
            let joints = state.tau_ext_hat_filtered;
            let seen = [
                x.abs(),
                y.abs(),
                z.abs(),
                Vector3::new(x, y, z).norm(),
                Vector3::from(about).norm(),
                joints
                    .iter()
                    .fold(0.0, |most, torque| torque.abs().max(most)),
                (z - *first.get_or_insert(z)).abs(),
            ];
            for (most, seen) in self.0.iter_mut().zip(seen) {
                *most = most.max(seen);
            }
        }
    }

    fn print(&self, what: &str) {
        let all = Self::NAMES.iter().zip(self.0);
        let text: Vec<String> = all
            .map(|(name, most)| format!("{name} {most:.1}"))
            .collect();
        println!("{what}: at most {}", text.join(", "));
    }
}

/// A threshold of 5 N, chosen without regard to friction, reacts without contact on some arms.
#[test]
fn recommended_thresholds_trigger_nothing_without_contact() {
    let velocities: &[f64] = match thorough() {
        true => &[0.05, 0.1, 0.3],
        false => &[0.1],
    };
    for &velocity in velocities {
        let mut most = Most::default();
        for seed in 0..20 {
            let kind = RobotKind::ALL[seed as usize % 2];
            let mut lockstep = realistic(kind, seed);
            for way in ways() {
                let target = (Translation3::from(way) * lockstep.arm_pose()).into();
                let goal = at(
                    velocity,
                    target,
                    recommended(velocity),
                    OnArrival::ReportAndFinish,
                    &mut lockstep,
                );
                let goal = lockstep.submit(goal).expect("within reach");
                most.see(&mut lockstep, goal);
                let report = report(&mut lockstep, goal);
                assert_eq!(report.reacted, None, "{kind:?} {seed}, {way}");
                lockstep.until_idle(1000);
            }
        }
        most.print(&format!("realistic, {velocity} m/s"));
        let [along_x, _, along_z, ..] = most.0;
        assert!(along_x > 5.0 && along_z > 5.0, "{most:?}");
    }
}

/// Worn arms with an undeclared load, for the figures of the book.
#[test]
fn bad_arms_that_touch_nothing_feel_twice_as_much() {
    let mut most = Most::default();
    for seed in 0..if thorough() { 8 } else { 3 } {
        let kind = RobotKind::ALL[seed as usize % 2];
        let arm = Arm::sample(kind, seed, &Family::bad());
        let mut lockstep = with_arm(kind, Some(arm), seed);
        for way in ways() {
            let target = (Translation3::from(way) * lockstep.arm_pose()).into();
            let beyond = force(20.0) | force_z(16.0);
            let goal = at(
                0.1,
                target,
                beyond,
                OnArrival::ReportAndFinish,
                &mut lockstep,
            );
            let goal = lockstep.submit(goal).expect("within reach");
            most.see(&mut lockstep, goal);
            assert_eq!(
                report(&mut lockstep, goal).reacted,
                None,
                "{kind:?} {seed}, {way}"
            );
            lockstep.until_idle(1000);
        }
    }
    most.print("bad, 0.1 m/s");
    assert!(most.0[2] > 8.0 && most.0[3] > 10.0, "{most:?}");
}
