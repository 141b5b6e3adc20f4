//! Solutions, what is known about each, and lists of them.

use core::f64::consts::{FRAC_PI_2, TAU};
use core::ops::Deref;

use crate::JointVector;
use crate::elbow::FLIP_ANGLE;
use crate::limits::JointLimits;

/// Which of the two answers of each step a solution takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Branch {
    /// Joint 4 above the [flip angle](crate::elbow::FLIP_ANGLE).
    pub elbow: bool,
    /// Joint 5 within a quarter turn of zero, for positions of joint 4 within its limits.
    pub wrist: bool,
    /// Joint 2 negative.
    pub shoulder: bool,
}

impl Branch {
    /// From 0 to 7, a number for each.
    pub fn index(self) -> usize {
        usize::from(self.elbow) * 4 + usize::from(self.wrist) * 2 + usize::from(self.shoulder)
    }
}

/// One solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Joint positions, `[rad]`.
    pub q: JointVector,
    /// Which one it is: the same along a path that crosses no singularity.
    pub branch: Branch,
    /// With axes 1 and 3 in line (joint 2 at zero): how far, `[rad]`, joint 1 may turn on while
    /// joint 3 turns back without moving the hand, as a lower and an upper bound. Within the
    /// limits if the solution was sought there. `None` anywhere else.
    pub slide: Option<[f64; 2]>,
}

impl Solution {
    /// Distance of each joint to the nearer of its limits, `[rad]`, negative beyond it.
    pub fn limit_distances(&self, limits: &JointLimits) -> JointVector {
        (self.q - limits.lower).inf(&(limits.upper - self.q))
    }

    /// The least of [`limit_distances`](Self::limit_distances), `[rad]`.
    pub fn limit_margin(&self, limits: &JointLimits) -> f64 {
        self.limit_distances(limits).min()
    }

    /// Distance to the three singularities of the arm.
    pub fn singularity(&self) -> Singularity {
        Singularity::of(&self.q)
    }

    /// The same pose with joints 1 and 3 as near to those of `q` as [`slide`](Self::slide) allows.
    pub(super) fn slid_towards(&self, q: &JointVector) -> Self {
        let Some([back, on]) = self.slide else {
            return *self;
        };
        // Both joints then miss `q` by the same.
        let ideal = 0.5 * ((q[0] - self.q[0]) - (q[2] - self.q[2]));
        let step = ideal.clamp(back, on);
        let mut slid = *self;
        slid.q[0] += step;
        slid.q[2] -= step;
        slid.slide = Some([back - step, on - step]);
        slid
    }

    /// Angles taken a turn on, or joints 1 and 3 slid, where that brings them within the limits.
    fn within(&self, lower: &JointVector, upper: &JointVector) -> Option<Self> {
        let mut moved = *self;
        for i in 0..7 {
            if moved.q[i] < lower[i] {
                moved.q[i] += TAU;
            } else if moved.q[i] > upper[i] {
                moved.q[i] -= TAU;
            }
        }
        if self.slide.is_some() {
            moved = self.slid_within(&moved, lower, upper)?;
        }
        let inside = |i: usize| lower[i] <= moved.q[i] && moved.q[i] <= upper[i];
        (0..7).all(inside).then_some(moved)
    }

    /// `moved` with joints 1 and 3 as near to their half of the turn as the limits allow.
    fn slid_within(&self, moved: &Self, lower: &JointVector, upper: &JointVector) -> Option<Self> {
        let (q1, q3) = (self.q[0], self.q[2]);
        let back = (lower[0] - q1).max(q3 - upper[2]);
        let on = (upper[0] - q1).min(q3 - lower[2]);
        if back > on {
            return None;
        }
        let step = 0_f64.clamp(back, on);
        let mut slid = *moved;
        // The sum of two roundings must not step over a limit.
        slid.q[0] = (q1 + step).clamp(lower[0], upper[0]);
        slid.q[2] = (q3 - step).clamp(lower[2], upper[2]);
        slid.slide = Some([back - step, on - step]);
        Some(slid)
    }
}

/// How far joints are, `[rad]`, from where two solutions meet and the six joints without joint 7
/// lose a direction: each is the angle of one joint to the place where a factor of their
/// determinant `L1 L2 sin(elbow) · sin(shoulder) · f(q4) sin(wrist)` vanishes.
///
/// The whole arm can be regular there, its seventh joint helping out;
/// [`manipulability`](crate::manipulability) tells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Singularity {
    /// Of joint 2 from zero, where axes 1 and 3 are in line.
    pub shoulder: f64,
    /// Of joint 4 from the [flip angle](crate::elbow::FLIP_ANGLE), where the arm is stretched.
    pub elbow: f64,
    /// Of joint 5 from a quarter turn either way.
    pub wrist: f64,
}

impl Singularity {
    /// At joint positions within the limits.
    pub fn of(q: &JointVector) -> Self {
        Self {
            shoulder: q[1].abs(),
            elbow: (q[3] - FLIP_ANGLE).abs(),
            wrist: (q[4].abs() - FRAC_PI_2).abs(),
        }
    }

    /// The least of the three.
    pub fn least(&self) -> f64 {
        self.shoulder.min(self.elbow).min(self.wrist)
    }
}

/// Solutions, as a slice.
#[derive(Debug, Clone, Copy)]
pub struct Solutions {
    list: [Solution; CAPACITY],
    count: usize,
}

/// Room in a list: four times what joints 7 and 4 can give. Of two million swivel problems none had
/// more than 12 solutions within the limits.
const CAPACITY: usize = 32;

impl Solutions {
    pub(super) const NONE: Self = Self {
        list: [Solution {
            q: crate::joint_vector([0.0; 7]),
            branch: Branch {
                elbow: false,
                wrist: false,
                shoulder: false,
            },
            slide: None,
        }; CAPACITY],
        count: 0,
    };

    /// Appends, unless the list is full.
    pub(super) fn push(&mut self, solution: Solution) {
        if let Some(place) = self.list.get_mut(self.count) {
            *place = solution;
            self.count += 1;
        }
    }

    /// Those within `lower` and `upper` `[rad]`, angles taken a turn on where that brings them in.
    ///
    /// No joint of these robots has a range of a turn, so the place within it is unique.
    pub fn within(mut self, lower: &JointVector, upper: &JointVector) -> Self {
        let found = self.count;
        self.count = 0;
        for index in 0..found {
            if let Some(solution) = self.list[index].within(lower, upper) {
                self.push(solution);
            }
        }
        self
    }

    /// The solution whose largest joint displacement from `q` is least, slid towards `q` where it
    /// can be ([`Solution::slide`]).
    pub fn nearest(&self, q: &JointVector) -> Option<Solution> {
        let distance = |solution: &Solution| (solution.q - q).amax();
        self.iter()
            .map(|solution| solution.slid_towards(q))
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// The solution with the greatest [`Solution::limit_margin`].
    pub fn max_margin(&self, limits: &JointLimits) -> Option<Solution> {
        self.iter()
            .max_by(|a, b| a.limit_margin(limits).total_cmp(&b.limit_margin(limits)))
            .copied()
    }
}

impl Deref for Solutions {
    type Target = [Solution];

    fn deref(&self) -> &[Solution] {
        &self.list[..self.count]
    }
}
