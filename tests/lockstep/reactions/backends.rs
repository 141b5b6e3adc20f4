//! Reactions under the robot's own controller, which presses with its own stiffness.

use franka_lockstep::{Lockstep, for_each_robot};
use franka_model::RobotKind;
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::condition::{elapsed, force_z};
use franka_rt::session::{Backend, GoalError, GoalId, OnArrival, Target};
use nalgebra::Translation3;

use super::{MS, above, at, felt, goes_on, realistic, report, says_so, table, tolerate};

fn engaged(lockstep: &mut Lockstep, backend: Backend) -> GoalId {
    tolerate(lockstep);
    lockstep.engage_with(Engagement {
        backend,
        ..Engagement::default()
    })
}

#[test]
fn the_robots_controller_reacts_to_a_table_as_well() {
    for backend in Backend::ROBOT_CONTROLLERS {
        for kind in RobotKind::ALL {
            for retreats in [false, true] {
                let mut lockstep = realistic(kind, 2);
                let engaged = engaged(&mut lockstep, backend);
                let table = table(&mut lockstep, 0.03, 5000.0);
                let home = lockstep.arm_pose();
                let down = above(&lockstep, -0.1);
                let touched = force_z(8.0).relative();
                let reaction = match retreats {
                    true => touched.then(home),
                    false => touched.into(),
                };
                let goal = at(
                    0.05,
                    down,
                    reaction,
                    OnArrival::ReportAndHold,
                    &mut lockstep,
                );
                let goal = lockstep.submit_within(engaged, goal).expect("within reach");
                let mut most = 0.0_f64;
                while goes_on(&lockstep, goal) {
                    lockstep.tick();
                    most = most.max(felt(&lockstep, table));
                }
                let report = report(&mut lockstep, goal);
                assert!(report.reacted.is_some(), "{report:?}");
                assert!(says_so(&lockstep));
                println!("{kind:?}, {backend}: {most:.1} N");
                assert!(most < 30.0, "{most} N");
                assert_eq!(report.final_error.is_some(), retreats);
                assert_eq!(felt(&lockstep, table) == 0.0, retreats);
            }
        }
    }
}

/// The robot continues without commands meanwhile, and the reference moves to its position.
#[test]
fn lost_commands_during_a_reaction_do_not_keep_it_from_its_end() {
    for_each_robot(|ready| {
        for backend in Backend::ROBOT_CONTROLLERS {
            for lost in [1, 4, 12] {
                let mut lockstep = ready();
                let engaged = engaged(&mut lockstep, backend);
                let home = lockstep.arm_pose();
                let up = above(&lockstep, 0.1);
                let due = elapsed(600 * MS).then(home);
                let goal = at(0.2, up, due, OnArrival::ReportAndHold, &mut lockstep);
                let goal = lockstep.submit_within(engaged, goal).expect("within reach");
                for at in 0..4000 {
                    if at % 20 == 0 && (600..720).contains(&at) {
                        lockstep.link.drop_commands(lost);
                    }
                    lockstep.tick();
                }
                let report = report(&mut lockstep, goal);
                assert!(report.reacted.is_some(), "{report:?}");
                let off = lockstep.arm_pose().translation.vector - home.translation.vector;
                assert!(off.norm() < 6e-3, "{off}");
            }
        }
    });
}

#[test]
fn a_controller_that_takes_poses_only_goes_on_to_poses_only() {
    for backend in Backend::ROBOT_CONTROLLERS
        .into_iter()
        .filter(|backend| backend.is_cartesian())
    {
        let mut lockstep = Lockstep::ready();
        let engaged = engaged(&mut lockstep, backend);
        let aside = Translation3::new(0.0, 0.05, 0.0) * lockstep.arm_pose();
        let joints = elapsed(10 * MS).then(<[f64; 7]>::from(franka_model::READY));
        let goal = at(
            0.2,
            aside.into(),
            joints,
            OnArrival::ReportAndHold,
            &mut lockstep,
        );
        let refused = MotionError::Goal(GoalError::Backend {
            backend,
            got: "joint positions as target",
            expected: "a pose, joint setpoints or Backend::Torques",
        });
        assert_eq!(lockstep.submit_within(engaged, goal), Err(refused));
        let rest = elapsed(10 * MS).then(Target::Rest);
        let goal = at(
            0.2,
            aside.into(),
            rest,
            OnArrival::ReportAndHold,
            &mut lockstep,
        );
        assert!(lockstep.submit_within(engaged, goal).is_ok());
    }
}
