//! A simulated robot in the process of the test, which observes and disturbs it while a program
//! controls it.

use std::sync::mpsc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use franka_async::{Realtime, RobotError, RobotMode, RobotState};
use franka_model::{EndEffector, Frame, JointVector, Load, Model, READY, Wrench};
use franka_rt::sched::Scheduling;
use franka_sim::{Sim, Tool};
use tokio::sync::oneshot;

/// The initial state of a robot, and the events while a program moves it.
#[derive(Clone)]
pub(crate) struct Scene {
    /// The joint positions at the start, `[rad]`.
    pub(crate) q: JointVector,
    /// The events while it moves, in order.
    pub(crate) events: Vec<(When, Event)>,
    /// Whether lost commands end a motion.
    pub(crate) strict: bool,
}

/// Whether the next event is due, from the state and the milliseconds since the motion began.
pub(crate) type When = fn(&RobotState, u64) -> bool;

#[derive(Clone, Copy)]
pub(crate) enum Event {
    /// The hand is pushed with this force, `[N]`, for so many milliseconds.
    PushHand([f64; 3], u64),
    /// The elbow is swung, which hardly moves the hand: joint 3 gets this torque, `[N m]`, for so
    /// many milliseconds.
    SwingElbow(f64, u64),
    /// The robot stops itself.
    Trip(RobotError),
}

impl Default for Scene {
    /// In the ready pose, without disturbances, as strict as a real robot.
    fn default() -> Self {
        Self {
            q: READY,
            events: Vec::new(),
            strict: true,
        }
    }
}

/// A running simulated robot.
pub(crate) struct Arm {
    pub(crate) address: String,
    end: oneshot::Sender<()>,
    watching: JoinHandle<Course>,
}

/// The simulator's states, every few milliseconds.
pub(crate) struct Course(Vec<Moment>);

struct Moment {
    at: Instant,
    state: RobotState,
}

impl Arm {
    /// Starts the robot of this name.
    pub(crate) fn start(robot: &str, scene: Scene) -> Self {
        let sim = match robot {
            "fr3" => Sim::fr3(),
            "fer" => Sim::fer(),
            other => panic!("no robot is called {other}"),
        };
        let sim = sim.tool(Tool::hand()).q(scene.q);
        let sim = sim.enforce_communication(scene.strict);
        let (started, address) = mpsc::channel();
        let (end, ended) = oneshot::channel();
        let watching = std::thread::spawn(move || {
            // The simulator's thread inherits the scheduling of this one. With real-time
            // scheduling, other work on this machine costs no cycles, as on a real robot.
            let scheduling = Scheduling {
                realtime: Realtime::Ignore,
                priority: Some(10),
                ..Scheduling::default()
            };
            scheduling.enter().expect("refusals are accepted");
            let runtime = tokio::runtime::Builder::new_current_thread()
                .enable_all()
                .build()
                .expect("a runtime starts");
            runtime.block_on(async {
                let sim = sim.start().await.expect("a simulator starts");
                started
                    .send(sim.addr().to_string())
                    .expect("the test waits");
                let watched = watch(&sim, &scene.events, ended).await;
                sim.stop().await;
                watched
            })
        });
        Self {
            address: address.recv().expect("the simulator has an address"),
            end,
            watching,
        }
    }

    /// Ends the simulation and returns what the arm has done.
    pub(crate) fn stop(self) -> Course {
        self.end.send(()).expect("the simulator runs");
        self.watching.join().expect("no panic")
    }
}

async fn watch(
    sim: &franka_sim::Running,
    events: &[(When, Event)],
    mut ended: oneshot::Receiver<()>,
) -> Course {
    let mut moments = Vec::new();
    let mut events = events.iter();
    let mut next = events.next();
    // The beginning of the present motion, in the robot's time.
    let mut moving = None;
    loop {
        let state = sim.state().await.expect("the simulator runs");
        let at = Instant::now();
        moments.push(Moment { at, state });
        if state.robot_mode == RobotMode::Move {
            let since = *moving.get_or_insert(state.message_id);
            let moving_for = state.message_id - since;
            if let Some((_, event)) = next.filter(|(when, _)| when(&state, moving_for)) {
                let event = *event;
                sim.with(move |robot| match event {
                    Event::PushHand([x, y, z], duration) => {
                        let wrench = Wrench::new(x, y, z, 0.0, 0.0, 0.0);
                        robot.push_end_effector(wrench, duration);
                    }
                    Event::SwingElbow(torque, duration) => {
                        let (q, load) = (*robot.q(), Load::NONE);
                        let torques = Model::fr3().mass(&q, &load) * self_motion(&q);
                        robot.push_joints(torques * (torque / torques[2]), duration);
                    }
                    Event::Trip(error) => robot.trip(error),
                })
                .await
                .expect("the simulator runs");
                next = events.next();
            }
        } else {
            moving = None;
        }
        tokio::select! {
            _ = &mut ended => break,
            () = tokio::time::sleep(Duration::from_millis(5)) => {}
        }
    }
    assert!(
        next.is_none(),
        "the motion ended before all events were due"
    );
    Course(moments)
}

/// The direction in which the joints at `q` can move without the hand, joint 3 forwards; of length
/// 1. Both robots have the same kinematics.
fn self_motion(q: &JointVector) -> JointVector {
    let jacobian = Model::fr3().zero_jacobian(Frame::EndEffector, q, &EndEffector::default());
    let gram = jacobian * jacobian.transpose();
    let inverse = gram.try_inverse().expect("far from singularities");
    let elbow = JointVector::from_fn(|joint, _| if joint == 2 { 1.0 } else { 0.0 });
    let still = elbow - jacobian.tr_mul(&(inverse * (jacobian * elbow)));
    still.normalize()
}

impl Course {
    /// The state at the end.
    pub(crate) fn last(&self) -> &RobotState {
        &self.0.last().expect("there is one at least").state
    }

    /// The smallest and the greatest value of a quantity.
    pub(crate) fn extent(&self, of: impl Fn(&RobotState) -> f64) -> (f64, f64) {
        let values = self.0.iter().map(|moment| of(&moment.state));
        values.fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(least, most), value| (least.min(value), most.max(value)),
        )
    }

    /// The displacement of the hand from its start along an axis of the base, `[m]`: smallest,
    /// greatest, and last.
    pub(crate) fn hand(&self, axis: usize) -> (f64, f64, f64) {
        let of = |state: &RobotState| state.O_T_EE[12 + axis] - self.0[0].state.O_T_EE[12 + axis];
        let (least, most) = self.extent(of);
        (least, most, of(self.last()))
    }

    /// The displacement of a joint from its start, `[rad]`: smallest, greatest, and last.
    pub(crate) fn joint(&self, joint: usize) -> (f64, f64, f64) {
        let of = |state: &RobotState| state.q[joint] - self.0[0].state.q[joint];
        let (least, most) = self.extent(of);
        (least, most, of(self.last()))
    }

    /// The displacement of the joints from the ready pose along their [`self_motion`], `[rad]`:
    /// smallest, greatest, and last.
    pub(crate) fn elbow(&self) -> (f64, f64, f64) {
        let of = |state: &RobotState| {
            let q = JointVector::from(state.q);
            self_motion(&q).dot(&(q - READY))
        };
        let (least, most) = self.extent(of);
        (least, most, of(self.last()))
    }

    /// The first time at which a condition held.
    pub(crate) fn first(&self, so: impl Fn(&RobotState) -> bool) -> Option<Instant> {
        let moment = self.0.iter().find(|moment| so(&moment.state));
        moment.map(|moment| moment.at)
    }
}
