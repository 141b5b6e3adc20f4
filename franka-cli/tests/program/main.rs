//! The program `franka` against simulated robots in the test process, in pipes, and in
//! pseudo-terminals for questions and drawings. Simulators wait for late commands of a busy
//! computer, so no verdict depends on the computer's punctuality.
//!
//! | module | content |
//! |---|---|
//! | `facts` | commands that print results, wrong arguments, names of robots |
//! | `links` | a robot that accepts no motion, a robot that disconnects |
//! | `watching` | `--watch` |
//! | `asking` | questions before motions |
//! | `every` | tables of all commands: no robot, a robot in use, Ctrl-C, reflexes, a terminal |
//! | `moving` | motions, and their early ends |
//! | `fingers` | the Hand |
//! | `settings` | tool, collision, recovery, stop |
//! | `recording` | recordings and cassettes |
//! | `measuring` | tests of connections, benchmarks |
//! | `trial` | the trial of an arm, and its report |
//! | `pages` | the dashboard |
//! | `papers` | help, completions, man pages, the book |

mod asking;
mod every;
mod facts;
mod fingers;
mod links;
mod measuring;
mod moving;
mod pages;
mod papers;
mod program;
mod recording;
mod settings;
mod simulated;
mod terminal;
mod trial;
mod watching;
