//! libfranka's texts, each against the string that it prints, byte for byte.

mod names;
mod refusals;
mod states;
