//! Tests of the simulated robot in virtual time. They use the protocol sessions of client and
//! robot, and the bytes between them.
//!
//! | module | content |
//! |---|---|
//! | `session` | stream, handshake, requests, stop, recovery, one client at a time |
//! | `wire` | versions, their negotiation, second clients, the size of replies, late and missing commands |
//! | `motions`, `torques` | every generator and controller: the arm follows, the state reports the command, the motion ends |
//! | `arm` | arms with stiction, elasticity, lag and drift, as a client sees them |
//! | `checks`, `commands` | strictness: limits, start, continuity, several errors at once, finishing, deviations, asynchronous motions |
//! | `losing` | lost commands, which the robot extrapolates, and bridges or refuses |
//! | `contact`, `pushes`, `falling` | the estimate of contacts, thresholds, reflexes, loads |
//! | `modes`, `people` | recovery, user stop, brakes, guiding, safety functions, the errors of the robot itself, touches |
//! | `firm` | grips, walls and blocked joints on every family of arms |
//! | `setters` | ranges, modes, and the effect of stiffnesses |
//! | `stiffest` | the stiffest springs that clients set |
//! | `echo` | the values of a motion in the state |
//! | `hand`, `scene` | the Franka Hand and the vacuum gripper, alone and in MuJoCo |
//! | `recorded` | the model and the arms against recordings of real arms |
//! | `fer` | the Franka Emika Robot |
//! | `open` | unpublished behaviour of the robot: an option for each question, with the documented default |
//! | `pair`, `plants` | a client and a robot in one thread, and the same on every plant |

mod arm;
mod checks;
mod commands;
mod contact;
mod echo;
mod falling;
mod fer;
mod firm;
mod hand;
mod losing;
mod modes;
mod motions;
mod open;
mod pair;
mod people;
mod plants;
mod pushes;
mod recorded;
#[cfg(feature = "mujoco")]
mod scene;
mod session;
mod setters;
mod stiffest;
mod torques;
mod wire;
