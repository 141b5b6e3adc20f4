//! Distribution of one parameter, and the bounds of its values.

use std::fmt;

use super::FamilyError;

/// Distribution of one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Distribution {
    /// Always this value.
    Constant(Values),
    /// Uniform, from `low` to `high`.
    #[allow(missing_docs)] // the fields are the ends
    Uniform { low: Values, high: Values },
    /// Gaussian distribution with mean `mean` and standard deviation `rms`.
    #[allow(missing_docs)] // the fields are in the text
    Normal { mean: Values, rms: Values },
}

/// One number for all joints, or one number per joint.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(untagged))]
pub enum Values {
    /// The same number for all joints.
    One(f64),
    /// One number per joint, for joints 1 to 7.
    Seven([f64; 7]),
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Bounds {
    Any,
    Positive,
    NotNegative,
    Between(f64, f64),
    Whole(u32, u32),
}

impl Bounds {
    fn admit(self, value: f64) -> bool {
        match self {
            Self::Any => true,
            Self::Positive => value > 0.0,
            Self::NotNegative => value >= 0.0,
            Self::Between(least, most) => (least..=most).contains(&value),
            Self::Whole(least, most) => {
                let range = f64::from(least)..=f64::from(most);
                value.fract() == 0.0 && range.contains(&value)
            }
        }
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => write!(f, "a finite number"),
            Self::Positive => write!(f, "more than 0"),
            Self::NotNegative => write!(f, "0 or more"),
            Self::Between(least, most) => write!(f, "{least} to {most}"),
            Self::Whole(least, most) => write!(f, "a whole number, {least} to {most}"),
        }
    }
}

impl Distribution {
    /// The two numbers of a distribution; a constant is returned twice.
    fn numbers(&self) -> [Values; 2] {
        match *self {
            Self::Constant(value) => [value, value],
            Self::Uniform { low, high } => [low, high],
            Self::Normal { mean, rms } => [mean, rms],
        }
    }

    /// Checks that all possible values of the distribution are within the bounds.
    pub(super) fn check(&self, field: &'static str, bounds: Bounds) -> Result<(), FamilyError> {
        let invalid = |got: String, expected: &dyn fmt::Display| {
            Err(FamilyError::Invalid {
                field,
                got,
                expected: expected.to_string(),
            })
        };
        for joint in 0..7 {
            let [first, second] = self.numbers().map(|values| values.of(joint));
            if let Some(wild) = [first, second].into_iter().find(|v| !v.is_finite()) {
                return invalid(format!("{wild}"), &"finite numbers");
            }
            match self {
                Self::Normal { .. } if second < 0.0 => {
                    return invalid(format!("rms {second}"), &"an rms of 0 or more");
                }
                Self::Normal { .. } if matches!(bounds, Bounds::Any) => {}
                Self::Normal { .. } => {
                    return invalid(
                        "a normal distribution, which has no bounds".into(),
                        &"a \
                        constant or uniform distribution",
                    );
                }
                Self::Uniform { .. } if first > second => {
                    return invalid(
                        format!("low {first}, high {second}"),
                        &"low at most as large \
                        as high",
                    );
                }
                Self::Constant(_) | Self::Uniform { .. } => {}
            }
            let bounded = [first, second].into_iter().find(|&v| !bounds.admit(v));
            if let Some(outside) = bounded {
                return invalid(format!("{outside}"), &bounds);
            }
        }
        Ok(())
    }

    /// Refuses a distribution with seven numbers for a parameter that is not per joint.
    pub(super) fn check_single(&self, field: &'static str) -> Result<(), FamilyError> {
        let seven = |values: &Values| matches!(values, Values::Seven(_));
        match self.numbers().iter().any(seven) {
            false => Ok(()),
            true => Err(FamilyError::Invalid {
                field,
                got: "seven numbers".into(),
                expected: "one number for the whole arm".into(),
            }),
        }
    }
}

impl Values {
    /// The value for joint `joint`, 0 to 6.
    pub(super) fn of(&self, joint: usize) -> f64 {
        match self {
            Self::One(value) => *value,
            Self::Seven(values) => values[joint],
        }
    }
}

impl From<f64> for Values {
    fn from(value: f64) -> Self {
        Self::One(value)
    }
}

impl From<[f64; 7]> for Values {
    fn from(values: [f64; 7]) -> Self {
        Self::Seven(values)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Values {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = Values;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or seven numbers")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Values, E> {
                Ok(Values::One(value))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Values, E> {
                Ok(Values::One(value as f64))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Values, E> {
                Ok(Values::One(value as f64))
            }

            fn visit_seq<A: serde::de::SeqAccess<'de>>(
                self,
                mut sequence: A,
            ) -> Result<Values, A::Error> {
                let mut values = Vec::new();
                while let Some(value) = sequence.next_element()? {
                    values.push(value);
                }
                let count = values.len();
                let seven = values.try_into().map(Values::Seven);
                seven.map_err(|_| serde::de::Error::invalid_length(count, &self))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}
