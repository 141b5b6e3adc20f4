//! Reflexes of the simulated robot, and the diagnosis of their causes.

mod arm;
mod losses;
mod steps;

use franka_diagnosis::{Diagnose, Diagnosis, Origin, Quantity, Subject};
use franka_lockstep::Lockstep;
use franka_proto::RobotError;
use franka_rt::control::{Callback, JointVelocities, Shaper};
use franka_rt::session::GoalId;

/// Cycles before the fault: enough for a success rate over a hundred of them, and for a log that
/// has wrapped around.
const QUIET: u32 = 150;

/// Begins a motion under `callback`, whose commands are sent without filter and limiter.
pub(crate) fn begin(lockstep: &mut Lockstep, callback: Callback) -> GoalId {
    let version = lockstep.client.version();
    let callback = callback.with_shaper(Shaper::new(version, false, 1000.0));
    lockstep.control_function(callback).expect("nothing moves")
}

/// Begins a motion under a function that returns the joint velocities, `[rad/s]`, of each cycle,
/// counted from 1.
fn velocities(
    lockstep: &mut Lockstep,
    mut at: impl FnMut(u32) -> [f64; 7] + Send + 'static,
) -> GoalId {
    let mut cycle = 0;
    let callback = Callback::motion(lockstep.client.version(), move |_, _| {
        cycle += 1;
        JointVelocities(at(cycle))
    });
    begin(lockstep, callback)
}

/// Runs until a reflex ends the motion; prints the diagnosis and checks its form.
fn diagnosis(lockstep: &mut Lockstep, work: GoalId) -> Diagnosis {
    let error = lockstep.until_resolved(work, 8000).expect_err("a reflex");
    let diagnosis = error.diagnose().expect("ended by the robot");
    println!("{diagnosis}\n");
    let text = diagnosis.to_string();
    assert!(text.lines().count() <= 6, "{text}");
    assert_eq!(
        diagnosis.errors,
        error.control().unwrap().failure.reflex_reason
    );
    diagnosis
}

/// The finding: error, subject, quantity and origin.
fn found(diagnosis: &Diagnosis) -> (RobotError, Subject, Quantity, Origin) {
    let finding = diagnosis.finding.expect("it is visible");
    assert_eq!(diagnosis.error, Some(finding.error));
    (
        finding.error,
        finding.subject,
        finding.quantity,
        finding.origin,
    )
}

/// The exceeded limit; asserts that the value is beyond it.
fn limit(diagnosis: &Diagnosis) -> f64 {
    let finding = diagnosis.finding.expect("it is visible");
    let Some(limit) = finding.bound.limit() else {
        panic!("{finding:?} has no limit")
    };
    assert!(
        finding.excess().is_some_and(|excess| excess > 0.0),
        "{finding:?}"
    );
    limit
}

/// A function that returns zeros, and after [`QUIET`] cycles `value` for joint `index`.
pub(crate) fn stepping(index: usize, value: f64) -> impl FnMut() -> [f64; 7] + Send {
    let mut cycle = 0;
    move || {
        cycle += 1;
        let mut values = [0.0; 7];
        values[index] = if cycle > QUIET { value } else { 0.0 };
        values
    }
}
