//! Errors and sets of errors as names, for `serde`.

use core::fmt;

use serde::de::{Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::robot::{Errors, RobotError};

/// Serialises as libfranka's name of the error.
impl Serialize for RobotError {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for RobotError {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name;

        impl Visitor<'_> for Name {
            type Value = RobotError;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a robot error")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<RobotError, E> {
                RobotError::from_name(name)
                    .ok_or_else(|| E::invalid_value(Unexpected::Str(name), &self))
            }
        }

        deserializer.deserialize_str(Name)
    }
}

/// Serialises as the names of the errors, in the order of the protocol.
impl Serialize for Errors {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

impl<'de> Deserialize<'de> for Errors {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Names;

        impl<'de> Visitor<'de> for Names {
            type Value = Errors;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of names of robot errors")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut names: A) -> Result<Errors, A::Error> {
                let mut errors = Errors::NONE;
                while let Some(error) = names.next_element()? {
                    errors.insert(error);
                }
                Ok(errors)
            }
        }

        deserializer.deserialize_seq(Names)
    }
}
