//! Compares the texts with libfranka's texts, byte for byte.

mod names;
mod refusals;
mod states;
