//! Random numbers from a seed.

use franka_model::JointVector;

/// SplitMix64 (Steele, Lea and Flood, 2014) and, for normally distributed values, the Box-Muller
/// transform.
///
/// The crate `rand` may change its small generator with the version or the platform. This generator
/// returns the same numbers for a seed everywhere.
#[derive(Debug, Clone)]
pub(crate) struct Random {
    state: u64,
}

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Seven independent, normally distributed values with these standard deviations.
    pub(crate) fn joints(&mut self, deviations: &JointVector) -> JointVector {
        if *deviations == JointVector::zeros() {
            return *deviations;
        }
        deviations.map(|deviation| self.normal() * deviation)
    }

    pub(crate) fn normal(&mut self) -> f64 {
        // The value is in (0, 1], because the logarithm must be finite.
        let u = 1.0 - self.uniform();
        let angle = core::f64::consts::TAU * self.uniform();
        (-2.0 * u.ln()).sqrt() * angle.cos()
    }

    /// Uniformly distributed number in [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_deviation_asked_for() {
        let mut random = Random::new(3);
        let count = 20_000;
        let mut sum = JointVector::zeros();
        let mut squares = JointVector::zeros();
        for _ in 0..count {
            let sample = random.joints(&JointVector::repeat(2.0));
            sum += sample;
            squares += sample.component_mul(&sample);
        }
        let n = f64::from(count);
        assert!((sum / n).amax() < 0.1);
        assert!((squares / n).add_scalar(-4.0).amax() < 0.25);
    }

    #[test]
    fn a_seed_repeats_itself() {
        let (mut a, mut b) = (Random::new(9), Random::new(9));
        let one = JointVector::repeat(1.0);
        assert_eq!(a.joints(&one), b.joints(&one));
        assert_eq!(a.joints(&JointVector::zeros()), JointVector::zeros());
    }
}
