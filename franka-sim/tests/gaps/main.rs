//! What the simulators before this one left open, closed: a test per gap, in virtual time, through
//! the sessions of both sides and the bytes between them.
//!
//! | module | gaps |
//! |---|---|
//! | `wire` | versions, their negotiation, second clients, the size of replies, late and missing commands |
//! | `commands` | strictness, several errors at once, their names, finishing, deviations, asynchronous motions, the elbow |
//! | `contact` | the estimate of what touches the arm, thresholds, reflexes, loads |
//! | `modes` | recovery, user stop, brakes, guiding, safety functions, and the errors of the robot itself |
//! | `setters` | ranges, modes, and the effect of stiffnesses |
//! | `echo` | what the state tells of a motion |
//! | `hand` | the Franka Hand and the vacuum gripper |
//! | `fer` | the Franka Emika Robot |
//! | `open` | what is not known of a robot: each an option, with the default that is documented |
//!
//! How large a push reads, how far it moves an impedance, and what a fall trips, on either plant,
//! is in the library's own tests (`robot::tests::pushes`, `robot::tests::falling`).

mod commands;
mod contact;
mod echo;
mod fer;
mod hand;
mod modes;
mod open;
mod pair;
mod setters;
mod wire;
