//! Control laws behind a C function pointer, over 10^5 cycles with parameters that change.

use std::sync::Arc;

use franka_async::connection::Version;
use franka_async::control::slot::{Read, slot};
use franka_async::control::{MoveControllerMode, Torques};
use franka_async::model::Model;
use franka_rt::control::{Callback, Shaper};
use franka_rt::driver::Program;

use crate::control::calls_of;

/// The part of the Python package that runs on the thread.
#[path = "../../franka-py/src/law/function.rs"]
#[allow(dead_code, reason = "the package reads the layout, too")]
mod function;

use function::{Code, Cycle, Setup};

/// Writes the parameter to the output, and counts the calls.
unsafe extern "C" fn counting(
    _: *const Cycle,
    parameters: *const f64,
    memory: *mut f64,
    output: *mut f64,
) -> i32 {
    // SAFETY: there are a parameter, a number of memory and seven of output, or more.
    unsafe {
        *memory += 1.0;
        for joint in 0..7 {
            *output.add(joint) = *parameters;
        }
    }
    0
}

#[test]
fn laws_allocate_and_free_nothing() {
    for (version, model) in [(Version::V5, Model::fer()), (Version::V10, Model::fr3())] {
        let (mut parameters, arriving) = slot();
        let (remembered, mut memory) = slot();
        // SAFETY: the function is static, and meets the requirements of a law.
        let code = unsafe { Code::new(counting as *const () as usize, Box::new(())) };
        let setup = Setup {
            model: Arc::new(model.clone()),
            version,
            parameters: &[0.0],
            arriving,
            memory: &[0.0],
            remembered,
        };
        let mut law = function::Running::new(Arc::new(code.expect("not null")), setup);
        let callback = Callback::torques(version, move |state, step| {
            law.next(state, step, |output| {
                Torques(core::array::from_fn(|joint| output[joint]))
            })
        })
        .with_shaper(Shaper::new(version, true, 100.0));
        let request = callback.request(version, MoveControllerMode::JointImpedance);
        let program = Program::Callback(Box::new(callback));
        let calls = calls_of(version, program, &request, |time| {
            if time % 7 == 0 {
                parameters.write(&function::padded(&[time as f64 * 1e-6]));
            }
        });
        assert_eq!(calls, 0, "{version:?}");
        let Read::Newer(memory) = memory.read_newer() else {
            panic!("the law has been called");
        };
        assert_eq!(memory[0], 100_000.0);
    }
}
