//! Bounds on the decrease of distances when joints turn.
//!
//! If a joint between two bodies turns, their distance changes by at most the angle times the
//! joint's lever. The lever is the greatest distance of the outer body from the joint's axis.
//! Distances between the same two bodies depend on the same joints, so they form a group.

use super::mounted::Mounted;
use crate::JointVector;
use crate::geometry::Lengths;

/// Bound on how fast margins shrink around a posture. It shows which margins may fall below a limit
/// when the joints turn.
#[derive(Debug, Clone)]
pub struct MotionBound {
    q: JointVector,
    /// Smallest margin of each group minus the bound's limit, `[m]`.
    spare: [f64; GROUPS_MAX],
}

impl MotionBound {
    pub(super) const fn new(q: JointVector, spare: [f64; GROUPS_MAX]) -> Self {
        Self { q, spare }
    }

    /// Returns the distances whose margin may be below the limit at some posture within `turns`,
    /// `[rad]`, of `q`. `turns` must not be negative.
    #[must_use]
    pub fn candidates(
        &self,
        spacing: &super::Spacing,
        q: &JointVector,
        turns: &JointVector,
    ) -> CandidateMask {
        let groups = &spacing.groups;
        // The array is padded to full SIMD rows. Groups beyond the count have no levers.
        let mut moved = [0.0; GROUPS_MAX];
        for (i, levers) in groups.levers.iter().enumerate() {
            let turn = (q[i] - self.q[i]).abs() + turns[i];
            for (moved, lever) in moved.iter_mut().zip(levers) {
                *moved += lever * turn;
            }
        }
        let all = moved.iter().zip(&self.spare).enumerate();
        // Comparisons with NaN are false, so NaN stays a candidate.
        let clear = all.fold(0, |clear, (i, (moved, spare))| {
            clear | u64::from(moved <= spare) << i
        });
        CandidateMask(!clear & groups.mask())
    }
}

/// Set of groups of distances of a [`Spacing`](super::Spacing) that must be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CandidateMask(u64);

impl CandidateMask {
    /// Mask of all distances.
    pub const ALL: Self = Self(u64::MAX);

    /// Returns true if no distance must be measured.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    #[inline(always)]
    pub(super) const fn has(self, group: usize) -> bool {
        self.0 >> group & 1 == 1
    }
}

/// The groups of distances, one for each pair of bodies.
#[derive(Debug, Clone)]
pub(super) struct Groups {
    /// Numbers of the two bodies of each group, with the inner body first. Regions do not move and
    /// count as the base, 0.
    numbers: [(u8, u8); GROUPS_MAX],
    count: usize,
    /// Largest motion of the outer body relative to the inner body per angle of a joint, by joint
    /// and group, `[m/rad]`.
    levers: [[f64; GROUPS_MAX]; 7],
}

impl Groups {
    pub(super) const NONE: Self = Self {
        numbers: [(0, 0); GROUPS_MAX],
        count: 0,
        levers: [[0.0; GROUPS_MAX]; 7],
    };

    /// Returns one bit for each group.
    const fn mask(&self) -> u64 {
        (1 << self.count) - 1
    }

    /// Returns the group of the distances from `outer` to the body with the number `inner`. If
    /// necessary, the function adds a new group and enlarges its levers.
    pub(super) fn join(&mut self, lengths: &Lengths, inner: u8, outer: &Mounted) -> usize {
        let numbers = (inner, outer.number);
        let known = self.numbers[..self.count].iter();
        let group = known.clone().position(|known| *known == numbers);
        let group = group.unwrap_or_else(|| {
            self.numbers[self.count] = numbers;
            self.count += 1;
            self.count - 1
        });
        for joint in usize::from(inner) + 1..=outer.joints() {
            let lever = &mut self.levers[joint - 1][group];
            *lever = lever.max(outer.lever(lengths, joint));
        }
        group
    }
}

/// Largest number of groups: all pairs of the base, seven links and a tool.
pub(super) const GROUPS_MAX: usize = 36;
