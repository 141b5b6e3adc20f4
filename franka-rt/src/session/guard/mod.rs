//! Guards, which limit commands. Each guard has its own file:
//!
//! | guard | file |
//! |---|---|
//! | leash | `leash` |
//! | deviation | `deviation` |
//! | lead | `lead` |
//! | clearance | `clearance`; slowing down and braking before an obstacle: `obstacle_braking` |
//! | bounds of joints that follow a pose: velocity, position, acceleration | `joint_bounds` |
//! | speed cap | `speed_cap` |
//! | force cap | `force_cap` |
//! | velocity barrier | `velocity_barrier` |
//! | torque clamp | `torque_clamp` |
//! | torque-rate limit | `torque_rate` |
//! | watchdog | `watchdog` |
//! | deadman | `deadman` |
//! | backstop: the limiter of setpoints | `backstop` |
//! | response: an arm that ignores its commands | `unresponsive` |
//!
//! `binding` names the guards for the record of each cycle.

pub(super) mod backstop;
mod binding;
pub(super) mod clearance;
pub(super) mod deadman;
pub(super) mod deviation;
pub(super) mod force_cap;
pub(super) mod joint_bounds;
pub(super) mod lead;
pub(super) mod leash;
pub(super) mod obstacle_braking;
pub(super) mod speed_cap;
pub(super) mod torque_clamp;
pub(super) mod torque_rate;
pub(super) mod unresponsive;
pub(super) mod velocity_barrier;
pub(super) mod watchdog;

pub use binding::{Bindings, Guard};
