//! What of an arm is nearer to itself, or to regions, than it is to be.
//!
//! ```text
//! Spacing (who keeps what distance from whom; made once)
//!    │ at(q)
//!    v
//! Arrangement ──> room_below(item, limit)    what is near, and only that is measured
//!             ──> leeway(limit)              how far the joints may turn before what is near
//! ```
//!
//! Nearly all that could meet is far apart nearly always. One pass places the capsules; balls and
//! boxes around them tell what is far, and what may be near is measured. What they tell at one
//! posture remains as its [`Leeway`], which saves looking at most of it, or at all of it, at the
//! next ones.

mod leeway;
mod mounted;
mod region;
#[cfg(test)]
mod tests;

pub use leeway::{Leeway, Open};

use leeway::{GROUPS_MAX, Groups};
use mounted::{Mounted, Spot};
use region::Region;

use super::segment::Segment;
use super::{CAPACITY, Obstacle, Shape, capsules, shape};
use crate::JointVector;
use crate::chain::Chain;
use crate::inertia::dot;
use crate::scalar::sqrt;

/// Regions that a [`Spacing`] has room for.
pub const REGIONS_MAX: usize = 4;

/// Pairs of links, and of links and a tool, that any shape has.
const PAIRS_MAX: usize = capsules::COVERING_PAIRS.len() + capsules::ARM_MAX * shape::TOOL_MAX;

/// Room, `[m]`, beyond which a bound stands for what is left of a distance. Joints take a while to
/// turn that far.
const AMPLE: f64 = 0.15;

/// Who keeps what distance from whom: an arm from itself, and from regions.
///
/// The distances are those of [`Placed`](super::Placed). What is left of one above the distance to
/// be kept is called its room, and is negative where that is not kept.
#[derive(Debug, Clone)]
pub struct Spacing {
    /// The capsules that keep from each other.
    arm: Crowd,
    pairs: [Pair; PAIRS_MAX],
    pair_count: usize,
    /// Distance that they keep, `[m]`.
    apart: f64,
    /// The capsules that keep from regions, if there are any. The base stands where it stands: it
    /// is left out.
    cover: Crowd,
    regions: [Region; REGIONS_MAX],
    region_count: usize,
    /// Distance that they keep, `[m]`.
    out: f64,
    groups: Groups,
}

/// One of the distances that are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Item(Kind);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// By its number.
    Pair(usize),
    /// A region and a capsule.
    Region(usize, usize),
}

/// Two capsules that keep from each other.
#[derive(Debug, Clone, Copy)]
struct Pair {
    inner: usize,
    outer: usize,
    /// What both reach from their middles, `[m]`, radii included.
    reach: f64,
    group: usize,
}

/// Capsules on links.
#[derive(Debug, Clone)]
struct Crowd {
    all: [Mounted; CAPACITY],
    count: usize,
}

impl Crowd {
    const NOBODY: Self = Self {
        all: [Mounted::NONE; CAPACITY],
        count: 0,
    };

    /// Base to tool.
    fn of(shape: &Shape<'_>) -> Self {
        let links = shape.arm.iter();
        let links = links.map(|c| Mounted::on_link(c.link, &c.capsule));
        Self::from(links.chain(shape.tool.iter().map(Mounted::on_flange)))
    }

    fn from(capsules: impl Iterator<Item = Mounted>) -> Self {
        let mut crowd = Self::NOBODY;
        for (place, mounted) in crowd.all.iter_mut().zip(capsules) {
            *place = mounted;
            crowd.count += 1;
        }
        crowd
    }

    fn each(&self) -> &[Mounted] {
        &self.all[..self.count]
    }

    #[inline(always)]
    fn at(&self, chain: &Chain) -> [Spot; CAPACITY] {
        let mut spots = [Spot::NOWHERE; CAPACITY];
        for (spot, mounted) in spots.iter_mut().zip(self.each()) {
            *spot = mounted.at(chain);
        }
        spots
    }
}

impl Spacing {
    /// The pairs of `arm` that can meet keep `distance`, `[m]`, between bodies that are `links` or
    /// more links apart along the chain; a tool comes after link 7. Closer ones may touch.
    pub fn within(arm: &Shape<'_>, distance: f64, links: u8) -> Self {
        let mut this = Self {
            arm: Crowd::of(arm),
            pairs: [Pair {
                inner: 0,
                outer: 0,
                reach: 0.0,
                group: 0,
            }; PAIRS_MAX],
            pair_count: 0,
            apart: distance,
            cover: Crowd::NOBODY,
            regions: [Region::NOWHERE; REGIONS_MAX],
            region_count: 0,
            out: 0.0,
            groups: Groups::NONE,
        };
        for (inner, outer) in arm.indices() {
            let (a, b) = (&this.arm.all[inner], &this.arm.all[outer]);
            if b.number - a.number >= links {
                this.pairs[this.pair_count] = Pair {
                    inner,
                    outer,
                    reach: a.reach + a.radius + b.reach + b.radius,
                    group: this.groups.join(a.number, b),
                };
                this.pair_count += 1;
            }
        }
        this
    }

    /// And all of `cover` that moves keeps `distance`, `[m]`, from each of `regions`.
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
        self.cover = Crowd::NOBODY;
        if self.region_count > 0 {
            let all = Crowd::of(cover);
            self.cover = Crowd::from(all.each().iter().copied().filter(|m| m.number > 0));
        }
        for i in 0..self.cover.count {
            self.cover.all[i].group = self.groups.join(0, &self.cover.all[i]);
        }
        self
    }

    /// The distances that are kept, of those that are `open`.
    #[inline]
    pub fn items(&self, open: Open) -> impl Iterator<Item = Item> + '_ {
        let pairs = self.pairs[..self.pair_count].iter().enumerate();
        let pairs = pairs.filter(move |(_, pair)| open.has(pair.group));
        let of_region = move |region| {
            let bodies = self.cover.each().iter().enumerate();
            let bodies = bodies.filter(move |(_, capsule)| open.has(capsule.group));
            bodies.map(move |(body, _)| Kind::Region(region, body))
        };
        let regions = (0..self.region_count).flat_map(of_region);
        let pairs = pairs.map(|(pair, _)| Kind::Pair(pair));
        pairs.chain(regions).map(Item)
    }

    /// Where everything is at the joint positions `q`, `[rad]`.
    pub fn at(&self, q: &JointVector) -> Arrangement<'_> {
        let chain = Chain::at(q);
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
    arm: [Spot; CAPACITY],
    cover: [Spot; CAPACITY],
}

impl Arrangement<'_> {
    /// The room of `item`, `[m]`, if that is less than `limit`; also if it is not a number.
    #[inline]
    pub fn room_below(&self, item: Item, limit: f64) -> Option<f64> {
        let room = match item.0 {
            Kind::Pair(pair) => {
                let pair = &self.spacing.pairs[pair];
                let gap = self.arm[pair.outer].middle - self.arm[pair.inner].middle;
                let near = pair.reach + self.spacing.apart + limit;
                if near <= 0.0 || dot(&gap, &gap) >= near * near {
                    return None;
                }
                self.room_of(pair)
            }
            Kind::Region(region, body) => {
                let region = &self.spacing.regions[region];
                let capsule = &self.spacing.cover.all[body];
                let near = self.spacing.out + limit;
                region.distance_below(&self.cover[body], capsule, near)? - self.spacing.out
            }
        };
        if room >= limit { None } else { Some(room) }
    }

    /// The room of `item`, `[m]`.
    pub fn room(&self, item: Item) -> f64 {
        self.room_below(item, f64::INFINITY)
            .unwrap_or(f64::INFINITY)
    }

    fn room_of(&self, pair: &Pair) -> f64 {
        let axis = |i: usize| self.arm[i].axis(&self.spacing.arm.all[i]);
        axis(pair.inner).nearest(&axis(pair.outer)).distance - self.spacing.apart
    }

    /// How far the joints may turn from here before any room can be less than `limit`, `[m]`.
    pub fn leeway(&self, limit: f64) -> Leeway {
        let mut spare = [f64::INFINITY; GROUPS_MAX];
        let mut bound = |group: usize, room: f64| spare[group] = spare[group].min(room - limit);
        for pair in &self.spacing.pairs[..self.spacing.pair_count] {
            let gap = self.arm[pair.outer].middle - self.arm[pair.inner].middle;
            let room = sqrt(dot(&gap, &gap)) - pair.reach - self.spacing.apart;
            let room = if room < AMPLE {
                self.room_of(pair)
            } else {
                room
            };
            bound(pair.group, room);
        }
        for region in &self.spacing.regions[..self.spacing.region_count] {
            for (spot, capsule) in self.cover.iter().zip(self.spacing.cover.each()) {
                let room = region.distance_at_least(spot, capsule) - self.spacing.out;
                bound(capsule.group, room);
            }
        }
        Leeway::new(self.q, spare)
    }
}

impl Spot {
    /// The axis of a capsule whose spot this is.
    #[inline(always)]
    fn axis(&self, capsule: &Mounted) -> Segment {
        Segment::around(&self.middle, &self.half, capsule.radius)
    }
}
