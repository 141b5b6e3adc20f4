//! Commands other than `Move`, and commands that a version does not have.

use franka_proto::framing::next_message;
use franka_proto::{
    Command, CommandId, Filters, LibraryStatus, MoveControllerMode, MoveGeneratorMode, MoveRequest,
    RecoveryStatus, Refusal, Reply, Request, RequestError, RobotMode, SetterStatus, Version,
    VirtualWall, client,
};

use super::{Pair, library};

#[test]
fn setters_and_recovery_work_in_every_version() {
    for version in Version::ALL {
        let mut pair = Pair::connected(version);
        let setters = [
            Request::SetJointImpedance([3000.0; 7]),
            Request::SetCartesianImpedance([300.0; 6]),
            Request::SetEEToK([1.0; 16]),
            Request::SetNEToEE([2.0; 16]),
            Request::SetGuidingMode {
                guiding_mode: [true, false, true, true, false, false],
                nullspace: true,
            },
        ];
        // All requests are open at once, and the answers arrive in reverse order.
        let ids: Vec<_> = setters.iter().map(|setter| pair.request(setter)).collect();
        for id in ids.into_iter().rev() {
            pair.reply(id, Reply::Setter(SetterStatus::InvalidArgumentRejected));
        }
        let id = pair.request(&Request::AutomaticErrorRecovery);
        pair.reply(id, Reply::Recovery(RecoveryStatus::EmergencyAborted));
    }
}

#[test]
fn request_unknown_to_the_version_is_refused_unsent() {
    let mut pair = Pair::connected(Version::V5);
    let torques = Request::Move(MoveRequest::new(
        MoveControllerMode::ExternalController,
        MoveGeneratorMode::None,
    ));
    let mut asynchronous = MoveRequest::new(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointPosition,
    );
    asynchronous.asynchronous = Some([1.0; 7]);
    for (request, what) in [
        (Request::GetRobotModel, "Get Robot Model"),
        (torques, "motion without a generator"),
        (Request::Move(asynchronous), "asynchronous motion"),
    ] {
        let error = pair.client.request(&request).unwrap_err();
        let expected = format!("protocol 5 (Franka Emika Robot) has no {what}");
        assert_eq!(error.to_string(), expected);
        assert!(
            matches!(error, RequestError::Unsupported { version, .. } if version == Version::V5),
            "{error:?}"
        );
    }
    assert_eq!(pair.client.pending(), 0);
    // The refused request used no id.
    assert_eq!(pair.request(&Request::StopMove), CommandId(1));

    let mut pair = Pair::connected(Version::V10);
    for (request, name) in [
        (Request::GetCartesianLimit { id: 1 }, "Get Cartesian Limit"),
        (Request::SetFilters(Filters::uniform(1000.0)), "Set Filters"),
        (library(), "Load Model Library"),
    ] {
        let error = pair.client.request(&request).unwrap_err();
        let expected = format!("protocol 10 (Franka Research 3) has no {name}");
        assert_eq!(error.to_string(), expected);
    }
    assert_eq!(pair.request(&Request::StopMove), CommandId(1));
}

#[test]
fn walls_filters_and_libraries_exist_in_protocol_5() {
    let mut pair = Pair::connected(Version::V5);
    let filters = pair.request(&Request::SetFilters(Filters::uniform(100.0)));
    let limit = pair.request(&Request::GetCartesianLimit { id: -3 });
    let wall = VirtualWall {
        object_world_size: [1.0, 2.0, 3.0],
        object_frame: [0.5; 16],
        object_activation: true,
    };
    let status = SetterStatus::Success;
    pair.reply(limit, Reply::CartesianLimit { status, wall });
    pair.reply(filters, Reply::Setter(SetterStatus::Success));

    let id = pair.request(&library());
    let reply = Reply::ModelLibrary {
        status: LibraryStatus::Error,
        library: &[],
    };
    pair.reply(id, reply);
    let refusal = Refusal::from_reply(Command::LoadModelLibrary, &reply, RobotMode::Idle);
    let text = refusal.expect("a refusal").to_string();
    assert_eq!(
        text,
        "libfranka: Server reports error when loading model library."
    );

    let id = pair.request(&library());
    let file = [0x7f; 5000];
    let header = pair.server.library_header(id, file.len()).unwrap();
    let stream = [header.as_bytes(), &file].concat();
    let message = next_message(&stream).unwrap().unwrap();
    let event = pair.client.on_message(message).unwrap();
    let (status, library) = (LibraryStatus::Success, &file[..]);
    let expected = client::Event::Reply {
        id,
        command: Command::LoadModelLibrary,
        reply: Reply::ModelLibrary { status, library },
    };
    assert_eq!(event, expected);
}
