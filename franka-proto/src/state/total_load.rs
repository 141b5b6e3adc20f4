//! End effector and load as one body.
#![allow(non_snake_case)]

use super::RobotState;

/// Mass, centre of mass and inertia of end effector and load together.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TotalLoad {
    /// Mass `[kg]`.
    pub m_total: f64,
    /// Centre of mass in the flange frame `[m]`; zero without mass.
    pub F_x_Ctotal: [f64; 3],
    /// Inertia about the common centre of mass, in the flange frame, column-major `[kg m^2]`; zero
    /// without mass.
    pub I_total: [f64; 9],
}

impl TotalLoad {
    /// libfranka 0.21, `robot_state.h`: masses add, the centre is their mean, and each inertia is
    /// moved to it by the parallel axis theorem. A body without mass has no inertia.
    ///
    /// libfranka 0.21 adds the masses as `f32`, as they are on the wire; here they are added as
    /// `f64`, which differs by half a step of an `f32` at most.
    pub(super) fn of(state: &RobotState) -> Self {
        let bodies = [
            (state.m_ee, &state.F_x_Cee, &state.I_ee),
            (state.m_load, &state.F_x_Cload, &state.I_load),
        ];
        let m_total = state.m_ee + state.m_load;
        if m_total <= 0.0 {
            return Self {
                m_total,
                F_x_Ctotal: [0.0; 3],
                I_total: [0.0; 9],
            };
        }
        let F_x_Ctotal = core::array::from_fn(|axis| {
            bodies
                .map(|(mass, centre, _)| mass * centre[axis])
                .iter()
                .sum::<f64>()
                / m_total
        });
        let mut I_total = steiner(-m_total, &F_x_Ctotal);
        for (mass, centre, inertia) in bodies.into_iter().filter(|(mass, ..)| *mass != 0.0) {
            let moved = steiner(mass, centre);
            for (total, (own, moved)) in I_total.iter_mut().zip(inertia.iter().zip(moved)) {
                *total += own + moved;
            }
        }
        Self {
            m_total,
            F_x_Ctotal,
            I_total,
        }
    }
}

/// Inertia of a point mass at `x` about the origin: `mass * (|x|^2 1 - x x')`, which is
/// `-mass * S(x)^2` with the skew matrix `S`. Symmetric, so column-major is row-major.
fn steiner(mass: f64, x: &[f64; 3]) -> [f64; 9] {
    let square: f64 = x.iter().map(|x| x * x).sum();
    core::array::from_fn(|index| {
        let (row, column) = (index % 3, index / 3);
        let diagonal = if row == column { square } else { 0.0 };
        mass * (diagonal - x[row] * x[column])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From vectors of libfranka's own computation.
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
        let total = state.total_load();
        assert_eq!(total.m_total, expected.m_total);
        assert_eq!(total.F_x_Ctotal, expected.F_x_Ctotal);
        // The sums are in another order.
        for (got, expected) in total.I_total.iter().zip(expected.I_total) {
            assert!((got - expected).abs() < 1e-16, "{got} {expected}");
        }
    }

    #[test]
    fn a_body_without_mass_has_no_inertia() {
        let mut state = RobotState {
            I_ee: [7.0; 9],
            I_load: [1.0; 9],
            m_load: 2.0,
            ..RobotState::default()
        };
        assert_eq!(state.total_load().I_total, [1.0; 9]);
        state.m_load = 0.0;
        let nothing = TotalLoad {
            m_total: 0.0,
            F_x_Ctotal: [0.0; 3],
            I_total: [0.0; 9],
        };
        assert_eq!(state.total_load(), nothing);
    }
}
