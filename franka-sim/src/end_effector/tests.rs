//! Tests of both end effectors in virtual time, with the protocol sessions of the client and the
//! device.

use franka_proto::client;
use franka_proto::gripper::{self, Grasp, Move, Reply, Request, Status};
use franka_proto::vacuum::{self, Profile, Vacuum};

use super::*;

/// An end effector and its client. A counter represents time.
struct Pair<M: Mechanism> {
    device: EndEffector<M>,
    client: Session<M>,
    /// Answers so far, each with the id of its request.
    answers: Vec<(CommandId, Status)>,
    states: Vec<u32>,
}

type Session<M> = client::Session<<M as Mechanism>::Protocol>;

impl<M: Mechanism> Pair<M> {
    fn new(mechanism: M) -> Self {
        let mut pair = Self {
            device: EndEffector::new(mechanism),
            client: client::Session::new(M::Protocol::default()),
            answers: Vec::new(),
            states: Vec::new(),
        };
        pair.connect();
        pair
    }

    fn connect(&mut self) {
        assert!(self.device.connect());
        // The ids of a new session start again.
        self.answers.clear();
        let hello = self.client.connect(4711);
        self.device.receive(hello.as_bytes()).expect("a handshake");
        self.take_replies();
        assert!(self.client.is_connected());
    }

    fn ask(&mut self, request: &<M::Protocol as Protocol>::Request) -> CommandId {
        let message = self.client.request(request).expect("a session");
        self.device.receive(message.as_bytes()).expect("a request");
        self.take_replies();
        message.id()
    }

    fn run(&mut self, milliseconds: u32) {
        for _ in 0..milliseconds {
            if let Some(datagram) = self.device.tick() {
                assert_eq!(datagram.port, 4711);
                let id = datagram.bytes[..4].try_into().expect("4 bytes");
                self.states.push(u32::from_le_bytes(id));
            }
            self.take_replies();
        }
    }

    /// Sends a request and waits for the answer. Returns the answer and its time in milliseconds.
    fn complete(&mut self, request: &<M::Protocol as Protocol>::Request) -> (Status, u32) {
        let id = self.ask(request);
        for elapsed in 0..200_000 {
            if let Some(&(answered, status)) = self.answers.last()
                && answered == id
            {
                return (status, elapsed);
            }
            self.run(1);
        }
        panic!("no answer to {request:?}");
    }

    fn take_replies(&mut self) {
        while let Some(reply) = self.device.take_reply() {
            let message = next_message(&reply).expect("a message").expect("whole");
            if let client::Event::Reply { id, reply, .. } =
                self.client.on_message(message).expect("an answer")
            {
                match reply {
                    Reply::Done(status) => self.answers.push((id, status)),
                    Reply::Connect { .. } => unreachable!("the session keeps these"),
                }
            }
        }
    }
}

fn homed(fingers: Fingers) -> Pair<Fingers> {
    let mut pair = Pair::new(fingers);
    assert_eq!(pair.complete(&Request::Homing).0, Status::Success);
    pair
}

fn move_to(width: f64, speed: f64) -> Request {
    Request::Move(Move { width, speed })
}

fn grasp(width: f64) -> Request {
    Request::Grasp(Grasp::new(width, 0.1, 40.0))
}

#[test]
fn widths_are_refused_until_homing_has_found_the_largest() {
    let mut hand = Pair::new(Fingers::new());
    assert_eq!(hand.device.state().max_width, 0.0);
    assert_eq!(hand.complete(&move_to(0.04, 0.1)), (Status::Fail, 0));
    assert_eq!(hand.complete(&grasp(0.04)), (Status::Fail, 0));
    // The fingers move 80 mm in both directions at 50 mm/s.
    let (status, elapsed) = hand.complete(&Request::Homing);
    assert_eq!(status, Status::Success);
    assert!(elapsed.abs_diff(3200) <= 2, "{elapsed}");
    assert_eq!(hand.device.state().max_width, 0.08);
    assert_eq!(hand.device.state().width, 0.08);
    assert_eq!(hand.complete(&move_to(0.04, 0.1)).0, Status::Success);
}

#[test]
fn move_takes_the_time_of_its_speed_up_to_the_fastest() {
    for (speed, milliseconds) in [(0.01, 4000), (0.04, 1000), (0.1, 400), (5.0, 400)] {
        let mut hand = homed(Fingers::new());
        let (status, elapsed) = hand.complete(&move_to(0.04, speed));
        assert_eq!(status, Status::Success);
        assert!(elapsed.abs_diff(milliseconds) <= 1, "{speed}: {elapsed}");
        assert_eq!(hand.device.state().width, 0.04);
    }
}

#[test]
fn senseless_request_fails_at_once_and_moves_nothing() {
    let mut hand = homed(Fingers::new());
    let speeds = [0.0, -0.1, f64::NAN, f64::INFINITY];
    let widths = [-0.001, 0.081, f64::NAN, f64::INFINITY];
    let grasps = [
        Grasp::new(0.09, 0.1, 40.0),
        Grasp::new(0.04, f64::NAN, 40.0),
        Grasp::new(0.04, 0.1, 0.0),
        Grasp::new(0.04, 0.1, f64::NAN),
        Grasp {
            epsilon_inner: -0.001,
            ..Grasp::new(0.04, 0.1, 40.0)
        },
        Grasp {
            epsilon_outer: f64::NAN,
            ..Grasp::new(0.04, 0.1, 40.0)
        },
    ];
    let moves = speeds.map(|speed| move_to(0.04, speed));
    let wide = widths.map(|width| move_to(width, 0.1));
    for request in moves.iter().chain(&wide).chain(&grasps.map(Request::Grasp)) {
        assert_eq!(hand.complete(request), (Status::Fail, 0), "{request:?}");
        hand.run(10);
        assert_eq!(hand.device.state().width, 0.08);
    }
}

#[test]
fn an_object_is_grasped_if_its_width_is_within_the_tolerances() {
    // The tolerances are 5 mm, and neither bound is included.
    for (asked, object, grasped) in [
        (0.04, Some(0.04), true),
        (0.04, Some(0.0449), true),
        (0.04, Some(0.0351), true),
        (0.04, Some(0.046), false),
        (0.04, Some(0.034), false),
        (0.04, None, false),
        (0.003, None, true),
    ] {
        let mut fingers = Fingers::new();
        if let Some(width) = object {
            fingers = fingers.with_object(width);
        }
        let mut hand = homed(fingers);
        let (status, elapsed) = hand.complete(&grasp(asked));
        let expected = [Status::Unsuccessful, Status::Success][usize::from(grasped)];
        assert_eq!(status, expected, "{asked} {object:?}");
        let state = hand.device.state();
        assert_eq!(state.is_grasped, grasped);
        assert_eq!(state.width, object.unwrap_or(0.0));
        let way = 0.08 - state.width;
        assert!((f64::from(elapsed) - way / 0.1 * 1e3).abs() <= 1.0);
        // The hand squeezes in both cases.
        assert_eq!(hand.device.mechanism().force(), 40.0);
    }
}

#[test]
fn the_force_of_a_squeeze_stays_within_that_of_the_hand() {
    for (asked, force) in [(1.0, 30.0), (60.0, 60.0), (1000.0, 140.0)] {
        let mut hand = homed(Fingers::new().with_object(0.05));
        let request = Request::Grasp(Grasp::new(0.05, 0.1, asked));
        assert_eq!(hand.complete(&request).0, Status::Success);
        assert_eq!(hand.device.mechanism().force(), force);
    }
}

#[test]
fn a_grasp_of_what_is_held_is_unsuccessful_and_holds_on() {
    let mut hand = homed(Fingers::new().with_object(0.05));
    assert_eq!(hand.complete(&grasp(0.05)).0, Status::Success);
    assert_eq!(hand.complete(&grasp(0.05)), (Status::Unsuccessful, 0));
    assert!(hand.device.state().is_grasped);
}

#[test]
fn lost_object_is_no_longer_grasped_and_fingers_close() {
    let mut hand = homed(Fingers::new().with_object(0.05));
    hand.complete(&grasp(0.05));
    assert_eq!(hand.device.mechanism_mut().take_object(), Some(0.05));
    hand.run(1);
    assert!(!hand.device.state().is_grasped);
    assert_eq!(hand.device.mechanism().force(), 0.0);
    hand.run(500);
    assert_eq!(hand.device.state().width, 0.0);
    assert!(!hand.device.mechanism_mut().place_object(0.05));
}

#[test]
fn a_blocked_move_keeps_trying_until_it_fails() {
    let mut hand = homed(Fingers::new().with_object(0.05));
    let (status, elapsed) = hand.complete(&move_to(0.02, 0.1));
    assert_eq!(status, Status::Fail);
    assert!(
        elapsed.abs_diff(Fingers::BLOCKED_MS + 300) <= 2,
        "{elapsed}"
    );
    // If the object is removed in time, it no longer blocks the move.
    hand.complete(&move_to(0.08, 0.1));
    hand.ask(&move_to(0.02, 0.1));
    hand.run(50_000);
    hand.device.mechanism_mut().take_object();
    hand.run(301);
    assert_eq!(hand.answers.last().expect("an answer").1, Status::Success);
}

#[test]
fn stop_and_a_newer_action_abort_the_one_that_runs() {
    for first in [Request::Homing, move_to(0.01, 0.1), grasp(0.05)] {
        let mut hand = homed(Fingers::new().with_object(0.05));
        hand.answers.clear();
        let aborted = hand.ask(&first);
        hand.run(100);
        let stop = hand.ask(&Request::Stop);
        let expected = [(aborted, Status::Aborted), (stop, Status::Success)];
        assert_eq!(hand.answers, expected, "{first:?}");
        let width = hand.device.state().width;
        hand.run(100);
        assert_eq!(hand.device.state().width, width);

        let superseded = hand.ask(&first);
        hand.run(100);
        assert_eq!(hand.complete(&move_to(0.07, 0.1)).0, Status::Success);
        assert_eq!(hand.answers[2], (superseded, Status::Aborted));
        assert_eq!(hand.answers.len(), 4);
    }
}

#[test]
fn stop_lets_go_of_what_is_held() {
    let mut hand = homed(Fingers::new().with_object(0.05));
    hand.complete(&grasp(0.05));
    assert_eq!(hand.complete(&Request::Stop), (Status::Success, 0));
    assert!(!hand.device.state().is_grasped);
    assert_eq!(hand.device.mechanism().force(), 0.0);
}

#[test]
fn client_that_leaves_stops_its_action_but_not_its_grasp() {
    let mut hand = homed(Fingers::new().with_object(0.05));
    hand.ask(&grasp(0.05));
    hand.run(100);
    hand.device.disconnect();
    let width = hand.device.state().width;
    hand.run(1000);
    assert_eq!(hand.device.state().width, width);

    hand.connect();
    assert_eq!(hand.complete(&grasp(0.05)).0, Status::Success);
    hand.device.disconnect();
    hand.run(1000);
    assert!(hand.device.state().is_grasped);
}

#[test]
fn states_come_at_their_rate_and_when_an_action_ends() {
    let mut hand = Pair::new(Fingers::new());
    hand.run(100);
    assert_eq!(hand.states, [20, 40, 60, 80, 100]);
    hand.states.clear();
    hand.complete(&move_to(0.0, 0.079));
    let last = *hand.states.last().expect("a state");
    assert!(!last.is_multiple_of(STATE_PERIOD), "{last}");
}

#[test]
fn a_second_client_and_a_foreign_version_are_refused() {
    let mut hand = Pair::new(Fingers::new());
    assert!(!hand.device.connect());
    hand.device.disconnect();
    assert!(hand.device.connect());
    // Connect, id 0, 14 bytes, version 4, port 4711.
    let hello = [0, 0, 0, 0, 0, 0, 14, 0, 0, 0, 4, 0, 0x67, 0x12];
    let result = hand.device.receive(&hello);
    assert_eq!(result, Err(SessionError::Incompatible { announced: 4 }));
    assert!(!hand.device.is_connected());
    let reply = hand.device.take_reply().expect("an answer");
    // Incompatible, version 3.
    assert_eq!(reply[10..], [1, 0, 3, 0]);
    hand.device.tick();
    assert!(hand.device.take_reply().is_none());
}

#[test]
fn garbage_disconnects_and_stops() {
    for garbage in [
        &b"GET / HTTP/1.1\r\n\r\n"[..],
        &[0; 40],
        &[9, 0, 1, 0, 0, 0, 10, 0, 0, 0],
    ] {
        let mut hand = homed(Fingers::new());
        hand.ask(&move_to(0.0, 0.01));
        hand.run(10);
        hand.device.receive(garbage).expect_err("no message");
        assert!(!hand.device.is_connected());
        let width = hand.device.state().width;
        hand.run(100);
        assert_eq!(hand.device.state().width, width);
        hand.connect();
    }
}

fn vacuum(vacuum: u8, timeout: i64) -> vacuum::Request {
    vacuum::Request::Vacuum(Vacuum {
        vacuum,
        profile: Profile::P0,
        timeout,
    })
}

#[test]
fn a_vacuum_is_reached_on_an_object_and_held() {
    let mut gripper = Pair::new(Suction::new().with_object());
    let (status, elapsed) = gripper.complete(&vacuum(50, 1000));
    assert_eq!(status, Status::Success);
    assert!(elapsed.abs_diff(500) <= 1, "{elapsed}");
    gripper.run(5000);
    let state = gripper.device.state();
    assert!(state.part_present && state.in_control_range && !state.part_detached);
    assert_eq!(state.vacuum, 500);

    let drop_off = vacuum::Request::DropOff { timeout: 1000 };
    assert_eq!(gripper.complete(&drop_off).0, Status::Success);
    let state = gripper.device.state();
    assert!(!state.part_present && !state.in_control_range && state.part_detached);
    assert_eq!(state.vacuum, 0);
}

#[test]
fn suction_that_takes_too_long_is_unsuccessful() {
    let mut gripper = Pair::new(Suction::new());
    assert_eq!(
        gripper.complete(&vacuum(10, 300)),
        (Status::Unsuccessful, 300)
    );
    gripper.device.mechanism_mut().place_object();
    assert_eq!(
        gripper.complete(&vacuum(50, 300)),
        (Status::Unsuccessful, 300)
    );
    assert_eq!(gripper.complete(&vacuum(200, 2000)).0, Status::Unsuccessful);
    assert_eq!(gripper.complete(&vacuum(50, 1000)).0, Status::Success);
    let drop_off = vacuum::Request::DropOff { timeout: 10 };
    assert_eq!(gripper.complete(&drop_off), (Status::Unsuccessful, 10));
    assert_eq!(gripper.complete(&vacuum(50, 0)), (Status::Fail, 0));
}

#[test]
fn pump_stop_aborts_and_a_lost_object_ends_the_vacuum() {
    let mut gripper = Pair::new(Suction::new().with_object());
    let aborted = gripper.ask(&vacuum(70, 5000));
    gripper.run(100);
    let stop = gripper.ask(&vacuum::Request::Stop);
    let expected = [(aborted, Status::Aborted), (stop, Status::Success)];
    assert_eq!(gripper.answers, expected);
    gripper.complete(&vacuum(50, 5000));
    assert!(gripper.device.mechanism_mut().take_object());
    assert!(!gripper.device.state().part_present);
    gripper.run(200);
    assert_eq!(gripper.device.state().vacuum, 0);
}

#[test]
fn a_profile_that_does_not_exist_fails() {
    let mut gripper = Pair::new(Suction::new());
    let request = gripper.client.request(&vacuum(50, 100)).expect("a session");
    let mut bytes = request.as_bytes().to_vec();
    bytes[11] = 4;
    gripper.device.receive(&bytes).expect("an answer");
    gripper.take_replies();
    assert_eq!(gripper.answers, [(request.id(), gripper::Status::Fail)]);
}
