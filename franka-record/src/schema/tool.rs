//! Conversion of an arm's tool to a message, and back.

use franka_proto::RobotState;

use super::arrays::get_exact;
use super::franka;

impl franka::Tool {
    /// Returns the tool in `state`.
    pub fn of(state: &RobotState) -> Self {
        Self {
            robot_time: state.message_id,
            f_t_ee: state.F_T_EE.into(),
            ee_t_k: state.EE_T_K.into(),
            f_t_ne: state.F_T_NE.into(),
            ne_t_ee: state.NE_T_EE.into(),
            m_ee: state.m_ee,
            i_ee: state.I_ee.into(),
            f_x_cee: state.F_x_Cee.into(),
            m_load: state.m_load,
            i_load: state.I_load.into(),
            f_x_cload: state.F_x_Cload.into(),
        }
    }

    /// Returns true if `state` contains the same tool.
    pub fn is_of(&self, state: &RobotState) -> bool {
        self.f_t_ee == state.F_T_EE
            && self.ee_t_k == state.EE_T_K
            && self.f_t_ne == state.F_T_NE
            && self.ne_t_ee == state.NE_T_EE
            && self.m_ee == state.m_ee
            && self.i_ee == state.I_ee
            && self.f_x_cee == state.F_x_Cee
            && self.m_load == state.m_load
            && self.i_load == state.I_load
            && self.f_x_cload == state.F_x_Cload
    }

    /// Writes the tool into `state`.
    pub fn apply(&self, state: &mut RobotState) {
        state.F_T_EE = get_exact(&self.f_t_ee);
        state.EE_T_K = get_exact(&self.ee_t_k);
        state.F_T_NE = get_exact(&self.f_t_ne);
        state.NE_T_EE = get_exact(&self.ne_t_ee);
        state.m_ee = self.m_ee;
        state.I_ee = get_exact(&self.i_ee);
        state.F_x_Cee = get_exact(&self.f_x_cee);
        state.m_load = self.m_load;
        state.I_load = get_exact(&self.i_load);
        state.F_x_Cload = get_exact(&self.f_x_cload);
    }
}
