use franka_proto::gripper::{Grasp, Move, Reply, Request, Status};
use franka_proto::{CommandId, client, gripper};
use franka_sim::{Fingers, Hand, Sim, Suction};

/// A hand and its client. Time is a counter.
struct GraspCase {
    hand: Hand,
    client: gripper::Client,
    answers: Vec<(CommandId, Status)>,
}

impl GraspCase {
    fn new(fingers: Fingers) -> Self {
        let mut case = Self {
            hand: Hand::new(fingers),
            client: gripper::Client::new(gripper::Version::V3),
            answers: Vec::new(),
        };
        assert!(case.hand.connect());
        let hello = case.client.connect(4711);
        case.hand.receive(hello.as_bytes()).expect("a handshake");
        case.read();
        case
    }

    fn homed(fingers: Fingers) -> Self {
        let mut case = Self::new(fingers);
        assert_eq!(case.complete(&Request::Homing).0, Status::Success);
        case
    }

    fn ask(&mut self, request: &Request) -> CommandId {
        let message = self.client.request(request).expect("a session");
        self.hand.receive(message.as_bytes()).expect("a request");
        self.read();
        message.id()
    }

    fn run(&mut self, milliseconds: u32) {
        for _ in 0..milliseconds {
            self.hand.tick();
            self.read();
        }
    }

    fn complete(&mut self, request: &Request) -> (Status, u32) {
        let id = self.ask(request);
        for elapsed in 0..200_000 {
            if let Some((_, status)) = self.answers.iter().find(|(known, _)| *known == id) {
                return (*status, elapsed);
            }
            self.run(1);
        }
        panic!("no answer to {request:?}");
    }

    fn answer(&self, id: CommandId) -> Option<Status> {
        let of_id = |answer: &&(CommandId, Status)| answer.0 == id;
        self.answers.iter().find(of_id).map(|(_, status)| *status)
    }

    fn read(&mut self) {
        while let Some(reply) = self.hand.take_reply() {
            let message = gripper::next_message(&reply)
                .expect("a message")
                .expect("whole");
            if let client::Event::Reply {
                id,
                reply: Reply::Done(status),
                ..
            } = self.client.on_message(message).expect("an answer")
            {
                self.answers.push((id, status));
            }
        }
    }
}

#[test]
fn stop_is_read_while_an_action_runs_and_aborts_it() {
    let mut case = GraspCase::homed(Fingers::new());
    let action = case.ask(&Request::Move(Move {
        width: 0.01,
        speed: 0.02,
    }));
    case.run(500);
    assert_eq!(case.answer(action), None);
    let width = case.hand.state().width;
    let stop = case.ask(&Request::Stop);
    case.run(1);
    assert_eq!(case.answer(stop), Some(Status::Success));
    assert_eq!(case.answer(action), Some(Status::Aborted));
    case.run(500);
    let stands = case.hand.state().width;
    assert!(
        (stands - width).abs() < 1e-3,
        "it stays where it is, and does not open: {stands}"
    );
}

#[test]
fn speed_and_force_count() {
    for (speed, milliseconds) in [(0.02, 2000), (0.1, 400)] {
        let mut case = GraspCase::homed(Fingers::new());
        let (status, elapsed) = case.complete(&Request::Move(Move { width: 0.04, speed }));
        assert_eq!(status, Status::Success);
        assert!(elapsed.abs_diff(milliseconds) <= 2, "{speed}: {elapsed}");
    }
    for (asked, exerted) in [(60.0, 60.0), (10.0, 30.0), (500.0, 140.0)] {
        let mut case = GraspCase::homed(Fingers::new().with_object(0.04));
        let grasp = Request::Grasp(Grasp::new(0.04, 0.1, asked));
        assert_eq!(case.complete(&grasp).0, Status::Success);
        assert_eq!(case.hand.mechanism().force(), exerted);
    }
}

#[test]
fn homing_finds_the_largest_width_and_takes_its_time() {
    let mut case = GraspCase::new(Fingers::new());
    assert_eq!(case.hand.state().max_width, 0.0);
    let (status, elapsed) = case.complete(&Request::Homing);
    assert_eq!(status, Status::Success);
    assert!(elapsed > 1000, "{elapsed}");
    assert_eq!(case.hand.state().max_width, Fingers::STROKE);
}

#[test]
fn a_lost_object_is_reported() {
    let mut case = GraspCase::homed(Fingers::new().with_object(0.04));
    let grasp = Request::Grasp(Grasp::new(0.04, 0.1, 60.0));
    assert_eq!(case.complete(&grasp).0, Status::Success);
    assert!(case.hand.state().is_grasped);
    case.hand.mechanism_mut().take_object();
    case.run(1000);
    assert!(!case.hand.state().is_grasped);
}

#[test]
fn robot_with_hand_and_vacuum_gripper_runs_in_one_process() {
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    runtime.block_on(async {
        let sim = Sim::fr3()
            .ideal()
            .hand(Fingers::new(), 0)
            .vacuum_gripper(Suction::new(), 0)
            .start()
            .await
            .expect("a robot");
        for address in [
            sim.addr(),
            sim.hand().expect("a hand").addr(),
            sim.vacuum_gripper().expect("a vacuum gripper").addr(),
        ] {
            tokio::net::TcpStream::connect(address)
                .await
                .expect("a listener");
        }
        sim.stop().await;
    });
}
