//! Measures target control on realistic simulated arms: `arms [--family F] [--arms N] [--seed S]
//! [--robot R] OUTPUT`.
//!
//! ```text
//! Family, seed -> Arm -> Programme (lockstep) -> ArmFigures -> Summary -> JSON
//! ```
//!
//! Each arm has its own seed, which its line contains: `--arms 1 --seed SEED` runs this arm alone.

mod figures;
mod programme;

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use anyhow::Context;
use clap::{Parser, ValueEnum};
use franka_model::RobotKind;
use franka_rt::law::Gains;
use franka_rt::session::{Backend, Goal, Setpoints, Target};
use franka_sim::arm::{Arm, Family};

use figures::Summary;

#[derive(Debug, Parser)]
struct Arguments {
    /// Family of the arms: ideal, nominal, realistic, bad, or a file.
    #[arg(long, default_value = "realistic")]
    family: String,
    /// Number of arms.
    #[arg(long, default_value_t = 20)]
    arms: u64,
    /// Seed of the first arm; the others count up from it.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The model of the arms.
    #[arg(long, value_enum, default_value_t = Kind::Fr3)]
    robot: Kind,
    /// Factor on gains of the law, to find the margin to the first oscillation.
    #[arg(long, default_value_t = 1.0)]
    gain: f64,
    /// The gains that the factor applies to.
    #[arg(long, value_enum, default_value_t = Scaled::All)]
    scaled: Scaled,
    /// The law.
    #[arg(long, value_enum, default_value_t = LawChoice::Default)]
    law: LawChoice,
    /// The setpoints of the robot's own controllers.
    #[arg(long, value_enum, default_value_t = SetpointChoice::JointPositions)]
    setpoints: SetpointChoice,
    /// Number of threads.
    #[arg(long, default_value_t = 2)]
    threads: u64,
    /// Print a line for every arm, not only for arms with failures.
    #[arg(long)]
    all: bool,
    /// The output file.
    output: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    Fr3,
    Fer,
}

/// Gains to scale.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Scaled {
    All,
    Stiffness,
    RotationalStiffness,
    Damping,
    RotationalDamping,
    JointStiffness,
    JointDamping,
}

impl Scaled {
    fn scale(self, mut gains: Gains, by: f64) -> Gains {
        let (stiffness, rotational_stiffness) = gains.cartesian_stiffness.split_at_mut(3);
        let (damping, rotational_damping) = gains.cartesian_damping.split_at_mut(3);
        for (of, numbers) in [
            (Self::Stiffness, stiffness),
            (Self::RotationalStiffness, rotational_stiffness),
            (Self::Damping, damping),
            (Self::RotationalDamping, rotational_damping),
            (Self::JointStiffness, &mut gains.joint_stiffness[..]),
            (Self::JointDamping, &mut gains.joint_damping[..]),
        ] {
            if self == Self::All || self == of {
                numbers.iter_mut().for_each(|number| *number *= by);
            }
        }
        gains
    }
}

/// The law of the goals for poses, and a factor on gains.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LawUnderTest {
    choice: LawChoice,
    setpoints: SetpointChoice,
    scaled: Scaled,
    by: f64,
}

impl LawUnderTest {
    /// Returns the backend, which converts setpoints to torques.
    pub(crate) fn backend(self) -> Backend {
        self.choice.backend(self.setpoints.into())
    }

    /// True if it is what goals have by default.
    pub(crate) fn is_default(self) -> bool {
        matches!(self.choice, LawChoice::Default) && self.by == 1.0
    }

    /// Returns the gains of a goal: its own unless it is a pose.
    pub(crate) fn gains(self, goal: &Goal) -> Gains {
        let gains = match goal.target {
            Target::Pose(_) => self.choice.gains(),
            Target::Joints(_) if self.choice.is_compensated() => goal.gains,
            Target::Joints(_) => goal.gains.without_compensation(),
            _ => return goal.gains,
        };
        self.scaled.scale(gains, self.by)
    }
}

/// Laws to compare.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum LawChoice {
    /// The law of a goal for a pose.
    Default,
    /// The same law, with springs and dampers only.
    Springs,
    /// 1500 N/m and 60 N m/rad.
    Stiff,
    /// The same gains, with springs and dampers only.
    StiffSprings,
    /// The law of a goal for joint positions.
    Joint,
    /// The same law, with springs and dampers only.
    JointSprings,
    /// The robot's own joint impedance controller, with `--setpoints`.
    JointImpedance,
    /// The robot's own Cartesian impedance controller, with `--setpoints`.
    CartesianImpedance,
}

/// Setpoints of the robot's own controllers.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SetpointChoice {
    JointPositions,
    JointVelocities,
    CartesianPoses,
    CartesianVelocities,
}

impl From<SetpointChoice> for Setpoints {
    fn from(choice: SetpointChoice) -> Self {
        match choice {
            SetpointChoice::JointPositions => Self::JointPositions,
            SetpointChoice::JointVelocities => Self::JointVelocities,
            SetpointChoice::CartesianPoses => Self::CartesianPoses,
            SetpointChoice::CartesianVelocities => Self::CartesianVelocities,
        }
    }
}

impl LawChoice {
    fn backend(self, setpoints: Setpoints) -> Backend {
        match self {
            Self::JointImpedance => Backend::joint_impedance(setpoints),
            Self::CartesianImpedance => Backend::cartesian_impedance(setpoints),
            _ => Backend::Torques,
        }
    }

    fn is_compensated(self) -> bool {
        matches!(self, Self::Default | Self::Stiff | Self::Joint)
    }

    fn gains(self) -> Gains {
        let stiff = Gains {
            cartesian_damping: [120.0, 120.0, 120.0, 3.0, 3.0, 3.0],
            cartesian_stiffness: [1500.0, 1500.0, 1500.0, 60.0, 60.0, 60.0],
            ..Gains::cartesian()
        };
        match self {
            Self::Default | Self::JointImpedance | Self::CartesianImpedance => Gains::cartesian(),
            Self::Springs => Gains::cartesian().without_compensation(),
            Self::Stiff => stiff,
            Self::StiffSprings => stiff.without_compensation(),
            Self::Joint => Gains::joint(),
            Self::JointSprings => Gains::joint().without_compensation(),
        }
    }
}

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let kind = match arguments.robot {
        Kind::Fr3 => RobotKind::Fr3,
        Kind::Fer => RobotKind::Fer,
    };
    let family = match arguments.family.as_str() {
        "ideal" => None,
        "nominal" => Some(Family::nominal()),
        "realistic" => Some(Family::realistic()),
        "bad" => Some(Family::bad()),
        file => {
            let text = std::fs::read_to_string(file).with_context(|| file.to_owned())?;
            Some(Family::from_json(&text).with_context(|| file.to_owned())?)
        }
    };
    let law = LawUnderTest {
        choice: arguments.law,
        setpoints: arguments.setpoints,
        scaled: arguments.scaled,
        by: arguments.gain,
    };
    let gains = law.scaled.scale(law.choice.gains(), law.by);
    gains.check().context("--gain")?;
    let (next, start) = (AtomicU64::new(0), Instant::now());
    let all = Mutex::new(Vec::new());
    let work = || loop {
        let i = next.fetch_add(1, Ordering::Relaxed);
        if i >= arguments.arms {
            return;
        }
        let seed = arguments.seed + i;
        let arm = match &family {
            Some(family) => Arm::sample(kind, seed, family),
            None => Arm::ideal(kind),
        };
        let figures = programme::run(kind, arm, seed, law);
        if arguments.all || figures.fell_short() {
            println!("{figures}");
        }
        let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
        all.push(figures);
    };
    std::thread::scope(|scope| {
        for _ in 0..arguments.threads {
            scope.spawn(work);
        }
    });
    let all = all.into_inner().unwrap_or_else(PoisonError::into_inner);
    let summary = Summary::of(&all);
    println!("{summary}");
    println!("{:.0} s", start.elapsed().as_secs_f64());
    let json = serde_json::to_string_pretty(&summary.values())?;
    let output = &arguments.output;
    std::fs::write(output, json + "\n").with_context(|| output.display().to_string())
}
