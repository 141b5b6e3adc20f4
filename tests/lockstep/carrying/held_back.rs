//! Hindrances and stops of one arm, and their effect on the bar.

use franka_lockstep::pose_of;
use franka_model::{EndEffector, READY};
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{GoalId, Lapse};
use franka_rt::team::{MemberFault, TeamStop};

use super::{APART, CAP, Carriers, MOST, bases, pairs, raised};

#[test]
fn hindered_arm_holds_up_the_other_until_it_is_free() {
    for pair in pairs(&[0, 2, 10]) {
        let mut carriers = Carriers::pair(pair);
        let [left, right] = carriers.references();
        let begun = left.inverse() * right;
        let to = raised(&carriers.bar(), 0.15, 0.0, 0.0);
        let wall = carriers.wall_above(0.04);
        let goals = carriers.carry(to);
        let mut gap = 0.0_f64;
        // Not much less than the time after which an arm that is held back gives up.
        for _ in 0..5000 {
            carriers.tick();
            gap = gap.max(carriers.gap(&begun));
        }
        for (i, goal) in goals.iter().enumerate() {
            assert_eq!(carriers.robots[i].client.outcome(*goal), None);
        }
        let height = carriers.bar().translation.z - to.translation.z + 0.15;
        println!(
            "pair {pair}: held {height:.3} m up: internal force {:.1} N, references apart by \
             {gap:.4} m",
            carriers.strain
        );
        assert!(height < 0.06, "{height} m");
        // The free arm halts within this distance: 12.8 to 17.1 mm.
        assert!(gap < 0.018, "{gap} m");
        let most = if pair == 0 { 12.0 } else { 2.0 * CAP };
        assert!(carriers.strain < most, "{} N", carriers.strain);
        assert!(carriers.robots[0].robot.release(wall));
        let ended = carriers.until_resolved(goals, 20_000);
        assert_eq!(ended, [Ok(()), Ok(())], "pair {pair}");
        let off = carriers.bar().translation.vector - to.translation.vector;
        assert!(off.norm() < 2.1e-3, "pair {pair}: {off:?}");
    }
}

/// If two arms halt, the hindered arm gives up after 5 s, not the waiting one.
#[test]
fn waiting_arm_gives_up_with_the_other_and_not_before() {
    let mut carriers = Carriers::new();
    let to = raised(&carriers.bar(), 0.15, 0.0, 0.0);
    carriers.wall_above(0.04);
    let goals = carriers.carry(to);
    let ended = carriers.until_resolved(goals, 20_000);
    println!("after {} ms: {ended:?}", carriers.ticks);
    let [held, waited] = ended;
    assert!(matches!(held, Err(MotionError::TargetNotReached(_))));
    let stop = TeamStop::Member {
        member: 0,
        fault: MemberFault::NotReached,
    };
    assert_eq!(waited, Err(MotionError::Braked(Lapse::Team(stop))));
}

#[test]
fn stop_of_one_arm_stops_the_other_with_the_bar_in_hand() {
    type Happen = fn(&mut Carriers, [GoalId; 2]);
    let ways: [(&str, Happen, MemberFault); 4] = [
        (
            "held for good",
            |carriers, _| {
                carriers.wall_above(0.02);
            },
            MemberFault::NotReached,
        ),
        (
            "user stop",
            |carriers, _| carriers.robots[0].robot.press_user_stop(true),
            MemberFault::RobotStopped,
        ),
        (
            "link cut",
            |carriers, _| carriers.robots[0].link.drop_states(1500),
            MemberFault::Silent,
        ),
        (
            "taken back",
            |carriers, [left, _]| carriers.robots[0].cancel(left),
            MemberFault::TakenBack,
        ),
    ];
    for (name, happen, fault) in ways {
        let mut carriers = Carriers::new();
        let start = carriers.bar();
        let to = raised(&start, 0.2, 0.0, 0.0);
        let goals = carriers.carry(to);
        carriers.run(500);
        happen(&mut carriers, goals);
        let [left, right] = carriers.until_resolved(goals, 20_000);
        assert!(left.is_err(), "{name}: {left:?}");
        let stop = TeamStop::Member { member: 0, fault };
        let braked = Err(MotionError::Braked(Lapse::Team(stop)));
        // The held bar holds both arms: either may be the first to give up.
        let held = matches!(right, Err(MotionError::TargetNotReached(_)));
        assert!(
            right == braked || fault == MemberFault::NotReached && held,
            "{name}: {right:?}"
        );
        carriers.run(1000);
        let rested = carriers.internal().norm();
        println!(
            "{name}: internal force {:.1} N at most, {rested:.1} N at rest",
            carriers.strain
        );
        assert!(carriers.strain < MOST, "{name}: {} N", carriers.strain);
        // It is still in both hands.
        let held = [0, 1].map(|i| {
            let flange = bases()[i] * carriers.hand(i);
            (flange.inverse() * carriers.bar())
                .translation
                .vector
                .norm()
        });
        let half = APART / 2.0 - pose_of(&READY, &EndEffector::default()).translation.x;
        for held in held {
            assert!((held - half).abs() < 3e-3, "{name}: {held} m, {half} m");
        }
    }
}
