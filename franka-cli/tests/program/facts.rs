//! Commands that print results.

use crate::program::Home;
use crate::simulated::Simulated;
use crate::terminal::Terminal;

#[test]
fn the_state_is_printed_as_text_and_as_json() {
    Simulated::each(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        let text = home.run(&["state", &robot]).done();
        assert!(text.contains("idle") && text.contains("link"), "{text}");
        assert_eq!(text.matches('●').count(), 7, "{text}");
        let width = text.lines().map(|line| line.chars().count()).max();
        assert!(width <= Some(80), "{width:?}: {text}");
        assert!(!text.contains('\x1b'), "no colours in a pipe: {text:?}");
        let json = home.run(&["state", &robot, "--json"]).json();
        assert_eq!(json["state"]["robot_mode"], "Idle");
        let q = json["state"]["q"].as_array().expect("positions");
        for (printed, q) in q.iter().zip(sim.state().q) {
            assert!((printed.as_f64().expect("a number") - q).abs() < 1e-2);
        }
    });
}

#[test]
fn colours_follow_the_rules_of_no_color() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let state = |variable: &str| {
        let mut command = home.command(&["state", &sim.address()]);
        let output = command.env(variable, "1").output().expect("it runs");
        String::from_utf8(output.stdout).expect("text")
    };
    assert!(state("CLICOLOR_FORCE").contains('\x1b'));
    assert!(!state("NO_COLOR").contains('\x1b'));
    let mut command = home.command(&["state", &sim.address(), "--color=always"]);
    let output = command.env("NO_COLOR", "1").output().expect("it runs");
    assert!(output.stdout.contains(&b'\x1b'));
}

#[test]
fn logs_have_the_levels_of_flags_and_of_rust_log() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let address = sim.address();
    let log = |option: Option<&str>, variable: &str| {
        let mut command = home.command(&["state", &address]);
        let command = command.args(option).env("RUST_LOG", variable);
        let output = command.output().expect("it runs");
        String::from_utf8(output.stderr).expect("text")
    };
    assert_eq!(log(None, ""), "");
    for option in ["-v", "-vv"] {
        assert!(log(Some(option), "").contains("INFO"));
    }
    assert!(log(None, "franka_async=info").contains("INFO"));
    assert_eq!(log(Some("-v"), "nothing=info"), "");
    let note = "note: RUST_LOG=a=b=c is ignored: ";
    assert!(log(None, "a=b=c").starts_with(note));
}

#[test]
fn colours_of_logs_follow_the_rules_of_no_color() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let arguments = ["state", &sim.address(), "-v"];
    let mut forced = home.command(&arguments);
    let forced = forced.env("CLICOLOR_FORCE", "1").output();
    let log = String::from_utf8(forced.expect("it runs").stderr).expect("text");
    assert!(log.contains("INFO") && log.contains('\x1b'), "{log:?}");
    let (_, shown) = Terminal::run(&home, &arguments).ended();
    assert!(log_lines(&shown).contains('\x1b'), "{shown:?}");
    let (_, shown) = Terminal::with(&home, &arguments, &[("NO_COLOR", "1")]).ended();
    assert!(!log_lines(&shown).contains('\x1b'), "{shown:?}");
}

/// Returns the lines of a log, by their level.
fn log_lines(shown: &str) -> String {
    let lines = shown.lines().filter(|line| line.contains("INFO"));
    let lines = lines.collect::<Vec<_>>().join("\n");
    assert!(!lines.is_empty(), "{shown:?}");
    lines
}

#[test]
fn fields_are_read_by_name() {
    Simulated::each(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        let text = home.run(&["read", &robot, "robot_mode", "m_ee"]).done();
        assert_eq!(text.lines().next(), Some("robot_mode = \"Idle\""), "{text}");
        let json = home.run(&["read", &robot, "q", "--json"]).json();
        assert_eq!(json["q"].as_array().map(Vec::len), Some(7));
        let unknown = home.run(&["read", &robot, "qq"]);
        unknown.failed(2, &["no field `qq`", "--list"]);
    });
    let list = Home::new().run(&["read", "--list"]).done();
    assert!(list.lines().any(|line| line == "O_T_EE"), "{list}");
}

#[test]
fn the_model_computes_with_the_robot_and_without() {
    let home = Home::new();
    let json = home.run(&[
        "model", "pose", "--kind", "fr3", "--frame", "flange", "--json",
    ]);
    let height = json.json()["position"][2].as_f64().expect("metres");
    assert!((height - 0.590_282).abs() < 1e-6, "{height}");
    let mass = home
        .run(&["model", "mass", "--kind", "fer", "--json"])
        .json();
    assert!(mass["mass"][0][0].as_f64().expect("kg m2") > 0.0);
    let jacobian = home.run(&["model", "jacobian", "--kind", "fr3"]).done();
    assert_eq!(jacobian.lines().count(), 7);
    assert!(jacobian.trim_end().ends_with(" rad/rad"), "{jacobian}");
    let far = home.run(&["model", "ik", "--kind", "fr3", "--pose", "2,0,0"]);
    far.failed(1, &["out of reach"]);
    Simulated::each(|sim| {
        let robot = sim.address();
        let arguments = ["model", "ik", &robot, "--pose", "0.4,0.1,0.4", "--json"];
        let q = home.run(&arguments).json()["q"].to_string();
        let q = q.trim_matches(['[', ']']);
        let arguments = ["model", "pose", &robot, "--q", q, "--json"];
        let pose = home.run(&arguments).json();
        for (got, wanted) in [(0, 0.4), (1, 0.1), (2, 0.4)] {
            let got = pose["position"][got].as_f64().expect("metres");
            assert!((got - wanted).abs() < 1e-6, "{pose}");
        }
    });
}

#[test]
fn limits_are_those_of_the_robot_or_of_its_kind() {
    let home = Home::new();
    let [fr3, fer] =
        ["fr3", "fer"].map(|kind| home.run(&["limits", "--kind", kind, "--json"]).json());
    assert_ne!(fr3["joints"]["upper"], fer["joints"]["upper"]);
    Simulated::each(|sim| {
        let told = home.run(&["limits", &sim.address(), "--json"]).json();
        let published = if told["kind"] == "FR3" { &fr3 } else { &fer };
        assert_eq!(told["joints"]["velocity"], published["joints"]["velocity"]);
    });
    let text = home.run(&["limits", "--kind", "fer"]).done();
    assert!(text.contains("FER (Panda)"), "{text}");
}

#[test]
fn wrong_arguments_are_told_with_code_2() {
    let home = Home::new();
    for (arguments, text) in [
        (&["dance"][..], "dance"),
        (&["state"], "got no robot, expected"),
        (&["state", "a b"], "not a host name"),
        (&["state", "x", "--rate", "5"], "--watch"),
        (&["state", "x", "--watch", "--rate", "1000"], "0.1 to 100"),
        (&["state", "x", "--watch"], "--json"),
        (
            &["model", "pose", "--kind", "fr3", "--q", "1,2"],
            "got 2 numbers, expected 7",
        ),
        (
            &["model", "ik", "--kind", "fr3", "--pose", "1"],
            "expected x,y,z",
        ),
        (&["move", "x"], "--ready"),
        (&["move", "x", "--ready", "--by", "0,0,1"], "cannot be used"),
        (&["move", "x", "--ready", "--speed", "0"], "more than 0"),
        (&["tool", "set", "x"], "--mass"),
        (&["robots", "add", "q", "x"], "a field of the state"),
        (&["robots", "remove", "nobody"], "no robot `nobody`"),
        (&["sim", "--port", "99999"], "99999"),
    ] {
        home.run(arguments).failed(2, &[text]);
    }
}

#[test]
fn robots_have_names() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let (robot, hand) = (sim.address(), sim.hand());
    home.run(&["state"]).failed(2, &["robots add"]);
    let add = [
        "robots",
        "add",
        "left",
        &robot,
        "--realtime",
        "ignore",
        "--hand",
        &hand,
    ];
    home.run(&add).done();
    let list = home.run(&["robots", "list"]).done();
    assert!(
        list.contains("left") && list.contains(&robot) && list.contains(&hand),
        "{list}"
    );
    assert_eq!(
        home.run(&["robots", "list", "--json"]).json()["robots"]["left"]["realtime"],
        "ignore"
    );
    // A single robot needs no name; an address replaces it.
    let text = home.run(&["state"]).done();
    assert!(text.contains(&format!("left ({robot})")), "{text}");
    home.run(&["robots", "add", "right", "127.0.0.1:1"]).done();
    home.run(&["state"]).failed(2, &["has 2"]);
    let mut command = home.command(&["read", "robot_mode"]);
    let output = command
        .env("FRANKA_ROBOT", "left")
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{output:?}");
    home.run(&["robots", "remove", "right"]).done();
    home.run(&["gripper", "state", "left"]).done();
    std::fs::write(home.path("franka/robots.toml"), "[left]\nport = 1").expect("written");
    home.run(&["state", "left"])
        .failed(2, &["robots.toml", "port"]);
}

/// This is a situation as in a container: the file of names is not needed, and its directory does
/// not exist.
#[test]
fn an_address_needs_no_home() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let without = |robot: &str| {
        let mut command = home.command(&["state", robot]);
        command.env_remove("XDG_CONFIG_HOME").env_remove("HOME");
        command.output().expect("it runs")
    };
    let output = without(&sim.address());
    assert!(output.status.success(), "{output:?}");
    let output = without("left");
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("HOME"), "{output:?}");
}

/// The fields have stable names; the text is for people.
#[test]
fn failures_are_json_on_standard_output_too() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let error = |arguments: &[&str], code: i32| {
        let ran = home.run(arguments);
        assert_eq!(ran.code, Some(code), "{ran:?}");
        assert!(ran.err.contains("error:"), "{ran:?}");
        let json: serde_json::Value = serde_json::from_str(&ran.out).expect("JSON");
        assert_eq!(json["schema"], 1, "{json}");
        assert_eq!(json["error"]["exit_code"], code, "{json}");
        json["error"].clone()
    };
    let free = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let nowhere = free.local_addr().expect("bound").to_string();
    drop(free);
    let none = error(&["state", &nowhere, "--json"], 3);
    assert_eq!(
        (&none["kind"], &none["party"]),
        (&"no_robot".into(), &"robot".into())
    );
    assert!(
        none["entry"].is_string() && none["advice"].is_string(),
        "{none}"
    );
    let usage = error(&["state", &sim.address(), "--json", "--rate", "x"], 2);
    assert_eq!(usage["kind"], "usage", "{usage}");
    assert!(
        usage["text"].as_str().expect("text").contains("--rate"),
        "{usage}"
    );
    let file = error(&["explain", "none.mcap", "--json"], 6);
    assert_eq!(
        (&file["kind"], &file["party"]),
        (&"host".into(), &serde_json::Value::Null)
    );
    let asked = [
        "move",
        &sim.address(),
        "--ready",
        "--realtime",
        "ignore",
        "--json",
    ];
    assert_eq!(error(&asked, 5)["kind"], "not_confirmed");
    // Without the option, nothing is printed.
    let ran = home.run(&["state", &nowhere]);
    assert_eq!(ran.out, "", "{ran:?}");
}
