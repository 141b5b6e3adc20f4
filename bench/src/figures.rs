//! Statistics of measured values: quantiles, and the part of torques above 30 Hz.

/// Returns the value that this share of the values does not exceed; infinite without values.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = (share * sorted.len() as f64).ceil() as usize;
    sorted
        .get(at.saturating_sub(1))
        .copied()
        .unwrap_or(f64::INFINITY)
}

/// The part of torques above 30 Hz, which is the noise and the ringing of a law: two first-order
/// high-passes in a row, for each joint at 1 kHz.
#[derive(Debug, Default)]
pub struct HighPass {
    last: Option<[f64; 7]>,
    stages: [[f64; 7]; 2],
    squares: [f64; 7],
    count: f64,
}

impl HighPass {
    /// Adds the torques of one cycle, `[N·m]`.
    pub fn add(&mut self, torques: &[f64; 7]) {
        let keep = 1.0 / (1.0 + core::f64::consts::TAU * 30.0 * 1e-3);
        let last = self.last.replace(*torques).unwrap_or(*torques);
        for i in 0..7 {
            let before = self.stages[0][i];
            self.stages[0][i] = keep * (before + torques[i] - last[i]);
            self.stages[1][i] = keep * (self.stages[1][i] + self.stages[0][i] - before);
            self.squares[i] += self.stages[1][i].powi(2);
        }
        self.count += 1.0;
    }

    /// Returns the root mean square of the worst joint, `[N·m]`.
    pub fn rms(&self) -> f64 {
        let most = self.squares.iter().copied().fold(0.0, f64::max);
        (most / self.count.max(1.0)).sqrt()
    }
}
