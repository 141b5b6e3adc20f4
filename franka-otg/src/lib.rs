//! Jerk-limited online trajectory generation for any machine with axes.
//!
//! [`Generator`] moves `N` axes from any state to a target, within limits of velocity, acceleration
//! and jerk. All axes arrive together, in the least possible time. A target may be at rest or in
//! motion. The target and the limits may change in any cycle. The generator creates a new plan only
//! when one of them changes. A new plan in every cycle would add a rounding error per cycle,
//! whereas a plan that does not change ends exactly at the target.
//!
//! ```text
//! state, target, limits -> plan          a straight line if the motion so far allows one, else each axis on its own
//!                            -> axis     brake into the limits if outside, then
//!                                 at rest     least_time       the least duration of this axis
//!                                             given_duration   a profile of a longer one
//!                                 in motion   moving_target    the feasible durations, a profile for each
//!                            -> profile  up to twenty segments of constant jerk; sampled once per cycle
//! ```
//!
//! ```
//! use franka_otg::{Generator, Limits, State};
//!
//! let limits = Limits::from_arrays([2.0; 2], [10.0; 2], [5000.0; 2])?;
//! let mut generator = Generator::new(State::at_rest([0.0, 0.5]), limits)?;
//! generator.set_target(&[0.3, -0.2])?;
//! for _ in 0..100 {
//!     let State { position, .. } = generator.step(); // the command of this cycle
//!     assert!(position[0] < 0.3);
//! }
//! generator.set_target(&[0.1, 0.0])?; // in the middle of the motion
//! while !generator.is_done() {
//!     generator.step();
//! }
//! assert_eq!(generator.state(), &State::at_rest([0.1, 0.0]));
//! # Ok::<(), franka_otg::PlanError>(())
//! ```
//!
//! `cargo run --release -p franka-otg --example plot` draws an irregular target and the smooth
//! command that follows it.
//!
//! # Modules
//!
//! | module | contents |
//! |---|---|
//! | `generator` | the public interface: input, output, the current plan |
//! | `state`, `limits`, `error`, `cycle` | inputs and outputs |
//! | `plan` | the motion of all axes, and their common duration |
//! | `straight_line` | all axes as one scalar problem |
//! | `axis` | one axis, from its state to its profile |
//! | `task` | one axis in units of its limits |
//! | `brake` | the motion of a state outside the limits back into them |
//! | `least_time` | targets at rest: the least duration of one axis |
//! | `given_duration`, `stop_then_go` | targets at rest: a profile with a longer, given duration, which has a lower velocity or begins with a stop |
//! | `moving_target` | targets in motion: a profile with each feasible duration |
//! | `feasible_durations`, `velocity_change` | targets in motion: the feasible durations |
//! | `extremal_profile`, `plateau` | the motion that gets farthest in a given time; a motion with a phase of constant velocity |
//! | `shape`, `profile` | the durations of the seven jerk phases; segments over time |
//! | `transfer`, `root`, `times`, `scalar` | velocity changes, root search, sorted lists, roots |
//!
//! # Targets at rest
//!
//! An axis may wait at rest. The positions at which it can rest at time `T` therefore form an
//! interval that only grows with `T`. This has three consequences. First, every duration above the
//! least duration is feasible, so the common duration is the longest least duration of the axes.
//! Second, the fastest motion is "push at the limits, then stop", from the end of an immediate stop
//! towards the target. Third, the longer the push, the farther away the motion ends. A comparison
//! with a few breakpoints therefore selects a closed form or one short convex search
//! (`least_time`).
//!
//! # Targets in motion
//!
//! An axis cannot wait at a target in motion, so infeasible (*blocked*) durations may exist between
//! feasible durations. For one duration, however, the reachable positions still form an interval.
//! The ends of this interval have closed forms, so two evaluations show if a duration is feasible.
//! The mean of two admissible motions is admissible, so each feasible duration has a weighted mean
//! as its profile. One short search per axis finds where the feasible durations begin
//! (`moving_target`).
//!
//! # Guarantees
//!
//! - Velocity, acceleration and jerk stay within their limits, except for rounding, if the start
//!   state can stay within them. The generator brings other states back within the limits as early
//!   as the jerk limit allows. It never clamps the state (`brake`).
//! - All axes are at the target at the same time, within rounding. If an axis can reach a target at
//!   rest without overshoot, it does not overshoot when it waits for slower axes. One case is
//!   special: an axis whose stop ends exactly at its target cannot arrive later without overshoot,
//!   so it arrives early and waits there (`stop_then_go`).
//! - From rest, and while new targets are on the same line, the path is straight (`straight_line`).
//! - The generator does not allocate or panic for finite inputs. It returns an error for inputs
//!   that are out of range for `f64`.
//!
//! # What it does not do
//!
//! - It does not model the robot: joint ranges, collisions, kinematics and torques are the caller's
//!   responsibility.
//! - It reads no clock: [`Generator::step`] advances by [`CYCLE`], one millisecond. For a machine
//!   with another cycle time, call [`Generator::sample`].
//! - Limits are symmetric and apply to each axis separately. The caller is responsible for a limit
//!   on a norm.
//! - It plans a motion to one target at a time. For a path through waypoints, the caller sets one
//!   target after another.
//!
//! # Termination
//!
//! No function calls itself, directly or through others: the modules call each other in the order
//! of the diagram. The work is therefore bounded, because each loop has a bound:
//!
//! | loop | passes at most |
//! |---|---|
//! | axes of a plan | `N` |
//! | `least_time`, Newton steps | 60 |
//! | `given_duration`, bracketed Newton steps | 60 |
//! | `stop_then_go`, one `root` around `least_time` | 100 evaluations |
//! | `feasible_durations`, pieces between breaks: one `root` each, for two sides | 15 pieces of 100 evaluations, none of which loops |
//! | `times`, insertion into a sorted list | the list's capacity, at most 48 |
//! | `plan`, common duration | 8 candidates of each axis |
//! | `plateau`, one `root` | 100 evaluations |
//! | `profile`, segments laid out, merged or skipped | 20, 40, 20 |
//!
//! Each search counts its passes, so it ends regardless of rounding, infinities or NaN. Accuracy is
//! a separate question. The bracketed searches fall back to bisection, which resolves one of at
//! most 53 bits in each step. On a grid over states, targets and limits, including flat and double
//! roots, `root` always needs less than 80 % of its passes (`tests/bounds.rs`). At a double root,
//! Newton's method may use all of its passes, because each step only halves the error.
//!
//! # Sources
//!
//! The problem, its time-optimal profiles and the two steps (the least duration of each axis, then
//! profiles with a common duration) come from L. Berscheid, T. Kröger, *Jerk-limited Real-time
//! Trajectory Generation with Arbitrary Target States*, RSS 2021, arXiv:2105.04830; T. Kröger, F.
//! Wahl, *Online Trajectory Generation: Basic Concepts for Instantaneous Reactions to Unforeseen
//! Events*, IEEE T-RO 26(1), 2010; R. Haschke, E. Weitnauer, H. Ritter, *On-Line Planning of
//! Time-Optimal, Jerk-Limited Trajectories*, IROS 2008. The decision between cases with
//! breakpoints, and the two families of profiles with a given duration, are derived in this crate.
//! The tests compare the results with plain bisection, and with vectors from Ruckig 0.19.4.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(any(test, feature = "std"))]
extern crate std;

mod axis;
mod brake;
mod cycle;
mod error;
mod extremal_profile;
mod feasible_durations;
mod generator;
mod given_duration;
mod least_time;
mod limits;
mod moving_target;
mod plan;
mod plateau;
mod profile;
mod root;
mod scalar;
mod search_passes;
mod shape;
mod state;
mod stop_then_go;
mod straight_line;
mod task;
mod times;
mod transfer;
mod velocity_change;

pub use axis::rest_of;
pub use cycle::CYCLE;
pub use error::{PlanError, Quantity};
pub use generator::Generator;
pub use limits::{AxisLimits, Limits};
pub use plan::Synchronisation;
pub use state::{AxisState, State};

// Compiles the program in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(test)]
mod tests;
