//! Clearance: decides whether the reference may make its next step without coming too near to the
//! arm itself or to a keep-out region. `obstacle_braking` then slows down or brakes the reference.
//!
//! The whole path to rest must be clear. Before the reference makes a step, the brake after that
//! step is planned. Two of its postures are checked with the arm's shape: at rest, and half way
//! there. If the arm could not stop in time after the step, the step is not made. Instead, the
//! reference brakes from where it is; the check of the previous step has shown that this brake is
//! clear.
//!
//! Therefore every kind of motion keeps the distance, and brakes within the robot's limits. Between
//! the two checked postures, the path may come a little nearer: by less than a tenth of a
//! millimetre at the default pace, and by half a millimetre at a quick pace.
//!
//! Only approaches are limited. An arm that begins inside a zone may move out of it freely.

use franka_model::collision::{
    Arrangement, CandidateMask, Item, MotionBound, Obstacle, REGIONS_MAX, Shape, Spacing,
};
use franka_model::{JointVector, Model};

/// Distance that is kept between links with at least two other links between them, `[m]`. The
/// robot's own self-collision avoidance is assumed to require 0.05. The rest is a margin for the
/// arm, which follows like a spring and overshoots its reference.
pub const SELF_STOP: f64 = 0.06;

/// Distance that is kept between the capsules around the links and a keep-out region, `[m]`.
pub const KEEP_OUT_STOP: f64 = 0.02;

/// Width of the zone beyond those distances in which an approach is slow, `[m]`.
pub const SLOW_ZONE: f64 = 0.06;

/// Maximum number of keep-out regions of a session.
pub const KEEP_OUT_MAX: usize = REGIONS_MAX;

/// Keep-out regions for the arm and its Hand, in the base frame, with room for [`KEEP_OUT_MAX`]
/// regions.
pub type KeepOut = [Option<Obstacle>; KEEP_OUT_MAX];

/// Least number of links, along the chain, between two links that are checked; a tool comes after
/// link 7. Links that are closer along the chain come near each other in ordinary postures.
const APART: u8 = 3;

/// Least change of a distance that counts as an approach, `[m]`. It is above the rounding of
/// distances, and below the change in the first cycle of a motion from rest.
const NEARER: f64 = 1e-9;

/// Surroundings from which a session keeps its arm clear.
#[derive(Debug)]
pub(crate) struct Clearance {
    /// Distances within the arm, and between its capsules and the regions.
    spacing: Spacing,
    known: Option<Known>,
}

/// Result of the last full check, at a posture on the path of the arm.
#[derive(Debug)]
struct Known {
    /// Bound on how far the joints may turn from that posture before a distance can become small.
    bound: MotionBound,
    /// Distances that could be small on the path from that posture to rest.
    candidates: CandidateMask,
}

/// Result of a check of the path to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ahead {
    /// No obstacle is near.
    Clear,
    /// An obstacle is near, so the approach is slow.
    Near,
    /// An obstacle that the arm must not come nearer to: the region with this index, or the arm
    /// itself.
    TooNear(Option<usize>),
}

impl Clearance {
    /// Creates the clearance of an arm with this model. With `hand`, the vendor's Hand is on the
    /// flange; without it, the flange is empty.
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

    /// Checks the path from `next` to rest at `end`, while the reference is at `now`.
    pub(crate) fn ahead(
        &mut self,
        now: &JointVector,
        next: &JointVector,
        end: &JointVector,
    ) -> Ahead {
        let half = (next + end) * 0.5;
        let way = (end - half).abs();
        let still = JointVector::zeros();
        // Nearly always, the arm has moved too little since the last full check for any other
        // obstacle to be near.
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

    /// Returns the first distance that is too small at `next`, and smaller there than at `now`.
    pub(crate) fn too_near(&self, now: &JointVector, next: &JointVector) -> Option<Item> {
        let (here, there) = (self.spacing.at(now), self.spacing.at(next));
        self.spacing.items(CandidateMask::ALL).find(|&item| {
            let then = there.margin_below(item, 0.0);
            let ahead = then.map(|then| judge(item.region(), here.margin(item), then));
            matches!(ahead, Some(Ahead::TooNear(_)))
        })
    }

    /// Checks the path from `now` to `half` and to `end`. Only the distances in the candidates can
    /// be small on it.
    ///
    /// Only distances that are small on the path are compared with their present values. Once an
    /// obstacle is known to be near, only a distance that is too small can change the result.
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

/// Classifies a margin that changes from `now` to `then`, in metres. It is the margin to a region,
/// or to the arm itself.
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
