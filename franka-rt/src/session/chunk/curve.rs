//! The motion through the points of a chunk, twice continuously differentiable.
//!
//! Each point gets a velocity and an acceleration that are estimated from its neighbours. Between
//! two points, the motion is the fifth-degree polynomial that meets position, velocity and
//! acceleration at both. Orientations are interpolated as rotation vectors in the chart around the
//! earlier point, so that no rotation in total leads to a singularity. The motion rests at its last
//! point.

use super::curve_state::CurveState;

/// States at increasing times, in seconds from the chunk's origin. Never empty.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve<M: CurveState> {
    times: Vec<f64>,
    states: Vec<M>,
    /// Range of the points. It is computed together with the curve, outside the thread, because the
    /// cycle that begins a chunk has no time to visit all points.
    extent: M::Extent,
}

impl<M: CurveState> Curve<M> {
    /// Creates the curve through `states` at `times`.
    ///
    /// # Panics
    /// Panics if there are no states, or if the number of times differs.
    pub(super) fn new(times: Vec<f64>, mut states: Vec<M>) -> Self {
        assert!(!states.is_empty() && times.len() == states.len());
        let last = states.len() - 1;
        states[last] = states[last].resting();
        let extent = M::extent(&states);
        Self {
            times,
            states,
            extent,
        }
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

    /// Returns the last state, at rest.
    pub(super) fn last(&self) -> &M {
        &self.states[self.states.len() - 1]
    }

    pub(super) fn extent(&self) -> &M::Extent {
        &self.extent
    }

    pub(super) fn states(&self) -> &[M] {
        &self.states
    }

    /// Returns the state at `t`, in seconds from the origin. Before the first point it is the first
    /// state, and after the last point it is the last state.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::reference::Reference;
    use franka_model::JointVector;

    #[test]
    fn the_extent_has_the_least_and_the_greatest_of_each_joint() {
        let at = |values: [f64; 7]| Reference::at_rest(JointVector::from(values));
        let states = vec![
            at([0.0, 1.0, -1.0, 2.0, 0.5, 0.0, 0.0]),
            at([0.1, 0.5, -2.0, 2.5, 0.5, 0.0, -1.0]),
            at([-0.1, 0.7, 3.0, 2.2, 0.5, 0.0, -2.0]),
        ];
        let curve = Curve::new(vec![0.0, 0.1, 0.2], states);
        let extent = curve.extent();
        let lower = [-0.1, 0.5, -2.0, 2.0, 0.5, 0.0, -2.0];
        let upper = [0.1, 1.0, 3.0, 2.5, 0.5, 0.0, 0.0];
        assert_eq!((extent.lower, extent.upper), (lower.into(), upper.into()));
    }
}
