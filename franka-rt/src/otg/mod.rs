//! Jerk-limited online trajectory generation to targets at rest.
//!
//! [`Generator`] moves `N` axes from any state to rest at a target inside limits of velocity, acceleration
//! and jerk, in the least time in which all axes can arrive together. Target and limits may change in any
//! cycle. A plan is made when something changes, then followed: planning anew in each cycle would add its
//! rounding in each, where a kept plan ends exactly at the target.
//!
//! ```text
//! state, target, limits -> plan     straight line if the motion so far allows one, else each axis on its own
//!                           -> axis      brake into the limits if outside, then
//!                                least_time        the least duration T of this axis
//!                                given_duration    a profile of the longest T of all axes
//!                           -> profile   at most eleven segments of constant jerk; sampled once per cycle
//! ```
//!
//! # Why targets at rest are the easy case
//!
//! An axis may wait at rest, so the positions at which it can rest at time `T` are an interval that only
//! grows with `T`. Three things follow. Every duration from the least on is feasible, so the common duration
//! is the longest of the least ones. The optimum is "push at the limits, then stop", its direction given by
//! the place where an immediate stop would end. And where the push ends is a monotone function of how long it
//! lasts, so the case that applies is found by comparing the target with the breakpoints: closed forms or one
//! short convex search, no families to try (`least_time`).
//!
//! A target velocity breaks this, since there are then durations that cannot be met between others that can.
//! That solution would replace `least_time` and `given_duration`, and the choice of the common duration in
//! `plan`; the rest stays.
//!
//! # What it holds
//!
//! - Velocity, acceleration and jerk keep their limits to rounding, from every state that can stay inside
//!   them. Others are brought back inside under the jerk limit, as early as possible; the state is never
//!   clamped (`brake`).
//! - A target that can be reached without overshooting is not overshot because another axis takes longer.
//!   Such an axis arrives with the others, except where it is slowing down into the target already and cannot
//!   lose so much time: then it waits there (`acceleration_cap`).
//! - From rest, and while new targets stay on the line, the path is straight (`line`). Budgets that bind a
//!   norm are used in full there, and kept while turning off (`turn`, [`Limits::norms`]).
//! - Bounded loops, no allocation, no panic, for all finite inputs; what `f64` cannot compute is an error at
//!   the door.
//!
//! # Sources
//!
//! The problem, its time-optimal profiles and the two steps: L. Berscheid, T. Kröger, *Jerk-limited
//! Real-time Trajectory Generation with Arbitrary Target States*, RSS 2021, arXiv:2105.04830; T. Kröger, F.
//! Wahl, *Online Trajectory Generation: Basic Concepts for Instantaneous Reactions to Unforeseen Events*,
//! IEEE T-RO 26(1), 2010; R. Haschke, E. Weitnauer, H. Ritter, *On-Line Planning of Time-Optimal,
//! Jerk-Limited Trajectories*, IROS 2008. The decision by breakpoints, the two families of step two and the
//! way off a line are derived in these files; the tests hold them against plain bisection, and against
//! vectors made with Ruckig 0.19.4.

mod acceleration_cap;
mod axis;
mod brake;
mod error;
mod generator;
mod given_duration;
mod least_time;
mod limits;
mod line;
mod plan;
mod profile;
mod state;
mod task;
mod transfer;
mod turn;

pub use error::{PlanError, Quantity};
pub use generator::{CYCLE, Generator};
pub use limits::{AxisLimits, Limits};
pub use plan::Synchronisation;
pub use state::{AxisState, State};

#[cfg(test)]
mod tests;
