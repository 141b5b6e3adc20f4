//! Creates the robot, the plant (the physics), the grippers and the network that the options
//! describe.

use std::fmt::Display;
use std::fs;
use std::net::SocketAddr;

use bytes::Bytes;
use franka_model::limits::JointLimits;
use franka_model::{JointVector, Load, RobotKind};
use nalgebra::{Matrix3, Vector3};

use super::arguments::{Arguments, GeometryKind, Kind, KinematicErrorKind, NetworkKind, PlantKind};
use crate::arm::{Arm, Family, Sensors, StateGeometry};
use crate::network::{BurstLoss, Conditions, Loss};
#[cfg(feature = "mujoco")]
use crate::plant::{MujocoArm, Scene};
use crate::{Config, Fingers, Network, Sim, Suction, Tool};

impl Arguments {
    fn config(&self) -> Result<Config, String> {
        let kind = self.robot.into();
        let mut arm = self.arm(kind)?;
        match (self.limits, self.robot) {
            (Some(_), Kind::Fer) => return Err("--limits needs --robot fr3".into()),
            (limits, _) => arm.limits = limits.map_or(arm.limits, Into::into),
        }
        let limits = arm.limits.joints(kind);
        if let Some(geometry) = self.state_geometry {
            arm.body.state_geometry = match geometry {
                GeometryKind::Described => StateGeometry::DESCRIBED,
                GeometryKind::Recorded => StateGeometry::RECORDED_FR3,
                GeometryKind::Random => StateGeometry::random(self.seed),
            };
        }
        if let Some(error) = self.kinematic_error {
            let other = match error {
                KinematicErrorKind::None => Arm::ideal(kind),
                KinematicErrorKind::Random => Arm::sample(kind, self.seed, &Family::realistic()),
            };
            arm.body.kinematic_error = other.body.kinematic_error;
        }
        if self.noise {
            arm.sensors = Sensors {
                torque_offset: arm.sensors.torque_offset,
                motor_offset: arm.sensors.motor_offset,
                ..Sensors::NOISY
            };
        }
        let mut config = Config {
            kind,
            arm: Some(arm),
            seed: self.seed,
            enforce_limits: self.enforce_motion_limits && !self.permissive,
            joint_discontinuity_scale: self.joint_discontinuity_scale,
            enforce_communication: self.enforce_comm_constraints && !self.permissive,
            ..Config::default()
        };
        if let Some(q) = self.q {
            config.q = possible(limits, q.into())?;
        }
        if self.hand {
            config.tool = Tool::hand();
        }
        if self.payload > 0.0 {
            config.payload = Load {
                mass: self.payload,
                com: Vector3::from(self.payload_com),
                inertia: Matrix3::zeros(),
            };
        }
        Ok(config)
    }

    fn arm(&self, kind: RobotKind) -> Result<Arm, String> {
        let family = match self.arm.as_str() {
            "ideal" if self.arm_seed.is_some() => {
                return Err(
                    "--arm-seed needs a family of arms, but --arm ideal is a single arm".into(),
                );
            }
            "ideal" => return Ok(Arm::ideal(kind)),
            "nominal" => Family::nominal(),
            "realistic" => Family::realistic(),
            "bad" => Family::bad(),
            path => {
                let failed = |error: &dyn Display| format!("{path}: {error}");
                let text = fs::read_to_string(path).map_err(|error| {
                    format!(
                        "{}; --arm takes ideal, nominal, realistic, bad, or a JSON file",
                        failed(&error)
                    )
                })?;
                Family::from_json(&text).map_err(|error| failed(&error))?
            }
        };
        Ok(match self.arm_seed {
            Some(seed) => Arm::sample(kind, seed, &family),
            None => Arm::central(kind, &family),
        })
    }

    /// Returns the robot that the options describe. The caller must start it.
    ///
    /// # Errors
    /// Returns a text that names the invalid option and the reason.
    pub fn sim(&self) -> Result<Sim, String> {
        let mut config = self.config()?;
        config.model_library = self.library()?;
        let sim = Sim::new(config)
            .bind(SocketAddr::new(self.bind, self.port))
            .realtime(self.realtime)
            .strict_clock(self.strict_clock);
        let sim = match (self.virtual_time, self.wait_for_commands) {
            (Some(patience), _) => sim.virtual_time(patience),
            (None, Some(patience)) => sim.wait_for_commands(patience),
            (None, None) => sim,
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
        // Port 0 selects a free port. If the number exceeds the last port, use a free port, too.
        let beside = |n| match self.port {
            0 => 0,
            port => port.checked_add(n).unwrap_or(0),
        };
        Ok(sim
            .hand(fingers, beside(1))
            .vacuum_gripper(suction, beside(2)))
    }

    fn library(&self) -> Result<Option<Bytes>, String> {
        let Some(path) = &self.model_library else {
            return Ok(None);
        };
        if let Kind::Fr3 = self.robot {
            return Err(
                "a model library needs --robot fer: an FR3 sends a description (URDF) \
                instead"
                    .into(),
            );
        }
        let library = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        if library.len() > LIBRARY_MAX {
            return Err(format!(
                "{}: the model library has {} bytes, expected {LIBRARY_MAX} at most",
                path.display(),
                library.len()
            ));
        }
        Ok(Some(library.into()))
    }

    fn with_plant(&self, sim: Sim) -> Result<Sim, String> {
        match self.plant {
            PlantKind::Rigid if self.scene.is_some() => Err(
                "a scene needs --plant mujoco: the default plant (physics engine) has no \
                    objects around the arm"
                    .into(),
            ),
            PlantKind::Rigid => Ok(sim),
            PlantKind::Mujoco if self.hand && self.gripper_object_width.is_some() => Err(
                "with --plant mujoco, the fingers grasp objects of the scene: leave out \
                 --gripper-object-width"
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

/// Size of the longest model library that fits into a message.
const LIBRARY_MAX: usize = franka_proto::framing::MAX_MESSAGE_SIZE - 64;

/// Returns the joint positions, or an error if the joints cannot reach them.
fn possible(limits: &JointLimits, q: JointVector) -> Result<JointVector, String> {
    match limits.outside_hard(&q) {
        None => Ok(q),
        Some(i) => Err(format!(
            "joint {} of --q is {} rad, expected {} to {}",
            i + 1,
            q[i],
            limits.hard_lower[i],
            limits.hard_upper[i]
        )),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use clap::Parser as _;

    use super::*;
    use crate::arm::{Body, SystemLimits};

    fn parsed(arguments: &[&str]) -> Arguments {
        Arguments::try_parse_from([&["franka-sim"], arguments].concat()).expect("valid")
    }

    #[test]
    fn joints_are_where_they_can_be() {
        let error = parsed(&["--q", "0,0,0,-2,0,9,0"]).config();
        let error = error.expect_err("out of range");
        assert!(error.contains("joint 6 of --q is 9 rad"), "{error}");
    }

    #[test]
    fn limits_are_those_of_the_system() {
        let q = ["--q", "2.9,0,0,-2,0,1.5,0"];
        let before = ["--limits", "before-5.9"];
        let config = parsed(&q).config().expect("within the range of 5.9");
        assert_eq!(config.arm.expect("one").limits, SystemLimits::From5_9);
        let config = parsed(&before).config().expect("an arm");
        assert_eq!(config.arm.expect("one").limits, SystemLimits::Before5_9);
        let error = parsed(&[q, before].concat()).config();
        let error = error.expect_err("out of range");
        assert!(error.contains("-2.7501 to 2.7501"), "{error}");
        let error = parsed(&["--robot", "fer", "--limits", "5.9"]).config();
        assert!(error.expect_err("one table").contains("--robot fr3"));
    }

    #[test]
    fn the_geometry_of_the_states_is_the_arms_or_the_chosen_one() {
        let geometry = |arguments: &[&str]| {
            let config = parsed(arguments).config().expect("an arm");
            config.arm.expect("one").body.state_geometry
        };
        let described = StateGeometry::DESCRIBED;
        let recorded = StateGeometry::RECORDED_FR3;
        for (arguments, expected) in [
            (&[][..], recorded),
            (&["--arm-seed", "7"], recorded),
            (&["--arm", "bad"], recorded),
            (&["--arm", "ideal"], described),
            (&["--robot", "fer"], described),
        ] {
            assert_eq!(geometry(arguments), expected, "{arguments:?}");
        }
        for (name, expected) in [
            ("described", described),
            ("recorded", recorded),
            ("random", StateGeometry::random(3)),
        ] {
            let chosen = geometry(&["--state-geometry", name, "--seed", "3"]);
            assert_eq!(chosen, expected, "{name}");
        }
    }

    #[test]
    fn the_kinematic_error_is_the_arms_or_the_chosen_one() {
        let body = |arguments: &[&str]| {
            let config = parsed(arguments).config().expect("an arm");
            config.arm.expect("one").body
        };
        let none = Arm::ideal(RobotKind::Fr3).body.kinematic_error;
        let drawn = |seed| Arm::sample(RobotKind::Fr3, seed, &Family::realistic()).body;
        let seventh = ["--arm-seed", "7", "--seed", "3"];
        let chosen = |name| body(&[&seventh[..], &["--kinematic-error", name]].concat());
        for (got, expected) in [
            (body(&[]), none),
            (body(&seventh), drawn(7).kinematic_error),
            (chosen("none"), none),
            (chosen("random"), drawn(3).kinematic_error),
        ] {
            assert_eq!(got.kinematic_error, expected);
        }
        assert_ne!(drawn(3).kinematic_error, none);
        // The two errors are independent: the rest of the body is the arm's.
        let only = Body {
            kinematic_error: drawn(3).kinematic_error,
            ..drawn(7)
        };
        assert_eq!(chosen("random"), only);
    }

    #[test]
    fn arguments_become_the_configuration() {
        let arguments = parsed(&["--q", "-1,0,0,-2,0,1.5,0", "--payload", "2", "--hand"]);
        let config = arguments.config().expect("an arm");
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
            let config = parsed(arguments).config().expect("an arm");
            let enforced = (config.enforce_limits, config.enforce_communication);
            assert_eq!(enforced, (limits, communication), "{arguments:?}");
        }
        let config = parsed(&["--joint-discontinuity-scale", "2.5"])
            .config()
            .expect("an arm");
        assert_eq!(config.joint_discontinuity_scale, 2.5);
        assert_eq!(config.kind, RobotKind::Fr3);
        let config = parsed(&["--robot", "fer"]).config().expect("an arm");
        assert_eq!(config.kind, RobotKind::Fer);
    }

    #[test]
    fn an_arm_is_one_of_a_family_or_says_why_there_is_none() {
        let arm = |arguments: &[&str]| parsed(arguments).arm(RobotKind::Fer);
        let family = Family::realistic();
        assert_eq!(arm(&[]), Ok(Arm::realistic(RobotKind::Fer)));
        assert_eq!(arm(&["--arm", "bad"]), Ok(Arm::bad(RobotKind::Fer)));
        let sampled = arm(&["--arm", "realistic", "--arm-seed", "3"]);
        assert_eq!(sampled, Ok(Arm::sample(RobotKind::Fer, 3, &family)));
        let error = arm(&["--arm", "ideal", "--arm-seed", "3"]).expect_err("one arm");
        assert!(error.contains("needs a family"), "{error}");
        let error = arm(&["--arm", "/no/such.json"]).expect_err("no such file");
        assert!(
            error.starts_with("/no/such.json: ") && error.contains("realistic"),
            "{error}"
        );

        let file = std::env::temp_dir().join(format!("franka-sim-{}.json", std::process::id()));
        let path = file.to_str().expect("text");
        fs::write(&file, family.to_json()).expect("a temporary file");
        assert_eq!(arm(&["--arm", path]), Ok(Arm::realistic(RobotKind::Fer)));
        let noisy = parsed(&["--arm", path, "--noise"])
            .config()
            .expect("an arm");
        let noise = noisy.arm.expect("one").sensors.torque_noise_at_rest;
        assert_eq!(noise, Sensors::NOISY.torque_noise_at_rest);
        fs::write(&file, family.to_json().replace("torque_lag", "lag")).expect("as before");
        let error = arm(&["--arm", path]).expect_err("an unknown field");
        assert!(
            error.starts_with(path) && error.contains("unknown field `lag`"),
            "{error}"
        );
        fs::remove_file(&file).expect("it is there");
    }

    #[test]
    fn every_network_but_the_perfect_one_does_something() {
        let network = |kind: &str| {
            let arguments = parsed(&["--network", kind]);
            arguments.network.network(arguments.seed)
        };
        assert!(network("perfect").is_none());
        for kind in ["fer-stalls", "lossy", "bursts"] {
            let mut network = network(kind).expect("one");
            let perfect = Conditions::default();
            assert_ne!(*network.to_client.conditions(), perfect, "{kind}");
            let ms = Duration::from_millis;
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
        let why = |arguments: &[&str]| parsed(arguments).sim().map(drop);
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
            parsed(&arguments).library()
        };
        assert_eq!(library("fer", path), Ok(Some(vec![7; 100].into())));
        let error = library("fr3", path).expect_err("it serves none");
        assert!(error.contains("--robot fer"), "{error}");
        let error = library("fer", "/no/such/file.so").expect_err("no such file");
        assert!(error.starts_with("/no/such/file.so: "), "{error}");
        fs::write(&file, vec![0; LIBRARY_MAX + 1]).expect("room for it");
        let error = library("fer", path).expect_err("too long");
        assert!(
            error.contains("the model library has 8388545 bytes, expected"),
            "{error}"
        );
        fs::remove_file(&file).expect("it is there");
    }
}
