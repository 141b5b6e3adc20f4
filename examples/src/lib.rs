//! Runnable programs
