//! The rate of a retimed motion: a quadratic spline over the parts of the motion.

use nalgebra::Vector3;

/// Square of the rate, `x`. Each coefficient contributes to three parts, and each part has three
/// coefficients.
#[derive(Clone, Debug)]
pub(super) struct Spline {
    pub(super) durations: Vec<f64>,
    pub(super) c: Vec<f64>,
}

/// Rate at a node: `dt/dT`, its derivative with respect to `T`, and the new time since the previous
/// node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub(super) rate: f64,
    pub(super) change: f64,
    pub(super) duration: f64,
}

impl Spline {
    /// Returns the rate 1, for a motion with parts of these durations.
    pub(super) fn one(durations: Vec<f64>) -> Self {
        let c = vec![1.0; durations.len() + 2];
        Self { durations, c }
    }

    pub(super) fn of_part(c: &[f64], k: usize) -> Vector3<f64> {
        Vector3::new(c[k], c[k + 1], c[k + 2])
    }

    /// Returns how part `k`'s three coefficients contribute to the value at the share `u` of the
    /// part, and to its first and second derivative.
    pub(super) fn basis(&self, k: usize, u: f64) -> [Vector3<f64>; 3] {
        let neighbour = |k: Option<usize>| k.and_then(|k| self.durations.get(k)).unwrap_or(&0.0);
        let h = self.durations[k];
        let first = 1.0 / (h * (neighbour(k.checked_sub(1)) + h));
        let last = 1.0 / (h * (h + neighbour(Some(k + 1))));
        let (gone, left) = (u * h, (1.0 - u) * h);
        let of = |sum: f64, a: f64, c: f64| Vector3::new(a, sum - a - c, c);
        [
            of(1.0, left * left * first, gone * gone * last),
            of(0.0, -2.0 * left * first, 2.0 * gone * last),
            of(0.0, 2.0 * first, 2.0 * last),
        ]
    }

    /// Returns the value at the share `u` of part `k`, and its first derivative.
    pub(super) fn at(&self, k: usize, u: f64) -> [f64; 2] {
        let [value, slope, _] = self.basis(k, u);
        let c = Self::of_part(&self.c, k);
        [value.dot(&c), slope.dot(&c)]
    }

    /// Returns the same spline, with each part halved for which `halved` is true.
    pub(super) fn refined(&self, halved: &[bool]) -> Self {
        let last = self.durations.len() - 1;
        let (mut durations, mut c) = (Vec::new(), vec![self.at(0, 0.0)[0]]);
        for (k, (&h, &halved)) in self.durations.iter().zip(halved).enumerate() {
            let count = if halved { 2.0 } else { 1.0 };
            let begins: &[f64] = if halved { &[0.0, 0.5] } else { &[0.0] };
            for &begin in begins {
                let h = h / count;
                let [x, slope] = self.at(k, begin);
                // The blossom of the parabola at both ends.
                c.push(x + 0.5 * h * slope);
                durations.push(h);
            }
        }
        c.push(self.at(last, 1.0)[0]);
        Self { durations, c }
    }

    pub(super) fn nodes(&self) -> Vec<Node> {
        let node = |[x, slope]: [f64; 2], duration: f64| Node {
            rate: x.sqrt(),
            change: 0.5 * slope,
            duration,
        };
        let begin = node(self.at(0, 0.0), 0.0);
        let ends = self.durations.iter().enumerate().map(|(k, h)| {
            let points = GAUSS.map(|[u, weight]| weight / self.at(k, u)[0].sqrt());
            node(self.at(k, 1.0), h * points.iter().sum::<f64>())
        });
        core::iter::once(begin).chain(ends).collect()
    }
}

/// Gauss's rule with four points: pairs of place and weight.
const GAUSS: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_7, 0.173_927_422_568_726_9],
    [0.330_009_478_207_571_9, 0.326_072_577_431_273_1],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_1],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_9],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refining_changes_no_value_and_a_constant_rate_scales_time() {
        let mut spline = Spline::one(vec![0.1, 0.3, 0.05, 0.2]);
        spline.c = vec![1.0, 1.3, 0.9, 1.1, 1.4, 1.2];
        let fine = spline.refined(&[true, false, true, true]);
        assert_eq!(fine.durations.len(), 7);
        let places = [
            (0, 0.25, 0, 0.5),
            (0, 0.75, 1, 0.5),
            (1, 0.4, 2, 0.4),
            (3, 0.9, 6, 0.8),
        ];
        for (k, u, fine_k, fine_u) in places {
            let (there, here) = (fine.at(fine_k, fine_u), spline.at(k, u));
            assert!((there[0] - here[0]).abs() < 1e-14, "{there:?} {here:?}");
            assert!((there[1] - here[1]).abs() < 1e-12, "{there:?} {here:?}");
        }
        spline.c.fill(4.0);
        let total: f64 = spline.nodes().iter().map(|node| node.duration).sum();
        assert!((total - 0.65 / 2.0).abs() < 1e-14);
    }
}
