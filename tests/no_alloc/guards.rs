//! The guards that act on the reference, while they bind.

use std::time::Duration;

use franka_lockstep::{Lockstep, Part};
use franka_model::collision::Obstacle;
use franka_model::{READY, Wrench};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::lifecycle::Engagement;
use franka_rt::session::condition::{Axis, Condition, Quantity, contact, elapsed, force};
use franka_rt::session::{Bindings, Goal, Guard, KeepOut, Lead, OnArrival, Target};
use nalgebra::Translation3;

use super::calls_during;

/// Advances by one tick and returns how often the driver called the allocator; marks which of
/// `guards` bound.
fn count(
    lockstep: &mut Lockstep,
    milliseconds: u64,
    guards: &[Guard],
    bound: &mut [bool],
    mut each: impl FnMut(&mut Lockstep),
) -> u64 {
    let mut calls = 0;
    for _ in 0..milliseconds {
        each(lockstep);
        lockstep.tick_around(|part, work| {
            let during = calls_during(work);
            if part == Part::Answer {
                calls += during;
            }
        });
        let bindings: Bindings = lockstep.client.record.bindings;
        for (bound, guard) in bound.iter_mut().zip(guards) {
            *bound |= bindings.contains(*guard);
        }
    }
    calls
}

#[test]
fn binding_guards_never_call_the_allocator() {
    let guards = [Guard::Clearance, Guard::Lead, Guard::Deviation];
    let mut bound = [false; 3];
    let mut lockstep = Lockstep::ready();
    let tolerant = CollisionBehavior::uniform([1000.0; 7], [1000.0; 7], [1000.0; 6], [1000.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    let mut regions = KeepOut::default();
    regions[0] = Some(Obstacle::floor(-0.1));
    lockstep.client.lifecycle.keep_out_of(regions);
    lockstep.run(5);

    // A target inside the arm itself, which the lead limits while updates arrive.
    let mut q: [f64; 7] = READY.into();
    q[1] += 1.9;
    let mut goal = lockstep.goal(Target::Joints(q), OnArrival::Hold);
    goal.lead = Some(Lead {
        translation: 0.05,
        rotation: 0.2,
        joints: 0.3,
    });
    let id = lockstep.submit(goal).expect("within the joints' ranges");
    lockstep.run(20);
    let calls = count(&mut lockstep, 12_000, &guards, &mut bound, |lockstep| {
        if lockstep.now().is_multiple_of(50) {
            let now = lockstep.now() as f64;
            q[6] = READY[6] + 1e-6 * now;
            let updated = lockstep.update(id, Target::Joints(q));
            assert_eq!(updated, Ok(true));
        }
    });
    assert_eq!((calls, bound), (0, [true, true, false]));

    // Away from there, and then pulled aside.
    let back = lockstep.begin(Target::Joints(READY.into()));
    lockstep.until_resolved(back, 20_000).expect("a way out");
    let home = lockstep.arm_pose();
    let goal = lockstep.goal(Target::Pose(home), OnArrival::Hold);
    lockstep.submit(goal).expect("it is there already");
    lockstep.run(20);
    let calls = count(&mut lockstep, 4000, &guards, &mut bound, |lockstep| {
        lockstep.robot.let_go();
        let pull = 60.0 - 100.0 * (lockstep.robot.dq().norm() - 0.3).max(0.0);
        let pull = Wrench::new(0.0, pull, 0.0, 0.0, 0.0, 0.0);
        lockstep.robot.push_end_effector(pull, 2);
    });
    assert_eq!((calls, bound), (0, [true; 3]));
}

#[test]
fn the_speed_cap_allocates_and_frees_nothing_where_it_binds() {
    let mut lockstep = Lockstep::ready();
    let engaged = lockstep.engage_with(Engagement {
        speed_cap: Some(0.1),
        ..Engagement::default()
    });
    // Slowed on the way to a pose, and given up on the way over joints.
    let below = Translation3::new(0.0, 0.0, -0.1) * lockstep.arm_pose();
    let mut q: [f64; 7] = READY.into();
    q[0] += 0.8;
    let guards = [Guard::SpeedCap];
    for target in [Target::Pose(below), Target::Joints(q)] {
        let mut bound = [false];
        let goal = lockstep.within(engaged, target, OnArrival::Hold);
        goal.expect("in reach");
        let calls = count(&mut lockstep, 3000, &guards, &mut bound, |_| {});
        assert_eq!((calls, bound), (0, [true]));
    }
}

/// As long as a condition may be, with every kind of operand.
fn full() -> Condition {
    let ms = Duration::from_millis(1);
    let held = (force(50.0).relative() | contact()).held_for(20 * ms);
    let far = Quantity::Position(Axis::Z).above(9.0) | Quantity::LargestJointTorque.beyond(80.0);
    let shaken = !(Quantity::AngularSpeed.below(30.0) | Quantity::JointVelocity(7).below(-30.0));
    let due = elapsed(400 * ms) & Quantity::Speed.below(9.0) & Quantity::TorqueNorm.below(90.0);
    let above = Quantity::JointPosition(4).above(3.0);
    let full = held | far | shaken | due.held_for(2 * ms) | above | above;
    assert!(full.check().is_ok() && (!full).check().is_err());
    full
}

#[test]
fn full_condition_never_calls_the_allocator() {
    for engaged in [false, true] {
        let mut lockstep = Lockstep::ready();
        let home = lockstep.arm_pose();
        let up = Translation3::new(0.0, 0.0, 0.15) * home;
        let on_arrival = match engaged {
            true => OnArrival::ReportAndHold,
            false => OnArrival::ReportAndFinish,
        };
        let goal = Goal {
            reaction: Some(full().then(home)),
            ..lockstep.goal(up.into(), on_arrival)
        };
        let id = match engaged {
            true => {
                let session = lockstep.engage();
                lockstep.submit_within(session, goal)
            }
            false => lockstep.submit(goal),
        };
        let id = id.expect("within reach");
        lockstep.run(20);
        let (mut calls, mut cycles) = (0, 0);
        while lockstep.client.outcome(id).is_none() {
            lockstep.tick_around(|part, work| {
                let during = calls_during(work);
                // A finished motion is handed over after the answer.
                calls += during;
                cycles += u64::from(part == Part::Answer);
            });
        }
        let report = lockstep.until_resolved(id, 1).expect("an arrival");
        assert!(report.reacted.is_some() && report.final_error.is_some());
        assert!(cycles > 500, "{cycles}");
        assert_eq!(calls, 0);
    }
}
