//! Clearance: the reference slows down towards the arm itself and towards regions that it is to keep out of, and comes to
//! rest before it is too near.
//!
//! What has to stay clear is the whole way to rest. Before the reference takes a step, the brake from behind that step is
//! planned, and its posture at rest and half way there are held against the arm's shape. A step from which the arm could
//! not stop in time is not taken: the reference brakes from where it is, and the step before has shown that this is clear.
//! So the distance is kept whatever moves the reference, and by the generator's own brake, which keeps the robot's limits;
//! to less than a tenth of a millimetre at the default pace and half a millimetre at a quick one, by which the way to rest
//! may sag between the two.
//!
//! Only what comes nearer is held up. A motion out of a zone is free, also for an arm that begins inside.

use franka_model::collision::{Body, Obstacle, Shape};
use franka_model::{JointVector, RobotKind};

use crate::law::hybrid::Reference;

/// Distance, `[m]`, that two links keep that have two others between them: what the robot's self-collision avoidance
/// asks for is put at 0.05, and the arm is a spring that swings past its reference.
pub const SELF_STOP: f64 = 0.06;

/// Distance, `[m]`, that the capsules around the links keep from a region to keep out of.
pub const KEEP_OUT_STOP: f64 = 0.02;

/// Distance beyond these, `[m]`, below which the approach is slow.
pub const SLOW_ZONE: f64 = 0.06;

/// Regions that a session can keep out of.
pub const KEEP_OUT_MAX: usize = 4;

/// Regions that the arm and its Hand keep out of, in the base frame; room for [`KEEP_OUT_MAX`] of them.
pub type KeepOut = [Option<Obstacle>; KEEP_OUT_MAX];

/// How many links further along the chain another one has to be; a tool comes after link 7. Closer ones come near each
/// other in postures that the arm takes every day.
const APART: u8 = 3;

/// How much nearer, `[m]`, counts as nearer: above the rounding of distances, and below what a first cycle from rest leads
/// to.
const NEARER: f64 = 1e-9;

/// How far a point of arm and Hand can be from the axis of a joint, `[m]`, rounded up: lengths and offsets from the
/// shoulder outwards are 1.18 m.
const LEVER: f64 = 1.25;

/// Time, `[s]`, that bounds how far a joint brakes: a brake takes about 0.25 s from its speed, of which an even one takes
/// half, and builds up and takes back its acceleration within 0.05 s.
const BRAKE: f64 = 0.2;

/// Time, `[s]`, for which an acceleration lasts that a brake takes back.
const ROLL_ON: f64 = 0.025;

/// What one session keeps clear of.
#[derive(Debug)]
pub(crate) struct Clearance {
    /// Against itself.
    arm: Shape<'static>,
    /// Against regions.
    cover: Shape<'static>,
    keep_out: KeepOut,
    /// Where the distances were last looked at, and the least room outside the slow zone, `[m]`.
    clear: Option<(JointVector, f64)>,
}

/// What lies on the way to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Ahead {
    /// Nothing near.
    Clear,
    /// Something that is approached slowly.
    Near,
    /// Something that is not to be approached.
    TooNear,
}

impl Clearance {
    /// For a robot of this kind, with the vendor's Hand on its flange or nothing.
    pub(crate) fn new(kind: RobotKind, hand: bool, keep_out: KeepOut) -> Self {
        let (arm, cover) = (Shape::vendor(), Shape::covering(kind));
        Self {
            arm: if hand { arm.with_hand() } else { arm },
            cover: if hand { cover.with_hand() } else { cover },
            keep_out,
            clear: None,
        }
    }

    /// What lies ahead of `next`, if the reference is at `now` and came to rest at `end()` from `next`.
    pub(crate) fn ahead(
        &mut self,
        now: &JointVector,
        next: &Reference,
        end: impl FnOnce() -> JointVector,
    ) -> Ahead {
        let reach = LEVER
            * next
                .dq
                .zip_map(&next.ddq, |v, a| (v.abs() + ROLL_ON * a.abs()) * BRAKE)
                .sum();
        if self.spare(&next.q) >= reach {
            return Ahead::Clear;
        }
        let end = end();
        let rooms = self.rooms(&end);
        let least = rooms.least();
        // What is clear at rest by more than the way there is clear all along it.
        if least - LEVER * (end - next.q).abs().sum() >= SLOW_ZONE {
            return Ahead::Clear;
        }
        let half = self.rooms(&((next.q + end) * 0.5));
        if least.min(half.least()) >= SLOW_ZONE {
            return Ahead::Clear;
        }
        let now = self.rooms(now);
        compare(&now, &half).max(compare(&now, &rooms))
    }

    /// How much further, `[m]`, everything is at least than where it is approached slowly. Nearly always the arm has not
    /// come far enough since it was looked at last.
    fn spare(&mut self, q: &JointVector) -> f64 {
        let left = |(seen, spare): &(JointVector, f64)| spare - LEVER * (q - seen).abs().sum();
        match self.clear.as_ref().map(left) {
            Some(left) if left > 0.0 => left,
            _ => {
                let spare = self.rooms(q).least() - SLOW_ZONE;
                self.clear = Some((*q, spare));
                spare
            }
        }
    }

    /// What is left at a posture of each distance that is to be kept, always in the same order: exactly of the least and
    /// of all below [`SLOW_ZONE`], and of others perhaps less.
    fn rooms(&self, q: &JointVector) -> Rooms {
        let mut rooms = Rooms {
            all: [f64::INFINITY; ROOMS_MAX],
            count: 0,
        };
        for ((inner, outer), distance) in self.arm.at(q).distances() {
            if number(outer) - number(inner) >= APART {
                rooms.push(distance - SELF_STOP);
            }
        }
        if self.keep_out.iter().any(Option::is_some) {
            let arm = self.cover.at(q);
            let mut least = rooms.least();
            for region in self.keep_out.iter().flatten() {
                for (bound, distance) in arm.bounds_to(region) {
                    // A bound stands for what is neither slow nor the least: no comparison asks for more.
                    let bound = bound - KEEP_OUT_STOP;
                    let room = if bound >= SLOW_ZONE && bound >= least {
                        bound
                    } else {
                        distance() - KEEP_OUT_STOP
                    };
                    least = least.min(room);
                    rooms.push(room);
                }
            }
        }
        rooms
    }
}

/// What is left of distances above those to stop at, `[m]`.
struct Rooms {
    all: [f64; ROOMS_MAX],
    count: usize,
}

impl Rooms {
    fn push(&mut self, room: f64) {
        self.all[self.count] = room;
        self.count += 1;
    }

    fn each(&self) -> &[f64] {
        &self.all[..self.count]
    }

    fn least(&self) -> f64 {
        self.each().iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// What it means to go from where the rooms are those of `now` to where they are those of `then`.
fn compare(now: &Rooms, then: &Rooms) -> Ahead {
    let judge = |(&now, &then): (&f64, &f64)| {
        if then >= SLOW_ZONE || then >= now - NEARER {
            Ahead::Clear
        } else if then >= 0.0 {
            Ahead::Near
        } else {
            Ahead::TooNear
        }
    };
    let pairs = now.each().iter().zip(then.each());
    pairs.map(judge).max().unwrap_or(Ahead::Clear)
}

/// Room for the pairs of the arm and its Hand, of which there are fewer than 48, and for 19 capsules that move beside
/// each region.
const ROOMS_MAX: usize = 48 + 19 * KEEP_OUT_MAX;

/// Links count from the base; the tool comes after the last.
fn number(body: Body) -> u8 {
    match body {
        Body::Link(link) => link,
        Body::Tool => 8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::READY;
    use nalgebra::{Isometry3, Vector3};

    fn of(keep_out: KeepOut) -> Clearance {
        Clearance::new(RobotKind::Fr3, true, keep_out)
    }

    /// The arm bent forwards at joint 2 until it has this much room to itself.
    fn bent(clearance: &Clearance, room: f64) -> JointVector {
        let at = |angle: f64| {
            let mut q = READY;
            q[1] += angle;
            q
        };
        let (mut far, mut near) = (1.1, 1.9);
        assert!(clearance.rooms(&at(far)).least() > room);
        assert!(clearance.rooms(&at(near)).least() < room);
        for _ in 0..60 {
            let middle = 0.5 * (near + far);
            if clearance.rooms(&at(middle)).least() < room {
                near = middle;
            } else {
                far = middle;
            }
        }
        at(far)
    }

    /// A reference at `q` whose joint 2 moves this fast.
    fn moving(q: JointVector, speed: f64) -> Reference {
        let mut reference = Reference::at_rest(q);
        reference.dq[1] = speed;
        reference
    }

    #[test]
    fn what_could_not_stop_in_time_is_too_near_and_what_could_is_slow() {
        let mut clearance = of(KeepOut::default());
        let mut ahead = |from: f64, to: f64| {
            let (now, end) = (bent(&clearance, from), bent(&clearance, to));
            let speed = if to < from { 1.0 } else { -1.0 };
            clearance.ahead(&now, &moving(now, speed), || end)
        };
        assert_eq!(ahead(0.065, 0.061), Ahead::Clear);
        assert_eq!(ahead(0.065, 0.059), Ahead::Near);
        assert_eq!(ahead(0.01, 0.001), Ahead::Near);
        assert_eq!(ahead(0.01, -0.001), Ahead::TooNear);
        assert_eq!(ahead(0.001, 0.01), Ahead::Clear);
        // From inside only outwards.
        assert_eq!(ahead(-0.03, -0.02), Ahead::Clear);
        assert_eq!(ahead(-0.03, -0.031), Ahead::TooNear);
    }

    #[test]
    fn a_reference_that_rests_or_goes_away_slowly_is_not_looked_at_again() {
        let mut clearance = of(KeepOut::default());
        let rest = Reference::at_rest(READY);
        let never = || panic!("nothing is near");
        assert_eq!(clearance.ahead(&READY, &rest, never), Ahead::Clear);
        let slow = moving(READY, 0.05);
        assert_eq!(clearance.ahead(&READY, &slow, never), Ahead::Clear);
    }

    /// A block below the hand of the ready posture, this high.
    fn block(height: f64) -> Obstacle {
        Obstacle::Box {
            pose: Isometry3::translation(0.31, 0.0, height - 0.05),
            half: Vector3::new(0.06, 0.1, 0.05),
        }
    }

    #[test]
    fn regions_are_kept_out_of_by_their_own_distance() {
        let mut lower = READY;
        lower[1] += 0.02;
        let arm = Shape::covering(RobotKind::Fr3).with_hand().at(&lower);
        // The block that is as near to the lower posture as it may be.
        let (mut low, mut high) = (0.2, 0.5);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if arm.nearest_to(&block(middle)).distance > KEEP_OUT_STOP {
                low = middle;
            } else {
                high = middle;
            }
        }
        assert!(low > 0.25 && low < 0.45, "{low}");
        for (height, expected) in [(low - 0.001, Ahead::Near), (low + 0.001, Ahead::TooNear)] {
            let mut keep_out = KeepOut::default();
            keep_out[1] = Some(block(height));
            let mut clearance = of(keep_out);
            let next = moving(READY, 1.0);
            assert_eq!(clearance.ahead(&READY, &next, || lower), expected);
            let next = moving(lower, -1.0);
            assert_eq!(clearance.ahead(&lower, &next, || READY), Ahead::Clear);
        }
    }
}
