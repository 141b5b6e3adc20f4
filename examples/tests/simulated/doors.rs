//! Requests that services must refuse, by the arm: it never moves, and is never recovered.

use std::io::{Read, Write};
use std::net::TcpStream;

use franka_async::state::{RobotError, RobotMode};
use tonic::Code;
use tonic::metadata::MetadataValue;
use tonic::transport::Endpoint;

use crate::arm::Arm;
use crate::program::{Beside, run};

/// Made by `build.rs`.
mod proto {
    #![allow(missing_docs, unreachable_pub, dead_code, clippy::all)]
    tonic::include_proto!("franka.example");
}

use proto::MoveRequest;
use proto::arm_client::ArmClient;

/// Headers of foreign requests, and the status of their answers.
const FOREIGN: [(&str, &str); 9] = [
    ("host: localhost\r\norigin: http://evil.example", "403"),
    ("host: localhost\r\norigin: null", "403"),
    ("host: localhost\r\nsec-fetch-site: cross-site", "403"),
    // The name of the page was rebound to this computer.
    ("host: evil.example\r\norigin: http://evil.example", "403"),
    ("host: evil.example", "403"),
    ("host: 192.0.2.7", "403"),
    ("host: localhost\r\nx-forwarded-for: 192.0.2.9", "403"),
    ("host: localhost\r\nforwarded: for=192.0.2.9", "403"),
    ("host: localhost\r\nhost: evil.example", "400"),
];

/// Requests that act, one for each service, and the status of their answers to a friend.
const ORDER: (&str, &str) = ("POST /jobs", r#"{"by": [0, 0, 0.05]}"#);
const JOB: (&str, &str) = ("POST /jobs", "[0, 0, 0.05]");
const RECOVER: (&str, &str) = ("POST /recover", "");
const SOCKET: (&str, &str) = ("GET /teleoperation", "");

/// The status of the answer to a request with these headers.
fn status(address: &str, (line, body): (&str, &str), headers: &str) -> String {
    let mut stream = TcpStream::connect(address).expect("the service listens");
    let kind = match line.starts_with("GET") {
        true => {
            "connection: upgrade\r\nupgrade: websocket\r\nsec-websocket-version: 13\r\n\
             sec-websocket-key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
        }
        false => "content-type: application/json\r\n",
    };
    let length = body.len();
    let request =
        format!("{line} HTTP/1.1\r\n{kind}{headers}\r\ncontent-length: {length}\r\n\r\n{body}");
    stream.write_all(request.as_bytes()).expect("it is taken");
    let mut answer = [0; 12];
    stream.read_exact(&mut answer).expect("an answer");
    String::from_utf8_lossy(&answer[9..]).into_owned()
}

/// Checks that the arm has stayed where it was, all the time.
fn stayed(arm: Arm, service: &str) {
    let path = arm.stop();
    for axis in 0..3 {
        let (least, most, _) = path.hand(axis);
        assert!(most - least < 1e-4, "{service}: {least} to {most} m");
    }
}

#[test]
fn foreign_requests_move_and_recover_nothing() {
    for (service, orders) in [
        ("axum_service", &[ORDER, RECOVER][..]),
        ("job_queue", &[JOB, RECOVER]),
        ("axum_teleoperation", &[SOCKET]),
    ] {
        let arm = Arm::by_the_clock("fr3");
        let (_service, address) = match service {
            "job_queue" => {
                let mut service = Beside::start(service, &[&arm.address]);
                let address = service.said("listening on ");
                (service, address)
            }
            _ => Beside::serve(service, &arm.address, &[]),
        };
        for order in orders {
            if *order == RECOVER {
                arm.trip(RobotError::CartesianReflex);
                arm.wait_for("stopped", |state| state.robot_mode == RobotMode::Reflex);
            }
            for (headers, refused) in FOREIGN {
                let got = status(&address, *order, headers);
                assert_eq!(got, refused, "{service}: {} {headers}", order.0);
            }
        }
        if orders.contains(&RECOVER) {
            assert_eq!(arm.state().robot_mode, RobotMode::Reflex, "{service}");
            // The same request is answered without the headers.
            assert_eq!(status(&address, RECOVER, "host: localhost"), "200");
        } else {
            assert_eq!(status(&address, SOCKET, "host: localhost"), "101");
        }
        stayed(arm, service);
    }
}

#[test]
fn services_with_a_token_refuse_clients_without_it() {
    for (service, order) in [("axum_service", ORDER), ("axum_teleoperation", SOCKET)] {
        let arm = Arm::by_the_clock("fr3");
        let (mut running, address) = Beside::serve(service, &arm.address, &["--new-token"]);
        let token = running.said("token ");
        for offered in [
            "",
            "\r\nauthorization: Bearer",
            "\r\nauthorization: Bearer \r\nsec-websocket-protocol: token.",
            "\r\nauthorization: Bearer wrong-wrong-wrong-wrong-wrong-wr",
            "\r\norigin: http://localhost\r\nx-forwarded-for: 127.0.0.1",
        ] {
            let got = status(&address, order, &format!("host: localhost{offered}"));
            assert_eq!(got, "401", "{service}: {offered}");
        }
        let right = format!("host: localhost\r\nauthorization: Bearer {token}");
        let rebound = right.replace("localhost", "evil.example");
        assert_eq!(status(&address, order, &rebound), "403", "{service}");
        if order == SOCKET {
            let right = format!("host: localhost\r\nsec-websocket-protocol: token.{token}");
            assert_eq!(status(&address, order, &right), "101");
            stayed(arm, service);
        } else {
            assert_eq!(status(&address, order, &right), "202");
            arm.rests();
        }
    }
}

#[test]
fn a_foreign_grpc_call_moves_nothing() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = Beside::serve("tonic_service", &arm.address, &[]);
    with_clients(async {
        let connect = async |authority: &str| {
            let endpoint = Endpoint::from_shared(format!("http://{address}")).expect("a URI");
            let endpoint = endpoint.origin(authority.parse().expect("a URI"));
            ArmClient::new(endpoint.connect().await.expect("the service listens"))
        };
        let own = format!("http://{address}");
        let mut client = connect(&own).await;
        let state = client.get_state(()).await.expect("a state").into_inner();
        let mut target = state.pose.expect("a pose");
        target.position[2] += 0.05;
        for (authority, header) in [
            ("http://evil.example", None),
            ("http://192.0.2.7", None),
            (&*own, Some(("origin", "http://evil.example"))),
            (&own, Some(("sec-fetch-site", "cross-site"))),
            (&own, Some(("x-forwarded-for", "192.0.2.9"))),
            (&own, Some(("forwarded", "for=192.0.2.9"))),
        ] {
            let mut client = connect(authority).await;
            let mut request = tonic::Request::new(MoveRequest {
                target: Some(target.clone()),
                speed: 0.5,
            });
            if let Some((name, value)) = header {
                let value = MetadataValue::from_static(value);
                request.metadata_mut().insert(name, value);
            }
            let refused = client.move_to(request).await.expect_err("it is refused");
            let code = refused.code();
            assert_eq!(code, Code::PermissionDenied, "{authority} {header:?}");
            let refused = client.recover(()).await;
            if header.is_none() {
                let code = refused.expect_err("it is refused").code();
                assert_eq!(code, Code::PermissionDenied, "{authority}");
            }
        }
    });
    stayed(arm, "tonic_service");
}

/// Runs clients in this process.
fn with_clients(test: impl Future<Output = ()>) {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    runtime.expect("a runtime starts").block_on(test);
}

#[test]
fn grpc_calls_need_the_token() {
    let arm = Arm::by_the_clock("fr3");
    let (mut service, address) = Beside::serve("tonic_service", &arm.address, &["--new-token"]);
    let token = service.said("token ");
    with_clients(async {
        let call = async |authority: &str, bearer: Option<&str>| {
            let endpoint = Endpoint::from_shared(format!("http://{address}")).expect("a URI");
            let endpoint = endpoint.origin(authority.parse().expect("a URI"));
            let mut client = ArmClient::new(endpoint.connect().await.expect("it listens"));
            let mut request = tonic::Request::new(());
            if let Some(bearer) = bearer {
                let value = bearer.parse().expect("text");
                request.metadata_mut().insert("authorization", value);
            }
            client
                .recover(request)
                .await
                .map_err(|status| status.code())
        };
        let own = format!("http://{address}");
        let right = format!("Bearer {token}");
        let wrong = format!("Bearer {}", "wrong-".repeat(8));
        for bearer in [None, Some(""), Some("Bearer "), Some(&wrong), Some(&token)] {
            let code = call(&own, bearer).await.expect_err("it is refused");
            assert_eq!(code, Code::Unauthenticated, "{bearer:?}");
        }
        let rebound = call("http://evil.example", Some(&right)).await;
        assert_eq!(rebound.expect_err("it is refused"), Code::PermissionDenied);
        // The robot has nothing to recover from; that answer is its own.
        let answered = call(&own, Some(&right)).await;
        assert!(matches!(answered, Ok(_) | Err(Code::FailedPrecondition)));
    });
    stayed(arm, "tonic_service");
}

/// The first caller keeps the arm, and the second is told its name. A stop needs no lease.
#[test]
fn second_grpc_caller_is_refused_and_stops() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = Beside::serve("tonic_service", &arm.address, &[]);
    let start = arm.state();
    let first = Beside::start("client", &["move", &address]);
    arm.wait_until_it_moves();
    with_clients(async {
        let connect = ArmClient::connect(format!("http://{address}")).await;
        let mut second = connect.expect("the service listens");
        let state = second.get_state(()).await.expect("a state").into_inner();
        let mut target = state.pose.expect("a pose");
        target.position[1] += 0.1;
        let order = MoveRequest {
            target: Some(target.clone()),
            speed: 1.0,
        };
        let refused = second.move_to(order).await.expect_err("it is refused");
        assert_eq!(refused.code(), Code::FailedPrecondition, "{refused}");
        let named = refused.message().starts_with("\"127.0.0.1:");
        assert!(
            named && refused.message().contains("holds the lease"),
            "{refused}"
        );
        let targets = tokio_stream::iter([target]);
        let refused = second.follow_targets(targets).await;
        let refused = refused.expect_err("it is refused");
        assert_eq!(refused.code(), Code::FailedPrecondition, "{refused}");
        let state = second.get_state(()).await.expect("a state").into_inner();
        assert_eq!(state.mode, "Move", "the first goes on");
        second.stop(()).await.expect("the arm rests");
    });
    drop(first);
    let sideways = arm.rests().O_T_EE[13] - start.O_T_EE[13];
    assert!(sideways.abs() < 1e-3, "{sideways} m");
}

#[test]
fn a_service_is_not_open_to_other_computers_by_mistake() {
    for (arguments, reason) in [
        (&["--listen", "0.0.0.0:0"][..], "set a token"),
        (&["--token-file", "/no/such/file"], "cannot read the token"),
        (&["--deadline", "-1"], "expected 0 to 86400 s"),
        (&["--deadline", "nan"], "expected 0 to 86400 s"),
        (&["--silence", "-1"], "expected 0 to 86400 s"),
        (&["--silence", "nan"], "expected 0 to 86400 s"),
        (&["--silence", "1e300"], "expected 0 to 86400 s"),
        (&["--silence", "soon"], "expected seconds"),
    ] {
        let said = run("axum_teleoperation", arguments, "");
        assert!(said.stderr.contains(reason), "{arguments:?}: {said:?}");
        assert!(!said.stderr.contains("panicked"), "{arguments:?}: {said:?}");
        assert!(said.code.is_some_and(|code| code != 0), "{arguments:?}");
    }
}
