//! The data that viewers see.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use franka_dash::Options;
use franka_sim::Sim;
use serde_json::json;

use crate::viewer::{Served, Viewer};

fn number(frame: &[u8], offset: usize) -> f64 {
    let bytes = frame[offset..offset + 4].try_into().expect("four bytes");
    f64::from(f32::from_le_bytes(bytes))
}

#[test]
fn frames_show_the_robot() {
    let served = Served::new(|_| Options::default());
    let mut viewer = Viewer::connect(served.address);
    viewer.wait_for("frame");
    let q = served.robot.state().q;
    for (joint, q) in q.iter().enumerate() {
        let shown = number(&viewer.frame, 32 + 4 * joint);
        assert!((shown - q).abs() < 1e-3, "joint {joint}: {shown}, {q}");
    }
    // The end effector is the last pose before the poses of the reference.
    let height = number(&viewer.frame, 196 + 8 * 28 + 8);
    assert!((height - served.height()).abs() < 1e-3);
}

#[test]
fn a_viewer_that_acknowledges_nothing_gets_one_frame() {
    let served = Served::new(|_| Options::default());
    let mut viewer = Viewer::connect(served.address);
    let before = viewer.frame.clone();
    let begin = Instant::now();
    let mut statistics = 0;
    // Not `read`, which would acknowledge.
    let mut frames = 0;
    while statistics < 5 {
        match viewer.read_only() {
            tungstenite::Message::Binary(_) => frames += 1,
            tungstenite::Message::Text(text) if text.contains("\"statistics\"") => statistics += 1,
            _ => {}
        }
        assert!(begin.elapsed() < Duration::from_secs(30));
    }
    assert!(!before.is_empty() && frames <= 1, "{frames} frames");
}

#[test]
fn a_simulated_robot_of_another_program_is_shown_and_pushed() {
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    let (address, running) = runtime.block_on(async {
        let running = Arc::new(Sim::fr3().start().await.expect("a simulated robot"));
        let router = franka_dash::simulator(&running, Options::default()).await;
        let router = router.expect("the simulator runs");
        let here = "127.0.0.1:0".parse().expect("an address");
        let bound = franka_dash::bind(here, &Options::default()).await;
        let listener = bound.expect("a port");
        let address = listener.local_addr().expect("an address");
        let router = router.into_make_service_with_connect_info::<SocketAddr>();
        tokio::spawn(axum::serve(listener, router).into_future());
        (address, running)
    });
    let mut viewer = Viewer::connect(address);
    viewer.take();
    viewer.send(json!({"type": "begin", "motion": {"kind": "ready"}, "speed": 0.1}));
    assert!(viewer.refusal().contains("view-only"));
    let push = json!({"kind": "push", "link": 7, "offset": [0, 0, 0], "force": [0, 0, -30]});
    let begin = Instant::now();
    // The robot estimates the force that it exerts: upwards.
    while number(&viewer.frame, 144 + 8) < 10.0 {
        viewer.send(json!({"type": "disturb", "disturbance": push}));
        viewer.wait_for("frame");
        assert!(
            begin.elapsed() < Duration::from_secs(20),
            "no force is seen"
        );
    }
    viewer.send(json!({"type": "stop"}));
    while viewer.frame[3] != 5 {
        viewer.wait_for("frame");
        assert!(begin.elapsed() < Duration::from_secs(20), "not stopped");
    }
    drop(running);
}
