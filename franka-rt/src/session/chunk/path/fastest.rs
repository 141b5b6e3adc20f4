//! Makes a timed path as fast as its limits allow. A part between two stops is retimed if it has
//! corners. A single straight line is already as fast as possible.

use franka_otg::AxisLimits;
use nalgebra::SMatrix;

use super::least_time::{self, PLACES, Part, Rates};
use super::spline::Spline;
use crate::session::chunk::curve::Curve;
use crate::session::chunk::curve_state::CurveState;

/// Velocity or acceleration of a state. Each column is a group of axes whose norm is limited.
type Columns<const W: usize, const G: usize> = SMatrix<f64, W, G>;

pub(super) struct Limits<M, const W: usize, const G: usize> {
    pub(super) of_groups: [AxisLimits; G],
    /// Function that returns velocity and acceleration of a state.
    pub(super) derivatives: fn(&M) -> [Columns<W, G>; 2],
}

/// A motion through states at times.
#[derive(Debug)]
pub(super) struct Timed<M> {
    pub(super) times: Vec<f64>,
    pub(super) states: Vec<M>,
    /// Number of the leg of each state. At a stop, the leg that begins there.
    pub(super) legs: Vec<usize>,
}

/// Initial number of nodes for each leg.
const NODES: usize = 32;

/// Maximum number of initial nodes.
const NODES_MAX: usize = 1024;

/// Number of times that parts are halved in which the acceleration changes much.
const REFINEMENTS: usize = 2;

/// Permitted excess over the least duration, as a share of it: before the last refinement, and
/// after it.
const GAPS: [f64; 2] = [0.03, 1e-3];

/// Number of intervals of each part in which the limits are checked again at the end.
const CHECKS: usize = 4;

impl<M: CurveState> Timed<M> {
    /// Returns the same path, timed for the least duration.
    pub(super) fn hurried<const W: usize, const G: usize>(self, limits: &Limits<M, W, G>) -> Self {
        let mut hurried = self.part(0, 0);
        let mut begin = 0;
        for end in 1..self.times.len() {
            if (limits.derivatives)(&self.states[end])[0] != Columns::<W, G>::zeros() {
                continue;
            }
            let corners = self.legs[end - 1] - self.legs[begin];
            let stretch = self.part(begin, end);
            hurried.append(if corners > 0 {
                stretch.retimed(corners + 1, limits)
            } else {
                stretch
            });
            begin = end;
        }
        hurried
    }

    pub(super) fn into_curve(self) -> Curve<M> {
        Curve::new(self.times, self.states)
    }

    /// Returns the states from `begin` to `end`, with times that start at zero.
    fn part(&self, begin: usize, end: usize) -> Self {
        let times = &self.times[begin..=end];
        Self {
            times: times.iter().map(|time| time - times[0]).collect(),
            states: self.states[begin..=end].to_vec(),
            legs: self.legs[begin..=end].to_vec(),
        }
    }

    fn append(&mut self, next: Self) {
        let end = self.end();
        let times = next.times.iter().skip(1);
        self.times.extend(times.map(|time| end + time));
        self.states.extend(next.states.iter().skip(1));
        self.legs.extend(next.legs.iter().skip(1));
    }

    fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Returns the state at the share `u` of the time from node `k` to the next node.
    pub(super) fn between(&self, k: usize, u: f64) -> M {
        let duration = self.times[k + 1] - self.times[k];
        M::between(&self.states[k], &self.states[k + 1], duration, u * duration)
    }

    /// Calls `pass` with times and states of the motion, `count` times in each part.
    pub(super) fn each(&self, count: usize, mut pass: impl FnMut(f64, &M)) {
        for (k, ends) in self.times.windows(2).enumerate() {
            for i in 1..=count {
                let u = i as f64 / count as f64;
                pass(ends[0] + u * (ends[1] - ends[0]), &self.between(k, u));
            }
        }
    }

    /// Returns a part of the path from stop to stop, with this many legs, timed for the least
    /// duration.
    pub(super) fn retimed<const W: usize, const G: usize>(
        self,
        legs: usize,
        limits: &Limits<M, W, G>,
    ) -> Self {
        let longest = self.end() / (NODES * legs).min(NODES_MAX) as f64;
        let counts: Vec<usize> = (self.times.windows(2))
            .map(|ends| ((ends[1] - ends[0]) / longest).ceil().max(1.0) as usize)
            .collect();
        let mut stretch = self.divided(&counts);
        let durations = stretch.times.windows(2).map(|ends| ends[1] - ends[0]);
        let mut spline = Spline::one(durations.collect());
        for refinement in 0..=REFINEMENTS {
            let last = refinement == REFINEMENTS;
            let (parts, gap) = (stretch.parts(limits), GAPS[usize::from(last)]);
            let long = least_time::minimise(&mut spline, &parts, &limits.of_groups, gap);
            if !last {
                let counts: Vec<usize> = long.iter().map(|&long| 1 + usize::from(long)).collect();
                stretch = stretch.divided(&counts);
                spline = spline.refined(&long);
            }
        }
        let next = stretch.at_rates(&spline);
        // Between the checked places, the motion may exceed the limits by a few thousandths.
        let next = next.slower(next.excess(limits));
        if next.end() < self.end() { next } else { self }
    }

    /// Returns the same motion, with each part divided evenly into the number of parts in `counts`.
    fn divided(&self, counts: &[usize]) -> Self {
        let mut fine = self.part(0, 0);
        for (k, &count) in counts.iter().enumerate() {
            let duration = self.times[k + 1] - self.times[k];
            for i in 1..count {
                let u = i as f64 / count as f64;
                fine.times.push(self.times[k] + u * duration);
                fine.states.push(self.between(k, u));
                fine.legs.push(self.legs[k]);
            }
            fine.times.push(self.times[k + 1]);
            fine.states.push(self.states[k + 1]);
            fine.legs.push(self.legs[k + 1]);
        }
        fine
    }

    fn parts<const W: usize, const G: usize>(&self, limits: &Limits<M, W, G>) -> Vec<Part<W, G>> {
        let part = |k: usize| {
            let duration = self.times[k + 1] - self.times[k];
            let at = |u: f64| (limits.derivatives)(&self.between(k, u));
            let [[_, begin], [_, middle], [_, end]] = [0.0, 0.5, 1.0].map(at);
            // Slope of the parabola through the three accelerations.
            let rise = (end - begin) / duration;
            let bend = (begin + end - middle * 2.0) * (2.0 / duration);
            PLACES.map(|u| {
                let [v, a] = at(u);
                let j = rise + bend * (2.0 * u - 1.0);
                Rates { v, a, j }
            })
        };
        (0..self.times.len() - 1).map(part).collect()
    }

    fn at_rates(&self, spline: &Spline) -> Self {
        let mut time = 0.0;
        let mut next = Self {
            times: Vec::with_capacity(self.times.len()),
            states: Vec::with_capacity(self.times.len()),
            legs: self.legs.clone(),
        };
        for (node, state) in spline.nodes().iter().zip(&self.states) {
            time += node.duration;
            next.times.push(time);
            next.states.push(state.paced(node.rate, node.change));
        }
        // Both states already rest, except for the sign of a zero.
        let last = next.states.len() - 1;
        for end in [0, last] {
            next.states[end] = self.states[end].resting();
        }
        next
    }

    fn slower(&self, factor: f64) -> Self {
        Self {
            times: self.times.iter().map(|time| time * factor).collect(),
            states: (self.states.iter())
                .map(|state| state.paced(1.0 / factor, 0.0))
                .collect(),
            legs: self.legs.clone(),
        }
    }

    /// Returns the factor, at least 1, by which the motion must be slower to stay within the
    /// limits.
    fn excess<const W: usize, const G: usize>(&self, limits: &Limits<M, W, G>) -> f64 {
        let mut most = 1.0_f64;
        for k in 0..self.times.len() - 1 {
            let step = (self.times[k + 1] - self.times[k]) / CHECKS as f64;
            let at = |i: usize| (limits.derivatives)(&self.between(k, i as f64 / CHECKS as f64));
            let mut before = at(0);
            for i in 1..=CHECKS {
                let now = at(i);
                let jerk = (now[1] - before[1]) / step;
                for (g, limits) in limits.of_groups.iter().enumerate() {
                    let of = |columns: &Columns<W, G>, most: f64| columns.column(g).norm() / most;
                    most = most
                        .max(of(&now[0], limits.velocity))
                        .max(of(&now[1], limits.acceleration).sqrt())
                        .max(of(&jerk, limits.jerk).cbrt());
                }
                before = now;
            }
        }
        most
    }
}
