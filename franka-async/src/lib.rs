//! Async driver for Franka robots
