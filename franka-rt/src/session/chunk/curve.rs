//! The motion through the points of a chunk, twice continuously differentiable.
//!
//! Each point gets a velocity and an acceleration from its neighbours, and two points are joined by
//! the fifth-degree polynomial that meets all six. Orientations are joined as rotation vectors in
//! the chart around the earlier of the two, so none of them is singular whatever way the end
//! effector turns in all. The motion rests at its last point.

use super::motion::Motion;

/// States at increasing times, seconds from the chunk's origin. Never empty.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve<M> {
    times: Vec<f64>,
    states: Vec<M>,
}

impl<M: Motion> Curve<M> {
    /// # Panics
    /// If there are no states, or not as many as times.
    pub(super) fn new(times: Vec<f64>, mut states: Vec<M>) -> Self {
        assert!(!states.is_empty() && times.len() == states.len());
        let last = states.len() - 1;
        states[last] = states[last].resting();
        Self { times, states }
    }

    pub(super) fn begin(&self) -> f64 {
        self.times[0]
    }

    pub(super) fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    pub(super) fn first(&self) -> &M {
        &self.states[0]
    }

    /// At rest.
    pub(super) fn last(&self) -> &M {
        &self.states[self.states.len() - 1]
    }

    pub(super) fn states(&self) -> &[M] {
        &self.states
    }

    /// The state at `t`, seconds from the origin: the first before the first point's time, the last
    /// from the last one's on.
    pub(super) fn at(&self, t: f64) -> M {
        match self.times.partition_point(|&time| time <= t) {
            0 => *self.first(),
            next if next == self.times.len() => *self.last(),
            next => {
                let from = self.times[next - 1];
                let duration = self.times[next] - from;
                M::between(
                    &self.states[next - 1],
                    &self.states[next],
                    duration,
                    t - from,
                )
            }
        }
    }
}
