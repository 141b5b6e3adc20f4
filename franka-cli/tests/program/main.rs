//! The program `franka` against simulated robots in the process of the tests: in pipes, and in
//! pseudo-terminals where it asks or draws. Simulators wait for commands that a busy computer sends
//! late; no verdict depends on how punctual it is.
//!
//! | module | what |
//! |---|---|
//! | `facts` | commands that print facts, wrong arguments, names of robots |
//! | `links` | a robot that takes no motion, one that goes away |
//! | `watching` | `--watch` |
//! | `asking` | questions before motions |
//! | `every` | tables of all commands: no robot, one that is taken, Ctrl-C, reflexes, a terminal |
//! | `moving` | motions, and what ends them early |
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
