//! Conversion between the wire state and [`RobotState`], shared by both layouts.

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use super::RobotState;
use crate::protocol::{DecodeError, EncodeError};
use crate::robot::Errors;
use crate::robot::{ControllerMode, MotionGeneratorMode, RobotMode};
use crate::wire::{self, F32, Real};

/// Reader and writer of one version's state, for the version table.
#[derive(Clone, Copy)]
pub(crate) struct StateCodec {
    pub(crate) size: usize,
    pub(super) decode: fn(&[u8]) -> Result<RobotState, DecodeError>,
    pub(super) encode: fn(&RobotState, &mut [u8]) -> Result<usize, EncodeError>,
    /// Adds two numbers with the precision of the layout.
    pub(super) add: fn(f64, f64) -> f64,
}

impl StateCodec {
    /// Creates the codec for the layout with numbers `R` and accelerometers `A`, in a version with
    /// the motion generator modes `G`.
    pub(crate) const fn of<R: Real, A: AccelerometerBlock, G: GeneratorModes>() -> Self {
        Self {
            size: size_of::<wire::RobotState<R, A>>(),
            decode: decode::<R, A, G>,
            encode: encode::<R, A, G>,
            add: |a, b| R::narrow(a).add(R::narrow(b)).widen(),
        }
    }
}

/// The block of accelerometers in a layout. It may be empty.
pub(crate) trait AccelerometerBlock:
    Copy + FromBytes + IntoBytes + Immutable + KnownLayout + Unaligned
{
    /// True if the layout has accelerometers.
    const EXISTS: bool;
    /// Returns the readings of the upper and the lower sensors, or zeros without accelerometers.
    fn values(&self) -> [[[f32; 3]; 6]; 2];
    fn of(top: &[[f32; 3]; 6], bottom: &[[f32; 3]; 6]) -> Self;
}

impl AccelerometerBlock for wire::Accelerometers {
    const EXISTS: bool = true;

    #[inline]
    fn values(&self) -> [[[f32; 3]; 6]; 2] {
        [self.top, self.bottom].map(|block| block.map(|sensor| sensor.map(F32::get)))
    }

    #[inline]
    fn of(top: &[[f32; 3]; 6], bottom: &[[f32; 3]; 6]) -> Self {
        Self {
            top: top.map(|sensor| sensor.map(F32::new)),
            bottom: bottom.map(|sensor| sensor.map(F32::new)),
        }
    }
}

impl AccelerometerBlock for () {
    const EXISTS: bool = false;

    #[inline]
    fn values(&self) -> [[[f32; 3]; 6]; 2] {
        [[[0.0; 3]; 6]; 2]
    }

    #[inline]
    fn of(_: &[[f32; 3]; 6], _: &[[f32; 3]; 6]) -> Self {}
}

/// The motion generator modes of a version. The byte of a mode is its position in the list.
pub(crate) trait GeneratorModes {
    const MODES: &'static [MotionGeneratorMode];
}

fn generator_mode<G: GeneratorModes>(byte: u8) -> MotionGeneratorMode {
    let known = G::MODES.get(usize::from(byte)).copied();
    known.unwrap_or(MotionGeneratorMode::Unknown(byte))
}

fn generator_byte<G: GeneratorModes>(mode: MotionGeneratorMode) -> Option<u8> {
    match mode {
        MotionGeneratorMode::Unknown(byte) => Some(byte),
        known => {
            let position = G::MODES.iter().position(|&mode| mode == known);
            position.and_then(|position| u8::try_from(position).ok())
        }
    }
}

/// Calls `$convert!` with the names of all fields that are arrays of reals.
macro_rules! for_arrays {
    ($convert:ident) => {
        $convert!(
            O_T_EE,
            O_T_EE_d,
            F_T_EE,
            EE_T_K,
            F_T_NE,
            NE_T_EE,
            I_ee,
            F_x_Cee,
            I_load,
            F_x_Cload,
            elbow,
            elbow_d,
            tau_J,
            tau_J_d,
            dtau_J,
            q,
            q_d,
            dq,
            dq_d,
            ddq_d,
            joint_contact,
            cartesian_contact,
            joint_collision,
            cartesian_collision,
            tau_ext_hat_filtered,
            O_F_ext_hat_K,
            K_F_ext_hat_K,
            O_dP_EE_d,
            O_ddP_O,
            elbow_c,
            delbow_c,
            ddelbow_c,
            O_T_EE_c,
            O_dP_EE_c,
            O_ddP_EE_c,
            theta,
            dtheta
        )
    };
}

fn decode<R: Real, A: AccelerometerBlock, G: GeneratorModes>(
    bytes: &[u8],
) -> Result<RobotState, DecodeError> {
    let (wire, _) = wire::RobotState::<R, A>::ref_from_prefix(bytes)
        .map_err(|_| DecodeError::datagram::<wire::RobotState<R, A>>(bytes))?;
    let [accelerometer_top, accelerometer_bottom] = wire.accelerometers.values();
    macro_rules! state {
        ($($array:ident),*) => {
            RobotState {
                message_id: wire.message_id.get(),
                m_ee: wire.m_ee.widen(),
                m_load: wire.m_load.widen(),
                $($array: wire::from_wire(&wire.$array),)*
                accelerometer_top,
                accelerometer_bottom,
                motion_generator_mode: generator_mode::<G>(wire.motion_generator_mode),
                controller_mode: ControllerMode::from_byte(wire.controller_mode),
                errors: Errors::from_flags(&wire.errors),
                reflex_reason: Errors::from_flags(&wire.reflex_reason),
                robot_mode: RobotMode::from_byte(wire.robot_mode),
                control_command_success_rate: wire.control_command_success_rate.widen(),
            }
        };
    }
    Ok(for_arrays!(state))
}

fn encode<R: Real, A: AccelerometerBlock, G: GeneratorModes>(
    state: &RobotState,
    buffer: &mut [u8],
) -> Result<usize, EncodeError> {
    let size = size_of::<wire::RobotState<R, A>>();
    let motion_generator_mode =
        generator_byte::<G>(state.motion_generator_mode).ok_or(EncodeError::Unsupported {
            what: "motion_generator_mode",
        })?;
    let got = buffer.len();
    let (wire, _) = wire::RobotState::<R, A>::mut_from_prefix(buffer)
        .map_err(|_| EncodeError::Buffer { got, needed: size })?;
    macro_rules! wire_state {
        ($($array:ident),*) => {
            wire::RobotState {
                message_id: state.message_id.into(),
                m_ee: R::narrow(state.m_ee),
                m_load: R::narrow(state.m_load),
                $($array: wire::to_wire(&state.$array),)*
                accelerometers: A::of(&state.accelerometer_top, &state.accelerometer_bottom),
                motion_generator_mode,
                controller_mode: state.controller_mode.byte(),
                errors: state.errors.to_flags(),
                reflex_reason: state.reflex_reason.to_flags(),
                robot_mode: state.robot_mode.byte(),
                control_command_success_rate: R::narrow(state.control_command_success_rate),
            }
        };
    }
    *wire = for_arrays!(wire_state);
    Ok(size)
}
