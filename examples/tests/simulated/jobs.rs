//! The web service with jobs, its clients, and its end.

use std::io::{BufRead, BufReader, Lines, Write};
use std::net::TcpStream;

use nix::sys::signal::Signal;
use serde_json::{Value, json};
use ureq::http::Response;
use ureq::{Body, BodyReader};

use crate::arm::Arm;
use crate::program::Beside;

/// A client of the service.
struct Client {
    address: String,
    agent: ureq::Agent,
}

/// The events of a job as they arrive: name, number and content.
struct Events(Lines<BufReader<BodyReader<'static>>>);

impl Client {
    fn new(address: String) -> Self {
        // Answers with any status are valid.
        let config = ureq::Agent::config_builder().http_status_as_error(false);
        let agent = config.build().into();
        Self { address, agent }
    }

    fn get(&self, path: &str) -> Response<Body> {
        let url = format!("http://{}{path}", self.address);
        self.agent.get(url).call().expect("an answer")
    }

    fn post(&self, path: &str, body: Value) -> Result<Response<Body>, ureq::Error> {
        let url = format!("http://{}{path}", self.address);
        self.agent.post(url).send_json(body)
    }

    fn delete(&self, path: &str) -> u16 {
        let url = format!("http://{}{path}", self.address);
        let answer = self.agent.delete(url).call().expect("an answer");
        answer.status().as_u16()
    }

    /// Starts a slow job, this distance upwards.
    fn begin(&self, upwards: f64) {
        let order = json!({ "by": [0.0, 0.0, upwards], "speed": 0.2 });
        let begun = self.post("/jobs", order).expect("an answer");
        assert_eq!(begun.status(), 202, "{:?}", text(begun));
    }

    /// Returns the events of a job after the `seen` one.
    fn events(&self, id: u64, seen: Option<u64>) -> Result<Events, u16> {
        let url = format!("http://{}/jobs/{id}/events", self.address);
        let mut request = self.agent.get(url);
        if let Some(seen) = seen {
            request = request.header("Last-Event-ID", seen.to_string());
        }
        let answer = request.call().expect("an answer");
        match answer.status().as_u16() {
            200 => Ok(Events(
                BufReader::new(answer.into_body().into_reader()).lines(),
            )),
            status => Err(status),
        }
    }

    fn stage(&self, id: u64) -> Value {
        let mut answer = self.get(&format!("/jobs/{id}"));
        let job: Value = answer.body_mut().read_json().expect("JSON");
        job["stage"].clone()
    }
}

impl Iterator for Events {
    type Item = (String, u64, Value);

    fn next(&mut self) -> Option<Self::Item> {
        let (mut name, mut number, mut content) = (String::new(), 0, Value::Null);
        for line in self.0.by_ref() {
            let line = line.expect("the service ends its answers");
            match line.split_once(": ") {
                Some(("event", text)) => name = text.to_owned(),
                Some(("id", text)) => number = text.parse().expect("a number"),
                Some(("data", text)) => content = serde_json::from_str(text).expect("JSON"),
                _ if line.is_empty() && !name.is_empty() => return Some((name, number, content)),
                _ => {} // a comment, which keeps the connection alive
            }
        }
        None
    }
}

fn text(answer: Response<Body>) -> String {
    answer.into_body().read_to_string().expect("text")
}

/// Returns the height of a state's hand above another's, `[m]`.
fn above(state: &franka_async::state::RobotState, start: &franka_async::state::RobotState) -> f64 {
    state.O_T_EE[14] - start.O_T_EE[14]
}

#[test]
fn a_job_goes_on_when_its_client_is_killed() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = Beside::serve("axum_service", &arm.address, &[]);
    let start = arm.state();
    let mut killed = Beside::start("client", &["job", &address]);
    killed.said("event: moving");
    killed.kill();
    let client = Client::new(address);
    assert_eq!(client.stage(1), "moving");
    let events: Vec<_> = client.events(1, None).expect("events").collect();
    let (last, way) = events.split_last().expect("events");
    assert_eq!(last.0, "arrived", "{last:?}");
    // Each event once, in order, with increasing progress.
    assert!(way.iter().all(|(name, _, _)| name == "moving"), "{way:?}");
    assert!(
        events.is_sorted_by_key(|(_, number, _)| *number),
        "{events:?}"
    );
    let figures = |name| {
        way.iter()
            .map(move |event| event.2[name].as_f64().expect("a number"))
    };
    assert!(figures("fraction").is_sorted(), "{way:?}");
    assert!(
        figures("remaining").is_sorted_by(|one, next| one >= next),
        "{way:?}"
    );
    let risen = above(&arm.rests(), &start);
    assert!((risen - 0.1).abs() < 2e-3, "{risen}");
    // A late client gets the newest event, or none if it has already received it.
    let late: Vec<_> = client.events(1, None).expect("events").collect();
    assert_eq!(late, std::slice::from_ref(last));
    assert_eq!(client.events(1, Some(last.1)).map(|_| ()), Err(204));
}

#[test]
fn a_cancelled_job_brakes_and_the_next_one_is_taken() {
    let arm = Arm::by_the_clock("fer");
    let (_service, address) = Beside::serve("axum_service", &arm.address, &[]);
    let client = Client::new(address);
    let start = arm.state();
    client.begin(0.1);
    let busy = client.post("/jobs", json!({ "by": [0.0, 0.0, 0.01] }));
    let busy = busy.expect("an answer");
    assert_eq!(busy.status(), 409);
    assert_eq!(text(busy), "job 1 has the arm");
    assert_eq!(client.delete("/jobs/1"), 202);
    let (name, _, content) = client
        .events(1, None)
        .expect("events")
        .last()
        .expect("an end");
    assert_eq!(name, "failed");
    assert_eq!(content["text"], "stopped on request");
    assert_eq!(content["party"], "Caller");
    let risen = above(&arm.rests(), &start);
    // Possibly before it has risen at all.
    assert!((-1e-3..0.09).contains(&risen), "{risen}");
    client.begin(0.01);
    assert_eq!(
        client
            .events(2, None)
            .expect("events")
            .last()
            .expect("an end")
            .0,
        "arrived"
    );
    assert_eq!(client.delete("/jobs/7"), 404);
}

#[test]
fn a_job_that_cannot_begin_is_refused_with_the_reason() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = Beside::serve("axum_service", &arm.address, &[]);
    let client = Client::new(address);
    let refusal = |order| {
        let answer = client.post("/jobs", order).expect("an answer");
        (answer.status().as_u16(), text(answer))
    };
    let (status, why) = refusal(json!({ "by": [1.5, 0.0, 0.0] }));
    assert_eq!(status, 422, "{why}");
    assert!(
        why.contains("no joint positions within their ranges reach this position"),
        "{why}"
    );
    let (status, why) = refusal(json!({ "by": [0.0, 0.0, 0.1], "speed": -1.0 }));
    assert_eq!(status, 422, "{why}");
    assert_eq!(refusal(json!({ "by": "a lot" })).0, 422);
    arm.trip(franka_async::state::RobotError::CartesianReflex);
    arm.wait_for("stopped", |state| {
        state.robot_mode == franka_async::state::RobotMode::Reflex
    });
    let (status, why) = refusal(json!({ "by": [0.0, 0.0, 0.01] }));
    assert_eq!(status, 409, "{why}");
    assert!(why.contains("command rejected"), "{why}");
    let recovered = client.post("/recover", Value::Null).expect("an answer");
    assert_eq!(recovered.status(), 200, "{}", text(recovered));
    client.begin(0.01);
    assert_eq!(
        client.events(5, None).map(|_| ()),
        Err(404),
        "none of the refused"
    );
}

#[test]
fn metrics_are_served_as_open_metrics() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = Beside::serve("axum_service", &arm.address, &[]);
    let answer = Client::new(address).get("/metrics");
    assert_eq!(
        answer.headers()["content-type"],
        franka_async::metrics::CONTENT_TYPE
    );
    let text = text(answer);
    assert!(text.ends_with("# EOF\n"), "{text}");
    let mode = format!(
        "franka_robot_mode{{robot=\"{}\",mode=\"idle\"}} 1\n",
        arm.address
    );
    assert!(text.contains(&mode), "{text}");
}

#[test]
fn service_rests_arm_and_tells_clients_on_sigterm() {
    let arm = Arm::by_the_clock("fr3");
    let start = arm.state();
    let deadline = ["--deadline", "60"];
    let (mut service, address) = Beside::serve("axum_service", &arm.address, &deadline);
    let client = Client::new(address);
    client.begin(0.1);
    arm.wait_until_it_moves();
    let events = client.events(1, None).expect("events");
    service.signal(Signal::SIGTERM);
    service.said("ending");
    // Until it ends, it refuses new requests.
    while let Ok(answer) = client.post("/jobs", json!({ "by": [0.0, 0.0, 0.01] })) {
        assert_eq!(answer.status(), 503, "{}", text(answer));
    }
    let (name, _, content) = events.last().expect("an end");
    assert_eq!(
        (name.as_str(), &content["text"]),
        ("failed", &json!("stopped on request"))
    );
    assert!(service.ended().success());
    let risen = above(&arm.rests(), &start);
    assert!((-1e-3..0.09).contains(&risen), "{risen}");
}

#[test]
fn service_ends_despite_a_request_that_never_ends() {
    let arm = Arm::by_the_clock("fr3");
    let (mut service, address) = Beside::serve("axum_service", &arm.address, &["--deadline", "3"]);
    let client = Client::new(address.clone());
    client.begin(0.1);
    arm.wait_until_it_moves();
    let mut stuck = TcpStream::connect(&address).expect("the service listens");
    let request = format!(
        "POST /jobs HTTP/1.1\r\nhost: {address}\r\ncontent-type: application/json\r\n\
         content-length: 100\r\nexpect: 100-continue\r\n\r\n"
    );
    stuck.write_all(request.as_bytes()).expect("it is taken");
    // The service waits for the body.
    let mut line = String::new();
    BufReader::new(&stuck)
        .read_line(&mut line)
        .expect("an answer");
    assert_eq!(line, "HTTP/1.1 100 Continue\r\n");
    service.signal(Signal::SIGTERM);
    service.said("cut the connections that were left");
    assert!(service.ended().success());
    arm.rests();
}
