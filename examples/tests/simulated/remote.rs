//! The gRPC service, with a client in this process and ones that are killed.

use franka_async::state::{RobotError, RobotMode};
use nix::sys::signal::Signal;
use prost::Message;
use tokio::sync::mpsc;
use tokio_stream::StreamExt;
use tokio_stream::wrappers::ReceiverStream;
use tonic::Code;
use tonic::transport::Channel;

use crate::arm::Arm;
use crate::program::Beside;

/// Made by `build.rs`.
mod proto {
    #![allow(missing_docs, unreachable_pub, dead_code, clippy::all)]
    tonic::include_proto!("franka.example");
}

use proto::arm_client::ArmClient;
use proto::{MoveRequest, Pose, Reflex, StatesRequest};

async fn connect(address: &str) -> ArmClient<Channel> {
    let client = ArmClient::connect(format!("http://{address}")).await;
    client.expect("the service listens")
}

/// The pose of the hand, this much further up.
async fn above(client: &mut ArmClient<Channel>, upwards: f64) -> Pose {
    let state = client.get_state(()).await.expect("a state").into_inner();
    let mut pose = state.pose.expect("a pose");
    pose.position[2] += upwards;
    pose
}

/// Has a client of the test in another process begin `task`, and waits until the arm moves.
fn client(task: &str, address: &str, arm: &Arm) -> Beside {
    let client = Beside::start("client", &[task, address]);
    arm.wait_until_it_moves();
    client
}

/// Runs a client in this process.
fn with_client(test: impl Future<Output = ()>) {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    runtime.expect("a runtime starts").block_on(test);
}

#[test]
fn a_call_moves_the_arm_and_states_stream_meanwhile() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = Beside::serve("tonic_service", &arm.address, &[]);
    let start = arm.state();
    with_client(async {
        let mut client = connect(&address).await;
        let rate = StatesRequest { rate: 100.0 };
        let states = client
            .stream_states(rate)
            .await
            .expect("states")
            .into_inner();
        let mut other = client.clone();
        let target = Some(above(&mut client, 0.05).await);
        let moving = other.move_to(MoveRequest { target, speed: 0.5 });
        let seen = states
            .map(|state| state.expect("the stream goes on"))
            .take_while(|state| {
                state
                    .pose
                    .as_ref()
                    .is_some_and(|pose| pose.position[2] < start.O_T_EE[14] + 0.045)
            });
        let (arrival, seen) = tokio::join!(moving, seen.collect::<Vec<_>>());
        let arrival = arrival.expect("it arrives").into_inner();
        assert!(
            arrival.error < 2e-3 && arrival.duration > 0.1,
            "{arrival:?}"
        );
        assert!(seen.is_sorted_by(|one, other| one.time < other.time));
        assert!(seen.iter().any(|state| state.mode == "Move"));

        let far = Some(Pose {
            position: vec![2.0, 0.0, 0.5],
            ..Pose::default()
        });
        let refused = client
            .move_to(MoveRequest {
                target: far,
                speed: 0.0,
            })
            .await;
        let refused = refused.expect_err("nothing reaches there");
        assert_eq!(refused.code(), Code::InvalidArgument);
        assert!(
            refused.message().starts_with("no joint positions"),
            "{refused}"
        );
        let rate = client.stream_states(StatesRequest { rate: f64::NAN }).await;
        assert_eq!(rate.expect_err("no rate").code(), Code::InvalidArgument);
    });
    let risen = arm.rests().O_T_EE[14] - start.O_T_EE[14];
    assert!((risen - 0.05).abs() < 2e-3, "{risen}");
}

#[test]
fn a_caller_that_is_killed_brakes_the_arm() {
    for task in ["move", "follow"] {
        let arm = Arm::by_the_clock("fr3");
        let (_service, address) = Beside::serve("tonic_service", &arm.address, &[]);
        let start = arm.state();
        client(task, &address, &arm).kill();
        let way = arm.rests().O_T_EE[14] - start.O_T_EE[14];
        assert!(way < 0.09, "{task}: went on to {way}");
    }
}

#[test]
fn a_caller_that_freezes_is_given_up_and_the_arm_brakes() {
    for task in ["move", "follow"] {
        let arm = Arm::by_the_clock("fer");
        let (_service, address) = Beside::serve("tonic_service", &arm.address, &[]);
        let start = arm.state();
        let frozen = client(task, &address, &arm);
        frozen.signal(Signal::SIGSTOP);
        let way = arm.rests().O_T_EE[14] - start.O_T_EE[14];
        assert!(way < 0.09, "{task}: went on to {way}");
        frozen.signal(Signal::SIGCONT);
    }
}

#[test]
fn targets_are_followed_to_the_last_and_silence_is_a_status() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = Beside::serve("tonic_service", &arm.address, &[]);
    let start = arm.state();
    with_client(async {
        let mut client = connect(&address).await;
        let target = above(&mut client, 0.05).await;
        for ends in [true, false] {
            let (targets, sent) = mpsc::channel(1);
            targets.send(target.clone()).await.expect("room");
            let call = client.follow_targets(ReceiverStream::new(sent)).await;
            let states = call.expect("it begins").into_inner();
            // Either the caller closes its side, or nothing comes any more.
            let kept = (!ends).then_some(targets);
            let answers: Vec<_> = states.collect().await;
            drop(kept);
            let (last, states) = answers.split_last().expect("answers");
            assert!(states.iter().all(Result::is_ok), "{states:?}");
            match last {
                Ok(_) => assert!(ends),
                Err(status) => {
                    assert!(!ends, "{status}");
                    assert_eq!(status.code(), Code::Aborted);
                    assert!(status.message().starts_with("braked: "), "{status}");
                }
            }
        }
    });
    let risen = arm.rests().O_T_EE[14] - start.O_T_EE[14];
    assert!((risen - 0.05).abs() < 2e-3, "{risen}");
}

#[test]
fn a_reflex_is_a_status_with_its_errors_and_diagnosis() {
    let arm = Arm::by_the_clock("fr3");
    let (_service, address) = Beside::serve("tonic_service", &arm.address, &[]);
    with_client(async {
        let mut client = connect(&address).await;
        let target = Some(above(&mut client, 0.1).await);
        let order = MoveRequest { target, speed: 0.2 };
        let mut caller = client.clone();
        let moving = tokio::spawn(async move { caller.move_to(order).await });
        while client
            .get_state(())
            .await
            .expect("a state")
            .into_inner()
            .mode
            != "Move"
        {}
        // The simulator has a runtime of its own.
        std::thread::scope(|scope| drop(scope.spawn(|| arm.trip(RobotError::CartesianReflex))));
        let status = moving
            .await
            .expect("no panic")
            .expect_err("the robot stopped");
        assert_eq!(status.code(), Code::FailedPrecondition, "{status}");
        let details = tonic_types::Status::decode(status.details()).expect("details");
        assert_eq!(details.message, status.message());
        let reflex: Reflex = details.details[0].to_msg().expect("a reflex");
        assert_eq!(reflex.errors, ["cartesian_reflex"]);
        assert!(reflex.diagnosis.contains("cartesian_reflex"), "{reflex:?}");
        let state = client.recover(()).await.expect("recovered").into_inner();
        assert!(state.errors.is_empty(), "{state:?}");
    });
    arm.wait_for("idle", |state| state.robot_mode == RobotMode::Idle);
}

#[test]
fn a_service_that_is_told_to_end_rests_the_arm_and_answers_its_caller() {
    let arm = Arm::by_the_clock("fr3");
    let deadline = ["--deadline", "60"];
    let (mut service, address) = Beside::serve("tonic_service", &arm.address, &deadline);
    let mut caller = client("move", &address, &arm);
    service.signal(Signal::SIGTERM);
    assert!(service.ended().success());
    assert!(!caller.ended().success(), "its motion was stopped");
    arm.rests();
}
