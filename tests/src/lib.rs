//! Fixtures and measurements that the cross-crate suites share.
//!
//! | module | what it is |
//! |---|---|
//! | [`broken_socket`] | receives that fail on a socket of another thread |
//! | [`contacts`] | random pushes on a simulated arm, and what its torques tell of them |
//! | [`cycle_counts`] | cycles, calls and success rates that a control function counts |
//! | [`follow`] | the lag behind a target that moves, in virtual time |
//! | [`mishaps`] | networks with one kind of fault each |
//! | [`push`] | a hand that pushes an arm, and the inertia that it meets |
//! | [`held_push`] | pushes on an arm that holds its pose, and what they leave |
//! | [`golden`] | the crates against stored vectors: wire bytes, model numbers, trajectories |

use std::time::Duration;

pub mod broken_socket;
pub mod contacts;
pub mod cycle_counts;
pub mod follow;
pub mod golden;
pub mod held_push;
pub mod mishaps;
pub mod push;

/// Time for which a robot at the pace of its client waits for a command. Twenty missing commands in
/// a row end a motion.
pub const PATIENCE: Duration = Duration::from_millis(100);

/// True if suites that draw or enumerate many cases run all of them: the variable
/// `FRANKA_THOROUGH`, as the nightly run sets it. Otherwise they run a sample with all boundaries.
pub fn thorough() -> bool {
    std::env::var("FRANKA_THOROUGH").is_ok_and(|value| value == "1")
}

/// Compiles the programs of the README and the book. Programs that need features with many
/// dependencies take the feature `book`.
#[cfg(doctest)]
mod programs {
    #[doc = include_str!("../../README.md")]
    struct Readme;

    #[doc = include_str!("../../docs/src/how-to/chunks.md")]
    struct HowToChunks;

    #[doc = include_str!("../../docs/src/how-to/grip.md")]
    struct HowToGrip;

    #[doc = include_str!("../../docs/src/how-to/policy.md")]
    struct HowToPolicy;

    #[doc = include_str!("../../docs/src/how-to/recover.md")]
    struct HowToRecover;

    #[doc = include_str!("../../docs/src/how-to/teach.md")]
    struct HowToTeach;

    #[doc = include_str!("../../docs/src/how-to/teleoperate.md")]
    struct HowToTeleoperate;

    #[doc = include_str!("../../docs/src/how-to/tune.md")]
    struct HowToTune;

    #[doc = include_str!("../../docs/src/how-to/two-arms.md")]
    struct HowToTwoArms;

    #[doc = include_str!("../../docs/src/start/first-motion.md")]
    struct FirstMotion;

    #[doc = include_str!("../../docs/src/tutorial/control.md")]
    struct TutorialControl;

    #[doc = include_str!("../../docs/src/tutorial/policy.md")]
    struct TutorialPolicy;

    #[doc = include_str!("../../docs/src/tutorial/service.md")]
    struct TutorialService;

    #[doc = include_str!("../../docs/src/control.md")]
    struct Control;

    #[doc = include_str!("../../docs/src/doctor.md")]
    struct Doctor;

    #[doc = include_str!("../../docs/src/explaining.md")]
    struct Explaining;

    #[doc = include_str!("../../docs/src/guards.md")]
    struct Guards;

    #[doc = include_str!("../../docs/src/from-libfranka.md")]
    struct FromLibfranka;

    #[doc = include_str!("../../docs/src/model.md")]
    struct Model;

    #[doc = include_str!("../../docs/src/identify.md")]
    struct Identify;

    #[doc = include_str!("../../docs/src/reactions.md")]
    struct Reactions;

    #[doc = include_str!("../../docs/src/realtime.md")]
    struct Realtime;

    #[doc = include_str!("../../docs/src/recording.md")]
    struct Recording;

    #[cfg_attr(feature = "book", doc = include_str!("../../docs/src/replaying.md"))]
    struct Replaying;

    #[doc = include_str!("../../docs/src/services.md")]
    struct Services;

    #[doc = include_str!("../../docs/src/sessions.md")]
    struct Sessions;

    #[doc = include_str!("../../docs/src/several-arms.md")]
    struct SeveralArms;

    #[doc = include_str!("../../docs/src/simulated-robot.md")]
    struct SimulatedRobot;

    #[doc = include_str!("../../docs/src/simulator.md")]
    struct Simulator;

    #[doc = include_str!("../../docs/src/supervision.md")]
    struct Supervision;
}
