//! Contacts whose torques are computed exactly.

#![allow(clippy::result_large_err)] // See `locate`.

use super::*;
use crate::collision::Shape;
use crate::random::Random;
use crate::{Frame, Model, READY, RobotKind};

/// Errors of exact torques. The only error of the estimate is the width of the patches.
const EXACT: TorqueError = TorqueError {
    floor: crate::joint_vector([0.05; 7]),
    share: 0.03,
    friction: crate::joint_vector([0.0; 7]),
};

fn arm(q: &JointVector) -> Placed<'static> {
    Shape::covering(RobotKind::Fr3).with_hand().at(q)
}

/// Returns the joint torques of a force on a link at a point, both in the base frame.
fn torque(q: &JointVector, body: Body, point: &Vector3<f64>, force: &Vector3<f64>) -> JointVector {
    let frame = match body {
        Body::Link(link) => Frame::ALL[usize::from(link) - 1],
        Body::Tool => Frame::Flange,
    };
    let ee = crate::EndEffector::default();
    let pose = Model::fr3().pose(frame, q, &ee);
    let origin = Vector3::new(pose.m14, pose.m24, pose.m34);
    let moment = (point - origin).cross(force);
    let wrench = crate::Wrench::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
    Model::fr3().zero_jacobian(frame, q, &ee).tr_mul(&wrench)
}

/// Returns a push along the normal at a random point of a body, and its torques.
fn push(
    random: &mut Random,
    placed: &Placed<'_>,
    q: &JointVector,
    body: Body,
) -> (Vector3<f64>, Vector3<f64>, JointVector) {
    let search = Search::new(placed, &JointVector::zeros(), &EXACT);
    let mut places = std::vec::Vec::new();
    search.visit(body, 0.01, |patch| places.push(*patch));
    let patch = places[random.bits() as usize % places.len()];
    let point = patch.point + Vector3::new(0.0, 0.0, SHOULDER);
    let force = patch.normal * -random.uniform(5.0, 40.0);
    (point, force, torque(q, body, &point, &force))
}

#[test]
fn exact_torques_name_body_place_and_force() {
    let mut random = Random::new(11);
    let placed = arm(&READY);
    let (mut told, mut right) = (0, 0);
    for round in 0..100 {
        let body = body(4 + round % 5);
        let (point, force, torque) = push(&mut random, &placed, &READY, body);
        let Ok(contact) = locate(&placed, &torque, &EXACT) else {
            continue;
        };
        told += 1;
        assert!(contact.force.dot(&contact.normal) < 0.0);
        // A force through the axis of the outermost joint may also act on the previous link.
        if contact.body != body {
            continue;
        }
        right += 1;
        let off = (contact.point - point).norm();
        assert!(off < 0.02 + 2.0 * contact.spread, "{off} m, {contact:?}");
        let part = (contact.force - force).norm() / force.norm();
        assert!(part < 0.15 || contact.spread > 0.02, "{part}: {contact:?}");
    }
    assert!(told > 80 && right * 100 >= told * 95, "{right} of {told}");
}

#[test]
fn unknown_contact_is_reported_with_the_reason() {
    let placed = arm(&READY);
    let locate = |torque: JointVector| locate(&placed, &torque, &EXACT);
    let mut torque = JointVector::zeros();
    assert!(matches!(locate(torque), Err(Unknown::Weak { ratio: 0.0 })));
    torque[0] = f64::NAN;
    assert_eq!(locate(torque), Err(Unknown::NotFinite));
    torque[0] = 5.0;
    assert!(matches!(locate(torque), Err(Unknown::Base { .. })));
    // A grip turns the last joint; no push on the surface causes such a torque.
    torque = JointVector::from([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0]);
    let grip = locate(torque);
    assert!(matches!(grip, Err(Unknown::Unexplained { .. })), "{grip:?}");
}

#[test]
fn a_force_that_pulls_is_not_taken_for_a_push_there() {
    let mut random = Random::new(3);
    let placed = arm(&READY);
    for _ in 0..20 {
        let (point, force, torque) = push(&mut random, &placed, &READY, Body::Link(6));
        let Ok(contact) = locate(&placed, &-torque, &EXACT) else {
            continue;
        };
        // The push may be on the other side of the link, along the same line.
        let way = contact.point - point;
        let beside = way - force * (way.dot(&force) / force.norm_squared());
        assert!((contact.force + force).norm() < 0.2 * force.norm());
        assert!(way.norm() > 0.03 && beside.norm() < 0.03, "{contact:?}");
    }
}

#[test]
fn numbers_of_any_size_are_taken() {
    let placed = arm(&READY);
    for torque in [1e-300, 1e300, f64::MAX] {
        let _ = locate(&placed, &JointVector::repeat(torque), &EXACT);
    }
    let nowhere = arm(&JointVector::repeat(f64::NAN));
    assert!(locate(&nowhere, &JointVector::repeat(1.0), &EXACT).is_err());
}

#[test]
fn the_tare_follows_offset_and_friction_and_not_a_contact() {
    let offset = JointVector::from([0.3, -0.5, 0.1, 0.8, -0.3, 0.2, 0.0]);
    let friction = JointVector::from([0.3, 0.3, 0.2, 0.4, 0.2, 0.1, 0.1]);
    let mut tare = Tare::new();
    let run = |tare: &mut Tare, milliseconds: u32, push: f64| {
        let mut left = JointVector::zeros();
        for i in 0..milliseconds {
            // The joints move back and forth, half a second in each direction.
            let v = if (i / 500) % 2 == 0 { 0.2 } else { -0.2 };
            let dq = JointVector::repeat(v);
            let read = offset + friction * (v / 0.2) + JointVector::repeat(push);
            left = tare.update(&read, &dq, 1e-3);
        }
        left
    };
    run(&mut tare, 10_000, 0.0);
    let left = run(&mut tare, 1000, 0.0);
    assert!(left.amax() < 0.1, "{left}");
    assert!(!tare.is_touched());
    // The baseline stays frozen, however long the contact lasts.
    for _ in 0..20 {
        let left = run(&mut tare, 1000, 4.0);
        assert!((left.add_scalar(-4.0)).amax() < 0.1, "{left}");
        assert!(tare.is_touched());
    }
    assert!(run(&mut tare, 1000, 0.0).amax() < 0.1);
}
