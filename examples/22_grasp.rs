//! Grasps an object between the fingers and reports its width.
//!
//! ```text
//! cargo run --release --example grasp -- WIDTH [ADDRESS] [--force 30] [--speed 0.05] \
//!     [--tolerance 0.005] [--no-homing]
//! ```
//! Exit code 0: an object of about WIDTH is held; 3: no object is held, and the fingers stopped at
//! the printed width; 1: the Hand was not reached or failed; 2: an error on the command line. The
//! object stays grasped when the program ends. No connection to the arm is needed.

use std::process::ExitCode;

use clap::Parser;
use franka_async::gripper::Grasp;
use franka_examples::Connection;

#[derive(Parser)]
#[command(after_help = "Exit code: 0 held, 3 nothing of that width, 1 the Hand failed.")]
struct Arguments {
    /// Width of the object, `[m]`. In the simulator without an address it is 0.03.
    width: f64,
    #[command(flatten)]
    connection: Connection,
    /// Force of the grasp, `[N]`.
    #[arg(long, default_value_t = 30.0)]
    force: f64,
    /// Speed of the fingers, `[m/s]`.
    #[arg(long, default_value_t = 0.05)]
    speed: f64,
    /// Tolerance of the object's width, `[m]`.
    #[arg(long, default_value_t = 0.005)]
    tolerance: f64,
    /// Skip homing, which moves the fingers through their range. The Hand must have been homed
    /// since power-on.
    #[arg(long)]
    no_homing: bool,
}

#[tokio::main]
async fn main() -> anyhow::Result<ExitCode> {
    let Arguments {
        width,
        connection,
        force,
        speed,
        tolerance,
        no_homing,
    } = Arguments::parse();
    let (gripper, _sim) = connection.open_hand().await?;
    connection.ask("moves its fingers, and grasps what is between them")?;
    if !no_homing {
        anyhow::ensure!(
            gripper.homing().await?,
            "the fingers did not find their ends"
        );
        println!(
            "homed: the fingers open to {:.1} mm",
            gripper.state().max_width * 1e3
        );
    }
    let grasp = Grasp {
        epsilon_inner: tolerance,
        epsilon_outer: tolerance,
        ..Grasp::new(width, speed, force)
    };
    let held = gripper.grasp(grasp).await?;
    let state = gripper.state();
    let (found, wanted) = (state.width * 1e3, width * 1e3);
    if held && state.is_grasped {
        println!("holds {found:.1} mm with {force} N");
        return Ok(ExitCode::SUCCESS);
    }
    println!("nothing of {wanted:.1} mm: the fingers stopped at {found:.1} mm");
    Ok(ExitCode::from(3))
}
