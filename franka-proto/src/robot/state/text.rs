//! libfranka's text form of a state.

use core::fmt;

use super::RobotState;
use crate::number_text::General;
use crate::version::Version;

/// Prints a state in the format of libfranka's `operator<<`: a JSON object on one line.
///
/// Numbers have six significant digits. [`RobotState::text`] creates this value.
#[derive(Clone, Copy, Debug)]
pub struct StateText<'a> {
    state: &'a RobotState,
    version: Version,
}

impl RobotState {
    /// Returns libfranka's text of a state of this version. Protocol 5 has the text of libfranka
    /// 0.9, without accelerometers. Protocol 10 has the text of libfranka 0.21.
    #[must_use]
    pub fn text(&self, version: Version) -> StateText<'_> {
        StateText {
            state: self,
            version,
        }
    }
}

impl fmt::Display for StateText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (state, total) = (self.state, self.state.total_load(self.version));
        f.write_str("{")?;
        macro_rules! write_fields {
            ($($of:ident $field:ident),*) => {
                $(
                    write!(f, concat!("\"", stringify!($field), "\": "))?;
                    $of.$field.write(f)?;
                    f.write_str(", ")?;
                )*
            };
        }
        // The order is libfranka's; `total` is computed from the end effector and the load.
        write_fields! {
            state O_T_EE, state O_T_EE_d, state F_T_NE, state NE_T_EE, state F_T_EE, state EE_T_K,
            state m_ee, state F_x_Cee, state I_ee, state m_load, state F_x_Cload, state I_load,
            total m_total, total F_x_Ctotal, total I_total, state elbow, state elbow_d,
            state elbow_c, state delbow_c, state ddelbow_c, state tau_J, state tau_J_d,
            state dtau_J, state q, state dq, state q_d, state dq_d, state ddq_d,
            state joint_contact, state cartesian_contact, state joint_collision,
            state cartesian_collision, state tau_ext_hat_filtered, state O_F_ext_hat_K,
            state K_F_ext_hat_K, state O_dP_EE_d, state O_ddP_O, state O_T_EE_c, state O_dP_EE_c,
            state O_ddP_EE_c, state theta, state dtheta
        }
        if self.version.has_accelerometers() {
            f.write_str("\"accelerometer_top\": ")?;
            state.accelerometer_top.write(f)?;
            f.write_str(", \"accelerometer_bottom\": ")?;
            state.accelerometer_bottom.write(f)?;
            f.write_str(", ")?;
        }
        write!(
            f,
            "\"current_errors\": {}, \"last_motion_errors\": {}, \
             \"control_command_success_rate\": {}, \"robot_mode\": \"{}\", \"time\": {}}}",
            state.errors,
            state.reflex_reason,
            General(state.control_command_success_rate),
            state.robot_mode,
            state.message_id
        )
    }
}

/// A value in the text.
trait Write {
    fn write(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result;
}

impl Write for f64 {
    fn write(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&General(*self), f)
    }
}

impl Write for f32 {
    fn write(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f64::from(*self).write(f)
    }
}

impl<const N: usize> Write for [f64; N] {
    fn write(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_list(self, ",", f)
    }
}

impl<const N: usize> Write for [f32; N] {
    fn write(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_list(self, ",", f)
    }
}

impl<const N: usize, const M: usize> Write for [[f32; M]; N] {
    fn write(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_list(self, ", ", f)
    }
}

fn write_list<T: Write>(list: &[T], between: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    f.write_str("[")?;
    for (position, item) in list.iter().enumerate() {
        if position > 0 {
            f.write_str(between)?;
        }
        item.write(f)?;
    }
    f.write_str("]")
}
