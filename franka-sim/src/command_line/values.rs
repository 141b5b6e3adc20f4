//! Checked values of options.

use std::time::Duration;

use crate::Fingers;

/// Returns `N` finite numbers from comma-separated text.
///
/// # Errors
/// A text that reports the error.
pub fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let values = text
        .split(',')
        .map(|number| number.trim().parse::<f64>().map_err(|e| e.to_string()))
        .collect::<Result<Vec<_>, _>>()?;
    if !values.iter().all(|value| value.is_finite()) {
        return Err("every number has to be finite".into());
    }
    let count = values.len();
    values
        .try_into()
        .map_err(|_| format!("{N} numbers expected, {count} given"))
}

/// The width of an object that fits between the fingers.
pub(crate) fn object_width(text: &str) -> Result<f64, String> {
    let [width] = numbers::<1>(text)?;
    if Fingers::new().place_object(width) {
        Ok(width)
    } else {
        Err(format!("between 0 and {} m fit", Fingers::STROKE))
    }
}

/// A positive factor.
pub(crate) fn factor(text: &str) -> Result<f64, String> {
    let [factor] = numbers::<1>(text)?;
    if factor <= 0.0 {
        return Err("a factor is positive".into());
    }
    Ok(factor)
}

/// A possible mass of a load.
pub(crate) fn mass(text: &str) -> Result<f64, String> {
    let [mass] = numbers::<1>(text)?;
    if mass < 0.0 {
        return Err("a mass is not negative".into());
    }
    Ok(mass)
}

/// Time in seconds that a robot may wait.
pub(crate) fn patience(text: &str) -> Result<Duration, String> {
    let [seconds] = numbers::<1>(text)?;
    match Duration::try_from_secs_f64(seconds) {
        Ok(patience) if patience >= Duration::from_millis(1) => Ok(patience),
        _ => Err("at least 0.001 s expected".into()),
    }
}
