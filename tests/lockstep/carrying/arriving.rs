//! Final position of the bar when nothing holds the arms.

use franka_rt::lifecycle::MotionError;
use franka_rt::session::Tolerance;

use super::{CAP, Carriers, pairs, raised};

#[test]
fn two_arms_carry_one_bar_and_hardly_pull_at_each_other() {
    for pair in pairs(&[0, 9, 10]) {
        let mut carriers = Carriers::pair(pair);
        let at_rest = carriers.internal().norm();
        for (by, yaw, tilt) in [
            (0.1, 0.0, 0.0),
            (-0.1, 0.2, 0.0),
            (0.05, -0.2, 0.15),
            (0.15, 0.3, 0.0),
        ] {
            let (start, [left, right]) = (carriers.bar(), carriers.references());
            let begun = left.inverse() * right;
            let to = raised(&start, by, yaw, tilt);
            let hands = carriers.grasps();
            let goals = carriers.carry(to);
            (carriers.strain, carriers.ticks) = (0.0, 0);
            let (mut gap, mut lag) = (0.0_f64, 0.0_f64);
            while goals
                .iter()
                .zip(&carriers.robots)
                .any(|(goal, robot)| robot.client.outcome(*goal).is_none())
            {
                carriers.tick();
                gap = gap.max(carriers.gap(&begun));
                lag = lag.max(carriers.lag(&hands));
                assert!(carriers.ticks < 20_000, "pair {pair}: it never arrives");
            }
            let ended = carriers.until_resolved(goals, 1);
            assert_eq!(ended, [Ok(()), Ok(())], "pair {pair}");
            let arrived = carriers.bar();
            let off = (arrived.translation.vector - to.translation.vector).norm();
            let turned = arrived.rotation.angle_to(&to.rotation);
            println!(
                "pair {pair}, {by} m, {yaw}, {tilt} rad in {} ms: off by {off:.4} m, {turned:.4} \
                 rad; internal force {:.1} N (at rest {at_rest:.1} N), references apart by \
                 {gap:.5} m, arms behind by {lag:.4} m",
                carriers.ticks, carriers.strain
            );
            // Both within the tolerance of arrival; turned by 9.4 mrad at most.
            assert!(off < 2.1e-3 && turned < 10e-3, "{off} m, {turned} rad");
            assert!(gap < 0.7e-3, "{gap} m");
            // Half of the distance at which the other one halts.
            assert!(lag < 7.5e-3, "{lag} m");
            // Arms with different errors of position pull at each other up to the cap.
            let most = if pair == 0 { 4.0 } else { CAP + 3.0 };
            assert!(carriers.strain < most, "{} N", carriers.strain);
        }
    }
}

#[test]
fn a_motion_that_is_tighter_than_both_arms_can_keep_says_so() {
    // Both arms have an individual tolerance here, so none is added for the distance between them.
    let mut carriers = Carriers::pair(9);
    let to = raised(&carriers.bar(), 0.1, 0.0, 0.0);
    let goals = carriers.carry_within(to, Some(Tolerance::default()));
    let ended = carriers.until_resolved(goals, 20_000);
    let short = ended
        .iter()
        .any(|it| matches!(it, Err(MotionError::TargetNotReached(_))));
    assert!(short, "{ended:?}");
}
