//! The dashboard, served for a robot and by the simulator.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;

use franka_async::recording::Recording;
use nix::sys::signal::Signal;
use tungstenite::Message;
use tungstenite::client::IntoClientRequest as _;

use crate::program::{Home, Started, until};
use crate::simulated::Simulated;

/// Returns the address that serves the page, from the first output line with an address.
fn page(program: &mut Started) -> String {
    let out = program.child().stdout.as_mut().expect("piped");
    let lines = BufReader::new(out).lines().map(|line| line.expect("text"));
    let mut addresses = lines.filter_map(|line| Some(line.split_once("http://")?.1.to_owned()));
    let address = addresses.next().expect("an address");
    address.trim_end_matches('/').to_owned()
}

/// Returns the server's answer to a browser.
fn get(address: &str, path: &str) -> String {
    let mut socket = TcpStream::connect(address).expect("it listens");
    let request = format!("GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n");
    socket.write_all(request.as_bytes()).expect("it reads");
    let mut answer = Vec::new();
    socket.read_to_end(&mut answer).expect("an answer");
    String::from_utf8_lossy(&answer).into_owned()
}

#[test]
fn the_dashboard_is_served_until_ctrl_c() {
    Simulated::each(|sim| {
        let home = Home::new();
        let robot = sim.address();
        let free = ["--listen", "127.0.0.1:0"];
        let moving = ["dash", &robot, "--allow-motion", "--realtime", "ignore"];
        let moving = [&moving[..], &free].concat();
        let watching = [&["dash", &robot][..], &free].concat();
        for arguments in [
            &watching[..],
            &moving,
            &["sim", "--port", "0", "--dash", "127.0.0.1:0"],
        ] {
            let mut program = home.start(arguments);
            let address = page(&mut program);
            let answer = get(&address, "/");
            assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
            assert!(answer.contains("<title>"), "{answer}");
            assert!(get(&address, "/dash.js").starts_with("HTTP/1.1 200"));
            program.signal(Signal::SIGINT);
            program.ended().done();
        }
    });
}

#[test]
fn several_robots_have_a_page_each() {
    let (home, left, right) = (Home::new(), Simulated::fr3(), Simulated::fer());
    let robots = [left.address(), right.address()];
    let mut program = home.start(&["dash", &robots[0], &robots[1], "--listen", "127.0.0.1:0"]);
    let address = page(&mut program);
    let listed = get(&address, "/robots.json");
    for robot in &robots {
        assert!(listed.contains(robot.as_str()), "{listed}");
        let answer = get(&address, &format!("/{robot}/"));
        assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    }
    assert!(get(&address, "/").contains("overview"));
    program.signal(Signal::SIGINT);
    program.ended().done();
    let twice = ["dash", &robots[0], &robots[0], "--listen", "127.0.0.1:0"];
    home.run(&twice)
        .failed(2, &[&robots[0], " twice, expected different robots"]);
}

#[test]
fn a_folder_for_recordings_has_to_be_there() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let nowhere = ["dash", &sim.address(), "--record", "/no/such/folder"];
    home.run(&nowhere)
        .failed(2, &["/no/such/folder", "existing folder"]);
}

#[test]
fn pages_for_other_computers_take_a_token() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let open = ["dash", &sim.address(), "--listen", "0.0.0.0:0"];
    home.run(&open).failed(2, &["set a token", "--token-file"]);
    let open = ["sim", "--port", "0", "--dash", "0.0.0.0:0"];
    home.run(&open).failed(2, &["FRANKA_ACCESS_TOKEN"]);
}

#[test]
fn a_token_is_made_or_read_from_a_file_and_never_an_argument() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let dash = ["dash", &sim.address(), "--listen", "127.0.0.1:0"];
    let access = |address: &str, token: &str| {
        let mut socket = TcpStream::connect(address).expect("it listens");
        let request = format!(
            "GET /access HTTP/1.1\r\nHost: {address}\r\nAuthorization: Bearer {token}\r\n\r\n"
        );
        socket.write_all(request.as_bytes()).expect("it reads");
        let mut status = [0; 12];
        socket.read_exact(&mut status).expect("an answer");
        String::from_utf8_lossy(&status[9..]).into_owned()
    };
    let mut program = home.start(&[&dash[..], &["--new-token"]].concat());
    let address = page(&mut program);
    let (address, token) = address.split_once("/#").expect("a token");
    assert_eq!(access(address, token), "204");
    assert_eq!(access(address, "another-token-of-32-characters--"), "401");
    program.signal(Signal::SIGINT);
    program.ended().done();

    let file = std::env::temp_dir().join(format!("franka-dash-token-{}", std::process::id()));
    std::fs::write(&file, "token-of-the-file\n").expect("a file");
    let path = file.to_str().expect("text");
    let mut program = home.start(&[&dash[..], &["--token-file", path]].concat());
    let address = page(&mut program);
    assert!(!address.contains('#'), "{address} shows the token");
    assert_eq!(access(&address, "token-of-the-file"), "204");
    program.signal(Signal::SIGINT);
    program.ended().done();

    std::fs::write(&file, "").expect("a file");
    let empty = [&dash[..], &["--token-file", path]].concat();
    home.run(&empty).failed(2, &["the token is empty"]);
    std::fs::remove_file(&file).expect("it was there");
    let both = [&dash[..], &["--token-file", path, "--new-token"]].concat();
    home.run(&both).failed(2, &["--new-token"]);
    let argument = [&dash[..], &["--token", "token-of-the-argument"]].concat();
    home.run(&argument).failed(2, &["--token"]);
}

#[test]
fn one_lost_robot_leaves_the_others_their_page() {
    let (home, left, right) = (Home::new(), Simulated::fr3(), Simulated::fer());
    let robots = [left.address(), right.address()];
    let mut program = home.start(&["dash", &robots[0], &robots[1], "--listen", "127.0.0.1:0"]);
    let address = page(&mut program);
    left.end();
    let mut said = String::new();
    let err = program.child().stderr.as_mut().expect("piped");
    BufReader::new(err).read_line(&mut said).expect("text");
    assert!(said.contains(&robots[0]), "{said}");
    assert!(said.contains("the others continue"), "{said}");
    let answer = get(&address, &format!("/{}/", robots[1]));
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    assert_eq!(program.child().try_wait().expect("its child"), None);
    right.end();
    program.ended().failed(3, &[&robots[1], "has ended"]);
}

#[test]
fn page_recording_is_complete_after_ctrl_c_and_lost_robot() {
    for is_lost in [false, true] {
        let (home, sim) = (Home::new(), Simulated::fr3());
        let folder = home.path("recordings");
        std::fs::create_dir(&folder).expect("a folder");
        let record = [
            "--listen",
            "127.0.0.1:0",
            "--allow-motion",
            "--realtime",
            "ignore",
            "--record",
            "recordings",
        ];
        let mut program = home.start(&[&["dash", &sim.address()][..], &record].concat());
        let address = page(&mut program);
        let request = format!("ws://{address}/ws").into_client_request();
        let socket = TcpStream::connect(&address).expect("it listens");
        let (mut socket, _) = tungstenite::client(request.expect("a request"), socket).expect("it");
        for request in [
            r#"{"type":"take","name":"test"}"#,
            r#"{"type":"record","on":true}"#,
        ] {
            let request = Message::text(request);
            socket.send(request).expect("it reads");
        }
        let file = || std::fs::read_dir(&folder).expect("a folder").next();
        // The first write happens after a second; later data is not on the disk yet.
        until("a chunk", || {
            let length = file().map_or(0, |it| it.expect("a file").metadata().expect("it").len());
            length > 10_000
        });
        let code = match is_lost {
            true => {
                sim.end();
                3
            }
            false => {
                program.signal(Signal::SIGINT);
                0
            }
        };
        let ran = program.ended();
        assert_eq!(ran.code, Some(code), "{ran:?}");
        let path = file().expect("a file").expect("a file").path();
        let recording = Recording::open(path).expect("a recording");
        assert_eq!(recording.damage(), None, "lost: {is_lost}");
    }
}
