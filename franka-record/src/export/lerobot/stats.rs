//! Statistics of a feature, in LeRobot's format, for each episode and for the whole dataset.

use serde_json::{Map, Value, json};

/// Quantiles. The quantiles of several episodes are combined as means, weighted by the number of
/// frames.
const QUANTILES: [(&str, f64); 5] = [
    ("q01", 0.01),
    ("q10", 0.10),
    ("q50", 0.50),
    ("q90", 0.90),
    ("q99", 0.99),
];

/// Names of the statistics that have one value for each number of a feature.
pub(super) const NAMES: [&str; 9] = [
    "min", "max", "mean", "std", "q01", "q10", "q50", "q90", "q99",
];

/// Statistics of one feature over some frames. Each of [`NAMES`] has one value per number of the
/// feature.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stats {
    pub(super) values: [Vec<f64>; NAMES.len()],
    pub(super) count: u64,
}

impl Stats {
    /// Computes the statistics of consecutive rows of `width` numbers each.
    pub(super) fn of(numbers: &[f64], width: usize) -> Self {
        let count = numbers.len() / width;
        let mut values: [Vec<f64>; NAMES.len()] = Default::default();
        for place in 0..width {
            let rows = numbers.iter().skip(place).step_by(width);
            let mut sorted: Vec<f64> = rows.copied().collect();
            sorted.sort_by(f64::total_cmp);
            let mean = sorted.iter().sum::<f64>() / count as f64;
            let squares = sorted.iter().map(|x| (x - mean).powi(2));
            let deviation = (squares.sum::<f64>() / count as f64).sqrt();
            let basic = [sorted[0], sorted[count - 1], mean, deviation];
            let quantiles = QUANTILES.map(|(_, share)| quantile(&sorted, share));
            for (values, value) in values.iter_mut().zip(basic.into_iter().chain(quantiles)) {
                values.push(value);
            }
        }
        let count = count as u64;
        Self { values, count }
    }

    /// Combines the statistics of two sets of frames as LeRobot does: the combined quantiles are
    /// means of the quantiles.
    pub(super) fn and(&self, other: &Self) -> Self {
        let [n, m] = [self, other].map(|stats| stats.count as f64);
        let share = m / (n + m);
        let mean = |a: f64, b: f64| a + (b - a) * share;
        let values = std::array::from_fn(|k| {
            let pairs = self.values[k].iter().zip(&other.values[k]);
            let combined = pairs.enumerate().map(|(place, (a, b))| match NAMES[k] {
                "min" => a.min(*b),
                "max" => a.max(*b),
                "std" => {
                    let [a_mean, b_mean] = [self, other].map(|stats| stats.values[MEAN][place]);
                    let total = mean(a_mean, b_mean);
                    let square =
                        |deviation: f64, mean: f64| deviation.powi(2) + (mean - total).powi(2);
                    mean(square(*a, a_mean), square(*b, b_mean)).sqrt()
                }
                _ => mean(*a, *b),
            });
            combined.collect()
        });
        let count = self.count + other.count;
        Self { values, count }
    }

    /// Converts the statistics to the format of `meta/stats.json`.
    pub(super) fn to_json(&self) -> Value {
        let values = NAMES.iter().zip(&self.values);
        let mut object: Map<String, Value> = values
            .map(|(name, values)| ((*name).to_owned(), json!(values)))
            .collect();
        object.insert("count".into(), json!([self.count]));
        object.into()
    }

    /// Reads statistics from the format of `meta/stats.json`; `None` if a value is missing or has
    /// the wrong width.
    pub(super) fn from_json(value: &Value, width: usize) -> Option<Self> {
        let numbers = |name: &str| -> Option<Vec<f64>> {
            let numbers = value.get(name)?.as_array()?.iter().map(number);
            numbers.collect()
        };
        let mut values: [Vec<f64>; NAMES.len()] = Default::default();
        for (name, values) in NAMES.iter().zip(&mut values) {
            *values = numbers(name).filter(|numbers| numbers.len() == width)?;
        }
        let count = *numbers("count")?.first()? as u64;
        Some(Self { values, count })
    }
}

/// Index of the mean in [`NAMES`].
const MEAN: usize = 2;

/// Returns a number, or a flag as a number.
fn number(value: &Value) -> Option<f64> {
    value.as_f64().or(value.as_bool().map(f64::from))
}

/// Returns the value below which a `share` of the `sorted` values lies, with linear interpolation.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let below = sorted[place.floor() as usize];
    let above = sorted[place.ceil() as usize];
    below + (above - below) * place.fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_parts_together_have_the_statistics_of_the_whole() {
        let all: Vec<f64> = (0..120).map(|i| f64::from(i * i % 37)).collect();
        let whole = Stats::of(&all, 2);
        let parts = Stats::of(&all[..50], 2).and(&Stats::of(&all[50..], 2));
        assert_eq!(parts.count, whole.count);
        for (name, (a, b)) in NAMES
            .iter()
            .zip(parts.values.iter().zip(&whole.values))
            .take(4)
        {
            let close = a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(close, "{name}: {a:?}, {b:?}");
        }
        assert_eq!(Stats::from_json(&parts.to_json(), 2), Some(parts.clone()));
        assert_eq!(Stats::from_json(&parts.to_json(), 3), None);
    }

    #[test]
    fn quantiles_lie_on_the_line_between_neighbours() {
        let stats = Stats::of(&[3.0, 1.0, 2.0, 0.0, 4.0], 1);
        let values: Vec<f64> = stats.values.iter().map(|values| values[0]).collect();
        let expected = [0.0, 4.0, 2.0, 2.0_f64.sqrt(), 0.04, 0.4, 2.0, 3.6, 3.96];
        for (value, expected) in values.iter().zip(expected) {
            assert!((value - expected).abs() < 1e-12, "{values:?}");
        }
    }
}
