//! Motions in lockstep: no sockets, no sleeps, every run the same.

mod awkward_poses;
mod cancelling;
#[cfg(feature = "mujoco")]
mod carrying;
mod clearance;
mod contact;
mod control_log;
mod diagnosis;
mod endings;
mod engaged;
mod explaining;
mod faults;
mod force;
mod goal_options;
mod goals;
mod guards;
mod holds;
mod identify;
mod laws;
mod mishaps;
mod moving_targets;
mod paths;
mod random_targets;
mod reactions;
mod reflex_log;
mod replaying;
mod schedules;
mod silence;
mod stalls;
mod steps;
mod supervised;
mod switching;
mod taking_over;
mod team;
mod telemetry;
mod together;
