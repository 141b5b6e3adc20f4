//! Jerk-limited online trajectory generation, to targets at rest and in motion.
//!
//! [`Generator`] moves `N` axes from any state to a target inside limits of velocity, acceleration
//! and jerk, in the least time in which all axes can arrive together. Target and limits may change
//! in any cycle. A plan is made when something changes, then followed: planning anew in each cycle
//! would add its rounding in each, where a kept plan ends exactly at the target.
//!
//! ```text
//! state, target, limits -> plan     straight line if the motion so far allows one, else each axis on its own
//!                           -> axis      brake into the limits if outside, then
//!                                to rest           least_time      the least duration of this axis
//!                                                  given_duration  a profile of a longer one
//!                                to what moves     passing         the durations that are possible, a profile of each
//!                                                  farthest        what both are made of
//!                           -> profile   at most twenty segments of constant jerk; sampled once per cycle
//! ```
//!
//! # Targets at rest
//!
//! An axis may wait at rest, so the positions at which it can rest at time `T` are an interval that
//! only grows with `T`. Three things follow. Every duration from the least on is feasible, so the
//! common duration is the longest of the least ones. The optimum is "push at the limits, then
//! stop", its direction given by the place where an immediate stop would end. And where the push
//! ends is a monotone function of how long it lasts, so the case that applies is found by comparing
//! the target with the breakpoints: closed forms or one short convex search, no families to try
//! (`least_time`).
//!
//! # Targets in motion
//!
//! At a target that moves an axis cannot wait, and there may be durations that cannot be met
//! between others that can. But for one duration the positions that can be reached still are an
//! interval, whose ends have closed forms, and the mean of two admissible motions is one. So
//! whether a duration is possible is decided by two evaluations, and a profile for it is a weighted
//! mean: one short search per axis finds where possible durations begin, and nothing else is
//! searched for (`passing`).
//!
//! # What it holds
//!
//! - Velocity, acceleration and jerk keep their limits to rounding, from every state that can stay
//!   inside them. Others are brought back inside under the jerk limit, as early as possible; the
//!   state is never clamped (`brake`).
//! - All axes arrive together. A target at rest that can be reached without overshooting is not
//!   overshot because another axis takes longer. The one exception keeps the second promise: an
//!   axis whose stop ends exactly at its target cannot be late there without overshooting, and
//!   waits (`late_push`).
//! - From rest, and while new targets stay on the line, the path is straight (`line`).
//! - No allocation, no panic, for all finite inputs; what `f64` cannot compute is an error at the
//!   door.
//!
//! # Why it terminates
//!
//! No function calls itself, directly or through others: the modules call each other in the order
//! of the diagram. So the work is bounded if each loop is, and each loop counts:
//!
//! | loop | passes at most |
//! |---|---|
//! | axes of a plan, groups of limits | `N` |
//! | `least_time`, Newton steps | 60 |
//! | `given_duration`, bracketed Newton steps | 60 |
//! | `late_push`, one `root` around `least_time` | 100 evaluations |
//! | `possible`, pieces between breaks: one `root` each, for two sides | 15 pieces of 100 evaluations, none of which loops |
//! | `times`, insertion into a sorted list | the list's capacity, at most 48 |
//! | `plan`, common duration | 8 candidates of each axis |
//! | `plateau`, one `root` | 100 evaluations |
//! | `profile`, segments laid out, merged or skipped | 20, 40, 20 |
//!
//! The counts of the searches are ceilings that no comparison of floating-point numbers can lift,
//! whatever is rounded, infinite or not a number. What a search needs is a separate question, which
//! decides accuracy and not termination: bisection alone, into which the bracketed ones fall back,
//! halves the bracket in each step and has no more than 53 to halve. On a grid over states, targets
//! and limits, flat and double roots among them, `root` never takes 80 % of what it may
//! (`tests/bounds.rs`); Newton steps may take all of theirs at a double root, where each halves the
//! rest.
//!
//! # Sources
//!
//! The problem, its time-optimal profiles and the two steps: L. Berscheid, T. Kröger, *Jerk-limited
//! Real-time Trajectory Generation with Arbitrary Target States*, RSS 2021, arXiv:2105.04830; T.
//! Kröger, F. Wahl, *Online Trajectory Generation: Basic Concepts for Instantaneous Reactions to
//! Unforeseen Events*, IEEE T-RO 26(1), 2010; R. Haschke, E. Weitnauer, H. Ritter, *On-Line
//! Planning of Time-Optimal, Jerk-Limited Trajectories*, IROS 2008. The decision by breakpoints,
//! the two families of step two and the way off a line are derived in these files; the tests hold
//! them against plain bisection, and against vectors made with Ruckig 0.19.4.

#![no_std]
#![forbid(unsafe_code)]

#[cfg(any(test, feature = "std"))]
extern crate std;

mod axis;
mod brake;
mod error;
mod farthest;
mod generator;
mod given_duration;
mod late_push;
mod least_time;
mod limits;
mod line;
mod passing;
mod plan;
mod plateau;
mod possible;
mod profile;
mod root;
mod scalar;
mod state;
mod steps;
mod task;
mod times;
mod transfer;
mod velocity_change;

pub use axis::rest_of;
pub use error::{PlanError, Quantity};
pub use generator::{CYCLE, Generator};
pub use limits::{AxisLimits, Limits};
pub use plan::Synchronisation;
pub use state::{AxisState, State};

#[cfg(test)]
mod tests;
