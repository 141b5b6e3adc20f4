//! End effector and load as one body.
#![allow(non_snake_case)]

use super::RobotState;

/// Mass, centre of mass and inertia of end effector and load together.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// libfranka adds the masses of protocol 10 as `f32`. Here they are added as `f64`: the
    /// difference is below the resolution of the `f32` that it ends in.
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
