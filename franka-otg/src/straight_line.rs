//! Straight lines: all axes as one axis.
//!
//! The motion is a straight line if these vectors are all multiples of one vector: the displacement
//! to the target, and the velocities and accelerations now and at the target. One scalar problem
//! along this line then moves the axes in phase. From rest, this is always possible. If the same
//! axis determines all three limits, the motion takes as long as a motion with
//! [`Time`](crate::Synchronisation::Time). Otherwise it takes longer.
//!
//! Because of rounding, the axes of a motion are not exactly parallel to its line. Therefore the
//! scalar state continues while targets stay on the line, and is not derived from the axes again.

use crate::state::{AxisState, State};

/// The line `origin + s * direction`. The largest component of the direction is one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StraightLine<const N: usize> {
    origin: [f64; N],
    direction: [f64; N],
    /// Axis with the largest component.
    main: usize,
}

impl<const N: usize> StraightLine<N> {
    /// Returns the line along which `state` moves and on which `target` lies, and the state along
    /// this line.
    ///
    /// Returns `None` if no such line exists, or if the state and the target are the same at rest.
    pub(crate) fn through(state: &State<N>, target: &State<N>) -> Option<(Self, AxisState)> {
        let displacement: [f64; N] =
            core::array::from_fn(|i| target.position[i] - state.position[i]);
        let vectors = [
            displacement,
            state.velocity,
            state.acceleration,
            target.velocity,
            target.acceleration,
        ];
        let along = vectors
            .iter()
            .find(|vector| vector.iter().any(|x| *x != 0.0))?;
        let main = (0..N).reduce(|best, i| {
            if along[i].abs() > along[best].abs() {
                i
            } else {
                best
            }
        })?;
        let direction = along.map(|x| x / along[main]);
        let line = Self {
            origin: state.position,
            direction,
            main,
        };
        vectors
            .iter()
            .all(|vector| line.is_parallel(vector))
            .then(|| {
                let along = AxisState {
                    position: 0.0,
                    velocity: state.velocity[main],
                    acceleration: state.acceleration[main],
                };
                (line, along)
            })
    }

    /// Returns true if `vector` is parallel to the line. The comparison is separate for each
    /// component, so units do not matter.
    fn is_parallel(&self, vector: &[f64; N]) -> bool {
        (0..N).all(|i| {
            let expected = vector[self.main] * self.direction[i];
            (vector[i] - expected).abs() <= PARALLEL * expected.abs()
        })
    }

    /// Returns the place on the line that is nearest to `position`.
    pub(crate) fn nearest(&self, position: &[f64; N]) -> f64 {
        let way = (0..N).map(|i| (position[i] - self.origin[i]) * self.direction[i]);
        let size = self.direction.iter().map(|x| x * x);
        way.sum::<f64>() / size.sum::<f64>()
    }

    /// Returns the state along the line for a `target` that is on the line and moves along the
    /// line.
    pub(crate) fn state_of(&self, target: &State<N>) -> Option<AxisState> {
        let to = target.axis(self.main);
        let s = to.position - self.origin[self.main];
        let on_it = (0..N).all(|i| {
            let (target, step) = (target.position[i], s * self.direction[i]);
            let size = target.abs() + self.origin[i].abs() + step.abs();
            (self.origin[i] + step - target).abs() <= 4.0 * f64::EPSILON * size
        });
        let parallel = self.is_parallel(&target.velocity) && self.is_parallel(&target.acceleration);
        (on_it && parallel).then_some(AxisState { position: s, ..to })
    }

    /// Returns the state of all axes for the line's state `along`.
    pub(crate) fn state(&self, along: AxisState) -> State<N> {
        State {
            position: core::array::from_fn(|i| self.origin[i] + along.position * self.direction[i]),
            velocity: self.direction.map(|x| along.velocity * x),
            acceleration: self.direction.map(|x| along.acceleration * x),
        }
    }

    pub(crate) const fn direction(&self) -> &[f64; N] {
        &self.direction
    }
}

/// Relative difference up to which components of vectors count as parallel: the rounding of a few
/// operations, times the length of a chain of plans.
const PARALLEL: f64 = 1e-13;
