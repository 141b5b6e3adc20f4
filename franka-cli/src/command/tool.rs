//! `franka tool`: declares or measures the load at the flange.

use std::fs::File;
use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, Subcommand};
use franka_async::identify::Identified;
use franka_async::settings::Load;
use franka_sim::command_line::numbers;
use serde_json::json;

use crate::connection::{Which, check_ready};
use crate::ending::{Ending, Failure};
use crate::motion::{Length, Mover, Moving};
use crate::output::{Output, say};
use crate::values::{PartialPose, partial_pose};

/// Declare or measure the load at the flange
#[derive(Debug, Subcommand)]
pub(crate) enum Tool {
    #[command(after_help = "Example: franka tool set left --mass 0.4 --com 0,0,0.05")]
    Set(Set),
    #[command(after_help = "Example: franka tool identify left --save load.json")]
    Identify(Identify),
}

/// Declare the load or the end effector
///
/// Applies until it is declared again or the robot restarts.
#[derive(Debug, Args)]
#[group(id = "what", required = true, multiple = true, args = ["mass", "frame"])]
pub(crate) struct Set {
    #[command(flatten)]
    which: Which,
    /// Mass of the load beyond the end effector in kg; 0 for none
    #[arg(long, value_name = "KG", value_parser = not_negative, allow_hyphen_values = true)]
    mass: Option<f64>,
    /// Centre of mass in the flange frame, in metres
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, requires = "mass", allow_hyphen_values = true)]
    com: Option<[f64; 3]>,
    /// Inertia about the centre of mass in kg m2: xx,yy,zz,xy,xz,yz
    #[arg(long, value_name = "I1,...,I6", value_parser = numbers::<6>, requires = "mass", allow_hyphen_values = true)]
    inertia: Option<[f64; 6]>,
    /// Pose of the end effector in the nominal end-effector frame: x,y,z, x,y,z,roll,pitch,yaw
    /// (degrees), or x,y,z,qx,qy,qz,qw
    #[arg(long, value_name = "POSE", value_parser = partial_pose, allow_hyphen_values = true)]
    frame: Option<PartialPose>,
    #[command(flatten)]
    output: Output,
}

/// Measure load, friction and sensor bias with a minute of small motions
///
/// The arm moves around its present position. Shows how far, and asks. Ctrl-C brakes.
#[derive(Debug, Args)]
pub(crate) struct Identify {
    #[command(flatten)]
    mover: Mover,
    /// Write the results to a JSON file
    #[arg(long, value_name = "FILE.json")]
    save: Option<PathBuf>,
}

fn not_negative(text: &str) -> Result<f64, String> {
    let [value] = numbers::<1>(text)?;
    match value >= 0.0 {
        true => Ok(value),
        false => Err(format!("got {value}, expected 0 or more")),
    }
}

impl Tool {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        match self {
            Self::Set(set) => set.run().await,
            Self::Identify(identify) => identify.run().await,
        }
    }
}

impl Set {
    async fn run(self) -> anyhow::Result<Ending> {
        let (robot, place) = self.which.connect().await?;
        let outcome = async {
            check_ready(&robot.state(), &place)?;
            if let Some(m_load) = self.mass {
                let [xx, yy, zz, xy, xz, yz] = self.inertia.unwrap_or_default();
                let load = Load {
                    m_load,
                    F_x_Cload: self.com.unwrap_or_default(),
                    I_load: [xx, xy, xz, xy, yy, yz, xz, yz, zz],
                };
                robot.set_load(load).await?;
            }
            if let Some(frame) = self.frame {
                robot.set_ee(frame.complete(&Default::default())).await?;
            }
            anyhow::Ok(())
        };
        let outcome = outcome.await;
        // The states show the change a few cycles later.
        tokio::time::sleep(std::time::Duration::from_millis(50)).await;
        let state = robot.state();
        robot.shutdown().await;
        outcome?;
        let value = json!({
            "m_load": state.m_load,
            "F_x_Cload": state.F_x_Cload,
            "I_load": state.I_load,
            "F_T_EE": state.F_T_EE,
        });
        self.output.print(&value, || {
            let [x, y, z] = state.F_x_Cload.map(|metres| metres * 1e3);
            let [ex, ey, ez] = [12, 13, 14].map(|index| state.F_T_EE[index] * 1e3);
            format!(
                "declared load {:.3} kg at {x:.1}, {y:.1}, {z:.1} mm\nend effector at {ex:.1}, {ey:.1}, {ez:.1} mm from the flange",
                state.m_load
            )
        })
    }
}

impl Identify {
    async fn run(self) -> anyhow::Result<Ending> {
        let moving = self.mover.begin().await?;
        let outcome = self.identify(&moving).await;
        let found = moving.end(outcome).await?;
        if let Some(path) = &self.save {
            let text = serde_json::to_string_pretty(&found)?;
            let written =
                File::create_new(path).and_then(|mut file| file.write_all(text.as_bytes()));
            written.with_context(|| format!("writing {}", path.display()))?;
            say(&format!("in {}", path.display()));
        }
        self.mover.how.output.print(&found, || found.to_string())
    }

    async fn identify(&self, moving: &Moving) -> anyhow::Result<Identified> {
        if let Some(path) = &self.save
            && path.exists()
        {
            let message = format!("{} already exists: choose another name", path.display());
            return Err(Failure::new(Ending::Host, message).into());
        }
        let identify = moving.robot.identify();
        let reach = identify.reach();
        let what = format!(
            "{} motions around the current position, {:.0?} in total.\n\
             hand  up to {:.0} mm away, up to {:.0} mm down\n\
             speed at most 12 deg/s for each joint",
            identify.motions().len(),
            identify.duration(),
            reach.end_effector * 1e3,
            reach.down * 1e3
        );
        moving.ask("identify", &what).await?;
        let length = Some(Length::About(identify.duration()));
        moving.drive(identify.run(), length).await
    }
}
