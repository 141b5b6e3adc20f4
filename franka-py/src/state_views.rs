//! States as one array, as a dictionary and as text.
#![allow(non_snake_case)]

use franka_async::pose;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMappingProxy};

use crate::arrays::array;
use crate::state::RobotState;

/// Places of the parts of `RobotState.flat()`: name, begin, end.
pub(crate) const FLAT_LAYOUT: [(&str, usize, usize); 13] = [
    ("q", 0, 7),
    ("dq", 7, 14),
    ("tau_J", 14, 21),
    ("tau_ext_hat_filtered", 21, 28),
    ("O_T_EE_position", 28, 31),
    ("O_T_EE_quaternion", 31, 35),
    ("O_F_ext_hat_K", 35, 41),
    ("q_d", 41, 48),
    ("O_T_EE_c_position", 48, 51),
    ("O_T_EE_c_quaternion", 51, 55),
    ("joint_contact", 55, 62),
    ("cartesian_contact", 62, 68),
    ("time", 68, 69),
];

/// The length of `RobotState.flat()`.
pub(crate) const FLAT_LEN: usize = 69;

/// Writes the numbers of `RobotState.flat()`.
pub(crate) fn write_flat(state: &franka_async::state::RobotState, numbers: &mut [f64]) {
    let (position, quaternion) = place(&state.O_T_EE);
    let (position_c, quaternion_c) = place(&state.O_T_EE_c);
    let parts: [&[f64]; 13] = [
        &state.q,
        &state.dq,
        &state.tau_J,
        &state.tau_ext_hat_filtered,
        &position,
        &quaternion,
        &state.O_F_ext_hat_K,
        &state.q_d,
        &position_c,
        &quaternion_c,
        &state.joint_contact,
        &state.cartesian_contact,
        &[state.message_id as f64 / 1000.0],
    ];
    for (part, (_, begin, end)) in parts.into_iter().zip(FLAT_LAYOUT) {
        numbers[begin..end].copy_from_slice(part);
    }
}

/// Returns position and quaternion `x y z w` with `w >= 0`; zeros if the matrix is not a rigid
/// transformation.
fn place(matrix: &[f64; 16]) -> ([f64; 3], [f64; 4]) {
    let Ok(pose) = pose::from_array(matrix) else {
        return ([0.0; 3], [0.0; 4]);
    };
    let (position, quaternion) = pose::to_xyzw(&pose);
    let sign = if quaternion[3] < 0.0 { -1.0 } else { 1.0 };
    (position, quaternion.map(|part| sign * part))
}

#[pymethods]
impl RobotState {
    /// Places of the parts of `flat()`: name, begin, end.
    #[classattr]
    #[pyo3(name = "FLAT_LAYOUT")]
    fn flat_layout() -> Vec<(&'static str, usize, usize)> {
        FLAT_LAYOUT.to_vec()
    }

    /// The length of `flat()`.
    #[classattr]
    #[pyo3(name = "FLAT_LEN")]
    fn flat_len() -> usize {
        FLAT_LEN
    }

    /// The usual observation of a policy as one array, `(69,)`: see `FLAT_LAYOUT`.
    fn flat<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let mut numbers = [0.0; FLAT_LEN];
        write_flat(&self.state, &mut numbers);
        array(py, &numbers)
    }

    /// All attributes by name.
    fn to_dict<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(this.py());
        let class = this.get_type().getattr("__dict__")?;
        for item in class.cast::<PyMappingProxy>()?.items()? {
            let (name, member) = item.extract::<(String, Bound<'py, PyAny>)>()?;
            if !name.starts_with('_') && member.get_type().name()? == "getset_descriptor" {
                let value = this.getattr(&*name)?;
                all.set_item(name, value)?;
            }
        }
        Ok(all)
    }

    fn __repr__(&self) -> String {
        let [x, y, z] = [12, 13, 14].map(|i| self.state.O_T_EE[i]);
        let joints = fixed(&self.state.q, 4).join(" ");
        format!(
            "<RobotState {:.3} s, {}, q [{joints}], O_T_EE at [{x:.4} {y:.4} {z:.4}]>",
            self.time(),
            self.robot_mode(),
        )
    }

    fn __str__(&self) -> String {
        let mut text = self.title();
        for (name, numbers, unit) in self.table() {
            text += &format!("\n  {name:<14}");
            for number in numbers {
                text += &format!("{number:>9}");
            }
            text += &format!("  {unit}");
        }
        for (name, errors) in self.errors() {
            text += &format!("\n  {name:<14}  {errors}");
        }
        text
    }

    fn _repr_html_(&self) -> String {
        let cell = |text: &String| format!("<td style='text-align:right'>{text}</td>");
        let mut rows = String::new();
        for (name, numbers, unit) in self.table() {
            let cells: String = numbers.iter().map(cell).collect();
            let rest = 7 - numbers.len();
            let rest = "<td></td>".repeat(rest);
            rows += &format!("<tr><th>{name}</th>{cells}{rest}<td>{unit}</td></tr>");
        }
        for (name, errors) in self.errors() {
            rows += &format!("<tr><th>{name}</th><td colspan='8'>{errors}</td></tr>");
        }
        format!("<table><caption>{}</caption>{rows}</table>", self.title())
    }
}

impl RobotState {
    fn title(&self) -> String {
        format!(
            "RobotState at {:.3} s: {} ({}, {}), success rate {:.2}",
            self.time(),
            self.robot_mode(),
            self.motion_generator_mode(),
            self.controller_mode(),
            self.control_command_success_rate(),
        )
    }

    /// Returns the most important numbers for a person: name, numbers, unit.
    fn table(&self) -> Vec<(&'static str, Vec<String>, &'static str)> {
        let state = &*self.state;
        let (position, quaternion) = place(&state.O_T_EE);
        vec![
            ("q", fixed(&state.q, 4), "rad"),
            ("q_d", fixed(&state.q_d, 4), "rad"),
            ("dq", fixed(&state.dq, 4), "rad/s"),
            ("tau_J", fixed(&state.tau_J, 2), "N m"),
            ("tau_ext_hat", fixed(&state.tau_ext_hat_filtered, 2), "N m"),
            ("O_T_EE", fixed(&position, 4), "m"),
            ("  quaternion", fixed(&quaternion, 4), "x y z w"),
            ("O_F_ext_hat_K", fixed(&state.O_F_ext_hat_K, 2), "N, N m"),
        ]
    }

    /// Returns the current errors, by attribute.
    fn errors(&self) -> Vec<(&'static str, String)> {
        let current = ("current_errors", self.current_errors());
        let last = ("last_errors", self.last_motion_errors());
        let all = [current, last].into_iter();
        all.filter(|(_, errors)| !errors.is_empty())
            .map(|(name, errors)| (name, errors.join(", ")))
            .collect()
    }
}

/// Returns numbers as text; `-0.000` loses its sign.
fn fixed(numbers: &[f64], decimals: usize) -> Vec<String> {
    let least = 0.5 * 10_f64.powi(-(decimals as i32));
    let shown = |x: f64| if x.abs() < least { 0.0 } else { x };
    let text = numbers.iter().map(|x| format!("{:.decimals$}", shown(*x)));
    text.collect()
}
