//! Robots for tests of the physics, of every kind and on every plant.

#[cfg(feature = "mujoco")]
use franka_sim::plant::{MujocoArm, Scene};

use crate::pair::*;
use franka_sim::config::Tool;

/// Returns a robot of every kind on every plant, with its client and a description. Robots in
/// MuJoCo stand on the table. If the tool is the Hand, the scene includes its body and fingers.
pub(crate) fn robots(config: &Config) -> Vec<(String, Pair)> {
    let mut robots = Vec::new();
    for kind in RobotKind::ALL {
        let config = Config {
            kind,
            ..config.clone()
        };
        #[cfg(feature = "mujoco")]
        {
            let mut scene = Scene::table();
            if config.tool == Tool::hand() {
                scene = scene.with_hand();
            }
            let arm = MujocoArm::new(kind, scene).expect("a scene");
            let robot = Robot::with_plant(config.clone(), Box::new(arm));
            robots.push((format!("{kind:?}, MuJoCo"), Pair::with(robot)));
        }
        robots.push((format!("{kind:?}, rigid"), Pair::new(config)));
    }
    robots
}

/// Like [`robots`], both with a bare flange and with a Hand.
pub(crate) fn robots_with_and_without_hand() -> Vec<(String, Pair)> {
    let tools = [("bare", Tool::NONE), ("Hand", Tool::hand())];
    let with = |(name, tool): (&str, Tool)| {
        let named = |(robot, pair)| (format!("{robot}, {name}"), pair);
        let config = Config {
            tool,
            ..Config::default()
        };
        robots(&config).into_iter().map(named).collect::<Vec<_>>()
    };
    tools.into_iter().flat_map(with).collect()
}
