//! An arm that is hit: the explanation of the error's log names the cause and the place.

use crate::diagnosis::begin;
use franka_diagnosis::Diagnose;
use franka_model::collision::Body;
use franka_model::{EndEffector, Frame};
use franka_proto::{CollisionBehavior, Request, RobotError};
use franka_record::explain::{Explanation, MomentKind};
use franka_rt::control::{Callback, JointVelocities};
use franka_sim::Touch;
use franka_tests::lockstep::{Lockstep, for_each_robot};
use nalgebra::{Point3, Vector3};

#[test]
fn a_blow_on_the_forearm_is_explained_from_the_log_of_the_error() {
    for_each_robot(|ready| {
        let mut lockstep: Lockstep = ready();
        let behavior = CollisionBehavior::uniform([3.0; 7], [12.0; 7], [10.0; 6], [40.0; 6]);
        lockstep.request(&Request::SetCollisionBehavior(behavior));
        lockstep.run(5);
        let version = lockstep.client.version();
        let hold = Callback::motion(version, |_, _| JointVelocities([0.0; 7]));
        let work = begin(&mut lockstep, hold);
        lockstep.run(1500);
        // On the forearm, against its side.
        let place = Vector3::new(0.03, 0.083, -0.118);
        let q = *lockstep.robot.q();
        let model = lockstep.client.lifecycle.model();
        let pose = model.pose(Frame::Joint5, &q, &EndEffector::default());
        let point = pose.transform_point(&Point3::from(place)).coords;
        let force = pose.fixed_view::<3, 3>(0, 0) * Vector3::new(-70.0, 0.0, 0.0);
        let touch = Touch::force(force).at(Frame::Joint5).offset(place);
        lockstep.robot.touch(touch);

        let error = lockstep.until_resolved(work, 1000).expect_err("a reflex");
        let error = error.control().expect("the robot stopped");
        let explanation = Explanation::of_error(error);
        let cause = explanation.cause.as_ref().expect("a reflex");
        assert!(cause.errors.contains(RobotError::JointReflex), "{cause:?}");
        assert_eq!(cause.diagnosis, error.diagnose());
        let contact = explanation.contact.as_ref().expect("cycles").contact;
        let contact = contact.expect("a contact");
        assert_eq!(contact.body, Body::Link(5));
        let off = (Vector3::from(contact.point) - point).norm();
        assert!(off < 0.06, "{off} m");
        let along = Vector3::from(contact.force).dot(&force) / (contact.size() * force.norm());
        assert!(along > 0.8, "{along}");
        let first = |kind| {
            let mut moments = explanation.timeline.iter();
            moments.position(|moment| moment.kind == kind)
        };
        let [contact, collision, stop] = [
            MomentKind::Contact,
            MomentKind::Collision,
            MomentKind::Error,
        ]
        .map(first);
        assert!(contact.is_some() && contact < collision && collision < stop);
        let figure = explanation.figure();
        assert!(figure.contains("collision") && figure.contains("link 5"));
    });
}
