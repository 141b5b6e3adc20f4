//! Several robots on one server.

use std::net::SocketAddr;

use franka_async::{Realtime, Robot};
use franka_dash::{NameError, Options};
use franka_sim::Sim;
use serde_json::json;
use tokio::runtime::Runtime;

use crate::viewer::Viewer;

#[test]
fn each_robot_has_a_page_and_a_commander_of_its_own() {
    let runtime = Runtime::new().expect("a runtime");
    let (address, _running) = runtime.block_on(async {
        let mut robots = Vec::new();
        let mut running = Vec::new();
        for (name, sim) in [("left", Sim::fr3()), ("right", Sim::fer())] {
            let sim = sim.start().await.expect("a simulated robot");
            let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
            let robot = builder.connect().await.expect("a connection");
            robots.push((name, robot, Options::default().allow_motion()));
            running.push(sim);
        }
        for (name, error) in [("left", "left"), ("dash.js", "dash.js")] {
            let twice =
                robots
                    .iter()
                    .cloned()
                    .chain([(name, robots[0].1.clone(), Options::default())]);
            let name = error.to_owned();
            assert_eq!(
                franka_dash::several(twice).err(),
                Some(NameError::Taken { name })
            );
        }
        let here = "127.0.0.1:0".parse().expect("an address");
        let bound = franka_dash::bind(here, &Options::default()).await;
        let listener = bound.expect("a port");
        let address = listener.local_addr().expect("an address");
        let pages = franka_dash::several(robots).expect("names");
        let pages = pages.into_make_service_with_connect_info::<SocketAddr>();
        tokio::spawn(axum::serve(listener, pages).into_future());
        (address, running)
    });
    let get = |path: &str| {
        let answer = ureq::get(format!("http://{address}/{path}")).call();
        let mut answer = answer.unwrap_or_else(|error| panic!("{path}: {error}"));
        assert!(
            answer.headers().contains_key("content-security-policy"),
            "{path}"
        );
        let body = answer.body_mut().read_to_vec().expect("a body");
        String::from_utf8_lossy(&body).into_owned()
    };
    assert_eq!(get("robots.json"), "[\"left\",\"right\"]");
    assert!(get("").contains("id=\"overview\""));
    // The first path is redirected to the second, whose files are next to it.
    for path in ["left", "left/", "right/"] {
        assert!(get(path).contains("id=\"scene\""), "{path}");
    }
    assert!(!get("right/dash.js").is_empty() && !get("dash.js").is_empty());
    let mut left = Viewer::connect_to(address, "left/ws");
    let mut right = Viewer::connect_to(address, "right/ws");
    left.take();
    right.take();
    left.send(json!({"type": "stop"}));
    assert_eq!(right.commander, Some(right.number));
    assert_eq!(right.hello["siblings"], json!(["left", "right"]));
    assert_eq!(
        (&left.hello["meshes"], &right.hello["meshes"]),
        (&json!("fr3"), &json!("fer"))
    );
}

/// A page at this path would look for its files in the parent folder.
#[test]
fn a_page_nested_under_a_path_without_a_slash_says_so() {
    let runtime = Runtime::new().expect("a runtime");
    let (address, _running) = runtime.block_on(async {
        let sim = std::sync::Arc::new(Sim::fr3().start().await.expect("a simulated robot"));
        let page = franka_dash::simulator(&sim, Options::default()).await;
        let page = page.expect("a page");
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await;
        let listener = listener.expect("a port");
        let address = listener.local_addr().expect("an address");
        let nested = axum::Router::new()
            .nest("/wrong", page.clone())
            .nest("/right/", page);
        let nested = nested.into_make_service_with_connect_info::<SocketAddr>();
        tokio::spawn(axum::serve(listener, nested).into_future());
        (address, sim)
    });
    let agent: ureq::Agent = ureq::Agent::config_builder()
        .http_status_as_error(false)
        .build()
        .into();
    let get = |path: &str| {
        let answer = agent.get(format!("http://{address}{path}")).call();
        let mut answer = answer.expect("an answer");
        let text = answer.body_mut().read_to_string().expect("text");
        (answer.status().as_u16(), text)
    };
    let (status, text) = get("/wrong");
    assert_eq!(status, 404);
    assert!(
        text.contains(r#"got the path "/wrong", expected "/wrong/""#),
        "{text}"
    );
    let (status, text) = get("/right/");
    assert!(
        status == 200 && text.contains("id=\"scene\""),
        "{status} {text}"
    );
}
