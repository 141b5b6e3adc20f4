//! Clearance: decides whether the reference may make its next step without coming too near to the
//! arm itself or to a keep-out region. `obstacle_braking` then slows down or brakes the reference.
//!
//! The whole path to rest must stay clear. Before the reference makes a step, the brake after that
//! step is planned. Its postures at rest and half way there are checked against the arm's shape. A
//! step after which the arm could not stop in time is not made. The reference brakes from its place
//! instead; the check of the previous step has shown that this brake is clear.
//!
//! The distance is therefore kept for every kind of motion, under the generator's own brake, which
//! keeps the robot's limits. Between the two checked postures the path may sag: by less than a
//! tenth of a millimetre at the default pace, and by half a millimetre at a quick pace.
//!
//! Only approaches are held back. A motion out of a zone is free, even for an arm that begins
//! inside.

use franka_model::collision::{
    Arrangement, CandidateMask, Item, MotionBound, Obstacle, REGIONS_MAX, Shape, Spacing,
};
use franka_model::{JointVector, Model};

/// Distance kept between two links that have two other links between them, `[m]`. The robot's
/// self-collision avoidance is assumed to require 0.05. The rest is for the arm, which follows like
/// a spring and overshoots its reference.
pub const SELF_STOP: f64 = 0.06;

/// Distance kept between the capsules around the links and a keep-out region, `[m]`.
pub const KEEP_OUT_STOP: f64 = 0.02;

/// Additional distance below which the approach is slow, `[m]`.
pub const SLOW_ZONE: f64 = 0.06;

/// Maximum number of keep-out regions of a session.
pub const KEEP_OUT_MAX: usize = REGIONS_MAX;

/// Keep-out regions of the arm and its Hand in the base frame; room for [`KEEP_OUT_MAX`] regions.
pub type KeepOut = [Option<Obstacle>; KEEP_OUT_MAX];

/// Least distance along the chain between two links that are checked, in links; a tool comes after
/// link 7. Closer links come near each other in everyday postures.
const APART: u8 = 3;

/// Least change that counts as an approach, `[m]`: above the rounding of distances, and below the
/// first cycle of a motion from rest.
const NEARER: f64 = 1e-9;

/// Surroundings of which one session keeps clear.
#[derive(Debug)]
pub(crate) struct Clearance {
    /// Distances within the arm, and between its capsules and the regions.
    spacing: Spacing,
    known: Option<Known>,
}

/// Result of the last full check, at a posture on the path of the arm.
#[derive(Debug)]
struct Known {
    /// Bound on the turns of the joints from that posture before a distance is small.
    bound: MotionBound,
    /// Distances that could be small on the path from that posture to rest.
    candidates: CandidateMask,
}

/// Obstacles on the path to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ahead {
    /// Nothing near.
    Clear,
    /// An obstacle that is approached slowly.
    Near,
    /// An obstacle that the arm must not approach: the region with this index, or the arm itself.
    TooNear(Option<usize>),
}

impl Clearance {
    /// Creates the clearance of an arm with this model. With `hand`, the vendor's Hand is on its
    /// flange, otherwise nothing.
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

    /// Checks the path from `next` to rest at `end`, for a reference at `now`.
    pub(crate) fn ahead(
        &mut self,
        now: &JointVector,
        next: &JointVector,
        end: &JointVector,
    ) -> Ahead {
        let half = (next + end) * 0.5;
        let way = (end - half).abs();
        let still = JointVector::zeros();
        // Nearly always the arm has moved too little since the last full check to be near anything
        // else.
        if let Some(known) = &self.known {
            let candidates = known.bound.candidates(&self.spacing, &half, &way);
            if candidates.is_empty() {
                return Ahead::Clear;
            }
            if candidates == known.candidates {
                let there = known.bound.candidates(&self.spacing, &half, &still);
                let middle = (!there.is_empty()).then(|| self.spacing.at(&half));
                let middle = middle.as_ref().map(|middle| (middle, there));
                return self.on_the_way(now, middle, (end, candidates));
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
        self.on_the_way(now, Some((&middle, there)), (end, candidates))
    }

    /// Returns the first distance that is too small at `next` and smaller than at `now`.
    pub(crate) fn too_near(&self, now: &JointVector, next: &JointVector) -> Option<Item> {
        let (here, there) = (self.spacing.at(now), self.spacing.at(next));
        self.spacing.items(CandidateMask::ALL).find(|&item| {
            let then = there.margin_below(item, 0.0);
            let ahead = then.map(|then| judge(item.region(), here.margin(item), then));
            matches!(ahead, Some(Ahead::TooNear(_)))
        })
    }

    /// Checks the path from `now` to `half` and to `end`. Only distances of the candidates may be
    /// small on it; `half` is `None` if none may be there.
    ///
    /// Only distances that are small on the path are compared with their present values. Once an
    /// obstacle is known to be near, only distances that would be too small can change the result.
    fn on_the_way(
        &self,
        now: &JointVector,
        half: Option<(&Arrangement<'_>, CandidateMask)>,
        end: (&JointVector, CandidateMask),
    ) -> Ahead {
        let mut ahead = Ahead::Clear;
        let mut limit = SLOW_ZONE;
        let mut here = None;
        let (end, candidates) = (self.spacing.at(end.0), end.1);
        for (there, candidates) in half.into_iter().chain([(&end, candidates)]) {
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

/// Classifies a margin that changes from `now` to `then`, both in metres: to a region, or within
/// the arm.
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
