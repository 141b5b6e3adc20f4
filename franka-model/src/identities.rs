//! Laws of mechanics that relate the algorithms, checked at random states and loads.

use nalgebra::{Matrix3, Vector3};

use crate::random::Random;
use crate::{
    EndEffector, Frame, GRAVITY_EARTH, JointVector, Load, MassMatrix, Model, RigidBody, RobotKind,
    Twist, rotation, transform,
};

/// One state of the arm, with all inputs of the model.
struct Case {
    q: JointVector,
    dq: JointVector,
    ddq: JointVector,
    load: Load,
    ee: EndEffector,
    gravity: Vector3<f64>,
}

/// Returns every constant model. The FER client's model is not a set of physical bodies, and it
/// adds loads to link 7 with a non-physical rule. The tests mark the places where this matters.
fn models() -> [&'static Model; 3] {
    [
        Model::fr3(),
        Model::fer(),
        Model::physically_consistent(RobotKind::Fer),
    ]
}

/// Returns true if a load acts as an additional rigid body.
fn loads_add_up(model: &Model) -> bool {
    !core::ptr::eq(model, Model::fer())
}

/// Calls `check` with many cases of every model. Every fourth case has no load.
fn for_each_case(seed: u64, check: impl Fn(&Model, &Case)) {
    for model in models() {
        for_each_case_of(model, seed, &check);
    }
}

fn for_each_case_of(model: &Model, seed: u64, check: &impl Fn(&Model, &Case)) {
    let mut random = Random::new(seed);
    for index in 0..CASES {
        let mut frame = || {
            let rotation = rotation::exp(&random.vector3(2.0));
            transform::matrix(&nalgebra::Isometry3::from_parts(
                random.vector3(0.2).into(),
                rotation,
            ))
        };
        let ee = EndEffector {
            f_t_ee: frame(),
            ee_t_k: frame(),
        };
        let load = random.load();
        let case = Case {
            q: random.posture(model),
            dq: random.joints(2.0),
            ddq: random.joints(10.0),
            load: if index % 4 == 0 { Load::NONE } else { load },
            ee,
            gravity: random.vector3(10.0),
        };
        check(model, &case);
    }
}

fn unit(i: usize) -> JointVector {
    JointVector::from_fn(|k, _| f64::from(u8::from(k == i)))
}

const ZERO: JointVector = crate::joint_vector([0.0; 7]);
const FLOATING: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);
/// Number of cases per model: ten thousand in total, or ten thousand per model in release builds.
const CASES: usize = if cfg!(debug_assertions) {
    3_400
} else {
    10_000
};

#[test]
fn the_mass_matrix_is_symmetric_and_positive_definite() {
    for_each_case(31, |model, case| {
        let mass = model.mass(&case.q, &case.load);
        assert_eq!(mass, mass.transpose());
        let least = mass.symmetric_eigenvalues().min();
        assert!(least > 9e-5, "eigenvalue {least}");
    });
}

#[test]
fn columns_of_the_mass_matrix_are_torques_of_unit_accelerations() {
    for_each_case(32, |model, case| {
        let mass = model.mass(&case.q, &case.load);
        for i in 0..7 {
            let torques = model.inverse_dynamics(&case.q, &ZERO, &unit(i), &case.load, &FLOATING);
            assert!((mass.column(i) - torques).amax() < 1e-13);
        }
    });
}

#[test]
fn inverse_dynamics_is_the_sum_of_its_terms() {
    for_each_case(33, |model, case| {
        let Case {
            q,
            dq,
            ddq,
            load,
            gravity,
            ..
        } = case;
        let whole = model.inverse_dynamics(q, dq, ddq, load, gravity);
        let sum = model.mass(q, load) * ddq
            + model.coriolis(q, dq, load)
            + model.gravity(q, load, gravity);
        assert!((whole - sum).amax() < 1e-12);
    });
}

#[test]
fn forward_dynamics_undoes_inverse_dynamics() {
    for_each_case(34, |model, case| {
        let Case {
            q,
            dq,
            ddq,
            load,
            gravity,
            ..
        } = case;
        let armature = JointVector::from_element(0.05);
        let torques =
            model.inverse_dynamics(q, dq, ddq, load, gravity) + armature.component_mul(ddq);
        let back = model.forward_dynamics(q, dq, &torques, load, gravity, &armature);
        assert!((back.expect("positive definite") - ddq).amax() < 1e-10);
    });
}

#[test]
fn forward_dynamics_refuses_what_is_not_positive_definite() {
    let (model, q) = (Model::fr3(), crate::READY);
    let solve = |q: &JointVector, armature: f64| {
        let armature = JointVector::from_element(armature);
        model.forward_dynamics(q, &ZERO, &ZERO, &Load::NONE, &GRAVITY_EARTH, &armature)
    };
    assert!(solve(&q, 0.0).is_some());
    assert_eq!(solve(&q, -0.1), None);
    assert_eq!(solve(&JointVector::from_element(f64::NAN), 0.1), None);
}

/// Returns the mass, the centre of mass and the inertia of body `i` in base axes, from the frames'
/// poses. Body 7 is the load.
fn body(model: &Model, case: &Case, i: usize) -> (f64, Vector3<f64>, Matrix3<f64>, Frame) {
    let (frame, mass, com, inertia) = if i == 7 {
        let load = &case.load;
        (Frame::Flange, load.mass, load.com, load.inertia)
    } else {
        let link = &model.links()[i];
        (Frame::ALL[i], link.mass, link.com, link.inertia.matrix())
    };
    let pose = model.pose(frame, &case.q, &case.ee);
    let rotation = pose.fixed_view::<3, 3>(0, 0);
    let place = pose.transform_point(&com.into()).coords;
    (
        mass,
        place,
        rotation * inertia * rotation.transpose(),
        frame,
    )
}

#[test]
fn kinetic_energy_is_that_of_the_bodies() {
    for_each_case(35, |model, case| {
        let load = if loads_add_up(model) {
            case.load
        } else {
            Load::NONE
        };
        let case = &Case { load, ..*case };
        let mut energy = 0.0;
        for i in 0..8 {
            let (mass, com, inertia, frame) = body(model, case, i);
            let twist = model.zero_jacobian(frame, &case.q, &case.ee) * case.dq;
            let origin = model.pose(frame, &case.q, &case.ee);
            let lever = com - origin.fixed_view::<3, 1>(0, 3);
            let omega = twist.fixed_rows::<3>(3).into_owned();
            let velocity = twist.fixed_rows::<3>(0) + omega.cross(&lever);
            energy += 0.5 * (mass * velocity.norm_squared() + omega.dot(&(inertia * omega)));
        }
        let quadratic = 0.5 * case.dq.dot(&(model.mass(&case.q, &case.load) * case.dq));
        assert!((energy - quadratic).abs() < 1e-12 * energy.max(1.0));
    });
}

#[test]
fn gravity_is_the_gradient_of_the_potential() {
    let potential = |model: &Model, case: &Case, q: JointVector| -> f64 {
        let case = Case { q, ..*case };
        let energy = |i| {
            let (mass, com, ..) = body(model, &case, i);
            -mass * com.dot(&case.gravity)
        };
        (0..8).map(energy).sum()
    };
    for_each_case(36, |model, case| {
        let gravity = model.gravity(&case.q, &case.load, &case.gravity);
        for i in 0..7 {
            let h = 1e-4;
            let (after, before) = (case.q + unit(i) * h, case.q - unit(i) * h);
            let slope =
                (potential(model, case, after) - potential(model, case, before)) / (2.0 * h);
            // The third derivative of some 100 J over rad³, times h²/6.
            assert!((gravity[i] - slope).abs() < 1e-6);
        }
    });
}

#[test]
fn coriolis_torques_follow_from_the_mass_matrix() {
    for_each_case(37, |model, case| {
        let h = 1e-5;
        let slopes: [MassMatrix; 7] = core::array::from_fn(|i| {
            let mass = |step: f64| model.mass(&(case.q + unit(i) * step), &case.load);
            (mass(h) - mass(-h)) / (2.0 * h)
        });
        let coriolis = model.coriolis(&case.q, &case.dq, &case.load);
        let along = (0..7).fold(MassMatrix::zeros(), |sum, k| sum + slopes[k] * case.dq[k]);
        for i in 0..7 {
            // Lagrange's equations: d/dt (M dq) minus the gradient of the kinetic energy.
            let expected = (along * case.dq)[i] - 0.5 * case.dq.dot(&(slopes[i] * case.dq));
            assert!((coriolis[i] - expected).abs() < 1e-7);
        }
    });
}

#[test]
fn coriolis_torques_do_no_work_but_what_changes_the_inertia() {
    // dM/dt − 2 C does no work. Control laws rely on this passivity.
    for_each_case(44, |model, case| {
        let h = 1e-5;
        let mass = |step: f64| model.mass(&(case.q + case.dq * step), &case.load);
        let rate = (mass(h) - mass(-h)) / (2.0 * h);
        let work = case.dq.dot(&model.coriolis(&case.q, &case.dq, &case.load));
        let expected = 0.5 * case.dq.dot(&(rate * case.dq));
        assert!((work - expected).abs() < 1e-7, "{work} {expected}");
    });
}

#[test]
fn a_free_swing_keeps_its_energy() {
    let potential = |model: &Model, case: &Case| -> f64 {
        let energy = |i| {
            let (mass, com, ..) = body(model, case, i);
            -mass * com.dot(&case.gravity)
        };
        (0..8).map(energy).sum()
    };
    let mut random = Random::new(45);
    for kind in RobotKind::ALL {
        let model = Model::physically_consistent(kind);
        for _ in 0..20 {
            let mut case = Case {
                q: random.posture(model),
                dq: random.joints(1.0),
                ddq: ZERO,
                load: random.load(),
                ee: EndEffector::default(),
                gravity: GRAVITY_EARTH,
            };
            let energy = |case: &Case| {
                let mass = model.mass(&case.q, &case.load);
                0.5 * case.dq.dot(&(mass * case.dq)) + potential(model, case)
            };
            let before = energy(&case);
            // Fourth-order Runge-Kutta integration, a quarter of a second.
            let rate = |q: JointVector, dq: JointVector| {
                let (load, gravity) = (&case.load, &case.gravity);
                let ddq = model.forward_dynamics(&q, &dq, &ZERO, load, gravity, &ZERO);
                (dq, ddq.expect("positive definite"))
            };
            let (mut q, mut dq, h) = (case.q, case.dq, 2.5e-4);
            for _ in 0..1000 {
                let (a, b) = rate(q, dq);
                let (c, d) = rate(q + a * (h / 2.0), dq + b * (h / 2.0));
                let (e, f) = rate(q + c * (h / 2.0), dq + d * (h / 2.0));
                let (g, k) = rate(q + e * h, dq + f * h);
                q += (a + (c + e) * 2.0 + g) * (h / 6.0);
                dq += (b + (d + f) * 2.0 + k) * (h / 6.0);
            }
            (case.q, case.dq) = (q, dq);
            let drift = energy(&case) - before;
            assert!(drift.abs() < 1e-6, "{kind:?}: {drift:e} J");
        }
    }
}

#[test]
fn jacobians_are_derivatives_of_poses() {
    for_each_case(38, |model, case| {
        let h = 1e-5;
        for frame in Frame::ALL {
            let at = |step: f64| {
                let pose = model.pose(frame, &(case.q + case.dq * step), &case.ee);
                transform::isometry(&pose).expect("rigid frames")
            };
            let (after, before, here) = (at(h), at(-h), at(0.0));
            let linear = (after.translation.vector - before.translation.vector) / (2.0 * h);
            let angular = rotation::error(&after.rotation, &before.rotation) / (2.0 * h);
            let numeric =
                |a: Vector3<f64>, b: Vector3<f64>| Twist::new(a.x, a.y, a.z, b.x, b.y, b.z);
            let zero = model.zero_jacobian(frame, &case.q, &case.ee) * case.dq;
            assert!((zero - numeric(linear, angular)).amax() < 1e-8, "{frame:?}");
            let inverse = here.rotation.inverse();
            let body = model.body_jacobian(frame, &case.q, &case.ee) * case.dq;
            let expected = numeric(inverse * linear, inverse * angular);
            assert!((body - expected).amax() < 1e-8, "{frame:?}");
        }
    });
}

#[test]
fn joints_beyond_a_frame_do_not_move_it() {
    for_each_case(39, |model, case| {
        for frame in Frame::ALL {
            let jacobian = model.zero_jacobian(frame, &case.q, &case.ee);
            let beyond = jacobian.columns_range(frame.joints()..);
            assert!(beyond.iter().all(|x| *x == 0.0), "{frame:?}");
        }
    });
}

#[test]
fn bias_acceleration_is_the_jacobians_rate_times_velocity() {
    for_each_case(40, |model, case| {
        let h = 1e-5;
        let jacobian = |step: f64| {
            let q = case.q + case.dq * step;
            model.zero_jacobian(Frame::EndEffector, &q, &case.ee)
        };
        let numeric = (jacobian(h) - jacobian(-h)) / (2.0 * h) * case.dq;
        let Case {
            q, dq, ee, load, ..
        } = case;
        let dynamics = model.dynamics(q, dq, ee, load, &case.gravity);
        assert!((dynamics.jdot_dq - numeric).amax() < 1e-7);
    });
}

#[test]
fn one_pass_gives_what_the_separate_calls_give() {
    for_each_case(41, |model, case| {
        let Case {
            q,
            dq,
            ee,
            load,
            gravity,
            ..
        } = case;
        let all = model.dynamics(q, dq, ee, load, gravity);
        let frame = Frame::EndEffector;
        assert!((all.pose - model.pose(frame, q, ee)).amax() < 1e-13);
        assert!((all.jacobian - model.zero_jacobian(frame, q, ee)).amax() < 1e-13);
        assert!((all.mass - model.mass(q, load)).amax() < 1e-13);
        assert!((all.coriolis - model.coriolis(q, dq, load)).amax() < 1e-13);
        assert!((all.gravity - model.gravity(q, load, gravity)).amax() < 1e-13);
        for frame in Frame::ALL {
            let both = (model.pose(frame, q, ee), model.zero_jacobian(frame, q, ee));
            assert_eq!(model.pose_and_jacobian(frame, q, ee), both);
        }
    });
}

#[test]
fn a_payload_in_two_parts_weighs_like_their_combination() {
    // Gravity and mass are affine in the load's parameters about a common point.
    let mut random = Random::new(42);
    for model in models() {
        for _ in 0..200 {
            let (q, a, b) = (random.posture(model), random.load(), random.load());
            let gravity = |load| model.gravity(&q, load, &GRAVITY_EARTH);
            let mass = |load| model.mass(&q, load);
            let (both, none) = (a.combine(&b), Load::NONE);
            let torque = gravity(&a) + gravity(&b) - gravity(&none) - gravity(&both);
            assert!(torque.amax() < 1e-12);
            if loads_add_up(model) {
                assert!((mass(&a) + mass(&b) - mass(&none) - mass(&both)).amax() < 1e-13);
            }
        }
    }
}

/// Returns the smallest eigenvalue of the second moments of a body's mass distribution about its
/// centre. The eigenvalue is positive if the density is positive everywhere.
fn least_second_moment(body: &RigidBody) -> f64 {
    let inertia = body.inertia.matrix();
    let moments = Matrix3::from_diagonal_element(0.5 * inertia.trace()) - inertia;
    moments.symmetric_eigenvalues().min()
}

#[test]
fn physically_consistent_models_have_bodies_that_can_exist() {
    for kind in RobotKind::ALL {
        for body in Model::physically_consistent(kind).links() {
            assert!(body.mass > 0.0);
            assert!(least_second_moment(body) > 0.0, "{kind:?}: {body:?}");
        }
    }
    let fer = Model::fer().links();
    assert!(fer.iter().all(|body| least_second_moment(body) < 0.0));
}

#[test]
fn the_physically_consistent_fer_is_near_the_one_of_the_clients() {
    for_each_case_of(Model::fer(), 43, &|model, case| {
        let Case { q, dq, .. } = case;
        let other = Model::physically_consistent(RobotKind::Fer);
        let none = &Load::NONE;
        // 0.018, 0.013 and 0.083 at the reference states, whose velocities are about this large.
        assert!((model.mass(q, none) - other.mass(q, none)).amax() < 0.03);
        // The weight of link 1 loads joint 1 only if the base is tilted.
        let gravity = |model: &Model| model.gravity(q, none, &GRAVITY_EARTH);
        let torque = gravity(model) - gravity(other);
        assert!(torque.amax() < 0.03, "{torque}");
        let torque = model.coriolis(q, dq, none) - other.coriolis(q, dq, none);
        assert!(torque.amax() < 0.2, "{torque}");
    });
}
