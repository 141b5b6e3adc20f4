//! How far joints may turn before anything comes near.
//!
//! A body moves against another by the joints between them, and by no more than the length of the
//! lever with which each of these moves it. What moves by the same joints is kept together in a
//! group.

use super::mounted::Mounted;
use crate::JointVector;

/// How far the joints may turn from a posture before anything is near: from each posture within,
/// everything has more room than the limit for which it was made.
#[derive(Debug, Clone)]
pub struct Leeway {
    q: JointVector,
    /// What each group has left above that limit, `[m]`.
    spare: [f64; GROUPS_MAX],
}

impl Leeway {
    pub(super) const fn new(q: JointVector, spare: [f64; GROUPS_MAX]) -> Self {
        Self { q, spare }
    }

    /// What may be near at a posture that is within `turns`, `[rad]`, none of them negative, of
    /// `q`.
    #[must_use]
    pub fn open(&self, spacing: &super::Spacing, q: &JointVector, turns: &JointVector) -> Open {
        self.open_below(0.0, spacing, q, turns)
    }

    /// What may have so much less room there than the limit for which this was made, `[m]`.
    #[must_use]
    pub fn open_below(
        &self,
        less: f64,
        spacing: &super::Spacing,
        q: &JointVector,
        turns: &JointVector,
    ) -> Open {
        let groups = &spacing.groups;
        // All groups that there could be: whole rows are added in a few instructions.
        let mut moved = [0.0; GROUPS_MAX];
        for (i, levers) in groups.levers.iter().enumerate() {
            let turn = (q[i] - self.q[i]).abs() + turns[i];
            for (moved, lever) in moved.iter_mut().zip(levers) {
                *moved += lever * turn;
            }
        }
        let all = moved.iter().zip(&self.spare).enumerate();
        // What is not a number is not clear.
        let clear = all.fold(0, |clear, (i, (moved, spare))| {
            clear | u64::from(*moved <= spare + less) << i
        });
        Open(!clear & groups.mask())
    }
}

/// Some of the distances that are kept: those that may be near.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Open(u64);

impl Open {
    /// All of them.
    pub const ALL: Self = Self(u64::MAX);

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    #[inline(always)]
    pub(super) const fn has(self, group: usize) -> bool {
        self.0 >> group & 1 == 1
    }
}

/// Groups of pairs of bodies.
#[derive(Debug, Clone)]
pub(super) struct Groups {
    /// Numbers of the bodies, the inner one first; of two regions and the base alike 0.
    numbers: [(u8, u8); GROUPS_MAX],
    count: usize,
    /// By joint, and by group, how far a turn moves the outer body against the inner one,
    /// `[m/rad]`.
    levers: [[f64; GROUPS_MAX]; 7],
}

impl Groups {
    pub(super) const NONE: Self = Self {
        numbers: [(0, 0); GROUPS_MAX],
        count: 0,
        levers: [[0.0; GROUPS_MAX]; 7],
    };

    /// A bit for each of them.
    const fn mask(&self) -> u64 {
        (1 << self.count) - 1
    }

    /// Adds a capsule that keeps from something on the body with the number `inner`, and gives its
    /// group.
    pub(super) fn join(&mut self, inner: u8, outer: &Mounted) -> usize {
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
            *lever = lever.max(outer.lever(joint));
        }
        group
    }
}

/// All pairs of the base, seven links and a tool.
pub(super) const GROUPS_MAX: usize = 36;
