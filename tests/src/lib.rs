//! Cross-crate suites: lockstep harness, golden vectors, live tests and benchmarks
