//! End effector and load, and the totals that the vendor's client makes of them.
#![allow(non_snake_case)]

use franka_model::Load;
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;

use super::Case;

#[derive(Deserialize)]
pub(super) struct Parts {
    pub(super) m_ee: f64,
    pub(super) F_x_Cee: [f64; 3],
    pub(super) I_ee: [f64; 9],
    pub(super) m_load: f64,
    pub(super) F_x_Cload: [f64; 3],
    pub(super) I_load: [f64; 9],
}

#[derive(Deserialize)]
pub(super) struct Total {
    pub(super) m_total: f64,
    pub(super) F_x_Ctotal: [f64; 3],
    pub(super) I_total: [f64; 9],
}

impl Parts {
    /// Both parts, combined by the model.
    pub(super) fn combined(&self) -> Load {
        let ee = load(self.m_ee, &self.F_x_Cee, &self.I_ee);
        ee.combine(&load(self.m_load, &self.F_x_Cload, &self.I_load))
    }
}

impl Total {
    pub(super) fn load(&self) -> Load {
        load(self.m_total, &self.F_x_Ctotal, &self.I_total)
    }

    /// Compares to the last bit.
    pub(super) fn check(&self, case: &mut Case<'_>, got: &Load) {
        case.near("m_total", &[got.mass], &[self.m_total], 0.0);
        case.near("F_x_Ctotal", got.com.as_slice(), &self.F_x_Ctotal, 0.0);
        case.near("I_total", got.inertia.as_slice(), &self.I_total, 0.0);
    }
}

fn load(mass: f64, centre: &[f64; 3], inertia: &[f64; 9]) -> Load {
    Load {
        mass,
        com: Vector3::from(*centre),
        inertia: Matrix3::from_column_slice(inertia),
    }
}
