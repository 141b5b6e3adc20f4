//! Commands over a network that delays like a cable.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use franka_async::control::{Finish as _, Torques};
use franka_sim::network::Conditions;
use franka_sim::{Network, Sim};

use crate::{alone, by_the_clock};

/// An answer may be on its way when the next cycle is due: it is waited for as well.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn command_behind_a_cable_is_never_lost_if_waited_for() {
    let _alone = alone();
    let cable = Network::new(1, Conditions::cable(), Conditions::cable());
    let (robot, _sim) = by_the_clock(Sim::fer().ideal().network(cable)).await;
    let mut cycles = 0;
    let least = Arc::new(Mutex::new(1.0_f64));
    let noted = Arc::clone(&least);
    let motion = robot.control_torques(move |state, _| {
        cycles += 1;
        std::thread::sleep(Duration::from_micros(100) * (cycles % 12));
        // The first commands may have been late; the rate covers the last 100 ms.
        if cycles > 200 {
            let mut least = noted.lock().expect("no panic");
            *least = least.min(state.control_command_success_rate);
        }
        Torques([0.0; 7]).finish_if(cycles >= 2000)
    });
    motion.await.expect("the robot has all commands");
    robot.shutdown().await;
    let least = *least.lock().expect("no panic");
    assert_eq!(least, 1.0);
}
