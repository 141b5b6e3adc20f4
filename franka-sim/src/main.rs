//! A simulated Franka robot for any client that speaks its protocol.

use std::fs;
use std::io::IsTerminal;
use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use bytes::Bytes;
use clap::{ArgAction, Parser, ValueEnum};
use franka_model::{JointVector, Load, RobotKind};
use franka_sim::network::{BurstLoss, Conditions, Loss};
#[cfg(feature = "mujoco")]
use franka_sim::plant::{MujocoArm, Scene};
use franka_sim::{Config, Fingers, Network, Noise, Sim, Suction, Tool};
use nalgebra::{Matrix3, Vector3};
use tokio::signal::unix::{SignalKind, signal};

/// Simulates a Franka Research 3 (protocol 10) or a Franka Emika Robot (protocol 5) until it is
/// interrupted.
///
/// Point a client at the address that is printed once the robot is ready, for example
/// libfranka's `franka::Robot robot("127.0.0.1")` or pylibfranka's
/// `Robot("127.0.0.1", RealtimeConfig.kIgnore)`. There is one client at a time; the robot stays as
/// it is between clients.
///
/// The robot is as strict as a real one: a command beyond a limit, a step in velocity or torque, a
/// collision and 20 missing commands in a row end a motion in a reflex, which the client clears
/// with an automatic error recovery. With --permissive it lets commands pass, so that a program can
/// be brought to run before it is made safe.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Arguments {
    /// Which robot, and with it which protocol version.
    #[arg(long, value_enum, default_value_t = Kind::Fr3)]
    robot: Kind,

    /// Address to listen on, IPv4 or IPv6; 0.0.0.0 for all interfaces, :: for both families on all
    /// of them.
    #[arg(long, default_value = "127.0.0.1")]
    bind: IpAddr,

    /// TCP port to listen on; 0 takes a free one. Other clients than ours only know 1337.
    #[arg(long, default_value_t = 1337)]
    port: u16,

    /// Joint positions at the start, in radians, separated by commas; the ready pose if absent.
    #[arg(long, value_name = "Q1,...,Q7", value_parser = numbers::<7>, allow_hyphen_values = true)]
    q: Option<[f64; 7]>,

    /// Serves neither a Franka Hand nor a vacuum gripper. Without this, they listen on the two
    /// ports that follow the robot's, as on a robot: 1338 and 1339. On port 0 all three are free
    /// ones.
    #[arg(long)]
    no_gripper: bool,

    /// Puts an object of this width between the Hand's fingers and in front of the vacuum gripper,
    /// in metres.
    #[arg(long, value_name = "M", value_parser = object_width, conflicts_with = "no_gripper")]
    gripper_object_width: Option<f64>,

    /// Mounts the Franka Hand's mass and frame on the flange.
    #[arg(long)]
    hand: bool,

    /// A load on the flange that the robot does not know of until a client declares it, in
    /// kilograms.
    #[arg(long, value_name = "KG", value_parser = mass, default_value = "0", allow_hyphen_values = true)]
    payload: f64,

    /// Centre of mass of the load in the flange frame, in metres.
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, default_value = "0,0,0.05", allow_hyphen_values = true)]
    payload_com: [f64; 3],

    /// Adds noise to the sensors.
    #[arg(long)]
    noise: bool,

    /// What moves: the arm alone, or the arm in MuJoCo, on a table or among what --scene names,
    /// and fingers that grasp if there is a --hand.
    #[arg(long, value_enum, default_value_t = PlantKind::Rigid)]
    plant: PlantKind,

    /// An MJCF file with what is around the robot, in its base frame, instead of the table. Bodies
    /// with a free joint are objects to push and to grasp.
    #[arg(long, value_name = "FILE.xml")]
    scene: Option<PathBuf>,

    /// A file with the model library that the robot serves (FER only): the vendor's, which is not
    /// ours to give, for clients that insist on one. Without, they are told that there is none.
    #[arg(long, value_name = "FILE")]
    model_library: Option<PathBuf>,

    /// What happens to states and commands on their way, besides what the network between the hosts
    /// does.
    #[arg(long, value_enum, default_value_t = NetworkKind::Perfect)]
    network: NetworkKind,

    /// Seed of all randomness.
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Whether commands and motions beyond the limits end in a reflex, as on a robot. With `false`
    /// the arm does what it physically can.
    #[arg(long, value_name = "BOOL", default_value_t = true, default_missing_value = "true",
          num_args = 0..=1, action = ArgAction::Set)]
    enforce_motion_limits: bool,

    /// Factor on the bounds of acceleration and jerk that commands have to keep in the joints.
    /// Above 1 for clients that are rougher than a robot allows: it would stop with a discontinuity
    /// error.
    #[arg(long, value_name = "FACTOR", value_parser = factor, default_value = "1")]
    joint_discontinuity_scale: f64,

    /// Whether 20 commands missing in a row end in a reflex, as on a robot. With `false` the robot
    /// waits for them: for slow or debugged clients.
    #[arg(long, value_name = "BOOL", default_value_t = true, default_missing_value = "true",
          num_args = 0..=1, action = ArgAction::Set)]
    enforce_comm_constraints: bool,

    /// Lets pass what a robot stops for: neither limits nor missing commands are enforced.
    #[arg(long)]
    permissive: bool,

    /// Asks for a real-time priority (SCHED_FIFO) of the thread that keeps the millisecond, which
    /// takes the right to one. Without the right, the simulator says so and goes on without.
    #[arg(long)]
    realtime: bool,

    /// Keeps to the clock on the wall even where the host holds the simulator up: the states that
    /// are due then come in a burst, and answers that they leave no time for count as lost.
    /// Without, the robot's clock slips by what the host is late. How often that was is logged at
    /// the end.
    #[arg(long)]
    strict_clock: bool,

    /// Lets the robot's time pass as fast as the client answers, not by the clock on the wall: in a
    /// motion the next millisecond begins when the answer to the last state is there, within a
    /// second. For tests, and for clients slower than a robot allows.
    #[arg(long, conflicts_with_all = ["realtime", "strict_clock"])]
    virtual_time: bool,
}

/// How long an answer may take in virtual time.
const PATIENCE: Duration = Duration::from_secs(1);

/// The longest model library: what a message carries.
const LIBRARY_MAX: usize = franka_proto::framing::MAX_MESSAGE_SIZE - 64;

const EXAMPLES: &str = "\
Examples:
  franka-sim                                    a Franka Research 3 with a hand's server, on 1337 and 1338
  franka-sim --robot fer --hand --gripper-object-width 0.04
                                                a Panda with its hand, and something to grasp
  franka-sim --payload 0.5 --noise --seed 7     half a kilogram that no client has declared, and sensors
                                                that are not perfect, the same way every time
  franka-sim --robot fer --network fer-stalls   a Panda that sends its states as late as a Panda does
  franka-sim --virtual-time                     seconds of motion in as little time as the client takes
  franka-sim --enforce-comm-constraints=false   for a client in a debugger
  franka-sim --port 0                           on free ports, which it prints";

/// The kinds of robot by their short names.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Kind {
    /// Franka Research 3
    Fr3,
    /// Franka Emika Robot, known as Panda
    Fer,
}

/// The plants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PlantKind {
    /// Rigid links that nothing is around
    Rigid,
    /// MuJoCo: contact, objects, fingers
    Mujoco,
}

/// Networks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum NetworkKind {
    /// Nothing
    Perfect,
    /// The robot's network interface stalls for 2 to 7 ms seven times a second, as an FER's does
    FerStalls,
    /// One packet in a hundred is lost, in either direction
    Lossy,
    /// The same number is lost, eight in a row in the mean
    Bursts,
}

impl NetworkKind {
    fn network(self, seed: u64) -> Option<Network> {
        let losing = |loss| {
            let conditions = Conditions::default().with_loss(loss);
            Some(Network::new(seed, conditions, conditions))
        };
        match self {
            Self::Perfect => None,
            Self::FerStalls => Some(Network::fer(seed)),
            Self::Lossy => losing(Loss::Independent(0.01)),
            Self::Bursts => losing(Loss::Bursts(BurstLoss::of(0.01, 8.0))),
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

impl Arguments {
    fn config(&self) -> Config {
        let mut config = Config {
            kind: self.robot.into(),
            seed: self.seed,
            enforce_limits: self.enforce_motion_limits && !self.permissive,
            joint_discontinuity_scale: self.joint_discontinuity_scale,
            enforce_communication: self.enforce_comm_constraints && !self.permissive,
            ..Config::default()
        };
        if let Some(q) = self.q {
            config.q = JointVector::from(q);
        }
        if self.hand {
            config.tool = Tool::hand();
        }
        if self.noise {
            config.noise = Noise::MODERATE;
        }
        if self.payload > 0.0 {
            config.payload = Load {
                mass: self.payload,
                com: Vector3::from(self.payload_com),
                inertia: Matrix3::zeros(),
            };
        }
        config
    }

    /// The robot, or why there is none.
    fn sim(&self) -> Result<Sim, String> {
        let mut config = self.config();
        config.model_library = self.library()?;
        let sim = Sim::new(config)
            .bind(SocketAddr::new(self.bind, self.port))
            .realtime(self.realtime)
            .strict_clock(self.strict_clock);
        let sim = match self.virtual_time {
            true => sim.virtual_time(PATIENCE),
            false => sim,
        };
        let sim = match self.network.network(self.seed) {
            Some(network) => sim.network(network),
            None => sim,
        };
        let sim = self.with_plant(sim)?;
        if self.no_gripper {
            return Ok(sim);
        }
        let (fingers, suction) = match self.gripper_object_width {
            Some(width) => (
                Fingers::new().with_object(width),
                Suction::new().with_object(),
            ),
            None => (Fingers::new(), Suction::new()),
        };
        // Port 0 takes a free one; beyond the last port there are only those.
        let beside = |n| match self.port {
            0 => 0,
            port => port.checked_add(n).unwrap_or(0),
        };
        Ok(sim
            .hand(fingers, beside(1))
            .vacuum_gripper(suction, beside(2)))
    }

    /// The model library to serve.
    fn library(&self) -> Result<Option<Bytes>, String> {
        let Some(path) = &self.model_library else {
            return Ok(None);
        };
        if let Kind::Fr3 = self.robot {
            return Err("a model library needs --robot fer: an FR3 serves a description".into());
        }
        let library = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        if library.len() > LIBRARY_MAX {
            return Err(format!(
                "{}: {} bytes are too long for a model library, at most {LIBRARY_MAX} expected",
                path.display(),
                library.len()
            ));
        }
        Ok(Some(library.into()))
    }

    fn with_plant(&self, sim: Sim) -> Result<Sim, String> {
        match self.plant {
            PlantKind::Rigid if self.scene.is_some() => {
                Err("a scene needs --plant mujoco: nothing is around a rigid arm".into())
            }
            PlantKind::Rigid => Ok(sim),
            PlantKind::Mujoco if self.hand && self.gripper_object_width.is_some() => Err(
                "fingers in MuJoCo grasp what is in the scene: leave out --gripper-object-width"
                    .into(),
            ),
            PlantKind::Mujoco => self.with_mujoco(sim),
        }
    }

    #[cfg(feature = "mujoco")]
    fn with_mujoco(&self, sim: Sim) -> Result<Sim, String> {
        let mut scene = self.scene.as_ref().map_or_else(Scene::table, Scene::file);
        if self.hand {
            scene = scene.with_hand();
        }
        let arm = MujocoArm::new(self.robot.into(), scene).map_err(|error| error.to_string())?;
        Ok(sim.plant(arm))
    }

    #[cfg(not(feature = "mujoco"))]
    fn with_mujoco(&self, _: Sim) -> Result<Sim, String> {
        Err("this program was built without MuJoCo: run `cargo xtask mujoco` once, then build it with \
             `--features mujoco`"
            .into())
    }
}

/// `N` finite numbers, separated by commas.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let values = text
        .split(',')
        .map(|number| number.trim().parse::<f64>().map_err(|e| e.to_string()))
        .collect::<Result<Vec<_>, _>>()?;
    if !values.iter().all(|value| value.is_finite()) {
        return Err("every number has to be finite".into());
    }
    let count = values.len();
    values
        .try_into()
        .map_err(|_| format!("{N} numbers expected, {count} given"))
}

/// The width of an object that fits between the fingers.
fn object_width(text: &str) -> Result<f64, String> {
    let [width] = numbers::<1>(text)?;
    if Fingers::new().place_object(width) {
        Ok(width)
    } else {
        Err(format!("between 0 and {} m fit", Fingers::STROKE))
    }
}

/// A factor that leaves something.
fn factor(text: &str) -> Result<f64, String> {
    let [factor] = numbers::<1>(text)?;
    if factor <= 0.0 {
        return Err("a factor is positive".into());
    }
    Ok(factor)
}

/// A mass that a load can have.
fn mass(text: &str) -> Result<f64, String> {
    let [mass] = numbers::<1>(text)?;
    if mass < 0.0 {
        return Err("a mass is not negative".into());
    }
    Ok(mass)
}

#[tokio::main(flavor = "current_thread")]
async fn main() -> ExitCode {
    tracing_subscriber::fmt()
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false)
        .init();
    let arguments = Arguments::parse();
    match run(&arguments).await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("franka-sim: {error}");
            ExitCode::FAILURE
        }
    }
}

async fn run(arguments: &Arguments) -> std::io::Result<()> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let sim = arguments.sim().map_err(std::io::Error::other)?;
    let sim = sim.start().await.map_err(|error| {
        let kind = error.kind();
        std::io::Error::new(kind, format!("cannot listen on {error}"))
    })?;
    println!("listening on {}", sim.addr());
    if let Some(hand) = sim.hand() {
        println!("Franka Hand on {}", hand.addr());
    }
    if let Some(gripper) = sim.vacuum_gripper() {
        println!("vacuum gripper on {}", gripper.addr());
    }
    tokio::select! {
        _ = interrupt.recv() => {}
        _ = terminate.recv() => {}
        () = sim.ended() => return Err(std::io::Error::other("the simulation has ended")),
    }
    sim.stop().await;
    Ok(())
}

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
    fn arguments_become_the_configuration() {
        let arguments = parse(&["--q", "-1,0,0,-2,0,1.5,0", "--payload", "2", "--hand"]);
        let config = arguments.expect("valid").config();
        assert_eq!(config.q[0], -1.0);
        assert_eq!(config.payload.mass, 2.0);
        assert_eq!(config.payload.com.z, 0.05);
        assert_eq!(config.tool, Tool::hand());
        assert!(config.enforce_limits && config.enforce_communication);
        assert_eq!(config.joint_discontinuity_scale, 1.0);
        for (arguments, limits, communication) in [
            (&["--enforce-motion-limits=false"][..], false, true),
            (&["--enforce-motion-limits", "false"], false, true),
            (&["--enforce-motion-limits"], true, true),
            (&["--enforce-comm-constraints=false"], true, false),
            (&["--permissive"], false, false),
            (&["--joint-discontinuity-scale", "2.5"], true, true),
        ] {
            let config = parse(arguments).expect("valid").config();
            let enforced = (config.enforce_limits, config.enforce_communication);
            assert_eq!(enforced, (limits, communication), "{arguments:?}");
        }
        let config = parse(&["--joint-discontinuity-scale", "2.5"])
            .expect("valid")
            .config();
        assert_eq!(config.joint_discontinuity_scale, 2.5);
        assert_eq!(config.kind, RobotKind::Fr3);
        let config = parse(&["--robot", "fer"]).expect("valid").config();
        assert_eq!(config.kind, RobotKind::Fer);
    }

    #[test]
    fn every_network_but_the_perfect_one_does_something() {
        let network = |kind: &str| {
            let arguments = parse(&["--network", kind]).expect("valid");
            arguments.network.network(arguments.seed)
        };
        assert!(network("perfect").is_none());
        for kind in ["fer-stalls", "lossy", "bursts"] {
            let mut network = network(kind).expect("one");
            let perfect = Conditions::default();
            assert_ne!(*network.to_client.conditions(), perfect, "{kind}");
            let ms = std::time::Duration::from_millis;
            let mut late = 0;
            for n in 1..3000 {
                network.to_client.send(ms(n), &[0; 100]);
                late += i32::from(network.to_client.take(ms(n + 1)).is_none());
            }
            assert!(late > 0, "{kind}");
        }
    }

    #[test]
    fn a_plant_that_cannot_be_says_why() {
        let why = |arguments: &[&str]| parse(arguments).expect("valid").sim().map(drop);
        let error = why(&["--scene", "table.xml"]).expect_err("nothing is around a rigid arm");
        assert!(error.contains("--plant mujoco"), "{error}");
        let error = why(&["--plant", "mujoco", "--scene", "/no/such/file.xml"]);
        let error = error.expect_err("no such file");
        let expected = if cfg!(feature = "mujoco") {
            "/no/such/file.xml"
        } else {
            "--features mujoco"
        };
        assert!(error.contains(expected), "{error}");
        let object = [
            "--plant",
            "mujoco",
            "--hand",
            "--gripper-object-width",
            "0.04",
        ];
        assert!(why(&object).is_err());
    }

    #[test]
    fn a_model_library_is_that_of_the_file() {
        let file = std::env::temp_dir().join(format!("franka-sim-{}.so", std::process::id()));
        fs::write(&file, [7; 100]).expect("a temporary file");
        let path = file.to_str().expect("text");
        let library = |robot: &str, path: &str| {
            let arguments = ["--robot", robot, "--model-library", path];
            parse(&arguments).expect("valid").library()
        };
        assert_eq!(library("fer", path), Ok(Some(vec![7; 100].into())));
        let error = library("fr3", path).expect_err("it serves none");
        assert!(error.contains("--robot fer"), "{error}");
        let error = library("fer", "/no/such/file.so").expect_err("no such file");
        assert!(error.starts_with("/no/such/file.so: "), "{error}");
        fs::write(&file, vec![0; LIBRARY_MAX + 1]).expect("room for it");
        let error = library("fer", path).expect_err("too long");
        assert!(error.contains("too long"), "{error}");
        fs::remove_file(&file).expect("it is there");
    }

    #[test]
    fn what_makes_no_robot_is_refused() {
        assert!(parse(&["--virtual-time"]).is_ok());
        for wrong in [
            ["--virtual-time", "--realtime"],
            ["--virtual-time", "--strict-clock"],
            ["--q", "1,2"],
            ["--q", "nan,0,0,0,0,0,0"],
            ["--payload", "-1"],
            ["--payload-com", "0,0"],
            ["--joint-discontinuity-scale", "0"],
            ["--enforce-motion-limits", "maybe"],
            ["--gripper-object-width", "0.09"],
            ["--gripper-object-width", "nan"],
            ["--network", "carrier-pigeon"],
        ] {
            assert!(parse(&wrong).is_err(), "{wrong:?}");
        }
    }
}
