//! Distances between the arm's links, and from the arm to planes and boxes, each with its gradient.
//!
//! ```text
//! Shape (capsules on links, pairs that can meet)
//!    │ at(q)
//!    v
//! Placed ──> pairs(), nearest_pair()        arm and tool against each other
//!        ──> to(obstacle), nearest_to(..)   arm and tool against a plane or a box
//! ```
//!
//! The bodies are [capsules](Capsule): all points within a radius of a segment. Distances are
//! exact, in metres, and measured between surfaces. If two bodies overlap, their distance is minus
//! the length of the shortest shift that separates them. Gradients are with respect to the joint
//! positions, in m/rad. No function allocates, and the amount of work is bounded.
//!
//! # Kinks
//!
//! Each distance is a continuous function of `q`, but it is not smooth everywhere:
//!
//! - Two axes may be parallel and side by side, or they may cross (distance `-(r1 + r2)`). The
//!   nearest points then jump, and the gradient is one of the gradients at neighbouring postures.
//!   For parallel axes, it is the gradient at the middle of the overlap. For crossing axes, it is
//!   the gradient along their common normal, and rounding determines its sign.
//! - The axis of a capsule that crosses a box may have equal distances to several faces or edges.
//!   An axis parallel to a face or a plane has equal distances at both ends. The gradient is then
//!   one of the possible gradients. For a parallel axis, it is the gradient at the middle.
//! - The least distance over all pairs has a kink where another pair becomes the nearest. For a
//!   smooth constraint, use every pair's distance and gradient ([`Placed::pairs`]) as a separate
//!   constraint.
//!
//! At all other postures, the gradient is the derivative of the distance.
//!
//! # Example
//!
//! ```
//! use franka_model::collision::{Body, Obstacle, Shape};
//! use franka_model::{READY, RobotKind};
//!
//! let arm = Shape::vendor().with_hand().at(&READY);
//! assert!(arm.nearest_pair().distance > 0.05);
//!
//! let table = Obstacle::floor(0.0);
//! let arm = Shape::covering(RobotKind::Fr3).with_hand().at(&READY);
//! let hand = arm.to(&table).filter(|near| near.bodies == Body::Tool);
//! let nearest = hand.min_by(|a, b| a.distance.total_cmp(&b.distance)).expect("a hand");
//! assert!(nearest.distance > 0.3);
//! // Turning joint 2 forwards brings the hand closer to the table.
//! assert!(nearest.gradient[1] < -0.2);
//! ```

mod capsules;
mod obstacle;
mod segment;
mod shape;
mod spacing;
#[cfg(test)]
mod tests;

pub use obstacle::Obstacle;
pub use shape::{Capsule, Shape, ToolError};
pub use spacing::{Arrangement, CandidateMask, Item, MotionBound, REGIONS_MAX, Spacing};

use nalgebra::Vector3;

use crate::JointVector;
use crate::chain::Chain;
use crate::geometry::{FLANGE, SHOULDER};
use crate::inertia::{cross, dot};
use capsules::LinkCapsule;
use segment::Segment;

/// Body to which a capsule belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Body {
    /// Link 0 (the base) to link 7.
    Link(u8),
    /// The tool on the flange.
    Tool,
}

impl Body {
    /// Returns the number of the body along the arm: the link's number, or 8 for the tool.
    #[must_use]
    pub fn number(self) -> u8 {
        match self {
            Self::Link(link) => link,
            Self::Tool => 8,
        }
    }

    pub(crate) fn joints(self) -> usize {
        match self {
            Self::Link(link) => usize::from(link),
            Self::Tool => 7,
        }
    }
}

/// Distance between two bodies, and its derivative. `P` identifies the bodies: `(Body, Body)`
/// within the arm, with the body nearer to the base first, or one [`Body`] for an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proximity<P> {
    /// The bodies.
    pub bodies: P,
    /// Distance between the surfaces, `[m]`. It is negative if the bodies overlap.
    pub distance: f64,
    /// Change of the distance per joint position, `[m/rad]`.
    pub gradient: JointVector,
    /// Unit vector from the inner body, or the obstacle, to the outer body, in base axes.
    pub normal: Vector3<f64>,
    /// The nearest points, `[m]`, in the base frame. The first is on the inner body's axis or on
    /// the obstacle's surface, and the second is on the outer body's axis.
    pub points: [Vector3<f64>; 2],
}

/// A [`Shape`] at one posture.
#[derive(Clone)]
pub struct Placed<'a> {
    shape: Shape<'a>,
    chain: Chain,
    segments: [Segment; CAPACITY],
}

/// Largest number of capsules of a shape with a tool.
pub(crate) const CAPACITY: usize = capsules::ARM_MAX + shape::TOOL_MAX;

impl<'a> Shape<'a> {
    /// Places the shape at the joint positions `q`, `[rad]`.
    pub fn at(&self, q: &JointVector) -> Placed<'a> {
        let chain = Chain::at(&self.lengths, q);
        let mut segments = [Segment::EMPTY; CAPACITY];
        for (segment, LinkCapsule { link, capsule, .. }) in segments.iter_mut().zip(self.arm) {
            *segment = match link {
                0 => Segment::of(capsule, |p| p - Vector3::new(0.0, 0.0, SHOULDER)),
                link => {
                    let i = usize::from(*link) - 1;
                    Segment::of(capsule, |p| chain.origin[i] + chain.rotation[i] * p)
                }
            };
        }
        let flange = chain.origin[6] + chain.axis[6] * FLANGE;
        for (segment, capsule) in segments[self.arm.len()..].iter_mut().zip(self.tool) {
            *segment = Segment::of(capsule, |p| flange + chain.rotation[6] * p);
        }
        Placed {
            shape: *self,
            chain,
            segments,
        }
    }

    /// Returns the indices of the pairs of capsules that can meet, with the inner capsule first.
    fn indices(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (arm, tool) = (self.arm, self.arm.len()..self.len());
        let within = self.pairs.iter().map(|&(a, b)| (a.into(), b.into()));
        let inner = arm.iter().take_while(|c| c.link <= capsules::TOOL_MEETS);
        let beyond = move |(a, _)| tool.clone().map(move |b| (a, b));
        within.chain(inner.enumerate().flat_map(beyond))
    }
}

impl Placed<'_> {
    /// Returns the distance and the gradient of every pair that can meet.
    pub fn pairs(&self) -> impl Iterator<Item = Proximity<(Body, Body)>> + '_ {
        self.shape.indices().map(|(a, b)| {
            let nearest = self.segments[a].nearest(&self.segments[b]);
            self.pair_proximity(a, b, &nearest)
        })
    }

    /// Returns the distance of every pair that can meet, `[m]`, in the order of
    /// [`pairs`](Self::pairs). This function is cheaper than `pairs`, because it computes no
    /// gradients.
    pub fn distances(&self) -> impl Iterator<Item = ((Body, Body), f64)> + '_ {
        self.shape.indices().map(|(a, b)| {
            let nearest = self.segments[a].nearest(&self.segments[b]);
            ((self.body(a), self.body(b)), nearest.distance)
        })
    }

    /// Returns the pair with the smallest distance. This function is cheaper than
    /// [`pairs`](Self::pairs), because it computes only one gradient.
    pub fn nearest_pair(&self) -> Proximity<(Body, Body)> {
        let distances = self.shape.indices().map(|(a, b)| {
            let nearest = self.segments[a].nearest(&self.segments[b]);
            (nearest.distance, (a, b, nearest))
        });
        let (a, b, nearest) = least(distances).expect("every shape has pairs");
        self.pair_proximity(a, b, &nearest)
    }

    /// Returns the distances of every moving capsule to an obstacle. The base does not move and is
    /// omitted.
    pub fn to<'o>(&'o self, obstacle: &'o Obstacle) -> impl Iterator<Item = Proximity<Body>> + 'o {
        self.moving().map(move |i| {
            let nearest = obstacle.nearest(&self.segments[i]);
            self.obstacle_proximity(i, &nearest)
        })
    }

    /// Returns the moving capsule that is nearest to an obstacle. For a floor at the height of the
    /// base, the nearest capsule is usually link 1, which turns in place a decimetre above the
    /// floor.
    pub fn nearest_to(&self, obstacle: &Obstacle) -> Proximity<Body> {
        let distances = self.moving().map(|i| {
            let nearest = obstacle.nearest(&self.segments[i]);
            (nearest.distance, (i, nearest))
        });
        let (i, nearest) = least(distances).expect("every shape has moving links");
        self.obstacle_proximity(i, &nearest)
    }

    /// Returns the capsules in the base frame, from base to tool.
    pub fn capsules(&self) -> impl Iterator<Item = (Body, Capsule)> + '_ {
        (0..self.shape.len()).map(|i| (self.body(i), self.segments[i].capsule()))
    }

    /// Returns capsules that follow the surface of the arm, relative to the shoulder, for contacts
    /// on the surface. They are the [`Self::capsules`] without their margins.
    pub(crate) fn surfaces(&self) -> impl Iterator<Item = (Body, Capsule)> + '_ {
        (0..self.shape.len()).map(|i| {
            let segment = &self.segments[i];
            let margin = self.shape.arm.get(i).map_or(0.0, |capsule| capsule.margin);
            let capsule = Capsule {
                start: segment.start,
                end: segment.start + segment.along,
                radius: segment.radius - margin,
            };
            (self.body(i), capsule)
        })
    }

    pub(crate) fn chain(&self) -> &Chain {
        &self.chain
    }

    fn body(&self, i: usize) -> Body {
        match self.shape.arm.get(i) {
            Some(capsule) => Body::Link(capsule.link),
            None => Body::Tool,
        }
    }

    fn moving(&self) -> impl Iterator<Item = usize> + '_ {
        let base = self.shape.arm.iter().take_while(|c| c.link == 0).count();
        base..self.shape.len()
    }

    #[inline(always)]
    fn pair_proximity(
        &self,
        a: usize,
        b: usize,
        nearest: &segment::Nearest,
    ) -> Proximity<(Body, Body)> {
        let bodies = (self.body(a), self.body(b));
        let joints = bodies.0.joints()..bodies.1.joints();
        self.proximity(bodies, joints, nearest)
    }

    #[inline(always)]
    fn obstacle_proximity(&self, i: usize, nearest: &segment::Nearest) -> Proximity<Body> {
        let body = self.body(i);
        self.proximity(body, 0..body.joints(), nearest)
    }

    /// Computes distance and gradient from the nearest points. `joints` are the joints that move
    /// the second point but not the first.
    ///
    /// To first order, the same points stay nearest. Therefore the distance changes by the velocity
    /// of the second point along the normal: `n · (axis × p + moment) = axis · (p × n) + moment ·
    /// n`.
    #[inline(always)]
    fn proximity<P>(
        &self,
        bodies: P,
        joints: core::ops::Range<usize>,
        nearest: &segment::Nearest,
    ) -> Proximity<P> {
        let (normal, [inner, outer]) = (nearest.normal, nearest.points);
        let torque = cross(&outer, &normal);
        let mut gradient = JointVector::zeros();
        for i in joints {
            gradient[i] = dot(&self.chain.axis[i], &torque) + dot(&self.chain.moment[i], &normal);
        }
        let shoulder = Vector3::new(0.0, 0.0, SHOULDER);
        Proximity {
            bodies,
            distance: nearest.distance,
            gradient,
            normal,
            points: [inner + shoulder, outer + shoulder],
        }
    }
}

/// Returns the item with the smallest distance. If a distance is NaN, returns that item.
fn least<T>(items: impl Iterator<Item = (f64, T)>) -> Option<T> {
    let nearer = |best: (f64, T), next: (f64, T)| {
        if next.0 < best.0 || next.0.is_nan() {
            next
        } else {
            best
        }
    };
    items.reduce(nearer).map(|(_, item)| item)
}
