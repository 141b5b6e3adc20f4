//! Two arms at once from one program: both move to their ready pose, then swing in mirror image.
//! When the motion of one fails, the other stops.
//!
//! `cargo run --release --example two_robots -- [ADDRESS OTHER]`

use clap::Parser;
use franka_async::Robot;
use franka_async::control::{Control, Finish, JointPositions};
use franka_async::motion::StartBarrier;
use franka_examples::{Connection, Ease, Summary, make_ready};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Address of the other robot, which uses the same options; without it, the other robot is
    /// simulated too.
    #[arg(requires = "address")]
    other: Option<String>,
}

/// Duration of the motion there and back, `[s]`.
const DURATION: f64 = 4.0;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { connection, other } = Arguments::parse();
    let opposite = Connection {
        address: other,
        ..connection.clone()
    };
    let ((left, _sim), (right, _other)) = tokio::try_join!(connection.open(), opposite.open())?;
    connection.ask("and the other one go to their ready poses, and swing aside by 0.3 rad")?;
    tokio::try_join!(make_ready(&left), make_ready(&right))?;

    // Both begin within a millisecond, once both are ready. When one motion fails, `try_join` drops
    // the other, which stops its robot.
    let [first, second] = StartBarrier::new().tickets();
    let both = tokio::try_join!(
        swing(&left, 0.3).start_with(first),
        swing(&right, -0.3).start_with(second)
    );
    tokio::join!(left.shutdown(), right.shutdown());
    let (first, second) = both?;
    println!("one:   {}", Summary(&first));
    println!("other: {}", Summary(&second));
    Ok(())
}

/// Turns the first joint by `angle` `[rad]` and back.
fn swing(robot: &Robot, angle: f64) -> Control {
    let (mut time, mut start) = (0.0, None);
    let control = robot.control_joint_positions(move |state, step| {
        time += step.as_secs_f64();
        let mut q = *start.get_or_insert(state.q_d);
        q[0] += angle * Ease::there_and_back(DURATION, time).value;
        JointPositions(q).finish_if(time >= DURATION)
    });
    control.limit_rate(true)
}
