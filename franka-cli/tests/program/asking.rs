//! Questions before motions.

use franka_async::state::RobotMode;
use nix::sys::signal::Signal;

use crate::program::{Home, until};
use crate::simulated::Simulated;
use crate::terminal::Terminal;

/// Returns the arguments of a motion of the hand by 50 mm.
fn up(robot: &str) -> [&str; 6] {
    ["move", robot, "--by", "0,0,0.05", "--realtime", "ignore"]
}

#[test]
fn without_a_terminal_nothing_moves_unless_agreed_beforehand() {
    Simulated::each(|sim| {
        let (home, robot, before) = (Home::new(), sim.address(), sim.state().q);
        let texts = ["50 mm", "no terminal", "--yes"];
        home.run(&up(&robot)).failed(5, &texts);
        let guide = ["guide", &robot, "--realtime", "ignore"];
        home.run(&guide).failed(5, &["no terminal"]);
        let open = ["gripper", "close", &sim.hand()];
        home.run(&open)
            .failed(5, &["The fingers move from", "no terminal"]);
        near(sim.state().q, before);
    });
}

#[test]
fn a_question_names_what_will_move_how_far_and_how_fast() {
    Simulated::each(|sim| {
        let (home, robot, before) = (Home::new(), sim.address(), sim.state().q);
        let kind = if sim.with(|robot| robot.description().is_some()) {
            "FR3"
        } else {
            "FER"
        };
        for answer in ["n\n", "\n", "maybe\n"] {
            let mut terminal = Terminal::run(&home, &up(&robot));
            terminal.shows("[y/N]");
            for text in [kind, &robot, "deg", "50 mm away", "300 mm/s", "user stop"] {
                terminal.shows(text);
            }
            terminal.types(answer);
            let (code, shown) = terminal.ended();
            assert_eq!(code, Some(5), "{shown}");
            assert!(shown.contains("Nothing has moved"), "{shown}");
        }
        near(sim.state().q, before);
        let height = || sim.with(|robot| robot.true_pose().translation.z);
        let before = height();
        let mut terminal = Terminal::run(&home, &up(&robot));
        terminal.shows("[y/N]");
        terminal.types("y\n");
        let (code, shown) = terminal.ended();
        assert_eq!(code, Some(0), "{shown}");
        assert!((height() - before - 0.05).abs() < 0.01, "{shown}");
        sim.rests(RobotMode::Idle);
    });
}

#[test]
fn ctrl_c_at_a_question_moves_nothing() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let before = sim.state().q;
    let robot = sim.address();
    let terminal = Terminal::run(&home, &up(&robot));
    terminal.shows("[y/N]");
    terminal.signal(Signal::SIGINT);
    let (code, shown) = terminal.ended();
    assert_eq!(code, Some(130), "{shown}");
    assert!(shown.contains("Nothing has moved"), "{shown}");
    near(sim.state().q, before);
}

#[test]
fn an_arm_that_moves_while_somebody_reads_is_not_moved_as_said() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let robot = sim.address();
    let mut terminal = Terminal::run(&home, &up(&robot));
    terminal.shows("[y/N]");
    sim.with(|robot| {
        let mut q = *robot.q();
        q[0] += 0.1;
        robot.place(&q);
    });
    let placed = sim.state().message_id;
    until("a state from there", || sim.state().message_id > placed + 1);
    terminal.types("y\n");
    let (code, shown) = terminal.ended();
    assert_eq!(code, Some(4), "{shown}");
    assert!(shown.contains("joint 1 has moved from"), "{shown}");
}

/// Checks a position, with a tolerance for the noise of the sensors and the motion of the brakes.
#[track_caller]
fn near(q: [f64; 7], expected: [f64; 7]) {
    for (q, expected) in q.iter().zip(expected) {
        assert!((q - expected).abs() < 5e-3, "{q} instead of {expected}");
    }
}
