//! The guards that act on the reference, while they bind.

use franka_model::collision::Obstacle;
use franka_model::{READY, Wrench};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::session::{Bindings, Guard, KeepOut, Lead, OnArrival, Target};
use franka_tests::lockstep::{Lockstep, Part};

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
fn clearance_lead_and_deviation_allocate_and_free_nothing_where_they_bind() {
    let guards = [Guard::Clearance, Guard::Lead, Guard::Deviation];
    let mut bound = [false; 3];
    let mut lockstep = Lockstep::ready();
    let tolerant = CollisionBehavior::uniform([1000.0; 7], [1000.0; 7], [1000.0; 6], [1000.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    let mut regions = KeepOut::default();
    regions[0] = Some(Obstacle::floor(-0.1));
    lockstep.client.lifecycle.keep_out_of(regions);
    lockstep.run(5);

    // A target inside the arm itself, which the lead limits as long as updates arrive.
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
