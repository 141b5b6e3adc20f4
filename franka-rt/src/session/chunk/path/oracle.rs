//! The least duration for the path of a motion if only velocity and acceleration are limited. It is
//! a lower bound for all motions whose jerk is also limited.
//!
//! The method is reachability analysis over the length of the path (H. Pham and Q.-C. Pham, 2018).
//! The backward pass finds the greatest speed at each place from which the arm can still brake. The
//! forward pass moves as fast as that speed allows.

use franka_otg::AxisLimits;
use nalgebra::SMatrix;

/// A place of a path. `x` is the square of the speed along it.
struct Place<const W: usize, const G: usize> {
    /// Length of the path to the next place.
    step: f64,
    /// Greatest permitted `x`; 0 at a stop.
    most: f64,
    /// Direction and curvature, divided by the acceleration limits. Each column is a group of axes.
    direction: SMatrix<f64, W, G>,
    curvature: SMatrix<f64, W, G>,
}

/// Speed below which a motion counts as resting.
const REST: f64 = 1e-12;

/// Speed below which a motion counts as following a line, as it does near a stop.
const STRAIGHT: f64 = 1e-3;

impl<const W: usize, const G: usize> Place<W, G> {
    /// Creates the place for a motion with this velocity and acceleration, which continues for
    /// `duration`.
    fn new(
        [v, a]: &[SMatrix<f64, W, G>; 2],
        duration: f64,
        next: f64,
        limits: &[AxisLimits; G],
    ) -> Self {
        let speed = v.norm();
        let direction = v / speed.max(REST);
        let turning = a - direction * direction.dot(a);
        let of = |columns: &SMatrix<f64, W, G>, limit: fn(&AxisLimits) -> f64| {
            let mut columns = *columns;
            for (mut column, limits) in columns.column_iter_mut().zip(limits) {
                column /= limit(limits);
            }
            columns
        };
        let velocities = of(&direction, |limits| limits.velocity);
        let fastest = velocities.column_iter().map(|column| column.norm_squared());
        let rests = speed < REST;
        Self {
            step: 0.5 * (speed + next) * duration,
            most: if rests {
                0.0
            } else {
                1.0 / fastest.fold(0.0, f64::max)
            },
            direction: of(&direction, |limits| limits.acceleration),
            curvature: of(&turning, |limits| limits.acceleration) / speed.max(STRAIGHT).powi(2),
        }
    }

    /// Returns the accelerations along the path that are possible at `x`.
    fn open(&self, x: f64) -> Option<(f64, f64)> {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for (d, c) in self
            .direction
            .column_iter()
            .zip(self.curvature.column_iter())
        {
            let (dd, dc, cc) = (d.norm_squared(), x * d.dot(&c), x * x * c.norm_squared());
            if dd < 1e-18 {
                continue;
            }
            let root = dc * dc - dd * (cc - 1.0);
            if root < 0.0 {
                return None;
            }
            low = low.max((-dc - root.sqrt()) / dd);
            high = high.min((-dc + root.sqrt()) / dd);
        }
        (low <= high).then_some((low, high))
    }

    /// Returns the greatest `x` from which the arm can pass the next place with `next` at most.
    fn brakable(&self, next: f64) -> f64 {
        let holds = |x: f64| {
            let open = self.open(x);
            open.is_some_and(|(low, _)| x + 2.0 * self.step * low <= next)
        };
        let (mut low, mut high) = (0.0, self.most);
        if holds(high) {
            return high;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if holds(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

/// Returns the least duration for the path of a motion that rests only at its ends. Its `rates` are
/// velocities and accelerations at times that are `duration` apart.
pub(super) fn least_duration<const W: usize, const G: usize>(
    rates: &[[SMatrix<f64, W, G>; 2]],
    duration: f64,
    limits: &[AxisLimits; G],
) -> f64 {
    let place = |(k, rates_here): (usize, &[SMatrix<f64, W, G>; 2])| {
        let next = rates.get(k + 1).map_or(0.0, |[v, _]| v.norm());
        Place::new(rates_here, duration, next, limits)
    };
    let places: Vec<_> = rates.iter().enumerate().map(place).collect();
    let mut brakable = vec![0.0; places.len()];
    for k in (0..places.len() - 1).rev() {
        brakable[k] = places[k].brakable(brakable[k + 1]);
    }
    let (mut x, mut time) = (0.0_f64, 0.0);
    for (k, (place, brakable)) in places.iter().zip(&brakable[1..]).enumerate() {
        // A stop has no direction, so the motion leaves it in the direction of the next place.
        let moving = if place.most > 0.0 { k } else { k + 1 };
        let high = places[moving].open(x).map_or(0.0, |(_, high)| high);
        let next = (x + 2.0 * place.step * high).min(*brakable);
        if place.step > 0.0 {
            time += 2.0 * place.step / (x.sqrt() + next.sqrt());
        }
        x = next;
    }
    time
}
