//! The end effector and the load as one body.
#![allow(non_snake_case)]

use super::RobotState;

/// Mass, centre of mass and inertia of the end effector and the load together.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TotalLoad {
    /// Mass `[kg]`.
    pub m_total: f64,
    /// Centre of mass in the flange frame `[m]`. It is zero if the mass is zero.
    pub F_x_Ctotal: [f64; 3],
    /// Inertia about the common centre of mass, in the flange frame, column-major `[kg m^2]`. It is
    /// zero if the mass is zero.
    pub I_total: [f64; 9],
}

impl TotalLoad {
    /// Computes the sums of libfranka 0.21 (`load_calculations.cpp`), in the same order of
    /// operations. The centre of mass is the weighted mean of both bodies. The parallel axis
    /// theorem moves each inertia to this mean. A body without mass has no inertia.
    pub(super) fn of(state: &RobotState, m_total: f64) -> Self {
        // This sum is an `f64`; in protocol 10, `m_total` has single precision.
        let mass = state.m_ee + state.m_load;
        let F_x_Ctotal = core::array::from_fn(|axis| {
            if mass > 0.0 {
                (state.m_ee * state.F_x_Cee[axis] + state.m_load * state.F_x_Cload[axis]) / mass
            } else {
                0.0
            }
        });
        let ee = about_flange(state.m_ee, &state.F_x_Cee, &state.I_ee);
        let load = about_flange(state.m_load, &state.F_x_Cload, &state.I_load);
        let total = skew_squared(m_total, &F_x_Ctotal);
        let I_total = core::array::from_fn(|i| {
            if m_total == 0.0 {
                0.0
            } else {
                ee[i] + load[i] + total[i]
            }
        });
        Self {
            m_total,
            F_x_Ctotal,
            I_total,
        }
    }
}

/// Returns the inertia of a body about the origin of the flange: `inertia - mass * S(centre)^2`.
fn about_flange(mass: f64, centre: &[f64; 3], inertia: &[f64; 9]) -> [f64; 9] {
    let moved = skew_squared(mass, centre);
    core::array::from_fn(|i| {
        let own = if mass == 0.0 { 0.0 } else { inertia[i] };
        own - moved[i]
    })
}

/// `mass * S(x)^2` with the skew matrix `S`: minus the inertia of a point mass at `x` about the
/// origin. The result is column-major. Eigen multiplies the first factor by the mass, and this
/// order determines the last bit.
fn skew_squared(mass: f64, [x, y, z]: &[f64; 3]) -> [f64; 9] {
    let (mx, my, mz) = (mass * x, mass * y, mass * z);
    [
        -(mz * z + my * y),
        mx * y,
        mx * z,
        my * x,
        -(mz * z + mx * x),
        my * z,
        mz * x,
        mz * y,
        -(my * y + mx * x),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::version::Version;

    /// The vectors come from libfranka's own computation.
    #[test]
    fn two_bodies_are_one_with_the_sum_of_their_moments() {
        let state = RobotState {
            m_ee: 1.2002047284780317,
            F_x_Cee: [
                0.07231498773043418,
                0.010729798648415015,
                -0.053344183193072964,
            ],
            I_ee: [
                0.0013276601010776623,
                0.00033470803797326946,
                -0.0012604090745448463,
                0.00033470803797326946,
                0.010382892094976464,
                -0.001045970213075998,
                -0.0012604090745448463,
                -0.001045970213075998,
                0.013687599127403936,
            ],
            m_load: 2.9869381711907623,
            F_x_Cload: [
                0.07792587519640914,
                0.0041398129712585385,
                -0.01886490561354097,
            ],
            I_load: [
                0.018135414718413276,
                -0.001218799732367267,
                -0.0019005146912796417,
                -0.001218799732367267,
                0.014910360003271504,
                -0.0005393891563617791,
                -0.0019005146912796417,
                -0.0005393891563617791,
                0.007062615872358169,
            ],
            ..RobotState::default()
        };
        let expected = TotalLoad {
            m_total: 4.187142899668794,
            F_x_Ctotal: [
                0.0763175676155635,
                0.006028769751537363,
                -0.028748062930367732,
            ],
            I_total: [
                0.020518098188447187,
                -0.0008524339613447615,
                -0.003326559295068053,
                -0.0008524339613447619,
                0.02633804769722491,
                -0.0013908204890979868,
                -0.003326559295068053,
                -0.0013908204890979866,
                0.020814351226077794,
            ],
        };
        // The numbers of the vectors are `f64`, as in protocol 5.
        assert_eq!(state.total_load(Version::V5), expected);
    }

    #[test]
    fn a_body_without_mass_has_no_inertia() {
        let mut state = RobotState {
            I_ee: [7.0; 9],
            I_load: [1.0; 9],
            m_load: 2.0,
            ..RobotState::default()
        };
        for version in Version::ALL {
            assert_eq!(state.total_load(version).I_total, [1.0; 9]);
        }
        state.m_load = 0.0;
        let nothing = TotalLoad {
            m_total: 0.0,
            F_x_Ctotal: [0.0; 3],
            I_total: [0.0; 9],
        };
        for version in Version::ALL {
            assert_eq!(state.total_load(version), nothing);
        }
    }

    /// Masses above 1 kg, as encoded in a datagram. The sum of two `f32` needs more than 24 bits,
    /// so the two precisions differ. The expected values were computed independently.
    #[test]
    fn the_masses_of_protocol_10_are_added_in_single_precision() {
        for (m_ee, m_load, single, double) in [
            // 1 + 2^-23 and 2 + 2^-22: the exact sum is halfway between two values and is rounded
            // to the even value, 3 + 2^-21.
            (
                0x3f80_0001,
                0x4000_0001,
                0x4040_0002,
                3.0 + 3.0 / 8_388_608.0,
            ),
            // 1.1 and 2.3.
            (0x3f8c_cccd, 0x4013_3333, 0x4059_999a, 3.399_999_976_158_142),
            // 1.7 and 2.6.
            (0x3fd9_999a, 0x4026_6666, 0x4089_999a, 4.299_999_952_316_284),
        ] {
            let [m_ee, m_load, single] = [m_ee, m_load, single].map(f32::from_bits);
            let state = RobotState {
                m_ee: m_ee.into(),
                m_load: m_load.into(),
                ..RobotState::default()
            };
            let mut bytes = [0; RobotState::MAX_SIZE];
            for (version, expected) in [(Version::V10, single.into()), (Version::V5, double)] {
                let size = state.encode(version, &mut bytes).unwrap();
                let received = RobotState::decode(version, &bytes[..size]).unwrap();
                assert_eq!(received, state);
                assert_eq!(
                    received.total_load(version).m_total,
                    expected,
                    "{version:?}"
                );
            }
        }
    }

    /// The mean of the centres divides by the sum as `f64`; the inertia uses the rounded mass.
    #[test]
    fn only_the_mass_of_protocol_10_is_rounded() {
        let state = RobotState {
            m_ee: f64::from(1.1_f32),
            m_load: f64::from(2.3_f32),
            F_x_Cee: [0.25, 0.0, 0.0],
            F_x_Cload: [0.0, 0.5, 0.0],
            ..RobotState::default()
        };
        let [v5, v10] = Version::ALL.map(|version| state.total_load(version));
        assert_ne!(v10.m_total, v5.m_total);
        assert_eq!(v10.F_x_Ctotal, v5.F_x_Ctotal);
        let [x, y, _] = v10.F_x_Ctotal;
        let about_flange = state.m_load * 0.5 * 0.5;
        assert_eq!(v10.I_total[0], about_flange - v10.m_total * y * y);
        assert_ne!(v10.I_total[0], v5.I_total[0]);
        assert_eq!(v10.I_total[1], v10.m_total * x * y);
    }
}
