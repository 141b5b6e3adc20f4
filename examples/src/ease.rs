//! References that begin and end at rest.

/// A smooth transition from 0 to 1: value and rate.
///
/// The transition is the polynomial of fifth degree whose velocity and acceleration vanish at both
/// ends (the minimum-jerk trajectory of Flash and Hogan, 1985). Commands to a motion generator must
/// be this smooth from the first one, because the robot accepts no steps in acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ease {
    /// The value, from 0 to 1.
    pub value: f64,
    /// Its derivative, `[1/s]`.
    pub rate: f64,
}

impl Ease {
    /// Returns the transition within `duration` seconds, at `time` seconds after its beginning;
    /// constant before and after.
    pub fn over(duration: f64, time: f64) -> Self {
        let s = (time / duration).clamp(0.0, 1.0);
        Self {
            value: s * s * s * (10.0 + s * (6.0 * s - 15.0)),
            rate: 30.0 * (s * (1.0 - s)).powi(2) / duration,
        }
    }

    /// Returns a transition from 0 to 1 in the first half of `duration`, and back in the second.
    pub fn there_and_back(duration: f64, time: f64) -> Self {
        let half = 0.5 * duration;
        if time < half {
            return Self::over(half, time);
        }
        let back = Self::over(half, time - half);
        Self {
            value: 1.0 - back.value,
            rate: -back.rate,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_rests_at_both_ends_and_between() {
        for (time, value) in [(-1.0, 0.0), (0.0, 0.0), (2.0, 1.0), (4.0, 0.0), (9.0, 0.0)] {
            let ease = Ease::there_and_back(4.0, time);
            assert_eq!((ease.value, ease.rate.abs()), (value, 0.0), "at {time}");
        }
    }

    #[test]
    fn the_rate_is_the_derivative_of_the_value() {
        let step = 1e-5;
        for cycle in 1..400 {
            let time = 0.01 * f64::from(cycle) + 0.005;
            let at = |time| Ease::there_and_back(4.0, time);
            let slope = (at(time + step).value - at(time - step).value) / (2.0 * step);
            assert!((slope - at(time).rate).abs() < 1e-8, "at {time}");
        }
    }
}
