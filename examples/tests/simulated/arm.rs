//! A simulated robot in the process of the test, which observes and disturbs it while a program
//! controls it.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use franka_async::READY;
use franka_async::model::{EndEffector, Frame, JointVector, Load, Model, Wrench};
use franka_async::nalgebra::Vector3;
use franka_async::state::{RobotError, RobotMode, RobotState};
use franka_sim::{Robot, Running, Sim, Tool, Touch};
use tokio::runtime::{self, Runtime};

/// Time for which a cycle waits for its command: less than the silence after which a client
/// considers the robot lost.
const PATIENCE: Duration = Duration::from_millis(500);

/// Time limit for events, also on a busy machine.
pub(crate) const SOON: Duration = Duration::from_secs(100);

/// Interval between recorded states, `[ms]`.
pub(crate) const SAMPLE: u64 = 5;

/// The initial state of a robot, and the events while a program moves it.
#[derive(Clone)]
pub(crate) struct Scene {
    /// The joint positions at the start, `[rad]`.
    pub(crate) q: JointVector,
    /// The events while it moves, in order.
    pub(crate) events: Vec<(When, Event)>,
    /// True if the robot keeps the wall clock, and waits for late commands. Otherwise it runs in
    /// virtual time, so that no command is late.
    pub(crate) on_the_wall: bool,
    /// True for an arm with realistic stiction, elasticity and lag; an ideal arm otherwise.
    pub(crate) realistic: bool,
    /// Smallest duration of each of the robot's milliseconds: a program with its own rate is then
    /// punctual for the robot, even on a busy machine.
    pub(crate) slow: Duration,
}

/// True if the next event is due, from the state and the milliseconds since the motion began.
pub(crate) type When = fn(&RobotState, u64) -> bool;

#[derive(Clone, Copy)]
pub(crate) enum Event {
    /// The hand is pushed with this force, `[N]`, for this number of milliseconds.
    PushHand([f64; 3], u64),
    /// The elbow is swung, which hardly moves the hand: joint 3 receives this torque, `[N m]`, for
    /// this number of milliseconds.
    SwingElbow(f64, u64),
    /// A table is placed at this distance below the hand, `[m]`.
    LayTable(f64),
    /// The robot stops itself.
    Trip(RobotError),
}

impl Default for Scene {
    /// Returns a scene in the ready pose, without disturbances, in virtual time.
    fn default() -> Self {
        Self {
            q: READY,
            events: Vec::new(),
            on_the_wall: false,
            realistic: false,
            slow: Duration::ZERO,
        }
    }
}

/// A running simulated robot.
pub(crate) struct Arm {
    pub(crate) address: String,
    sim: Running,
    runtime: Runtime,
    watch: Arc<Mutex<Watch>>,
}

/// The simulator's states, every few milliseconds.
#[derive(Default)]
pub(crate) struct MeasuredPath(Vec<RobotState>);

/// Returns a robot with this name in this scene, and its record.
fn simulator(robot: &str, scene: Scene) -> (Sim, Arc<Mutex<Watch>>) {
    let sim = match robot {
        "fr3" => Sim::fr3(),
        "fer" => Sim::fer(),
        other => panic!("no robot is called {other}"),
    };
    let sim = if scene.realistic { sim } else { sim.ideal() };
    let sim = sim
        .tool(Tool::hand())
        .configure(|config| config.q = scene.q);
    let sim = match scene.on_the_wall {
        true => sim.wait_for_commands(PATIENCE),
        false => sim.virtual_time(PATIENCE),
    };
    let watch = Arc::new(Mutex::new(Watch {
        events: scene.events.into(),
        moving: None,
        path: MeasuredPath::default(),
    }));
    let seen = watch.clone();
    let sim = sim.every_millisecond(move |robot| {
        std::thread::sleep(scene.slow);
        seen.lock().expect("no panic").see(robot);
    });
    (sim, watch)
}

impl Arm {
    /// Starts the robot with this name.
    pub(crate) fn start(robot: &str, scene: Scene) -> Self {
        let (sim, watch) = simulator(robot, scene);
        Self::serve(sim, watch)
    }

    /// Starts a robot of each kind, with synchronised milliseconds.
    pub(crate) fn in_step([one, other]: [Scene; 2]) -> [Self; 2] {
        let (one, watch) = simulator("fr3", one);
        let (other, other_watch) = simulator("fer", other);
        let [one, other] = Sim::in_step([one, other]);
        [Self::serve(one, watch), Self::serve(other, other_watch)]
    }

    fn serve(sim: Sim, watch: Arc<Mutex<Watch>>) -> Self {
        let mut runtime = runtime::Builder::new_multi_thread();
        let runtime = runtime.worker_threads(1).enable_all().build();
        let runtime = runtime.expect("a runtime starts");
        let sim = runtime.block_on(sim.start()).expect("a simulator starts");
        Self {
            address: sim.addr().to_string(),
            sim,
            runtime,
            watch,
        }
    }

    /// Starts a robot with this name in its ready pose, which keeps the wall clock.
    pub(crate) fn by_the_clock(robot: &str) -> Self {
        let scene = Scene {
            on_the_wall: true,
            ..Scene::default()
        };
        Self::start(robot, scene)
    }

    /// Returns the state of the robot, which its clients may not have received yet.
    pub(crate) fn state(&self) -> RobotState {
        let state = self.runtime.block_on(self.sim.state());
        state.expect("the simulator runs")
    }

    /// Waits for a state for which `holds` is true.
    pub(crate) fn wait_for(&self, what: &str, holds: impl Fn(&RobotState) -> bool) -> RobotState {
        let end = Instant::now() + SOON;
        loop {
            let state = self.state();
            if holds(&state) {
                return state;
            }
            assert!(Instant::now() < end, "never {what}: {state:?}");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Waits until the arm moves.
    pub(crate) fn wait_until_it_moves(&self) {
        self.wait_for("moving", |state| {
            state.robot_mode == RobotMode::Move && state.dq.iter().any(|dq| dq.abs() > 0.01)
        });
    }

    /// Waits until the arm is released, and checks that it is at rest, without an error.
    pub(crate) fn rests(&self) -> RobotState {
        let state = self.wait_for("idle", |state| state.robot_mode != RobotMode::Move);
        assert_eq!(
            state.robot_mode,
            RobotMode::Idle,
            "{:?}",
            state.reflex_reason
        );
        assert!(state.errors.is_empty(), "{:?}", state.errors);
        let fastest = state
            .dq
            .iter()
            .fold(0.0, |fastest: f64, dq| fastest.max(dq.abs()));
        assert!(
            fastest < 0.01,
            "let go while a joint moves at {fastest} rad/s"
        );
        state
    }

    /// Makes the robot stop itself.
    pub(crate) fn trip(&self, error: RobotError) {
        self.with(move |robot| robot.trip(error));
    }

    /// Runs a function with the robot.
    pub(crate) fn with(&self, what: impl FnOnce(&mut Robot) + Send + 'static) {
        let done = self.sim.with(what);
        self.runtime.block_on(done).expect("the simulator runs");
    }

    /// Ends the simulation and returns the motion of the arm.
    pub(crate) fn stop(self) -> MeasuredPath {
        let last = self.runtime.block_on(self.sim.state());
        self.runtime.block_on(self.sim.stop());
        let mut watch = self.watch.lock().expect("no panic");
        assert!(
            watch.events.is_empty(),
            "the motion ended before all events were due"
        );
        watch.path.0.push(last.expect("the simulator runs"));
        std::mem::take(&mut watch.path)
    }
}

/// The observer of a robot.
struct Watch {
    /// Events that are not due yet.
    events: VecDeque<(When, Event)>,
    /// The beginning of the current motion, in the robot's time.
    moving: Option<u64>,
    path: MeasuredPath,
}

impl Watch {
    /// Records the state, and disturbs the robot if an event is due.
    fn see(&mut self, robot: &mut Robot) {
        let state = robot.state();
        let now = state.message_id;
        if now.is_multiple_of(SAMPLE) {
            self.path.0.push(*state);
        }
        if state.robot_mode != RobotMode::Move {
            self.moving = None;
            return;
        }
        let moving_for = now - *self.moving.get_or_insert(now);
        let next = self.events.front();
        if let Some((_, event)) = next.copied().filter(|(when, _)| when(state, moving_for)) {
            self.events.pop_front();
            event.happen(robot);
        }
    }
}

impl Event {
    fn happen(self, robot: &mut Robot) {
        match self {
            Self::PushHand([x, y, z], duration) => {
                let wrench = Wrench::new(x, y, z, 0.0, 0.0, 0.0);
                robot.push_end_effector(wrench, duration);
            }
            Self::SwingElbow(torque, duration) => {
                let (q, load) = (*robot.q(), Load::NONE);
                let torques = Model::fr3().mass(&q, &load) * self_motion(&q);
                robot.push_joints(torques * (torque / torques[2]), duration);
            }
            Self::LayTable(below) => {
                let hand = robot.true_pose().translation.vector;
                let table = hand - Vector3::z() * below;
                robot.touch(Touch::wall(table, Vector3::z()));
            }
            Self::Trip(error) => robot.trip(error),
        }
    }
}

/// Returns the unit vector in which the joints at `q` can move without the hand, joint 3
/// forwards. Both robots have the same kinematics.
fn self_motion(q: &JointVector) -> JointVector {
    let jacobian = Model::fr3().zero_jacobian(Frame::EndEffector, q, &EndEffector::default());
    let gram = jacobian * jacobian.transpose();
    let inverse = gram.try_inverse().expect("far from singularities");
    let elbow = JointVector::from_fn(|joint, _| if joint == 2 { 1.0 } else { 0.0 });
    let still = elbow - jacobian.tr_mul(&(inverse * (jacobian * elbow)));
    still.normalize()
}

impl MeasuredPath {
    /// Returns the state at the end.
    pub(crate) fn last(&self) -> &RobotState {
        self.0.last().expect("there is one at least")
    }

    /// Returns the smallest and the largest value of a quantity.
    pub(crate) fn extent(&self, of: impl Fn(&RobotState) -> f64) -> (f64, f64) {
        let values = self.0.iter().map(of);
        values.fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(least, most), value| (least.min(value), most.max(value)),
        )
    }

    /// Returns the displacement of the hand from its start along an axis of the base, `[m]`:
    /// smallest, largest, and last.
    pub(crate) fn hand(&self, axis: usize) -> (f64, f64, f64) {
        let of = |state: &RobotState| state.O_T_EE[12 + axis] - self.0[0].O_T_EE[12 + axis];
        let (least, most) = self.extent(of);
        (least, most, of(self.last()))
    }

    /// Returns the displacement of a joint from its start, `[rad]`: smallest, largest, and last.
    pub(crate) fn joint(&self, joint: usize) -> (f64, f64, f64) {
        let of = |state: &RobotState| state.q[joint] - self.0[0].q[joint];
        let (least, most) = self.extent(of);
        (least, most, of(self.last()))
    }

    /// Returns the displacement of the joints from the ready pose along their [`self_motion`],
    /// `[rad]`: smallest, largest, and last.
    pub(crate) fn elbow(&self) -> (f64, f64, f64) {
        let of = |state: &RobotState| {
            let q = JointVector::from(state.q);
            self_motion(&q).dot(&(q - READY))
        };
        let (least, most) = self.extent(of);
        (least, most, of(self.last()))
    }

    /// Returns the first recorded millisecond of the robot in which a condition was true.
    pub(crate) fn first(&self, so: impl Fn(&RobotState) -> bool) -> Option<u64> {
        let state = self.0.iter().find(|state| so(state));
        state.map(|state| state.message_id)
    }
}
