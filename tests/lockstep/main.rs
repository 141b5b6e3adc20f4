//! Motions in lockstep: no sockets, no sleeps, every run the same.

mod awkward_poses;
mod cancelling;
mod clearance;
mod diagnosis;
mod endings;
mod engaged;
mod faults;
mod force;
mod goals;
mod guards;
mod holds;
mod identify;
mod laws;
mod mishaps;
mod moving_targets;
mod random_targets;
mod reflex_log;
mod schedules;
mod silence;
mod stalls;
mod steps;
mod supervised;
mod switching;
mod taking_over;
mod telemetry;
mod together;
