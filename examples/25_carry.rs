//! Two arms that face each other carry one bar, then put it back. When one of them must stop, the
//! other stops too.
//!
//! `cargo run --release --features mujoco --example carry`
//!
//! Both arms are simulated, in one MuJoCo world. Real robots would first grasp the bar, and the
//! positions of their bases would have been measured.

use std::time::Duration;

use clap::Parser;
use franka_async::error::ConnectError;
use franka_async::model::{EndEffector, Frame, Model, RobotKind};
use franka_async::team::Team;
use franka_async::{Engage, Pose, Realtime, Robot};
use franka_async::{READY, pose};
use franka_examples::Summary;
use franka_sim::plant::{Mount, Scene, shared_world};
use franka_sim::{Running, Sim};
use nalgebra::{Translation3, UnitQuaternion};

#[derive(Parser)]
struct Arguments {
    /// Speed, as a share of the default limits.
    #[arg(long, default_value_t = 0.7)]
    speed: f64,
    /// Largest force with which each arm presses or pulls, `[N]`.
    #[arg(long, default_value_t = 20.0)]
    force_cap: f64,
}

/// Distance of the bases, `[m]`.
const APART: f64 = 1.2;

/// Time for which a simulator and the team wait on a busy machine.
const PATIENCE: Duration = Duration::from_secs(1);

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { speed, force_cap } = Arguments::parse();
    let bases = [
        Pose::identity(),
        Pose::from_parts(
            Translation3::new(APART, 0.0, 0.0),
            UnitQuaternion::from_euler_angles(0.0, 0.0, std::f64::consts::PI),
        ),
    ];
    let hand =
        pose::from_matrix(&Model::fr3().pose(Frame::EndEffector, &READY, &EndEffector::default()));
    let hand = hand.expect("the model's poses are rigid");
    // Halfway between the hands.
    let bar = Pose::translation(APART / 2.0, 0.0, hand.translation.z);

    // A separate simulator for each arm. Their world keeps them in step.
    let arms = shared_world(scene(&bases, &hand, &bar), mounts(&bases))?;
    let sims = arms.map(|arm| Sim::fr3().plant(arm).wait_for_commands(PATIENCE));
    let [left, right] = Sim::in_step(sims);
    let (one, other) = tokio::try_join!(left.start(), right.start())?;
    let (left, right) = tokio::try_join!(connected(&one), connected(&other))?;
    let members = [(&left, Engage::default()), (&right, Engage::default())];
    // For real robots use `Team::engage`, for which 20 ms without a state are a fault.
    let team = Team::engage_tolerating(PATIENCE, members).await?;
    let grasp = team.grasp(bases, bar)?;
    let turned = UnitQuaternion::from_euler_angles(0.0, 0.1, 0.2);
    let up = Pose::from_parts(Translation3::new(APART / 2.0, 0.05, 0.7), turned);
    for (what, to) in [("up", up), ("back", bar)] {
        let carrying = grasp.move_with(to, |motion| motion.speed(speed).force_cap(force_cap));
        // One outcome for each arm: if one failed, the other names it.
        let [one, other] = carrying.await;
        println!("{what}, one arm:   {}", Summary(&one?));
        println!("{what}, the other: {}", Summary(&other?));
        let [one, other] = grasp.measured().map(|bar| {
            let off = bar.translation.vector - to.translation.vector;
            off.norm() * 1e3
        });
        println!("{what}: the bar is off by {one:.1} mm and {other:.1} mm, by the joints of each");
    }
    for ended in team.disengage().await {
        ended?;
    }
    tokio::join!(left.shutdown(), right.shutdown());
    Ok(())
}

async fn connected(sim: &Running) -> Result<Robot, ConnectError> {
    let robot = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    robot.connect().await
}

fn mounts([left, right]: &[Pose; 2]) -> [Mount; 2] {
    [("left", left), ("right", right)].map(|(name, base)| Mount {
        kind: RobotKind::Fr3,
        name: name.into(),
        base: *base,
    })
}

/// Returns a bar whose ends are held by the flanges.
fn scene(bases: &[Pose; 2], hand: &Pose, bar: &Pose) -> Scene {
    let half = APART / 2.0 - hand.translation.x;
    let [left, right] = [(bases[0], -half), (bases[1], half)].map(|(base, end)| {
        let end = bar * Translation3::new(end, 0.0, 0.0);
        let Pose {
            rotation: r,
            translation: p,
        } = (base * hand).inverse() * end;
        format!("{} {} {} {} {} {} {}", p.x, p.y, p.z, r.w, r.i, r.j, r.k)
    });
    let (x, z) = (bar.translation.x, bar.translation.z);
    Scene::mjcf(format!(
        "<mujoco><worldbody><body name='bar' pos='{x} 0 {z}'><freejoint/>
           <geom type='box' size='{half} 0.01 0.01' mass='0.6' contype='0' conaffinity='0'/>
           <body name='left_end' pos='-{half} 0 0'/><body name='right_end' pos='{half} 0 0'/>
         </body></worldbody><equality>
           <weld body1='left_flange' body2='left_end' relpose='{left}' solref='0.01 1'/>
           <weld body1='right_flange' body2='right_end' relpose='{right}' solref='0.01 1'/>
         </equality></mujoco>"
    ))
}
