//! The options.

use std::net::IpAddr;
use std::path::PathBuf;
use std::time::Duration;

use clap::{ArgAction, Parser, ValueEnum};
use franka_model::RobotKind;

use super::values::{factor, mass, numbers, object_width, patience};
use crate::arm::SystemLimits;

/// Simulates a Franka Research 3 (protocol 10) or a Franka Emika Robot (protocol 5) until it is
/// interrupted.
///
/// When the robot is ready, the simulator prints its address. Connect a client to this address, for
/// example libfranka's `franka::Robot robot("127.0.0.1")` or pylibfranka's
/// `Robot("127.0.0.1", RealtimeConfig.kIgnore)`. The robot accepts one client at a time and keeps
/// its state between clients.
///
/// The robot is as strict as a real robot. A command beyond a limit, a step in velocity or torque,
/// a collision, or 20 missing commands in a row cause a reflex: the robot stops the motion itself.
/// The client can then request an automatic error recovery. With --permissive, the robot accepts
/// such commands. You can then develop a program before you make it safe.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
pub struct Arguments {
    /// Kind of the robot, which also sets the protocol version.
    #[arg(long, value_enum, default_value_t = Kind::Fr3)]
    pub robot: Kind,

    /// Address to listen on, IPv4 or IPv6. 0.0.0.0 selects all IPv4 interfaces, and :: selects all
    /// interfaces with IPv4 and IPv6.
    #[arg(long, default_value = "127.0.0.1")]
    pub bind: IpAddr,

    /// TCP port to listen on; 0 selects a free port. Clients of other projects can use only 1337.
    #[arg(long, default_value_t = 1337)]
    pub port: u16,

    /// Joint positions at the start, in radians, separated by commas. The default is the ready
    /// pose.
    #[arg(long, value_name = "Q1,...,Q7", value_parser = numbers::<7>, allow_hyphen_values = true)]
    pub q: Option<[f64; 7]>,

    /// Serves neither a Franka Hand nor a vacuum gripper. Without this option, they listen on the
    /// two ports after the port of the robot, like real ones: 1338 and 1339. With port 0, all three
    /// ports are free ports.
    #[arg(long)]
    pub no_gripper: bool,

    /// Puts an object of this width between the Hand's fingers and in front of the vacuum gripper,
    /// in metres.
    #[arg(long, value_name = "M", value_parser = object_width, conflicts_with = "no_gripper")]
    pub gripper_object_width: Option<f64>,

    /// Mounts the Franka Hand's mass and frame on the flange.
    #[arg(long)]
    pub hand: bool,

    /// Mass of a load on the flange, in kilograms. The robot does not know the load until a client
    /// declares it.
    #[arg(long, value_name = "KG", value_parser = mass, default_value = "0", allow_hyphen_values = true)]
    pub payload: f64,

    /// Centre of mass of the load in the flange frame, in metres.
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, default_value = "0,0,0.05", allow_hyphen_values = true)]
    pub payload_com: [f64; 3],

    /// The arm: the middle of one of the families `nominal`, `realistic` and `bad`, or of the
    /// family in a JSON file; or `ideal`, which has no stiction, delay and noise, unlike any real
    /// arm. The book (docs/src/real-arm.md) lists the parameters.
    #[arg(long, value_name = "ARM|FILE.json", default_value = "realistic")]
    pub arm: String,

    /// Draws an arm from the family with this seed, instead of the middle arm.
    #[arg(long, value_name = "N")]
    pub arm_seed: Option<u64>,

    /// Joint limits of a system version, instead of the limits of the arm (FR3 only).
    #[arg(long, value_enum)]
    pub limits: Option<LimitsKind>,

    /// Geometry of the reported poses and of the robot's inverse kinematics, instead of the
    /// geometry of the arm. An FR3 has `recorded`; an FER and `--arm ideal` have `described`. The
    /// served description contains its lengths.
    #[arg(long, value_enum)]
    pub state_geometry: Option<GeometryKind>,

    /// Errors of the true links and axes against the reported poses, instead of the errors of the
    /// arm. No state shows them.
    #[arg(long, value_enum)]
    pub kinematic_error: Option<KinematicErrorKind>,

    /// Uses noisy sensors, but keeps the sensor offsets of the arm.
    #[arg(long)]
    pub noise: bool,

    /// The physics: the arm alone, or the arm in MuJoCo, on a table or in the surroundings of
    /// --scene, with fingers that grasp if --hand is set.
    #[arg(long, value_enum, default_value_t = PlantKind::Rigid)]
    pub plant: PlantKind,

    /// An MJCF file with the surroundings of the robot, in its base frame, instead of the table.
    /// Bodies with a free joint are objects to push and to grasp.
    #[arg(long, value_name = "FILE.xml")]
    pub scene: Option<PathBuf>,

    /// A file with the model library that the robot serves (FER only), for clients that require
    /// one. The vendor's library cannot be distributed here. Without this option, the robot answers
    /// that it has no library.
    #[arg(long, value_name = "FILE")]
    pub model_library: Option<PathBuf>,

    /// Conditions for states and commands in transit, in addition to the network between the hosts.
    #[arg(long, value_enum, default_value_t = NetworkKind::Perfect)]
    pub network: NetworkKind,

    /// Seed of all random numbers.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// True if commands and motions beyond the limits cause a reflex, as on a real robot. With
    /// `false`, only physics limits the arm.
    #[arg(long, value_name = "BOOL", default_value_t = true, default_missing_value = "true",
          num_args = 0..=1, action = ArgAction::Set)]
    pub enforce_motion_limits: bool,

    /// Factor on the acceleration and jerk limits of commanded joints. Use a value above 1 for
    /// clients that a real robot would stop with a discontinuity error.
    #[arg(long, value_name = "FACTOR", value_parser = factor, default_value = "1")]
    pub joint_discontinuity_scale: f64,

    /// True if 20 missing commands in a row cause a reflex, as on a real robot. With `false`, the
    /// robot waits for slow or debugged clients.
    #[arg(long, value_name = "BOOL", default_value_t = true, default_missing_value = "true",
          num_args = 0..=1, action = ArgAction::Set)]
    pub enforce_comm_constraints: bool,

    /// Accepts commands beyond the limits and missing commands, without a stop of the robot.
    #[arg(long)]
    pub permissive: bool,

    /// Requests a real-time priority (SCHED_FIFO) for the simulator's thread, which requires the
    /// right to such a priority. Without the right, the simulator prints a warning and continues.
    #[arg(long)]
    pub realtime: bool,

    /// Follows the wall clock even if the host delays the simulator. Due states then arrive in a
    /// burst, and late answers count as lost. Without this option, the robot's clock falls behind
    /// by the host's delay. The log reports at the end how often the host was late.
    #[arg(long)]
    pub strict_clock: bool,

    /// Waits for each late command, up to this number of seconds, and stops the robot's clock
    /// during the wait. Use this option for clients on a busy machine.
    #[arg(long, value_name = "SECONDS", value_parser = patience, num_args = 0..=1,
          require_equals = true, default_missing_value = "0.5",
          conflicts_with_all = ["strict_clock", "virtual_time"])]
    pub wait_for_commands: Option<Duration>,

    /// Advances the robot's time as fast as the client answers, not with the wall clock. In a
    /// motion, the next millisecond begins when the answer to the last state arrives. The answer
    /// counts as missing after this number of seconds. Use this option for tests and slow clients.
    #[arg(long, value_name = "SECONDS", value_parser = patience, num_args = 0..=1,
          require_equals = true, default_missing_value = "0.5",
          conflicts_with_all = ["realtime", "strict_clock"])]
    pub virtual_time: Option<Duration>,
}

/// The kinds of robot by their short names.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum Kind {
    /// Franka Research 3
    Fr3,
    /// Franka Emika Robot, known as Panda
    Fer,
}

/// System versions with different joint limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LimitsKind {
    /// 5.9 and later: wider ranges, lower speed near their ends
    #[value(name = "5.9")]
    From5_9,
    /// Before 5.9
    #[value(name = "before-5.9")]
    Before5_9,
}

/// Geometries from which the robot computes its poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GeometryKind {
    /// The vendor's description: upper arm 0.316 m, forearm 0.384 m
    Described,
    /// The recorded Franka Research 3: 0.3162 m and 0.3842 m
    Recorded,
    /// The vendor's description with errors of 1 mm and 3 mrad, drawn from --seed, which no client
    /// knows
    Random,
}

/// Errors of the true links and axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum KinematicErrorKind {
    /// The true links and axes equal the reported ones
    None,
    /// Errors of the family `realistic`, drawn from --seed
    Random,
}

/// The plants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PlantKind {
    /// Rigid links without surroundings
    Rigid,
    /// MuJoCo: contact, objects, fingers
    Mujoco,
}

/// Networks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum NetworkKind {
    /// No delay and no loss
    Perfect,
    /// The robot's network interface stalls seven times a second for 2 to 7 ms, like an FER's
    /// interface
    FerStalls,
    /// One packet in a hundred is lost, in either direction
    Lossy,
    /// One packet in a hundred is lost, in bursts of eight on average
    Bursts,
}

impl From<LimitsKind> for SystemLimits {
    fn from(limits: LimitsKind) -> Self {
        match limits {
            LimitsKind::From5_9 => Self::From5_9,
            LimitsKind::Before5_9 => Self::Before5_9,
        }
    }
}

impl From<Kind> for RobotKind {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Fr3 => Self::Fr3,
            Kind::Fer => Self::Fer,
        }
    }
}

const EXAMPLES: &str = "\
Examples:
  franka-sim                                    a Franka Research 3 and the server of a Hand, on ports 1337 and 1338
  franka-sim --robot fer --hand --gripper-object-width 0.04
                                                a Panda with a Hand and an object to grasp
  franka-sim --payload 0.5 --noise --seed 7     an undeclared load of 0.5 kg and sensor noise,
                                                repeatable by the seed
  franka-sim --arm-seed 3                       another arm with the friction, flexibility, lag and drift of a real arm
  franka-sim --arm ideal                        an arm that matches its model exactly, for exact tests
  franka-sim --robot fer --network fer-stalls   a Panda with the network delays of a real Panda
  franka-sim --virtual-time                     virtual time: a motion takes only as long as the client computes
  franka-sim --enforce-comm-constraints=false   for a client in a debugger
  franka-sim --port 0                           on free ports, printed at the start";

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(arguments: &[&str]) -> Result<Arguments, clap::Error> {
        Arguments::try_parse_from([&["franka-sim"], arguments].concat())
    }

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }

    #[test]
    fn arguments_that_make_no_robot_are_refused() {
        let patience = |arguments| parse(arguments).ok().and_then(|parsed| parsed.virtual_time);
        // libfranka closes a connection after a second without a state. A client that skips an
        // answer must not lose its connection.
        let default = patience(&["--virtual-time"]);
        assert_eq!(default, Some(Duration::from_millis(500)));
        let short = patience(&["--virtual-time=0.1"]);
        assert_eq!(short, Some(Duration::from_millis(100)));
        for wrong in [
            ["--virtual-time", "--realtime"],
            ["--virtual-time", "--strict-clock"],
            ["--virtual-time", "--wait-for-commands"],
            ["--strict-clock", "--wait-for-commands"],
            ["--wait-for-commands=0", "--hand"],
            ["--virtual-time=0", "--hand"],
            ["--virtual-time=nan", "--hand"],
            ["--virtual-time=1e30", "--hand"],
            ["--q", "1,2"],
            ["--q", "nan,0,0,0,0,0,0"],
            ["--payload", "-1"],
            ["--payload-com", "0,0"],
            ["--joint-discontinuity-scale", "0"],
            ["--enforce-motion-limits", "maybe"],
            ["--gripper-object-width", "0.09"],
            ["--gripper-object-width", "nan"],
            ["--network", "carrier-pigeon"],
            ["--limits", "5.8"],
        ] {
            assert!(parse(&wrong).is_err(), "{wrong:?}");
        }
    }
}
