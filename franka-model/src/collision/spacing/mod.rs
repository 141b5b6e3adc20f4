//! Detects distances below their minimum, within an arm and from the arm to regions.
//!
//! ```text
//! Spacing (pairs and their minimum distances; made once)
//!    │ at(q)
//!    v
//! Arrangement ──> margin_below(item, limit)    measures a distance only if it may be small
//!             ──> motion_bound(limit)          bounds how fast distances shrink from here
//! ```
//!
//! Most distances are large at most postures. One pass places the capsules, excludes large
//! distances with bounding balls and boxes, and measures the rest. The bounds at one posture form
//! its [`MotionBound`]. At nearby postures, the `MotionBound` excludes most or all distances
//! without another pass.

mod motion_bound;
mod mounted;
mod region;
#[cfg(test)]
mod tests;

pub use motion_bound::{CandidateMask, MotionBound};

use motion_bound::{GROUPS_MAX, Groups};
use mounted::{Location, Mounted};
use region::Region;

use super::segment::Segment;
use super::{CAPACITY, Obstacle, Shape, capsules, shape};
use crate::JointVector;
use crate::chain::Chain;
use crate::geometry::Lengths;
use crate::inertia::dot;
use crate::scalar::sqrt;

/// Largest number of regions of a [`Spacing`].
pub const REGIONS_MAX: usize = 4;

/// Largest number of pairs of capsules of a shape.
const PAIRS_MAX: usize = capsules::COVERING_PAIRS.len() + capsules::ARM_MAX * shape::TOOL_MAX;

/// Margin, `[m]`, above which a bound on a distance is sufficient, because the arm needs many
/// cycles to cover this margin.
const AMPLE: f64 = 0.15;

/// Pairs to monitor, each with a minimum distance. A pair is two capsules of an arm, or a capsule
/// and a region.
///
/// The distances are computed as in [`Placed`](super::Placed). The margin of a distance is the
/// distance minus its minimum, `[m]`.
#[derive(Debug, Clone)]
pub struct Spacing {
    lengths: Lengths,
    /// The capsules of the pairs.
    arm: LinkCapsules,
    pairs: [CapsulePair; PAIRS_MAX],
    pair_count: usize,
    /// The minimum distance of the pairs, `[m]`.
    apart: f64,
    /// The capsules whose distances to regions are checked: all except the base, which never moves.
    /// The list is empty if there are no regions.
    cover: LinkCapsules,
    regions: [Region; REGIONS_MAX],
    region_count: usize,
    /// The minimum distance to regions, `[m]`.
    out: f64,
    groups: Groups,
}

/// Identifies one distance of a [`Spacing`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Item(Kind);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Index of the pair.
    Pair(usize),
    /// Indices of the region and of the capsule.
    Region(usize, usize),
}

impl Item {
    /// Returns the index of the region to which this distance refers, or `None` for a distance
    /// within the arm.
    pub fn region(self) -> Option<usize> {
        match self.0 {
            Kind::Pair(_) => None,
            Kind::Region(region, _) => Some(region),
        }
    }
}

/// Two capsules with a minimum distance.
#[derive(Debug, Clone, Copy)]
struct CapsulePair {
    inner: usize,
    outer: usize,
    /// Sum of the radii of the balls around both capsules, `[m]`.
    reach: f64,
    group: usize,
}

/// The capsules of a shape, each in the frame of its link.
#[derive(Debug, Clone)]
struct LinkCapsules {
    all: [Mounted; CAPACITY],
    count: usize,
}

impl LinkCapsules {
    const EMPTY: Self = Self {
        all: [Mounted::NONE; CAPACITY],
        count: 0,
    };

    fn of(shape: &Shape<'_>) -> Self {
        let links = shape.arm.iter();
        let links = links.map(|c| Mounted::on_link(c.link, &c.capsule));
        Self::from(links.chain(shape.tool.iter().map(Mounted::on_flange)))
    }

    fn from(capsules: impl Iterator<Item = Mounted>) -> Self {
        let mut this = Self::EMPTY;
        for (place, mounted) in this.all.iter_mut().zip(capsules) {
            *place = mounted;
            this.count += 1;
        }
        this
    }

    fn each(&self) -> &[Mounted] {
        &self.all[..self.count]
    }

    #[inline(always)]
    fn at(&self, chain: &Chain) -> [Location; CAPACITY] {
        let mut locations = [Location::NONE; CAPACITY];
        for (location, mounted) in locations.iter_mut().zip(self.each()) {
            *location = mounted.at(chain);
        }
        locations
    }
}

impl Spacing {
    /// Creates a spacing with the minimum `distance`, `[m]`, for the pairs of `arm` whose links are
    /// at least `links` apart along the chain. A tool counts as the link after link 7. Other pairs
    /// are not checked.
    pub fn within(arm: &Shape<'_>, distance: f64, links: u8) -> Self {
        let mut this = Self {
            lengths: arm.lengths,
            arm: LinkCapsules::of(arm),
            pairs: [CapsulePair {
                inner: 0,
                outer: 0,
                reach: 0.0,
                group: 0,
            }; PAIRS_MAX],
            pair_count: 0,
            apart: distance,
            cover: LinkCapsules::EMPTY,
            regions: [Region::NONE; REGIONS_MAX],
            region_count: 0,
            out: 0.0,
            groups: Groups::NONE,
        };
        for (inner, outer) in arm.indices() {
            let (a, b) = (&this.arm.all[inner], &this.arm.all[outer]);
            if b.number - a.number >= links {
                this.pairs[this.pair_count] = CapsulePair {
                    inner,
                    outer,
                    reach: a.reach + a.radius + b.reach + b.radius,
                    group: this.groups.join(&arm.lengths, a.number, b),
                };
                this.pair_count += 1;
            }
        }
        this
    }

    /// Adds the minimum `distance`, `[m]`, between each moving capsule in `cover` and each of
    /// `regions`. The arm keeps its lengths.
    #[must_use]
    pub fn out_of(
        mut self,
        cover: &Shape<'_>,
        distance: f64,
        regions: &[Option<Obstacle>; REGIONS_MAX],
    ) -> Self {
        self.out = distance;
        self.region_count = 0;
        for region in regions.iter().flatten() {
            self.regions[self.region_count] = Region::of(region);
            self.region_count += 1;
        }
        self.cover = LinkCapsules::EMPTY;
        if self.region_count > 0 {
            let all = LinkCapsules::of(cover);
            self.cover = LinkCapsules::from(all.each().iter().copied().filter(|m| m.number > 0));
        }
        for i in 0..self.cover.count {
            self.cover.all[i].group = self.groups.join(&self.lengths, 0, &self.cover.all[i]);
        }
        self
    }

    /// Returns the distances that belong to the groups in `candidates`.
    #[inline]
    pub fn items(&self, candidates: CandidateMask) -> impl Iterator<Item = Item> + '_ {
        let pairs = self.pairs[..self.pair_count].iter().enumerate();
        let pairs = pairs.filter(move |(_, pair)| candidates.has(pair.group));
        let of_region = move |region| {
            let bodies = self.cover.each().iter().enumerate();
            let bodies = bodies.filter(move |(_, capsule)| candidates.has(capsule.group));
            bodies.map(move |(body, _)| Kind::Region(region, body))
        };
        let regions = (0..self.region_count).flat_map(of_region);
        let pairs = pairs.map(|(pair, _)| Kind::Pair(pair));
        pairs.chain(regions).map(Item)
    }

    /// Places the capsules at the joint positions `q`, `[rad]`.
    pub fn at(&self, q: &JointVector) -> Arrangement<'_> {
        let chain = Chain::at(&self.lengths, q);
        Arrangement {
            spacing: self,
            q: *q,
            arm: self.arm.at(&chain),
            cover: self.cover.at(&chain),
        }
    }
}

/// A [`Spacing`] at one posture.
#[derive(Debug, Clone)]
pub struct Arrangement<'a> {
    spacing: &'a Spacing,
    q: JointVector,
    arm: [Location; CAPACITY],
    cover: [Location; CAPACITY],
}

impl Arrangement<'_> {
    /// Returns the margin of `item`, `[m]`, if it is less than `limit` or NaN, and `None`
    /// otherwise.
    #[inline]
    pub fn margin_below(&self, item: Item, limit: f64) -> Option<f64> {
        let margin = match item.0 {
            Kind::Pair(pair) => {
                let pair = &self.spacing.pairs[pair];
                let gap = self.arm[pair.outer].middle - self.arm[pair.inner].middle;
                let near = pair.reach + self.spacing.apart + limit;
                if near <= 0.0 || dot(&gap, &gap) >= near * near {
                    return None;
                }
                self.margin_of(pair)
            }
            Kind::Region(region, body) => {
                let region = &self.spacing.regions[region];
                let capsule = &self.spacing.cover.all[body];
                let near = self.spacing.out + limit;
                region.distance_below(&self.cover[body], capsule, near)? - self.spacing.out
            }
        };
        if margin >= limit { None } else { Some(margin) }
    }

    /// Returns the margin of `item`, `[m]`.
    pub fn margin(&self, item: Item) -> f64 {
        self.margin_below(item, f64::INFINITY)
            .unwrap_or(f64::INFINITY)
    }

    fn margin_of(&self, pair: &CapsulePair) -> f64 {
        let axis = |i: usize| self.arm[i].axis(&self.spacing.arm.all[i]);
        axis(pair.inner).nearest(&axis(pair.outer)).distance - self.spacing.apart
    }

    /// Returns a bound on the joint motion from this posture within which no margin falls below
    /// `limit`, `[m]`.
    pub fn motion_bound(&self, limit: f64) -> MotionBound {
        let mut spare = [f64::INFINITY; GROUPS_MAX];
        let mut bound = |group: usize, margin: f64| spare[group] = spare[group].min(margin - limit);
        for pair in &self.spacing.pairs[..self.spacing.pair_count] {
            let gap = self.arm[pair.outer].middle - self.arm[pair.inner].middle;
            let margin = sqrt(dot(&gap, &gap)) - pair.reach - self.spacing.apart;
            let margin = if margin < AMPLE {
                self.margin_of(pair)
            } else {
                margin
            };
            bound(pair.group, margin);
        }
        for region in &self.spacing.regions[..self.spacing.region_count] {
            for (location, capsule) in self.cover.iter().zip(self.spacing.cover.each()) {
                let margin = region.distance_at_least(location, capsule) - self.spacing.out;
                bound(capsule.group, margin);
            }
        }
        MotionBound::new(self.q, spare)
    }
}

impl Location {
    /// Returns the axis of `capsule` at this location.
    #[inline(always)]
    fn axis(&self, capsule: &Mounted) -> Segment {
        Segment::around(&self.middle, &self.half, capsule.radius)
    }
}
