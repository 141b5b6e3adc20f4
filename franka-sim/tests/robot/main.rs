//! The simulated robot in virtual time, through the sessions of both sides and the bytes between
//! them. Gaps of earlier simulators have a test here, too.
//!
//! | module | content |
//! |---|---|
//! | `session` | stream, handshake, requests, stop, recovery, one client at a time |
//! | `wire` | versions, their negotiation, second clients, the size of replies, late and missing commands |
//! | `motions`, `torques` | every generator and controller: followed, echoed, ended |
//! | `arm` | arms that stick, flex, lag and drift: what a client sees of them |
//! | `checks`, `commands` | strictness: limits, start, continuity, several errors at once, finishing, deviations, asynchronous motions |
//! | `losing` | lost commands: extrapolated, and bridged or refused |
//! | `contact`, `pushes`, `falling` | the estimate of what touches the arm, thresholds, reflexes, loads |
//! | `modes`, `people` | recovery, user stop, brakes, guiding, safety functions, the errors of the robot itself, touches |
//! | `firm` | grips, walls and blocked joints on every family of arms |
//! | `setters` | ranges, modes, and the effect of stiffnesses |
//! | `stiffest` | the stiffest springs that clients set |
//! | `echo` | what the state contains of a motion |
//! | `hand`, `scene` | the Franka Hand and the vacuum gripper, alone and in MuJoCo |
//! | `recorded` | the model and the arms against recordings of real arms |
//! | `fer` | the Franka Emika Robot |
//! | `open` | what is not known of a robot: each an option, with the default that is documented |
//! | `pair`, `plants` | a client and a robot in one thread; on every plant |

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
