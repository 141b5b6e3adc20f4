//! A library with the functions of the vendor's, as a robot could send it, with easily recognised
//! results. Each number is a sum of the function's tag, the number's place, and all inputs, each
//! with a different weight.
//!
//! Compiled by the tests, as a `cdylib`; with `--cfg lacking`, one function is missing.

use std::slice::from_raw_parts;

/// The number at `place` of the result of function `tag`.
fn number(tag: u32, place: usize, inputs: &[&[f64]]) -> f64 {
    let weighted = inputs.iter().copied().flatten().zip(1_u32..);
    let sum: f64 = weighted.map(|(x, weight)| x * f64::from(weight)).sum();
    f64::from(tag) + place as f64 / 64.0 + sum
}

unsafe fn fill(out: *mut f64, size: usize, tag: u32, inputs: &[&[f64]]) {
    for place in 0..size {
        unsafe { out.add(place).write(number(tag, place, inputs)) };
    }
}

unsafe fn numbers<'a>(pointer: *const f64, size: usize) -> &'a [f64] {
    unsafe { from_raw_parts(pointer, size) }
}

#[unsafe(export_name = "M_NE")]
unsafe extern "C" fn mass(q: *const f64, i: *const f64, m: f64, c: *const f64, out: *mut f64) {
    unsafe {
        let inputs = [numbers(q, 7), numbers(i, 9), &[m], numbers(c, 3)];
        fill(out, 49, 1, &inputs);
    }
}

#[unsafe(export_name = "c_NE")]
unsafe extern "C" fn coriolis(
    q: *const f64,
    dq: *const f64,
    i: *const f64,
    m: f64,
    c: *const f64,
    out: *mut f64,
) {
    unsafe {
        let inputs = [
            numbers(q, 7),
            numbers(dq, 7),
            numbers(i, 9),
            &[m],
            numbers(c, 3),
        ];
        fill(out, 7, 2, &inputs);
    }
}

#[cfg(not(lacking))]
#[unsafe(export_name = "g_NE")]
unsafe extern "C" fn gravity(q: *const f64, g: *const f64, m: f64, c: *const f64, out: *mut f64) {
    unsafe {
        let inputs = [numbers(q, 7), numbers(g, 3), &[m], numbers(c, 3)];
        fill(out, 7, 3, &inputs);
    }
}

/// Functions of the posture.
macro_rules! of_posture {
    ($size:expr; $($function:ident $name:literal $tag:expr),*) => { $(
        #[unsafe(export_name = $name)]
        unsafe extern "C" fn $function(q: *const f64, out: *mut f64) {
            unsafe { fill(out, $size, $tag, &[numbers(q, 7)]) }
        }
    )* };
}

/// Functions of the posture and of a frame on the flange.
macro_rules! of_frame {
    ($size:expr; $($function:ident $name:literal $tag:expr),*) => { $(
        #[unsafe(export_name = $name)]
        unsafe extern "C" fn $function(q: *const f64, f_t_ee: *const f64, out: *mut f64) {
            unsafe { fill(out, $size, $tag, &[numbers(q, 7), numbers(f_t_ee, 16)]) }
        }
    )* };
}

/// Functions without inputs.
macro_rules! of_nothing {
    ($size:expr; $($function:ident $name:literal $tag:expr),*) => { $(
        #[unsafe(export_name = $name)]
        unsafe extern "C" fn $function(out: *mut f64) {
            unsafe { fill(out, $size, $tag, &[]) }
        }
    )* };
}

of_posture!(16; p1 "O_T_J1" 11, p2 "O_T_J2" 12, p3 "O_T_J3" 13, p4 "O_T_J4" 14, p5 "O_T_J5" 15, p6 "O_T_J6" 16,
    p7 "O_T_J7" 17, p8 "O_T_J8" 18);
of_posture!(42; b2 "Ji_J_J2" 22, b3 "Ji_J_J3" 23, b4 "Ji_J_J4" 24, b5 "Ji_J_J5" 25, b6 "Ji_J_J6" 26, b7 "Ji_J_J7" 27,
    b8 "Ji_J_J8" 28);
of_posture!(42; z2 "O_J_J2" 32, z3 "O_J_J3" 33, z4 "O_J_J4" 34, z5 "O_J_J5" 35, z6 "O_J_J6" 36, z7 "O_J_J7" 37,
    z8 "O_J_J8" 38);
of_frame!(16; p9 "O_T_J9" 19);
of_frame!(42; b9 "Ji_J_J9" 29, z9 "O_J_J9" 39);
of_nothing!(42; b1 "Ji_J_J1" 21, z1 "O_J_J1" 31);
