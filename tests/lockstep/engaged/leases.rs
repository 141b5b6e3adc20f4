//! Sessions of clients that hold the lease of the arm.

use std::time::Instant;

use franka_async::connection::lease::{Holder, Lease, Lost, Taken};
use franka_rt::session::Lapse;
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::*;

const SILENCE: Duration = Duration::from_millis(100);

/// From the loss of a lease until the arm rests, `[ms]`: a motion at the default pace brakes in a
/// quarter of a second.
const BRAKING: u64 = 500;

/// An arm whose clients share a lease, on one virtual clock.
struct Shared {
    lockstep: Lockstep,
    lease: Lease,
    now: Instant,
}

impl Shared {
    fn new(ready: &dyn Fn() -> Lockstep) -> Self {
        Self {
            lockstep: ready(),
            lease: Lease::default(),
            now: Instant::now(),
        }
    }

    fn run(&mut self, milliseconds: u64) {
        self.lockstep.run(milliseconds);
        self.now += Duration::from_millis(milliseconds);
    }

    fn take(&self, name: &str) -> Result<Holder, Taken> {
        self.lease.take(name, SILENCE, self.now)
    }

    fn engage(&mut self, holder: &Holder) -> GoalId {
        self.lockstep.engage_with(Engagement {
            deadman: Some(holder.deadman()),
            ..Engagement::default()
        })
    }

    fn head_for(&mut self, engaged: GoalId, by: f64) -> Result<GoalId, MotionError> {
        let on_arrival = OnArrival::ReportAndHold;
        self.lockstep.within(engaged, turned(by), on_arrival)
    }

    /// Moves the arm, with heartbeats.
    fn lead(&mut self, holder: &Holder, milliseconds: u64) {
        for _ in 0..milliseconds / 10 {
            self.run(10);
            holder.keep_alive(self.now).expect("it comes in time");
        }
    }

    /// Checks that the arm rests, and stays where it is.
    fn assert_at_rest(&mut self, case: &str) {
        let q = *self.lockstep.robot.q();
        self.run(500);
        let moved = (self.lockstep.robot.q() - q).amax();
        assert!(moved < 1e-3, "{case}: moved on by {moved} rad");
    }
}

#[test]
fn silent_holder_loses_the_lease_and_the_arm_brakes() {
    let seed = 55;
    println!("seed {seed}");
    for_each_robot(|ready| {
        let mut random = SmallRng::seed_from_u64(seed);
        for _ in 0..4 {
            let led = random.random_range(20..400);
            let case = format!("led for {led} ms");
            let mut arm = Shared::new(ready);
            let first = arm.take("Ada").expect("it is free");
            let engaged = arm.engage(&first);
            let goal = arm.head_for(engaged, 0.4).expect("it begins");
            arm.lead(&first, led);
            let name = "Ada".to_owned();
            assert_eq!(arm.take("Grace").err(), Some(Taken { name }), "{case}");
            // No more heartbeats come.
            arm.run(SILENCE.as_millis() as u64 + 1);
            let second = arm.take("Grace").expect("it is free again");
            arm.run(BRAKING);
            let held = Err(MotionError::Held(Lapse::Deadman));
            assert_eq!(arm.lockstep.until_resolved(goal, 1), held, "{case}");
            arm.assert_at_rest(&case);
            // Neither a late heartbeat nor a late goal moves the arm.
            let lost = Err(Lost { silence: SILENCE });
            assert_eq!(first.keep_alive(arm.now), lost, "{case}");
            assert_eq!(arm.head_for(engaged, 0.4).err(), held.err(), "{case}");
            arm.assert_at_rest(&case);
            // The next holder moves it once the first has released it.
            assert_eq!(second.keep_alive(arm.now), lost, "it was silent, too");
            let second = arm.take("Grace").expect("it is free again");
            arm.lockstep.disengage(engaged);
            arm.lockstep
                .until_resolved(engaged, 1000)
                .expect("it is released");
            second.keep_alive(arm.now).expect("no time has passed");
            let engaged = arm.engage(&second);
            let goal = arm.head_for(engaged, 0.0).expect("it begins");
            drop(first);
            arm.lead(&second, 4000);
            arm.lockstep.until_resolved(goal, 1).expect("it arrives");
        }
    });
}

/// Cycle for cycle, the same motion as after the end of a deadman.
#[test]
fn dropped_lease_brakes_as_a_dropped_deadman_does() {
    for_each_robot(|ready| {
        let mut arm = Shared::new(ready);
        let holder = arm.take("Ada").expect("it is free");
        let engaged = arm.engage(&holder);
        let (mut plain, plainly_engaged, token) = guarded(ready, 100);
        arm.head_for(engaged, 0.4).expect("it begins");
        let on_arrival = OnArrival::ReportAndHold;
        plain
            .within(plainly_engaged, turned(0.4), on_arrival)
            .expect("it begins");
        for _ in 0..40 {
            arm.lead(&holder, 10);
            plain.run(10);
            token.keep_alive();
        }
        drop((holder, token));
        assert_eq!(arm.lease.holder(arm.now), None);
        for _ in 0..BRAKING {
            arm.run(1);
            plain.run(1);
            assert_eq!(arm.lockstep.robot.q(), plain.robot.q());
        }
        arm.assert_at_rest("dropped");
    });
}
