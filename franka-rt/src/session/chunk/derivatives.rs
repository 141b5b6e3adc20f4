//! Derivatives of sampled values at one sample, computed from the samples around it.
//!
//! The weights are from B. Fornberg, *Generation of Finite Difference Formulas on Arbitrarily
//! Spaced Grids*, Math. Comp. 51, 1988.

use nalgebra::SVector;

/// Maximum number of samples in one derivative.
const SAMPLES: usize = 5;

/// Greatest ratio of two intervals for which five samples are used. On less even grids, the
/// fourth-degree polynomial would oscillate.
const EVEN: f64 = 3.0;

/// Returns the first and the second derivative, at sample `i`, of the values at `times`. `value`
/// returns a sample in coordinates that the caller chooses.
///
/// Uses five samples if there are two on each side at similar distances. Otherwise uses three
/// samples, or the slope between two. A single sample has no motion.
pub(super) fn at<const D: usize>(
    times: &[f64],
    i: usize,
    value: impl Fn(usize) -> SVector<f64, D>,
) -> [SVector<f64, D>; 2] {
    let window = window(times, i);
    let nodes = &times[window.clone()];
    let weights = weights(nodes, times[i]);
    let mut derivatives = [SVector::zeros(); 2];
    for (sample, [first, second]) in window.zip(weights) {
        let value = value(sample);
        derivatives[0] += value * first;
        derivatives[1] += value * second;
    }
    derivatives
}

fn window(times: &[f64], i: usize) -> core::ops::Range<usize> {
    let last = times.len() - 1;
    if i >= 2 && i + 2 <= last {
        let wide = i - 2..i + 3;
        let steps = || times[wide.clone()].windows(2).map(|pair| pair[1] - pair[0]);
        let (least, most) = (
            steps().fold(f64::INFINITY, f64::min),
            steps().fold(0.0, f64::max),
        );
        if most <= EVEN * least {
            return wide;
        }
    }
    let first = i.saturating_sub(1).min(last.saturating_sub(2));
    first..(first + 3).min(times.len())
}

/// Returns the weights of the values at `nodes` in the first and second derivative at `z`.
fn weights(nodes: &[f64], z: f64) -> [[f64; 2]; SAMPLES] {
    let mut c = [[0.0; 3]; SAMPLES];
    c[0][0] = 1.0;
    let mut product = 1.0;
    for i in 1..nodes.len() {
        let (here, before) = (nodes[i] - z, nodes[i - 1] - z);
        let mut next = 1.0;
        for j in 0..i {
            let distance = nodes[i] - nodes[j];
            next *= distance;
            if j + 1 == i {
                let last = c[j];
                for k in (0..3).rev() {
                    let lower = if k > 0 { k as f64 * last[k - 1] } else { 0.0 };
                    c[i][k] = product * (lower - before * last[k]) / next;
                }
            }
            for k in (0..3).rev() {
                let lower = if k > 0 { k as f64 * c[j][k - 1] } else { 0.0 };
                c[j][k] = (here * c[j][k] - lower) / distance;
            }
        }
        product = next;
    }
    c.map(|[_, first, second]| [first, second])
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;

    fn polynomial(t: f64, degree: i32) -> (f64, f64, f64) {
        let sum = |f: &dyn Fn(f64, i32) -> f64| (0..=degree).map(|n| f(f64::from(n), n)).sum();
        (
            sum(&|_, n| t.powi(n)),
            sum(&|x, n| if n > 0 { x * t.powi(n - 1) } else { 0.0 }),
            sum(&|x, n| {
                if n > 1 {
                    x * (x - 1.0) * t.powi(n - 2)
                } else {
                    0.0
                }
            }),
        )
    }

    #[test]
    fn exact_for_the_polynomials_that_the_samples_determine() {
        let times = [0.0, 0.05, 0.09, 0.15, 0.2, 0.24];
        for (i, degree) in [(0, 2), (1, 2), (2, 4), (3, 4), (4, 2), (5, 2)] {
            let [v, a] = at(&times, i, |k| {
                SVector::from([polynomial(times[k], degree).0])
            });
            let (_, dv, da) = polynomial(times[i], degree);
            assert!((v[0] - dv).abs() < 1e-11, "{i}: {v} {dv}");
            assert!((a[0] - da).abs() < 1e-9, "{i}: {a} {da}");
        }
    }

    #[test]
    fn few_samples_give_what_they_can() {
        let [v, a] = at(&[1.0, 3.0], 1, |k| SVector::from([k as f64]));
        assert!((v[0] - 0.5).abs() < 1e-15 && a[0] == 0.0);
        let [v, a] = at(&[1.0], 0, |_| SVector::from([7.0]));
        assert_eq!((v[0], a[0]), (0.0, 0.0));
    }

    #[test]
    fn uneven_samples_are_not_swung_by_far_ones() {
        let times = [0.0, 0.001, 0.5, 0.501, 1.0];
        let [v, _] = at(&times, 2, |k| {
            SVector::from([[0.0, 0.01, 0.0, 0.01, 0.0][k]])
        });
        // The slopes on the two sides are -0.02 and 10, so the result must be between them.
        assert!((-0.02..=10.0).contains(&v[0]), "{v}");
    }
}
