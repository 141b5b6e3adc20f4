//! A solution with its properties, and lists of solutions.

use core::f64::consts::{FRAC_PI_2, TAU};
use core::ops::Deref;

use crate::JointVector;
use crate::elbow::FLIP_ANGLE;
use crate::limits::JointLimits;

/// Branch of a solution: which of the two answers each step of the solver chose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Branch {
    /// True if joint 4 is above the [flip angle](crate::elbow::FLIP_ANGLE).
    pub elbow: bool,
    /// True if joint 5 is within a quarter turn of zero, if joint 4 is within its limits.
    pub wrist: bool,
    /// True if joint 2 is negative.
    pub shoulder: bool,
}

impl Branch {
    /// Returns the number of the branch, 0 to 7.
    pub fn index(self) -> usize {
        usize::from(self.elbow) * 4 + usize::from(self.wrist) * 2 + usize::from(self.shoulder)
    }
}

/// One solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Joint positions, `[rad]`.
    pub q: JointVector,
    /// Branch of the solution. It stays the same along a path that crosses no singularity.
    pub branch: Branch,
    /// Lower and upper bound of the angle, `[rad]`, by which joint 1 may turn if axes 1 and 3 are
    /// in line (joint 2 at zero). Joint 3 then turns back by the same angle, and the hand does not
    /// move. The bounds respect the joint limits if the search did. The value is `None` in all
    /// other postures.
    pub slide: Option<[f64; 2]>,
}

impl Solution {
    /// Returns the distance of each joint to the nearer of its limits, `[rad]`. The distance is
    /// negative beyond the limit.
    pub fn limit_distances(&self, limits: &JointLimits) -> JointVector {
        (self.q - limits.lower).inf(&(limits.upper - self.q))
    }

    /// Returns the smallest of the [`limit_distances`](Self::limit_distances), `[rad]`.
    pub fn limit_margin(&self, limits: &JointLimits) -> f64 {
        self.limit_distances(limits).min()
    }

    /// Returns the distances to the three singularities of the arm.
    pub fn singularity(&self) -> Singularity {
        Singularity::of(&self.q)
    }

    /// Returns the solution for the same pose with joints 1 and 3 as near to their values in `q` as
    /// [`slide`](Self::slide) allows.
    pub(super) fn slid_towards(&self, q: &JointVector) -> Self {
        let Some([back, on]) = self.slide else {
            return *self;
        };
        // Both joints then deviate from `q` by the same amount.
        let ideal = 0.5 * ((q[0] - self.q[0]) - (q[2] - self.q[2]));
        let step = ideal.clamp(back, on);
        let mut slid = *self;
        slid.q[0] += step;
        slid.q[2] -= step;
        slid.slide = Some([back - step, on - step]);
        slid
    }

    /// Returns the solution within the limits. If necessary, it shifts angles by a turn, or slides
    /// joints 1 and 3.
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

    /// Returns `moved`, with joints 1 and 3 as near to their positions in `self` as the limits
    /// allow.
    fn slid_within(&self, moved: &Self, lower: &JointVector, upper: &JointVector) -> Option<Self> {
        let (q1, q3) = (self.q[0], self.q[2]);
        let back = (lower[0] - q1).max(q3 - upper[2]);
        let on = (upper[0] - q1).min(q3 - lower[2]);
        if back > on {
            return None;
        }
        let step = 0_f64.clamp(back, on);
        let mut slid = *moved;
        // The sum of two rounded numbers must not exceed a limit.
        slid.q[0] = (q1 + step).clamp(lower[0], upper[0]);
        slid.q[2] = (q3 - step).clamp(lower[2], upper[2]);
        slid.slide = Some([back - step, on - step]);
        Some(slid)
    }
}

/// Distances of three joints, `[rad]`, from singular postures of joints 1 to 6. In such a posture,
/// two solutions meet. The Jacobian of these six joints has the determinant `L1 L2 sin(elbow) ·
/// sin(shoulder) · f(q4) sin(wrist)`. Each distance is the angle between a joint and the position
/// at which one of the three sines is zero.
///
/// With joint 7, the whole arm can still be regular in such a posture; see
/// [`manipulability`](crate::manipulability).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Singularity {
    /// Distance of joint 2 from zero, where axes 1 and 3 are in line.
    pub shoulder: f64,
    /// Distance of joint 4 from the [flip angle](crate::elbow::FLIP_ANGLE), where the arm is
    /// stretched.
    pub elbow: f64,
    /// Distance of joint 5 from a quarter turn in either direction.
    pub wrist: f64,
}

impl Singularity {
    /// Computes the distances at joint positions within the limits.
    pub fn of(q: &JointVector) -> Self {
        Self {
            shoulder: q[1].abs(),
            elbow: (q[3] - FLIP_ANGLE).abs(),
            wrist: (q[4].abs() - FRAC_PI_2).abs(),
        }
    }

    /// Returns the smallest of the three distances.
    pub fn least(&self) -> f64 {
        self.shoulder.min(self.elbow).min(self.wrist)
    }
}

/// List of solutions, which dereferences to a slice.
#[derive(Debug, Clone, Copy)]
pub struct Solutions {
    list: [Solution; CAPACITY],
    count: usize,
}

/// Capacity of a list. In a test with two million given swivel angles, no list had more than 12
/// solutions within the limits.
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

    /// Appends a solution, unless the list is full.
    pub(super) fn push(&mut self, solution: Solution) {
        if let Some(place) = self.list.get_mut(self.count) {
            *place = solution;
            self.count += 1;
        }
    }

    /// Returns the solutions within `lower` and `upper` `[rad]`. If necessary, the function shifts
    /// angles by a turn.
    ///
    /// No joint of these robots has a range of a full turn, so the shift is unique.
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

    /// Returns the solution nearest to `q`: its largest joint displacement from `q` is the
    /// smallest. If [`Solution::slide`] allows, joints 1 and 3 are moved towards `q`.
    pub fn nearest(&self, q: &JointVector) -> Option<Solution> {
        let distance = |solution: &Solution| (solution.q - q).amax();
        self.iter()
            .map(|solution| solution.slid_towards(q))
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Returns the solution with the greatest [`Solution::limit_margin`].
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
