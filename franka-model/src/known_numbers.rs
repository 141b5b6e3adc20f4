//! Numbers that Pinocchio 4.1 computed from the same parameters, at two postures.

use nalgebra::{Cholesky, Matrix3, Matrix4, SMatrix, Vector3};

use crate::merge::Merge;
use crate::{
    EndEffector, Frame, GRAVITY_EARTH, JointVector, Load, Model, READY, joint_vector,
    manipulability,
};

/// Tolerance for expected values with nine digits.
const NINE: f64 = 6e-10;
const SIX: f64 = 6e-7;

/// The hand's default payload in the vendor's settings.
pub(crate) fn hand_load() -> Load {
    Load {
        mass: 0.73,
        com: Vector3::new(-0.01, 0.0, 0.03),
        inertia: Matrix3::from_diagonal(&Vector3::new(0.001, 0.0025, 0.0017)),
    }
}

/// The frame of the Hand, turned by an eighth of a turn, 0.1034 m from the flange.
pub(crate) fn hand() -> EndEffector {
    let r = core::f64::consts::FRAC_1_SQRT_2;
    let mut f_t_ee = Matrix4::identity();
    (f_t_ee.m11, f_t_ee.m12, f_t_ee.m21, f_t_ee.m22) = (r, r, -r, r);
    f_t_ee.m34 = 0.1034;
    EndEffector {
        f_t_ee,
        ..EndEffector::default()
    }
}

#[track_caller]
fn assert_near(got: &[f64], want: &[f64], tolerance: f64) {
    assert_eq!(got.len(), want.len());
    for (got, want) in got.iter().zip(want) {
        assert!((got - want).abs() < tolerance, "{got} is not {want}");
    }
}

#[test]
fn poses_at_the_ready_posture() {
    let r = core::f64::consts::FRAC_1_SQRT_2;
    let (x, z) = (0.306890566593, 0.590282052303);
    let flange = Model::fr3().pose(Frame::Flange, &READY, &hand());
    let expected = [
        r, -r, 0.0, 0.0, -r, -r, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, x, 0.0, z, 1.0,
    ];
    assert_near(flange.as_slice(), &expected, 1e-12);

    let tip = Model::fr3().pose(Frame::EndEffector, &READY, &hand());
    let z = 0.486882052303;
    let expected = [
        1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, x, 0.0, z, 1.0,
    ];
    assert_near(tip.as_slice(), &expected, 1e-12);
}

#[test]
fn the_flange_at_the_zero_posture() {
    let pose = Model::fr3().pose(Frame::Flange, &JointVector::zeros(), &hand());
    let expected = [
        1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.088, 0.0, 0.926, 1.0,
    ];
    assert_near(pose.as_slice(), &expected, 1e-15);
}

#[test]
fn manipulability_at_the_ready_posture_for_every_tool() {
    for frame in [Frame::Flange, Frame::EndEffector] {
        let jacobian = Model::fr3().zero_jacobian(frame, &READY, &hand());
        assert_near(&[manipulability(&jacobian)], &[0.080151752], NINE);
    }
}

#[test]
fn a_frame_that_is_not_quite_orthonormal_is_used_as_given() {
    let mut ee = hand();
    ee.f_t_ee.fixed_view_mut::<3, 2>(0, 0).scale_mut(0.999);
    let pose = Model::fr3().pose(Frame::EndEffector, &READY, &ee);
    let column = pose.fixed_view::<3, 1>(0, 0).norm();
    assert_near(&[column], &[0.999], 1e-15);
}

/// Gravity torques, Coriolis torques at unit velocities, and the diagonal of the mass matrix.
type Torques = [[f64; 7]; 3];

#[track_caller]
fn assert_torques(model: &Model, load: &Load, [gravity, coriolis, diagonal]: Torques) {
    let ones = joint_vector([1.0; 7]);
    let got = model.gravity(&READY, load, &GRAVITY_EARTH);
    assert_near(got.as_slice(), &gravity, NINE);
    let got = model.coriolis(&READY, &ones, load);
    assert_near(got.as_slice(), &coriolis, NINE);
    let got = model.mass(&READY, load).diagonal();
    assert_near(got.as_slice(), &diagonal, NINE);
}

#[test]
fn dynamics_without_a_payload() {
    assert_torques(
        Model::fr3(),
        &Load::NONE,
        [
            [
                0.0,
                -1.709040364,
                -0.639460627,
                18.958219373,
                0.791900014,
                1.587942979,
                0.0,
            ],
            [
                0.886830189,
                -1.639461229,
                2.306917571,
                -0.669161087,
                0.078258692,
                -0.219319647,
                0.010004722,
            ],
            [
                0.498508051,
                1.525422051,
                0.923342249,
                0.834016095,
                0.027516621,
                0.030493746,
                0.000119426,
            ],
        ],
    );
}

#[test]
fn dynamics_with_the_hands_payload() {
    assert_torques(
        Model::fr3(),
        &hand_load(),
        [
            [
                0.0,
                -3.856137741,
                -0.675267127,
                22.287714935,
                0.842538052,
                2.167499341,
                0.0,
            ],
            [
                1.272142121,
                -1.824309729,
                2.776395322,
                -0.890650354,
                0.255517713,
                -0.421919722,
                0.008757829,
            ],
            [
                0.565865516,
                1.630502721,
                1.026513905,
                0.995730383,
                0.043004491,
                0.050726245,
                0.001892426,
            ],
        ],
    );
}

#[test]
fn dynamics_of_the_fer() {
    assert_torques(
        Model::fer(),
        &Load::NONE,
        [
            [
                0.0,
                -1.735531140,
                -0.670750875,
                18.522873683,
                0.715627332,
                1.671521850,
                0.0,
            ],
            [
                0.795303079,
                -1.660292410,
                2.226965986,
                -0.608814562,
                0.061786027,
                -0.217824107,
                0.008025844,
            ],
            [
                0.435393888,
                1.446910128,
                0.868571739,
                0.784482372,
                0.009456399,
                0.026186954,
                0.001272253,
            ],
        ],
    );
    // The rigid composition. The vendor's library for the FER does not use it.
    let rigid = Model {
        merge: Merge::Rigid,
        ..Model::fer().clone()
    };
    assert_torques(
        &rigid,
        &hand_load(),
        [
            [
                0.0,
                -3.882628517,
                -0.706557375,
                21.852369245,
                0.766265370,
                2.251078212,
                0.0,
            ],
            [
                1.180615010,
                -1.845140910,
                2.696443737,
                -0.830303829,
                0.239045048,
                -0.420424182,
                0.006778951,
            ],
            [
                0.502751353,
                1.551990798,
                0.971743395,
                0.946196660,
                0.024944269,
                0.046419453,
                0.003045253,
            ],
        ],
    );
}

#[test]
fn apparent_inertia_of_flange_and_hand() {
    // 1 / diag(J M⁻¹ Jᵀ) without and with the payload: kg along x, y and z, and kg·m² about these
    // axes.
    for (frame, load, expected) in [
        (
            Frame::Flange,
            Load::NONE,
            [1.861148, 1.807234, 2.903331, 0.025363, 0.024392, 0.000113],
        ),
        (
            Frame::EndEffector,
            hand_load(),
            [0.919318, 0.951865, 3.971772, 0.035463, 0.039900, 0.001857],
        ),
    ] {
        let jacobian = Model::fr3().zero_jacobian(frame, &READY, &hand());
        let mass = Model::fr3().mass(&READY, &load);
        let factor = Cholesky::new(mass).expect("positive definite");
        let mobility: SMatrix<f64, 6, 6> = jacobian * factor.solve(&jacobian.transpose());
        let apparent = mobility.diagonal().map(f64::recip);
        assert_near(apparent.as_slice(), &expected, SIX);
    }
}
