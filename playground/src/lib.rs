//! The driver and a simulated robot for a web page: the functions that JavaScript calls.
//!
//! ```text
//! page --> start, advance, target, push, block, recover --> Playground: driver <~bytes~> robot
//!      <-- view, message, guard_name
//! ```
//!
//! Each WebAssembly module is one arm. The module has no thread, no socket and no clock, because
//! the page decides how much time passes.

mod playground;

use std::cell::RefCell;
use std::ffi::CString;

use franka_model::RobotKind;
use franka_rt::session::Guard;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

pub use playground::{Playground, State};

/// Number of values in the view for the page.
const NUMBERS: usize = 36;

/// An arm, and its view for the page.
struct Shown {
    playground: Playground,
    view: [f64; NUMBERS],
    message: CString,
}

thread_local! {
    static SHOWN: RefCell<Option<Shown>> = const { RefCell::new(None) };
    static GUARDS: Vec<CString> = Guard::ALL.iter().map(guard_text).collect();
}

/// Replaces the arm by a new arm at rest in the ready pose. If `kind` is 1, the arm is a Franka
/// Emika Robot, otherwise an FR3. It is ideal if `realistic` is 0, otherwise realistic and drawn
/// from `seed`.
#[unsafe(no_mangle)]
pub extern "C" fn start(kind: u32, realistic: u32, seed: u32) {
    let kind = match kind {
        1 => RobotKind::Fer,
        _ => RobotKind::Fr3,
    };
    let shown = Shown {
        playground: Playground::new(kind, (realistic != 0).then_some(seed.into())),
        view: [0.0; NUMBERS],
        message: CString::default(),
    };
    SHOWN.set(Some(shown));
}

/// Advances time by `milliseconds`.
#[unsafe(no_mangle)]
pub extern "C" fn advance(milliseconds: u32) {
    with(|shown| shown.playground.advance(milliseconds));
}

/// Sets the target of the end effector in the base frame: a position, `[m]`, and a quaternion of
/// any length except 0. An invalid pose changes nothing.
#[unsafe(no_mangle)]
pub extern "C" fn target(x: f64, y: f64, z: f64, qx: f64, qy: f64, qz: f64, qw: f64) {
    let turn = UnitQuaternion::try_new(Quaternion::new(qw, qx, qy, qz), 1e-6);
    if let Some(turn) = turn
        && [x, y, z].iter().all(|value| value.is_finite())
    {
        let pose = Isometry3::from_parts(Translation3::new(x, y, z), turn);
        with(|shown| shown.playground.target(pose));
    }
}

/// Pushes the end effector with this force in the base frame, `[N]`, until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn push(x: f64, y: f64, z: f64) {
    with(|shown| shown.playground.push(Vector3::new(x, y, z)));
}

/// Grips the end effector in its position, or releases it.
#[unsafe(no_mangle)]
pub extern "C" fn block(on: u32) {
    with(|shown| shown.playground.block(on != 0));
}

/// Makes the robot recover from its stop. The arm then holds its position.
#[unsafe(no_mangle)]
pub extern "C" fn recover() {
    with(|shown| shown.playground.recover());
}

/// Returns the address of the arm's view, an array of numbers. The address is valid until the next
/// call of this module.
///
/// | index | content |
/// |---|---|
/// | 0 | time since the start, `[s]` |
/// | 1 | [`State`] |
/// | 2 to 8 | measured joint positions, `[rad]` |
/// | 9 to 15 | joint positions of the reference, `[rad]` |
/// | 16 to 22 | target, as `x y z qx qy qz qw`, base frame, `[m]` |
/// | 23 to 29 | measured pose of the end effector, in the same form |
/// | 30 to 32 | force on the end effector that the robot estimates, base frame, `[N]` |
/// | 33 | speed of the fastest point of the arm, `[m/s]` |
/// | 34 | guards that bound the newest command, one bit per guard in the order of [`guard_name`] |
/// | 35 | distance between the end effector and its target, `[m]` |
#[unsafe(no_mangle)]
pub extern "C" fn view() -> *const f64 {
    with(|shown| {
        let now = shown.playground.view();
        let pose = |pose: &Isometry3<f64>| {
            let [x, y, z] = pose.translation.vector.into();
            let [i, j, k, w] = pose.rotation.coords.into();
            [x, y, z, i, j, k, w]
        };
        let parts: [&[f64]; 8] = [
            &[now.seconds, f64::from(now.state as u8)],
            &now.q,
            &now.q_ref,
            &pose(&now.target),
            &pose(&now.end_effector),
            now.force.as_slice(),
            &[now.speed, f64::from(now.guards.to_bits())],
            &[(now.target.translation.vector - now.end_effector.translation.vector).norm()],
        ];
        let all = parts.into_iter().flatten();
        shown
            .view
            .iter_mut()
            .zip(all)
            .for_each(|(to, from)| *to = *from);
        shown.view.as_ptr()
    })
    .unwrap_or(std::ptr::null())
}

/// Returns the address of the newest message, as UTF-8 text that ends with a zero. The text is
/// empty if there is no message. The address is valid until the next call of this module.
#[unsafe(no_mangle)]
pub extern "C" fn message() -> *const u8 {
    with(|shown| {
        shown.message = text(shown.playground.message());
        shown.message.as_ptr().cast()
    })
    .unwrap_or(std::ptr::null())
}

/// Returns the address of a guard's name, as UTF-8 text that ends with a zero; null after the last
/// guard.
#[unsafe(no_mangle)]
pub extern "C" fn guard_name(index: u32) -> *const u8 {
    GUARDS.with(|guards| {
        let name = guards.get(index as usize);
        name.map_or(std::ptr::null(), |name| name.as_ptr().cast())
    })
}

fn with<T>(use_it: impl FnOnce(&mut Shown) -> T) -> Option<T> {
    SHOWN.with_borrow_mut(|shown| shown.as_mut().map(use_it))
}

fn guard_text(guard: &Guard) -> CString {
    text(&guard.to_string())
}

fn text(text: &str) -> CString {
    CString::new(text).unwrap_or_default()
}
