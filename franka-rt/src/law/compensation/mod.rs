//! Torques that are added to the springs, against friction, an undeclared load or a biased torque
//! sensor.
//!
//! If a joint has friction, its spring stays stretched by the friction torque divided by the
//! stiffness. With springs soft enough for a person to push the arm, the stretch is millimetres.
//! Three torques per joint compensate it:
//!
//! ```text
//! tau = c tanh(dq_ref / v0)                       friction, along the reference in motion
//!     + 0.6 c tanh((q_ref - q) / e0)              and towards the target at rest
//!     + b                                         bias: load, tilt, torque sensors
//!     + i                                         what is still missing at rest
//! ```
//!
//! - `c` and `b` are [`learned`] in motion, from the torque that the springs exert in addition to
//!   `c` and `b`. On an arm without friction and bias both are zero.
//! - `i` is an integral that grows while the arm rests outside its [`DEAD_ZONE`] or creeps to its
//!   target. It decays in motion. Inside the dead zone it stays constant, to avoid limit cycles.
//!   Springs and integral together may change only by the torque that friction can explain, counted
//!   from the torque with which the arm stopped; the integral may always return to zero. Therefore
//!   a push on the arm meets little more than the springs, and has no effect after it ends. Until
//!   the arm has stopped, the limit is higher for a while, because torques of the arm may be
//!   unknown and the hand may hold a new object.
//! - The second line is a spring that saturates at 0.6 of the friction. Therefore, for every delay
//!   of the torque loop, it adds less energy to an oscillation than friction removes. It also
//!   shortens the slip of a joint that breaks away, even if the springs are soft.
//!
//! [`Gains::compensation`](crate::law::Gains::compensation) bounds the sum for each joint. Torque
//! clamp and force cap treat the sum as part of the springs.
//!
//! If the springs demand more than that bound, or a guard bounds them, something holds the arm.
//! Then nothing is learned, the torques against friction at rest fade, and the integral returns to
//! the value that held the arm at rest. After a goal has reacted to a contact, nothing is learned
//! until the next goal. Otherwise, a push on the arm would be learned as friction or as a load, and
//! later motions would end short of their targets.

mod learned;

use franka_model::JointVector;

use crate::shaping::CYCLE;
use learned::UNBIASED;

pub(crate) use learned::Learned;

#[derive(Debug)]
pub(crate) struct Compensation {
    learned: Learned,
    /// The integral at rest, `[N m]`.
    rest: JointVector,
    /// Share of the sum that is applied. It rises from zero when the motion starts, and falls to
    /// zero when the motion ends.
    acting: f64,
    /// Share that is left of the torques that fade while something holds the arm.
    free: f64,
    /// Number of cycles for which each joint and its reference have rested.
    rested: [u32; 7],
    approach: Approach,
    /// True if the integral of any joint changes.
    is_working: bool,
}

/// Progress of the arm toward rest at its target.
#[derive(Debug)]
enum Approach {
    /// The arm has not stopped at its target yet.
    Arriving {
        /// Number of cycles for which the reference has rested. After [`ARRIVES`] cycles, unknown
        /// torques of the arm no longer count. A push raises the number above [`ARRIVES`] at once.
        cycles: u32,
        /// Least distance from the target at which each joint has rested during the approach,
        /// `[rad]`.
        nearest: JointVector,
    },
    /// The arm has stopped; the integral had this value, `[N m]`.
    Settled(JointVector),
}

impl Approach {
    /// Returns the approach to a moving target.
    fn under_way() -> Self {
        Self::Arriving {
            cycles: 0,
            nearest: JointVector::repeat(f64::INFINITY),
        }
    }
}

#[derive(Debug)]
pub(crate) struct Demand<'a> {
    /// Velocity of the reference, `[rad/s]`.
    pub(crate) dq_ref: &'a JointVector,
    /// Acceleration of the reference, `[rad/s^2]`.
    pub(crate) ddq_ref: &'a JointVector,
    /// Velocity of the arm, `[rad/s]`.
    pub(crate) dq: &'a JointVector,
    /// Vector from the arm to the reference, `[rad]`.
    pub(crate) error: &'a JointVector,
    /// Torques of the springs alone, `[N m]`.
    pub(crate) springs: &'a JointVector,
    /// Greatest compensation of each joint, `[N m]`.
    pub(crate) bounds: &'a [f64; 7],
    /// True if a guard of the interaction limits the torques.
    pub(crate) held: bool,
    /// True if the goal has reacted to a contact. Nothing is learned then.
    pub(crate) met: bool,
    /// True if the motion is about to end, which requires zero torque.
    pub(crate) ending: bool,
}

impl Compensation {
    /// Creates a compensation that starts with the learned values of the arm.
    pub(crate) fn new(learned: Learned) -> Self {
        Self {
            learned,
            rest: JointVector::zeros(),
            acting: 0.0,
            free: 1.0,
            rested: [0; 7],
            approach: Approach::under_way(),
            is_working: false,
        }
    }

    pub(crate) fn learned(&self) -> Learned {
        self.learned
    }

    /// True if the compensation still grows in order to move a joint that rests outside its dead
    /// zone.
    pub(crate) fn is_working(&self) -> bool {
        self.is_working
    }

    /// Records the torques that hold the arm when it stops at its target.
    fn settle(&mut self, demand: &Demand<'_>) {
        let rests = |i: usize| self.rested[i] > SETTLED && demand.error[i].abs() < DEAD_ZONE[i];
        if demand.dq_ref.amax() > MOVING {
            self.approach = Approach::under_way();
        } else if let Approach::Arriving { cycles, nearest } = &mut self.approach {
            if (0..7).all(rests) {
                self.approach = Approach::Settled(self.rest);
                return;
            }
            let distance = demand.error.abs();
            // Unless something pushes it, an arm that has rested only comes nearer to its target.
            let is_pushed = (distance - *nearest).max() > PUSHED;
            for i in (0..7).filter(|&i| self.rested[i] > RESTED[1]) {
                nearest[i] = nearest[i].min(distance[i]);
            }
            let rests = demand.dq_ref.amax() < REFERENCE_RESTS;
            *cycles = match is_pushed {
                true => ARRIVES + 1,
                false => cycles.saturating_add(u32::from(rests)),
            };
        }
    }

    /// Returns the torques of one cycle, `[N m]`.
    pub(crate) fn step(&mut self, demand: &Demand<'_>) -> JointVector {
        let Demand {
            springs, bounds, ..
        } = *demand;
        let stretched = (0..7).any(|i| springs[i].abs() > bounds[i]);
        let held = demand.held || stretched;
        self.settle(demand);
        self.acting = (self.acting + if demand.ending { -RAMP } else { RAMP }).clamp(0.0, 1.0);
        self.free = (self.free + if held { -LET_GO } else { TAKE_UP }).clamp(0.0, 1.0);
        self.is_working = false;
        JointVector::from_fn(|i, _| {
            let (friction, bias) = self.learned.of(i);
            self.integrate(i, (friction, bias), held, demand);
            let along = (demand.dq_ref[i] / SIGN_VELOCITY).tanh();
            let to_target = (demand.error[i] / SIGN_ERROR).tanh();
            let towards = (1.0 - along.abs()) * AT_REST * to_target * self.free;
            let sum = friction * (along + towards) + bias + self.rest[i];
            let sum = sum.clamp(-bounds[i], bounds[i]) * self.acting;
            self.learn(i, sum, demand);
            sum
        })
    }

    /// Advances the integral of one joint with this friction and this bias.
    fn integrate(
        &mut self,
        i: usize,
        (friction, bias): (f64, f64),
        held: bool,
        demand: &Demand<'_>,
    ) {
        let (v, e) = (demand.dq_ref[i], demand.error[i]);
        let bound = demand.bounds[i];
        let settled = match self.approach {
            Approach::Arriving { .. } => 0.0,
            Approach::Settled(settled) => settled[i],
        };
        // A joint that settles may creep to its target, but not one that is pushed away.
        let creeps = || {
            let towards = demand.dq[i] * e.signum();
            matches!(self.approach, Approach::Arriving { .. })
                && 0.0 < towards
                && towards < CREEP * e.abs()
        };
        let rests = !held && v.abs() < MOVING && (demand.dq[i].abs() < REST_VELOCITY || creeps());
        self.rested[i] = match rests {
            true => self.rested[i].saturating_add(1),
            false => 0,
        };
        let sticks = friction > 0.0;
        let grows = self.rested[i] > RESTED[usize::from(sticks)] && e.abs() > DEAD_ZONE[i];
        if held || v.abs() > MOVING {
            let rest = &mut self.rest[i];
            *rest -= (*rest - settled) * CYCLE / FORGET;
        } else if grows {
            let (least, most) = self.range(i, (friction, bias), demand);
            let rest = &mut self.rest[i];
            let rate = (INTEGRAL * demand.springs[i].abs()).max(BREAK_AWAY * friction);
            // An integral that pulls away from the target resisted something that has ended.
            let rate = rate * if *rest * e < 0.0 { UNWIND } else { 1.0 };
            let grown = *rest + rate.copysign(e) * CYCLE;
            self.is_working |= (least < grown && grown < most) || grown.abs() < rest.abs();
            *rest = grown.clamp(least.min(*rest), most.max(*rest));
        } else if !sticks && self.rest[i].abs() < UNBIASED {
            // Without friction and load the springs bring the joint to its target exactly.
            self.rest[i] -= self.rest[i] * CYCLE / FORGET;
        }
        // Clamp in every cycle, so that shrinking bounds do not step the integral.
        self.rest[i] = self.rest[i].clamp(-bound, bound);
    }

    /// Returns the least and the greatest integral of one joint with this friction and this bias,
    /// `[N m]`.
    fn range(&self, i: usize, (friction, bias): (f64, f64), demand: &Demand<'_>) -> (f64, f64) {
        let bound = demand.bounds[i];
        // Springs and integral together need no more than the friction, known or not, and the
        // change of a bias from pose to pose. For a while the unknown torques of the arm and a
        // possible new grip are added. Any greater resistance has another cause.
        let unknown = self.learned.unknown(i);
        let resists = FRICTION_SPREAD * friction
            + UNKNOWN_SPREAD * unknown * STATIC_FRICTION[i]
            + BIAS_SPREAD * bias.abs()
            + FELT;
        let (settled, resists) = match self.approach {
            Approach::Arriving { cycles, .. } if cycles > ARRIVES => (0.0, resists),
            Approach::Arriving { .. } => (0.0, (resists + unknown * bound).max(LOADED)),
            Approach::Settled(settled) => (settled[i], resists),
        };
        let room = (resists - demand.springs[i].abs()).max(0.0);
        let within = |torque: f64| torque.clamp(-bound, bound);
        // The torque with which the arm stopped may have resisted a push that has ended since.
        // Therefore the integral may return to zero. The exception is a joint that is now held by
        // more than friction, and was not when the arm stopped.
        let (low, high) = match room > 0.0 || settled.abs() > resists {
            true => (settled.min(0.0), settled.max(0.0)),
            false => (settled, settled),
        };
        (within(low - room), within(high + room))
    }

    /// Learns the torque of a joint whose compensation is `compensated`, while the joint's
    /// reference moves steadily and nothing holds the arm.
    fn learn(&mut self, i: usize, compensated: f64, demand: &Demand<'_>) {
        let v = demand.dq_ref[i];
        let steady = v.abs() > MOVING && demand.ddq_ref[i].abs() < STEADY;
        // When a joint hits an obstacle, it stops long before its springs demand more than
        // friction.
        let keeps_up = demand.dq[i] * v.signum() > KEEPS_UP * v.abs();
        if demand.met || self.free < 1.0 || !steady || !keeps_up {
            return;
        }
        let bound = demand.bounds[i];
        let takes = (compensated + demand.springs[i]).clamp(-bound, bound);
        self.learned.learn(i, v.signum(), takes);
    }
}

/// Distances from the reference within which a resting joint is not corrected, `[rad]`. Together
/// they amount to about 0.3 mm and 1 mrad at the end effector.
pub(crate) const DEAD_ZONE: [f64; 7] = [3e-4, 3e-4, 3e-4, 3e-4, 5e-4, 5e-4, 5e-4];

/// Velocity of the reference above which a joint counts as moving, `[rad/s]`.
const MOVING: f64 = 0.02;

/// Velocity of the reference below which the reference rests, `[rad/s]`.
const REFERENCE_RESTS: f64 = 1e-3;

/// Acceleration of the reference above which nothing is learned, `[rad/s^2]`. Above it, the springs
/// also compensate errors of the modelled inertia.
const STEADY: f64 = 2.5;

/// Ratio of a joint's velocity to its reference's velocity, below which the joint does not learn.
const KEEPS_UP: f64 = 0.2;

/// Velocity of the reference at which friction is compensated by 76 %, `[rad/s]`.
const SIGN_VELOCITY: f64 = 0.01;

/// Error at rest at which friction is compensated by 76 % of [`AT_REST`], `[rad]`.
const SIGN_ERROR: f64 = 1e-3;

/// Share of the friction that is compensated toward the target at rest. The learned friction
/// includes viscous friction, which is up to a third of it on the simulated arms. Even with viscous
/// friction, the torque stays below the static friction.
const AT_REST: f64 = 0.6;

/// Growth rate of the integral per torque of the springs, `[1/s]`. It is slower than the springs
/// settle.
const INTEGRAL: f64 = 5.0;

/// Least growth rate of the integral for a joint with friction outside its dead zone, in parts of
/// the friction per second.
const BREAK_AWAY: f64 = 2.5;

/// Velocity below which a joint of the arm counts as resting, `[rad/s]`.
const REST_VELOCITY: f64 = 0.01;

/// Velocity up to which a joint that has not settled yet counts as resting, divided by its error,
/// `[1/s]`. A joint at that velocity would reach its target later than its springs settle.
const CREEP: f64 = 2.0;

/// Cycles of rest after which the integral grows: for a joint without known friction, and for a
/// joint with known friction. In the first case, the springs alone have moved the joint as near as
/// they can.
const RESTED: [u32; 2] = [150, 20];

/// Factor by which the integral changes faster while it pulls away from the target.
const UNWIND: f64 = 4.0;

/// Time constant of the integral's decay in motion and while something holds the arm, `[s]`.
const FORGET: f64 = 0.15;

/// Cycles of rest after which an arm moves only if something pushes it.
const SETTLED: u32 = 300;

/// Cycles of a resting reference within which unknown torques of the arm are compensated.
const ARRIVES: u32 = 2500;

/// Distance from its target by which a joint moves back only if something pushes it, `[rad]`.
const PUSHED: f64 = 5e-3;

/// Greatest ratio of a joint's breakaway torque to its learned friction.
const FRICTION_SPREAD: f64 = 2.0;

/// Largest breakaway torque of the joints of a realistic arm, `[N m]`: the product of the upper
/// ends of the family's `static_friction` and `static_friction_scale`.
pub(crate) const STATIC_FRICTION: [f64; 7] = [1.52, 1.59, 1.31, 1.79, 1.45, 0.83, 0.69];

/// Greatest ratio of the torque that holds an unknown joint to its [`STATIC_FRICTION`]. It is above
/// 1 because the bias adds to the friction. Without this factor, nine of ten arms that were pushed
/// before they had moved stopped millimetres from their targets.
const UNKNOWN_SPREAD: f64 = 1.5;

/// Largest relative difference of a bias between two poses.
const BIAS_SPREAD: f64 = 0.5;

/// Greatest change of the integral of a joint without friction, after the arm has stopped, `[N m]`.
const FELT: f64 = 0.3;

/// Greatest change of a joint's load from one motion to the next, `[N m]`: the torque of 0.3 kg at
/// half a metre.
const LOADED: f64 = 1.6;

/// Change per cycle of the share that is applied, when a motion starts and ends.
const RAMP: f64 = 0.01;

/// Share by which the torques at rest fade in each cycle while something holds the arm.
const LET_GO: f64 = 0.02;

/// Share by which the torques at rest return in each cycle.
const TAKE_UP: f64 = 1.0 / 300.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Gains;
    use proptest::prelude::*;

    const BOUNDS: [f64; 7] = Gains::COMPENSATION;

    /// Runs one cycle. Every joint has this error, and its spring has this torque.
    fn step(this: &mut Compensation, v: f64, e: f64, spring: f64, held: bool) -> f64 {
        let demand = Demand {
            dq_ref: &JointVector::repeat(v),
            ddq_ref: &JointVector::zeros(),
            dq: &JointVector::repeat(v),
            error: &JointVector::repeat(e),
            springs: &JointVector::repeat(spring),
            bounds: &BOUNDS,
            held,
            met: false,
            ending: false,
        };
        this.step(&demand)[0]
    }

    fn run(this: &mut Compensation, cycles: u32, v: f64, e: f64, spring: f64) -> f64 {
        (0..cycles)
            .map(|_| step(this, v, e, spring, false))
            .last()
            .expect("a cycle")
    }

    /// Learns over motions to and fro in which the springs supply the torque that is not
    /// compensated.
    fn learned(friction: f64, bias: f64) -> Compensation {
        let mut this = Compensation::new(Learned::default());
        let mut last = 0.0;
        for cycle in 0..20_000 {
            let v: f64 = if cycle / 500 % 2 == 0 { 0.2 } else { -0.2 };
            let spring = friction * v.signum() + bias - last;
            last = step(&mut this, v, 0.0, spring, false);
        }
        this
    }

    #[test]
    fn joint_rests_in_its_dead_zone_and_breaks_away_outside() {
        let mut this = learned(0.8, 0.0);
        let inside = run(&mut this, 1, 0.0, 2e-4, 0.05);
        assert_eq!(run(&mut this, 5000, 0.0, 2e-4, 0.05), inside);
        assert!(!this.is_working());
        let outside = run(&mut this, 1, 0.0, 5e-4, 0.05);
        assert!(this.is_working());
        assert!(run(&mut this, 500, 0.0, 5e-4, 0.05) > outside + 0.3);
        run(&mut this, 10_000, 0.0, 5e-4, 0.05);
        assert!(!this.is_working(), "at its bound");
    }

    /// The arm stops while a push acts on it; then the push ends.
    #[test]
    fn torque_against_an_ended_push_is_not_kept() {
        let mut this = learned(0.8, 0.0);
        run(&mut this, 400, 0.0, 2e-3, 0.3);
        run(&mut this, 400, 0.0, 2e-4, 0.0);
        let against = this.rest[0];
        assert!(against > 0.3, "{against}");
        assert!(matches!(this.approach, Approach::Settled(_)));
        run(&mut this, 1000, 0.0, -2e-3, -0.3);
        let after = this.rest[0];
        assert!(after < -1.0, "{after}");
    }

    #[test]
    fn friction_that_is_not_known_yet_is_overcome_after_a_push() {
        let mut this = Compensation::new(Learned::default());
        run(&mut this, 400, 0.0, 0.0, 0.0);
        assert!(matches!(this.approach, Approach::Settled(_)));
        run(&mut this, 2000, 0.0, 2e-3, 0.4);
        assert!(this.rest[0] + 0.4 > STATIC_FRICTION[0], "{}", this.rest[0]);
        run(&mut this, 2000, 0.0, 2e-3, 0.4);
        assert!(this.rest[0] < 2.0 * STATIC_FRICTION[0], "{}", this.rest[0]);
    }

    #[test]
    fn integral_waits_until_springs_have_done_their_part() {
        let mut this = learned(0.8, 0.0);
        let at_once = run(&mut this, 1, 0.0, 5e-4, 0.05);
        assert_eq!(run(&mut this, RESTED[1] - 1, 0.0, 5e-4, 0.05), at_once);
        assert!(run(&mut this, 100, 0.0, 5e-4, 0.05) > at_once + 0.05);
    }

    /// Runs more cycles than the range of a counter: 49.7 days.
    #[test]
    fn an_arm_may_rest_for_months() {
        let mut this = learned(0.8, 0.0);
        run(&mut this, 5000, 0.0, 2e-4, 0.05);
        this.rested = [u32::MAX; 7];
        let before = run(&mut this, 1, 0.0, 2e-4, 0.05);
        assert_eq!(run(&mut this, 100, 0.0, 2e-4, 0.05), before);
        assert_eq!(this.rested, [u32::MAX; 7]);
    }

    #[test]
    fn an_arm_without_friction_and_bias_is_not_compensated() {
        let mut this = learned(0.08, -0.04);
        assert_eq!(run(&mut this, 1000, 0.0, 2e-4, 0.05), 0.0);
    }

    #[test]
    fn held_arm_keeps_only_the_bias_and_learns_nothing() {
        let mut this = learned(0.8, -0.3);
        run(&mut this, 1000, 0.0, 5e-3, 0.5);
        let before = this.learned();
        for _ in 0..1500 {
            step(&mut this, 0.0, 5e-3, 0.5, true);
        }
        let held = step(&mut this, 0.0, 5e-3, 0.5, true);
        assert!((held - before.of(0).1).abs() < 1e-3, "{held}");
        // The springs demand more than friction and bias can explain.
        for _ in 0..1500 {
            step(&mut this, 0.0, 2e-2, 6.0, false);
        }
        assert_eq!(this.learned(), before);
        let held = step(&mut this, 0.0, 2e-2, 6.0, false);
        assert!((held - before.of(0).1).abs() < 1e-3, "{held}");
    }

    #[test]
    fn compensation_begins_and_ends_at_zero_without_a_step() {
        let known = learned(0.8, -0.6).learned();
        let mut this = Compensation::new(known);
        let mut last = 0.0;
        for cycle in 0..400 {
            let demand = Demand {
                dq_ref: &JointVector::zeros(),
                ddq_ref: &JointVector::zeros(),
                dq: &JointVector::zeros(),
                error: &JointVector::zeros(),
                springs: &JointVector::zeros(),
                bounds: &BOUNDS,
                held: false,
                met: false,
                ending: cycle >= 200,
            };
            let now = this.step(&demand)[0];
            assert!((now - last).abs() < 0.01, "{cycle}: {now}");
            assert!(
                !(120..200).contains(&cycle) || now < -0.55,
                "{cycle}: {now}"
            );
            last = now;
        }
        assert_eq!(last, 0.0);
    }

    #[test]
    fn bounds_that_shrink_do_not_step_it() {
        let mut this = learned(0.8, 0.0);
        let mut last = run(&mut this, 5000, 0.0, 3.1e-4, 0.05);
        for cycle in (0..300).rev() {
            // For a while, the joint is just inside its dead zone, where the integral stays
            // constant.
            let error = if (100..200).contains(&cycle) {
                2.9e-4
            } else {
                3.1e-4
            };
            let demand = Demand {
                dq_ref: &JointVector::zeros(),
                ddq_ref: &JointVector::zeros(),
                dq: &JointVector::zeros(),
                error: &JointVector::repeat(error),
                springs: &JointVector::zeros(),
                bounds: &BOUNDS.map(|most| most * f64::from(cycle) / 300.0),
                held: false,
                met: false,
                ending: false,
            };
            let now = this.step(&demand)[0];
            assert!((now - last).abs() < 0.03, "{cycle}: {now} after {last}");
            last = now;
        }
        assert_eq!(last, 0.0);
    }

    proptest! {
        #[test]
        fn compensation_is_bounded_for_any_spring_torque(
            demands in prop::collection::vec((-0.5..0.5f64, -0.01..0.01f64, -5.0..5.0f64), 20),
        ) {
            let mut this = Compensation::new(Learned::default());
            for (v, e, spring) in demands {
                let torque = run(&mut this, 300, v, e, spring);
                prop_assert!(torque.abs() <= BOUNDS[0], "{torque}");
            }
        }
    }
}
