//! Tool, collision, stop.

use franka_sim::Sim;

use crate::program::Home;
use crate::simulated::Simulated;

#[test]
fn a_load_and_an_end_effector_are_declared() {
    Simulated::each(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        let set = [
            "tool", "set", &robot, "--mass", "0.5", "--com", "0,0,0.05", "--frame", "0,0,0.1",
        ];
        let text = home.run(&set).done();
        assert!(text.contains("0.500 kg at 0.0, 0.0, 50.0 mm"), "{text}");
        let state = sim.state();
        assert!((state.m_load - 0.5).abs() < 1e-6 && (state.NE_T_EE[14] - 0.1).abs() < 1e-6);
        let none = ["tool", "set", &robot, "--mass", "0", "--json"];
        assert_eq!(home.run(&none).json()["m_load"], 0.0);
        home.run(&["tool", "set", &robot, "--mass", "-1"])
            .failed(2, &["0 or more"]);
    });
}

#[test]
fn an_arm_is_identified() {
    let (home, sim) = (Home::new(), Simulated::fast(Sim::fr3()));
    let robot = sim.address();
    let identify = [
        "tool",
        "identify",
        &robot,
        "--realtime",
        "ignore",
        "--save",
        "found.json",
    ];
    home.run(&identify).failed(5, &["mm away", "deg/s"]);
    let text = home.run(&[&identify[..], &["--yes"]].concat()).done();
    assert!(text.contains("load"), "{text}");
    let found = std::fs::read_to_string(home.path("found.json")).expect("saved");
    assert!(found.contains("joints"), "{found}");
    home.run(&[&identify[..], &["--yes"]].concat())
        .failed(6, &["already exists"]);
}

#[test]
fn thresholds_are_set_by_name() {
    Simulated::each(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        for (preset, force) in [
            ("careful", "10 N"),
            ("compliant", "60 N"),
            ("insensitive", "100 N"),
        ] {
            let text = home.run(&["collision", preset, &robot]).done();
            assert!(text.contains(force), "{text}");
        }
        home.run(&["collision", "brave", &robot])
            .failed(2, &["careful"]);
    });
}

#[test]
fn a_stop_says_that_nothing_moves() {
    Simulated::each(|sim| {
        let text = Home::new().run(&["stop", &sim.address()]).done();
        assert!(text.contains("no motion runs on the robot"), "{text}");
    });
}
