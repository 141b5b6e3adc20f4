//! From the description in a recording to a model.

use franka_async::explain::Explanation;
use franka_async::model::Frame;
use franka_async::recording::{RecordOptions, Recorder, Recording, Track};
use franka_model::limits::JointLimits;
use franka_model::{EndEffector, READY, RobotKind, transform};
use franka_sim::{Config, Sim};

use crate::connected;

/// Joint 1 turns beyond its range in the constants, and within its range on a system 5.9.
#[tokio::test]
async fn a_recording_is_judged_by_the_description_that_its_robot_served() {
    let mut q = READY;
    q[0] = 2.8;
    assert!(q[0] > JointLimits::of(RobotKind::Fr3).hard_upper[0]);
    let (robot, sim) = connected(Sim::new(Config {
        q,
        ..Config::default()
    }))
    .await;
    let name = format!("franka-described-{}.mcap", std::process::id());
    let path = std::env::temp_dir().join(name);
    let recorder = Recorder::to_file(&path, RecordOptions::default()).expect("a new file");
    let attached = recorder.attach(&robot, Track::default()).await;
    attached.expect("the only robot");
    q[1] += 0.01;
    robot.move_joints(q).await.expect("within its range");
    recorder.finish().expect("room for it");

    let recording = Recording::open(&path).expect("a recording");
    std::fs::remove_file(&path).expect("its own file");
    let recorded = recording.robot("").expect("the robot");
    let model = recorded.model().expect("a known kind");
    assert_eq!((&model.model, &model.fallback), (robot.model(), &None));
    let explanation = Explanation::of_recording(&recorded, &model);
    let nearest = explanation.margins.position.expect("cycles");
    let upper = robot.model().joint_limits().upper[0];
    assert_eq!((nearest.joint, nearest.limit), (Some(1), upper));
    assert!(nearest.margin > 0.05, "{nearest:?}");
    assert!(!explanation.to_string().contains("constants"));

    // Poses of the reference have the lengths of the robot.
    let cycles = recorded.cycles().map(|cycle| cycle.expect("readable"));
    let moving = cycles.filter(|cycle| cycle.record.q_ref != [0.0; 7]);
    let cycle = moving.last().expect("a motion");
    let ee = EndEffector::from_arrays(&cycle.state.F_T_EE, &cycle.state.EE_T_K);
    let q_ref = cycle.record.q_ref.into();
    let pose = robot.model().pose(Frame::EndEffector, &q_ref, &ee);
    let reference = cycle.reference.expect("a reference");
    let off = (transform::matrix(&reference) - pose).amax();
    assert!(off < 1e-6, "{off} m");
    robot.shutdown().await;
    drop(sim);
}
