//! A control law behind a C function pointer: its input, and its calls.
//!
//! This module does not use Python. The real-time thread calls [`Running`], which neither allocates
//! nor waits.

use std::any::Any;
use std::sync::Arc;
use std::time::Duration;

use franka_async::connection::Version;
use franka_async::control::Next;
use franka_async::control::slot::{Read, SlotReader, SlotWriter};
use franka_async::model::{EndEffector, GRAVITY_EARTH, JointVector, Load, Model};
use franka_async::nalgebra::{Matrix3, Matrix4, SMatrix};
use franka_async::state::RobotState;

/// The version of [`Cycle`] and [`Function`]: incremented when a field moves or changes its
/// meaning. New fields at the end only change `Cycle::size`.
pub(crate) const VERSION: u32 = 1;

/// Largest number of parameters, and of memory values.
pub(crate) const MOST: usize = 256;

/// The numbers exchanged between threads, padded with zeros.
pub(crate) type Numbers = [f64; MOST];

/// The numbers of an output; the widest command is a pose with an elbow.
pub(crate) type Output = [f64; 18];

/// The called function: `(cycle, parameters, memory, output)`. It returns 0 to continue, a positive
/// number for the last command, and a negative number to stop the robot, which is the error's code.
pub(crate) type Function =
    unsafe extern "C" fn(*const Cycle, *const f64, *mut f64, *mut f64) -> i32;

/// A function, with the owner of its code.
pub(crate) struct Code {
    function: Function,
    /// Frees the code when it is dropped.
    _owner: Box<dyn Any + Send + Sync>,
}

impl Code {
    /// Creates the function at `address`, which lives as long as `owner`. `None` for the null
    /// pointer.
    ///
    /// # Safety
    /// `address` must be a [`Function`] that respects the lengths in [`Cycle`] and of the output,
    /// and that any thread may call.
    pub(crate) unsafe fn new(address: usize, owner: Box<dyn Any + Send + Sync>) -> Option<Self> {
        // SAFETY: a pointer and an optional function pointer have the same representation, and null
        // is `None`; the caller guarantees the rest.
        let function = unsafe { std::mem::transmute::<usize, Option<Function>>(address) }?;
        Some(Self {
            function,
            _owner: owner,
        })
    }
}

/// A number or array in [`Cycle`].
trait Field {
    /// The numpy format.
    const FORMAT: &'static str;
    fn shape() -> Vec<usize>;
}

macro_rules! number {
    ($($type:ty = $format:literal),*) => {$(
        impl Field for $type {
            const FORMAT: &'static str = $format;
            fn shape() -> Vec<usize> {
                Vec::new()
            }
        }
    )*};
}

number!(f64 = "f8", u32 = "u4", u64 = "u8");

impl<F: Field, const N: usize> Field for [F; N] {
    const FORMAT: &'static str = F::FORMAT;
    fn shape() -> Vec<usize> {
        [vec![N], F::shape()].concat()
    }
}

/// The place of a field: its name, its offset in bytes, its shape, its numpy format.
pub(crate) type Place = (&'static str, usize, Vec<usize>, &'static str);

macro_rules! cycle {
    ($($name:ident: $type:ty,)*) => {
        /// The input of a law in a cycle. Matrices are row-major, poses have the translation in the
        /// last column. Documented in `include/franka_async_law.h`, which has the same fields.
        #[repr(C)]
        #[derive(Clone, Default)]
        #[allow(non_snake_case)]
        pub(crate) struct Cycle {
            $($name: $type,)*
        }

        /// Returns every field in its order.
        pub(crate) fn layout() -> Vec<Place> {
            vec![$((
                stringify!($name),
                std::mem::offset_of!(Cycle, $name),
                <$type as Field>::shape(),
                <$type as Field>::FORMAT,
            )),*]
        }
    };
}

cycle! {
    version: u32,
    size: u32,
    message_id: u64,
    time: f64,
    dt: f64,
    parameters_len: u64,
    memory_len: u64,

    q: [f64; 7],
    dq: [f64; 7],
    q_d: [f64; 7],
    dq_d: [f64; 7],
    ddq_d: [f64; 7],
    tau_J: [f64; 7],
    tau_J_d: [f64; 7],
    dtau_J: [f64; 7],
    tau_ext_hat_filtered: [f64; 7],
    theta: [f64; 7],
    dtheta: [f64; 7],
    joint_contact: [f64; 7],
    cartesian_contact: [f64; 6],
    O_F_ext_hat_K: [f64; 6],
    K_F_ext_hat_K: [f64; 6],
    O_T_EE: [[f64; 4]; 4],
    O_T_EE_d: [[f64; 4]; 4],
    O_T_EE_c: [[f64; 4]; 4],
    F_T_EE: [[f64; 4]; 4],
    EE_T_K: [[f64; 4]; 4],
    O_dP_EE_d: [f64; 6],
    O_dP_EE_c: [f64; 6],
    elbow: [f64; 2],
    elbow_c: [f64; 2],
    m_total: f64,
    control_command_success_rate: f64,

    pose: [[f64; 4]; 4],
    jacobian: [[f64; 7]; 6],
    mass: [[f64; 7]; 7],
    coriolis: [f64; 7],
    gravity: [f64; 7],
    jdot_dq: [f64; 6],
}

impl Cycle {
    /// Copies a state, with the terms of `model` for it.
    fn update(&mut self, state: &RobotState, version: Version, model: &Model) {
        self.message_id = state.message_id;
        self.q = state.q;
        self.dq = state.dq;
        self.q_d = state.q_d;
        self.dq_d = state.dq_d;
        self.ddq_d = state.ddq_d;
        self.tau_J = state.tau_J;
        self.tau_J_d = state.tau_J_d;
        self.dtau_J = state.dtau_J;
        self.tau_ext_hat_filtered = state.tau_ext_hat_filtered;
        self.theta = state.theta;
        self.dtheta = state.dtheta;
        self.joint_contact = state.joint_contact;
        self.cartesian_contact = state.cartesian_contact;
        self.O_F_ext_hat_K = state.O_F_ext_hat_K;
        self.K_F_ext_hat_K = state.K_F_ext_hat_K;
        self.O_T_EE = rows(&Matrix4::from_column_slice(&state.O_T_EE));
        self.O_T_EE_d = rows(&Matrix4::from_column_slice(&state.O_T_EE_d));
        self.O_T_EE_c = rows(&Matrix4::from_column_slice(&state.O_T_EE_c));
        let end_effector = EndEffector {
            f_t_ee: Matrix4::from_column_slice(&state.F_T_EE),
            ee_t_k: Matrix4::from_column_slice(&state.EE_T_K),
        };
        self.F_T_EE = rows(&end_effector.f_t_ee);
        self.EE_T_K = rows(&end_effector.ee_t_k);
        self.O_dP_EE_d = state.O_dP_EE_d;
        self.O_dP_EE_c = state.O_dP_EE_c;
        self.elbow = state.elbow;
        self.elbow_c = state.elbow_c;
        self.control_command_success_rate = state.control_command_success_rate;

        let total = state.total_load(version);
        self.m_total = total.m_total;
        let load = Load {
            mass: total.m_total,
            com: total.F_x_Ctotal.into(),
            inertia: Matrix3::from_column_slice(&total.I_total),
        };
        let (q, dq) = (JointVector::from(state.q), JointVector::from(state.dq));
        let terms = model.dynamics(&q, &dq, &end_effector, &load, &GRAVITY_EARTH);
        self.pose = rows(&terms.pose);
        self.jacobian = rows(&terms.jacobian);
        self.mass = rows(&terms.mass);
        self.coriolis = terms.coriolis.into();
        self.gravity = terms.gravity.into();
        self.jdot_dq = terms.jdot_dq.into();
    }
}

fn rows<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> [[f64; C]; R] {
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[(row, column)]))
}

/// A running law: called with one state after the other.
pub(crate) struct Running {
    code: Arc<Code>,
    model: Arc<Model>,
    version: Version,
    cycle: Box<Cycle>,
    /// The newest received parameters.
    parameters: Box<Numbers>,
    arriving: SlotReader<Numbers>,
    memory: Box<Numbers>,
    /// The writer of the memory, which can be read while the law runs.
    remembered: SlotWriter<Numbers>,
}

/// The inputs of a law.
pub(crate) struct Setup<'a> {
    pub(crate) model: Arc<Model>,
    pub(crate) version: Version,
    /// The parameters of the first cycle.
    pub(crate) parameters: &'a [f64],
    /// Later parameters, with the same length.
    pub(crate) arriving: SlotReader<Numbers>,
    /// The memory before the first cycle.
    pub(crate) memory: &'a [f64],
    pub(crate) remembered: SlotWriter<Numbers>,
}

impl Running {
    /// Parameters and memory have at most [`MOST`] numbers.
    pub(crate) fn new(code: Arc<Code>, setup: Setup<'_>) -> Self {
        let cycle = Cycle {
            version: VERSION,
            size: size_of::<Cycle>() as u32,
            parameters_len: setup.parameters.len() as u64,
            memory_len: setup.memory.len() as u64,
            ..Cycle::default()
        };
        Self {
            code,
            model: setup.model,
            version: setup.version,
            cycle: Box::new(cycle),
            parameters: Box::new(padded(setup.parameters)),
            arriving: setup.arriving,
            memory: Box::new(padded(setup.memory)),
            remembered: setup.remembered,
        }
    }

    /// Calls the law. Returns its output and its return value; output numbers that it did not write
    /// are NaN, which is never sent to a robot.
    pub(crate) fn call(&mut self, state: &RobotState, step: Duration) -> (Output, i32) {
        // A torn read keeps the parameters of the previous cycle.
        if let Read::Newer(parameters) = self.arriving.read_newer() {
            *self.parameters = parameters;
        }
        let cycle = &mut *self.cycle;
        cycle.dt = step.as_secs_f64();
        cycle.time += cycle.dt;
        cycle.update(state, self.version, &self.model);
        let mut output = [f64::NAN; 18];
        let (parameters, memory) = (self.parameters.as_ptr(), self.memory.as_mut_ptr());
        // SAFETY: the pointers are to at least the stated numbers of values, alive and not aliased
        // during the call; the caller of `Code::new` has guaranteed the function.
        let code = unsafe { (self.code.function)(cycle, parameters, memory, output.as_mut_ptr()) };
        self.remembered.write(&self.memory);
        (output, code)
    }

    /// Returns the command of the law for a state, created from its output by `command`.
    pub(crate) fn next<C>(
        &mut self,
        state: &RobotState,
        step: Duration,
        command: impl FnOnce(&Output) -> C,
    ) -> Next<C> {
        let (output, code) = self.call(state, step);
        match code {
            0 => Next::Continue(command(&output)),
            1.. => Next::Finish(command(&output)),
            ..0 => Next::GiveUp(code),
        }
    }
}

/// Returns `numbers`, padded with zeros.
///
/// # Panics
/// If there are more than [`MOST`].
pub(crate) fn padded(numbers: &[f64]) -> Numbers {
    let mut padded = [0.0; MOST];
    padded[..numbers.len()].copy_from_slice(numbers);
    padded
}
