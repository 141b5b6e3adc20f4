//! Clearance: the reference slows down towards the arm itself and towards regions that it is to
//! keep out of, and comes to rest before it is too near.
//!
//! What has to stay clear is the whole way to rest. Before the reference takes a step, the brake
//! from behind that step is planned, and its posture at rest and half way there are held against
//! the arm's shape. A step from which the arm could not stop in time is not taken: the reference
//! brakes from where it is, and the step before has shown that this is clear. So the distance is
//! kept whatever moves the reference, and by the generator's own brake, which keeps the robot's
//! limits; to less than a tenth of a millimetre at the default pace and half a millimetre at a
//! quick one, by which the way to rest may sag between the two.
//!
//! Only what comes nearer is held up. A motion out of a zone is free, also for an arm that begins
//! inside.

use franka_model::collision::{
    Arrangement, CandidateMask, Item, MotionBound, Obstacle, REGIONS_MAX, Shape, Spacing,
};
use franka_model::{JointVector, Model};

/// Distance, `[m]`, that two links keep that have two others between them: what the robot's
/// self-collision avoidance asks for is put at 0.05, and the arm is a spring that swings past its
/// reference.
pub const SELF_STOP: f64 = 0.06;

/// Distance, `[m]`, that the capsules around the links keep from a region to keep out of.
pub const KEEP_OUT_STOP: f64 = 0.02;

/// Distance beyond these, `[m]`, below which the approach is slow.
pub const SLOW_ZONE: f64 = 0.06;

/// Regions that a session can keep out of.
pub const KEEP_OUT_MAX: usize = REGIONS_MAX;

/// Regions that the arm and its Hand keep out of, in the base frame; room for [`KEEP_OUT_MAX`] of
/// them.
pub type KeepOut = [Option<Obstacle>; KEEP_OUT_MAX];

/// How many links further along the chain another one has to be; a tool comes after link 7. Closer
/// ones come near each other in postures that the arm takes every day.
const APART: u8 = 3;

/// How much nearer, `[m]`, counts as nearer: above the rounding of distances, and below what a
/// first cycle from rest leads to.
const NEARER: f64 = 1e-9;

/// What one session keeps clear of.
#[derive(Debug)]
pub(crate) struct Clearance {
    /// The arm from itself, and what covers it from regions.
    spacing: Spacing,
    known: Option<Known>,
}

/// What the last full check found, at a posture on the way of the arm.
#[derive(Debug)]
struct Known {
    /// A bound on how far the joints may turn from there before a distance is small.
    bound: MotionBound,
    /// The distances that could be small on the way to rest from there.
    candidates: CandidateMask,
}

/// What lies on the way to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ahead {
    /// Nothing near.
    Clear,
    /// Something that is approached slowly.
    Near,
    /// Something that is not to be approached: the region with this index, or the arm itself.
    TooNear(Option<usize>),
}

impl Clearance {
    /// For an arm with this model, with the vendor's Hand on its flange or nothing.
    pub(crate) fn new(model: &Model, hand: bool, keep_out: KeepOut) -> Self {
        let shapes = [Shape::vendor(), Shape::covering(model.kind())];
        let [arm, cover] = shapes.map(|shape| shape.with_lengths(*model.lengths()));
        let (arm, cover) = if hand {
            (arm.with_hand(), cover.with_hand())
        } else {
            (arm, cover)
        };
        let within = Spacing::within(&arm, SELF_STOP, APART);
        Self {
            spacing: within.out_of(&cover, KEEP_OUT_STOP, &keep_out),
            known: None,
        }
    }

    /// Checks the way from `next` to rest at `end`, for a reference that is at `now`.
    pub(crate) fn ahead(
        &mut self,
        now: &JointVector,
        next: &JointVector,
        end: &JointVector,
    ) -> Ahead {
        let half = (next + end) * 0.5;
        let way = (end - half).abs();
        let still = JointVector::zeros();
        // Nearly always the arm has moved too little since the last full check for anything else to
        // be near.
        if let Some(known) = &self.known {
            let candidates = known.bound.candidates(&self.spacing, &half, &way);
            if candidates.is_empty() {
                return Ahead::Clear;
            }
            if candidates == known.candidates {
                let there = known.bound.candidates(&self.spacing, &half, &still);
                let half = self.spacing.at(&half);
                return self.on_the_way(now, (&half, there), (end, candidates));
            }
        }
        let middle = self.spacing.at(&half);
        let bound = middle.motion_bound(SLOW_ZONE);
        let candidates = bound.candidates(&self.spacing, &half, &way);
        let there = bound.candidates(&self.spacing, &half, &still);
        self.known = Some(Known { bound, candidates });
        if candidates.is_empty() {
            return Ahead::Clear;
        }
        self.on_the_way(now, (&middle, there), (end, candidates))
    }

    /// The first distance that is too small at `next` and smaller than at `now`.
    pub(crate) fn too_near(&self, now: &JointVector, next: &JointVector) -> Option<Item> {
        let (here, there) = (self.spacing.at(now), self.spacing.at(next));
        self.spacing.items(CandidateMask::ALL).find(|&item| {
            let then = there.margin_below(item, 0.0);
            let ahead = then.map(|then| judge(item.region(), here.margin(item), then));
            matches!(ahead, Some(Ahead::TooNear(_)))
        })
    }

    /// Checks the way from `now` to `half` and to `end`, where only distances of the candidates may
    /// be small.
    ///
    /// Only what is near there is compared with where it is now. Once something is known to be
    /// near, what could still make a difference is what would be too near.
    fn on_the_way(
        &self,
        now: &JointVector,
        half: (&Arrangement<'_>, CandidateMask),
        end: (&JointVector, CandidateMask),
    ) -> Ahead {
        let mut ahead = Ahead::Clear;
        let mut limit = SLOW_ZONE;
        let mut here = None;
        let (end, candidates) = (self.spacing.at(end.0), end.1);
        for (there, candidates) in [half, (&end, candidates)] {
            for item in self.spacing.items(candidates) {
                let Some(then) = there.margin_below(item, limit) else {
                    continue;
                };
                let here = here.get_or_insert_with(|| self.spacing.at(now));
                match judge(item.region(), here.margin(item), then) {
                    Ahead::Clear => {}
                    Ahead::Near => (ahead, limit) = (Ahead::Near, 0.0),
                    too_near @ Ahead::TooNear(_) => return too_near,
                }
            }
        }
        ahead
    }
}

/// Classifies a margin to a region, or within the arm, that changes from `now` to `then`, both in
/// metres.
fn judge(region: Option<usize>, now: f64, then: f64) -> Ahead {
    if then >= SLOW_ZONE || then >= now - NEARER {
        Ahead::Clear
    } else if then >= 0.0 {
        Ahead::Near
    } else {
        Ahead::TooNear(region)
    }
}

#[cfg(test)]
mod tests;
