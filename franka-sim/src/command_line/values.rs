//! Checked values of options.

use std::time::Duration;

use crate::Fingers;

/// Returns `N` finite numbers from comma-separated text.
///
/// # Errors
/// Returns a text that describes the error.
pub fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let values = text
        .split(',')
        .map(|number| number.trim().parse::<f64>().map_err(|e| e.to_string()))
        .collect::<Result<Vec<_>, _>>()?;
    if !values.iter().all(|value| value.is_finite()) {
        return Err("expected finite numbers only".into());
    }
    let count = values.len();
    values
        .try_into()
        .map_err(|_| format!("got {count} numbers, expected {N}"))
}

/// Returns the width of an object that fits between the fingers.
pub(crate) fn object_width(text: &str) -> Result<f64, String> {
    let [width] = numbers::<1>(text)?;
    if Fingers::new().place_object(width) {
        Ok(width)
    } else {
        Err(format!("expected 0 to {} m", Fingers::STROKE))
    }
}

/// Returns a positive factor.
pub(crate) fn factor(text: &str) -> Result<f64, String> {
    let [factor] = numbers::<1>(text)?;
    if factor <= 0.0 {
        return Err("expected a factor above 0".into());
    }
    Ok(factor)
}

/// Returns a possible mass of a load.
pub(crate) fn mass(text: &str) -> Result<f64, String> {
    let [mass] = numbers::<1>(text)?;
    if mass < 0.0 {
        return Err("expected a mass of 0 kg or more".into());
    }
    Ok(mass)
}

/// Returns the time for which a robot may wait, from text in seconds.
pub(crate) fn patience(text: &str) -> Result<Duration, String> {
    let [seconds] = numbers::<1>(text)?;
    match Duration::try_from_secs_f64(seconds) {
        Ok(patience) if patience >= Duration::from_millis(1) => Ok(patience),
        _ => Err("expected 0.001 s or more".into()),
    }
}
