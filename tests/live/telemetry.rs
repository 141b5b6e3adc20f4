//! Content and destination of the statistics while a robot is connected.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, Once, PoisonError};
use std::time::{Duration, Instant};

use franka_async::control::{Finish, Torques};
use franka_async::goal::{Backend, ForceCap, Gains, Setpoints, Tuning};
use franka_async::settings::CollisionBehavior;
use franka_async::state::RobotError;
use franka_async::supervision::{Condition, Policy};
use franka_async::{Engage, MotionReport, Pose, Realtime, Robot};
use franka_sim::network::{BurstLoss, Conditions, Loss};
use franka_sim::{Network, Sim, Tool};
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt;

use crate::{SOON, ahead_of_the_client, alone, planning};

/// One event, with its thread and its spans, the outermost first.
pub(crate) struct Told {
    thread: String,
    spans: Vec<&'static str>,
    pub(crate) level: Level,
    pub(crate) fields: BTreeMap<&'static str, String>,
}

/// Everything told in this process.
static TOLD: Mutex<Vec<Told>> = Mutex::new(Vec::new());

struct Listener;

impl<S: Subscriber + for<'a> LookupSpan<'a>> Layer<S> for Listener {
    fn on_event(&self, event: &Event<'_>, context: Context<'_, S>) {
        struct Fields(BTreeMap<&'static str, String>);
        impl Visit for Fields {
            fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
                self.0.insert(field.name(), format!("{value:?}"));
            }
        }
        let mut fields = Fields(BTreeMap::new());
        event.record(&mut fields);
        let thread = std::thread::current().name().unwrap_or_default().to_owned();
        let scope = context.event_scope(event).into_iter();
        let spans = scope.flat_map(|scope| scope.from_root().map(|span| span.name()));
        let spans = spans.collect();
        let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
        told.push(Told {
            thread,
            spans,
            level: *event.metadata().level(),
            fields: fields.0,
        });
    }
}

pub(crate) fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let log = tracing_subscriber::registry();
        log.with(Listener).with(planning::Barrier).init();
    });
    TOLD.lock().unwrap_or_else(PoisonError::into_inner).clear();
}

/// Events since [`listen`] that have this field.
pub(crate) fn told(field: &str) -> Vec<Told> {
    let told = std::mem::take(&mut *TOLD.lock().unwrap_or_else(PoisonError::into_inner));
    told.into_iter()
        .filter(|told| told.fields.contains_key(field))
        .collect()
}

/// Floats for 400 ms, and takes 5 ms over each of the cycles at 100 and 110 ms. The cycle at 300 ms
/// takes 20 ms, by the wall clock and by the robot's `time`.
async fn dawdle(robot: &Robot, time: Arc<AtomicU64>) -> MotionReport {
    let (mut floated, mut dawdled) = (Duration::ZERO, 0);
    let control = robot.control_torques(move |_, step| {
        floated += step;
        let due = [(100, 5), (110, 5), (300, 20)].get(dawdled);
        if let Some(&(at, long)) = due
            && floated >= Duration::from_millis(at)
        {
            dawdled += 1;
            let end = time.load(Ordering::Relaxed) + long;
            std::thread::sleep(Duration::from_millis(long));
            while time.load(Ordering::Relaxed) < end {
                std::thread::sleep(Duration::from_millis(1));
            }
        }
        Torques([0.0; 7]).finish_if(floated >= Duration::from_millis(400))
    });
    control.await.expect("the robot is patient")
}

#[tokio::test(flavor = "multi_thread")]
async fn slow_function_is_reported_outside_the_control_thread() {
    let _alone = alone();
    listen();
    let begun = Instant::now();
    let time = Arc::new(AtomicU64::new(0));
    let shown = time.clone();
    let sim = Sim::fr3()
        .ideal()
        .tool(Tool::hand())
        .every_millisecond(move |robot| {
            shown.store(robot.state().message_id, Ordering::Relaxed);
        });
    let (robot, _sim) = ahead_of_the_client(sim).await;
    let report = dawdle(&robot, time.clone()).await;
    // One of the delayed cycles, or a longer one, if the host delayed the thread.
    let worst = report.worst_cycle.expect("commands left");

    assert!(report.overruns >= 3, "{report:?}");
    assert!(report.skipped_states + report.lost_states > 0, "{report:?}");
    assert!(report.worst_turnaround >= Duration::from_millis(20));
    let slack = report.slack_min.expect("commands left");
    assert!(
        slack.overrun() >= Some(Duration::from_millis(19)),
        "{slack}"
    );
    assert!(worst.total() >= Duration::from_millis(20), "{worst:?}");
    let turnaround = report.turnaround.expect("commands left");
    assert_eq!(turnaround.max, report.worst_turnaround);

    let stats = robot.stats();
    assert!(stats.overrun.count() >= report.overruns);
    assert!(stats.worst_cycle().expect("commands left").total() >= worst.total());
    let motion = stats.motion().expect("there was one");
    assert_eq!(motion.overruns, report.overruns);
    assert_eq!(motion.success_rate_min, report.success_rate_min);
    // A delayed warning is reported within a second.
    let overruns = stats.overrun.count();
    let mut events = Vec::new();
    let warned = |events: &[Told]| -> u64 {
        let warnings = events.iter().filter(|told| told.level == Level::WARN);
        warnings
            .map(|told| told.fields["overruns"].parse::<u64>().expect("a number"))
            .sum()
    };
    while warned(&events) < overruns {
        assert!(begun.elapsed() < SOON, "some are not told of");
        tokio::time::sleep(Duration::from_millis(10)).await;
        events.extend(told("overruns"));
    }
    robot.shutdown().await;
    events.extend(told("overruns"));

    let threads: Vec<_> = events.iter().map(|told| told.thread.as_str()).collect();
    assert!(!threads.contains(&"franka-rt"), "{threads:?}");
    let of = |level| events.iter().filter(move |told| told.level == level);
    let sums: Vec<_> = of(Level::INFO).collect();
    assert_eq!(sums.len(), 1);
    let field = |name| sums[0].fields[name].as_str();
    assert_eq!(field("ending"), "Finished");
    assert_eq!(field("lost"), report.lost_states.to_string());
    assert_eq!(field("skipped"), report.skipped_states.to_string());
    assert_eq!(field("overruns"), report.overruns.to_string());
    assert_eq!(field("worst_time"), worst.time.to_string());
    assert_eq!(field("worst_phase"), worst.longest().0.to_string());
    assert_eq!(warned(&events), overruns, "each is told of once");
    let seconds = begun.elapsed().as_secs() as usize;
    assert!(
        of(Level::WARN).count() <= seconds + 2,
        "once a second at most"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn motion_ended_by_lost_packets_names_causes_off_thread() {
    let _alone = alone();
    listen();
    // After some 200 commands no more get through.
    let lost = Conditions {
        loss: Loss::Bursts(BurstLoss {
            begin: 0.005,
            end: 0.0,
            good: 0.0,
            bad: 1.0,
        }),
        ..Conditions::default()
    };
    let network = Network::new(1, Conditions::default(), lost);
    let sim = Sim::fr3().ideal().tool(Tool::hand()).network(network);
    let sim = sim.start().await.expect("a robot");
    let robot = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = robot.connect().await.expect("connected");
    let away = Pose::translation(0.0, 0.2, 0.0) * robot.pose();
    let error = robot.move_to(away).await.expect_err("commands are lost");
    assert!(error.control().is_some(), "{error}");
    let begun = Instant::now();
    let mut events = Vec::new();
    while events.is_empty() {
        assert!(begun.elapsed() < SOON, "nothing is told");
        tokio::time::sleep(Duration::from_millis(10)).await;
        events.extend(told("causes"));
    }
    robot.shutdown().await;
    let [event] = &events[..] else {
        panic!("{} events", events.len())
    };
    assert_eq!(event.level, Level::WARN);
    assert_ne!(event.thread, "franka-rt");
    let causes = &event.fields["causes"];
    assert!(causes.contains("on this computer:"), "{causes}");
}

/// Shows that the test above could fail: the control thread has the name that it looks for.
#[tokio::test(flavor = "multi_thread")]
async fn an_event_on_the_control_thread_would_be_seen() {
    let _alone = alone();
    listen();
    let (robot, _sim) = crate::simulated().await;
    let mut first = true;
    let control = robot.control_torques(move |_, _| {
        if std::mem::take(&mut first) {
            tracing::info!(misplaced = true);
        }
        Torques([0.0; 7]).finish()
    });
    control.await.expect("it ends at once");
    robot.shutdown().await;
    let events = told("misplaced");
    let threads: Vec<_> = events.iter().map(|told| told.thread.as_str()).collect();
    assert_eq!(threads, ["franka-rt"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn detached_motion_tells_its_end_even_if_it_never_begins() {
    let _alone = alone();
    listen();
    let (robot, _sim) = crate::simulated().await;
    let here = robot.pose();
    robot
        .move_to(Pose::translation(5.0, 0.0, 0.0) * here)
        .detach();
    robot.move_to(here).await.unwrap();
    robot.shutdown().await;
    let told = told("goal");
    let errors: Vec<_> = told.iter().map(|told| told.fields.get("error")).collect();
    let [Some(refused), None] = errors[..] else {
        panic!("{errors:?}")
    };
    assert!(refused.contains("no joint positions"), "{refused}");
}

#[tokio::test(flavor = "multi_thread")]
async fn connect_motion_and_recovery_log_a_line_in_their_spans() {
    let _alone = alone();
    listen();
    let (robot, sim) = ahead_of_the_client(Sim::fr3().ideal().tool(Tool::hand())).await;
    robot.shutdown().await;
    listen();
    let policy = Policy::default().recover(1, Duration::from_secs(1));
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = builder.supervise(policy).connect().await.expect("it runs");
    let there = robot.state().q;
    robot.move_joints(there).await.expect("it is there");
    let mut health = robot.health();
    let trip = |robot: &mut franka_sim::Robot| robot.trip(RobotError::JointReflex);
    sim.with(trip).await.expect("it runs");
    for ready in [false, true] {
        let shown = health.wait_for(|health| (health.condition == Condition::Ready) == ready);
        tokio::time::timeout(SOON, shown)
            .await
            .expect("it is told")
            .expect("it goes on");
    }
    // A state shows the recovery before its request is answered.
    let begun = Instant::now();
    let mut lines = told("message");
    while !lines.iter().any(|line| line.spans.contains(&"recovery")) {
        assert!(begun.elapsed() < SOON, "no answer");
        tokio::time::sleep(Duration::from_millis(1)).await;
        lines.append(&mut told("message"));
    }
    robot.shutdown().await;
    lines.append(&mut told("message"));
    for (spans, message) in [
        (&["connect"][..], "connected"),
        (&["robot", "motion"], "motion ended"),
        (&["robot", "recovery"], "recovered"),
    ] {
        let lines = lines.iter().filter(|told| told.spans == spans);
        let lines: Vec<_> = lines.map(|told| told.fields["message"].as_str()).collect();
        assert_eq!(lines, [message], "{spans:?}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn gains_near_an_oscillation_are_warned_of() {
    let _alone = alone();
    listen();
    let (robot, _sim) = ahead_of_the_client(Sim::fr3().ideal().tool(Tool::hand())).await;
    let stiff = Gains::joint();
    let wild = Gains {
        joint_damping: stiff.joint_damping.map(|damping| 2.0 * damping),
        ..stiff
    };
    assert!(robot.margin(&stiff).expect("a tool").is_wanted());
    for (gains, warned) in [(stiff, false), (wild, true)] {
        let there = robot.state().q;
        let moved = robot.move_joints(there).gains(gains).await;
        moved.expect("it is there");
        let told = told("damping");
        assert_eq!(told.len(), usize::from(warned));
        assert!(told.iter().all(|told| told.level == Level::WARN));
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn thresholds_below_the_force_cap_are_warned_of() {
    let _alone = alone();
    listen();
    let (robot, _sim) = ahead_of_the_client(Sim::fr3().ideal().tool(Tool::hand())).await;
    let there = robot.state().q;
    for (behavior, force_cap, warned) in [
        (CollisionBehavior::compliant(), 30.0, 0),
        (CollisionBehavior::careful(), 30.0, 1),
        (CollisionBehavior::insensitive(), 95.0, 1),
    ] {
        robot.set_collision_behavior(behavior).await.expect("set");
        let moved = robot.move_joints(there).force_cap(force_cap).await;
        moved.expect("it is there");
        warns(warned);
    }
}

/// Asserts the number of warnings, since the last call, that the robot stops before the arm yields.
fn warns(times: usize) {
    let told = told("threshold_newtons");
    assert_eq!(told.len(), times);
    assert!(told.iter().all(|told| told.level == Level::WARN));
}

#[tokio::test(flavor = "multi_thread")]
async fn sessions_are_warned_of_thresholds_as_single_motions_are() {
    let _alone = alone();
    listen();
    let (robot, _sim) = ahead_of_the_client(Sim::fr3().tool(Tool::hand())).await;
    let careful = CollisionBehavior::careful();
    robot.set_collision_behavior(careful).await.expect("set");
    let there = robot.state().q;
    let arm = robot.engage(Engage::default()).await.expect("it is free");
    warns(1);
    arm.move_joints(there).await.expect("it is there");
    warns(1);
    let cap = |newtons| Tuning {
        force_cap: Some(ForceCap::Newtons(newtons)),
        ..Tuning::default()
    };
    arm.tune(cap(20.0)).await.expect("within the bounds");
    warns(1);
    arm.disengage().await.expect("it ends as asked");

    // The robot's controller does not yield: nothing is reported.
    let stiff = Engage::default().backend(Backend::joint_impedance(Setpoints::JointPositions));
    let arm = robot.engage(stiff).await.expect("it is free");
    arm.move_joints(there).await.expect("it is there");
    arm.disengage().await.expect("it ends as asked");
    warns(0);

    let compliant = CollisionBehavior::compliant();
    robot.set_collision_behavior(compliant).await.expect("set");
    let arm = robot.engage(Engage::default()).await.expect("it is free");
    arm.move_joints(there).await.expect("it is there");
    arm.tune(cap(49.0)).await.expect("within the bounds");
    warns(0);
    arm.tune(cap(51.0)).await.expect("within the bounds");
    warns(1);
    arm.disengage().await.expect("it ends as asked");
}
