//! Numbers between Python and Rust: arguments from lists or arrays of any numeric type, results as
//! new `float64` arrays.

use franka_async::Pose;
use franka_async::nalgebra::{Matrix4, SMatrix};
use franka_async::pose::{self, NotRigid};
use numpy::{
    PyArray1, PyArray2, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyException, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;

/// The numbers of an argument, with its shape. Row-major, for any order in memory.
pub(crate) struct Numbers {
    pub(crate) shape: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

impl Numbers {
    /// Reads a number, a list (of lists) or an array from the argument `name`.
    ///
    /// # Errors
    /// `TypeError` for any other object, such as text, truth values and complex numbers; an
    /// interrupt in the meantime is passed on.
    pub(crate) fn read(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Self> {
        let array = match argument.cast::<PyArrayDyn<f64>>() {
            Ok(array) => array.clone(),
            Err(_) => converted(name, argument)?,
        };
        let array = array.readonly();
        let shape = array.shape().to_vec();
        let values = match array.as_slice() {
            Ok(values) if array.is_c_contiguous() => values.to_vec(),
            _ => array.as_array().iter().copied().collect(),
        };
        Ok(Self { shape, values })
    }
}

/// Returns numpy's conversion of the argument `name`.
fn converted<'py>(
    name: &str,
    argument: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = argument.py();
    let got = |what: &str| PyTypeError::new_err(format!("{name} has {what}, expected numbers"));
    if argument.is_none() {
        return Err(got("None"));
    }
    let no_numbers = |cause: PyErr| {
        // Ctrl-C may arrive while numpy reads the argument.
        if !cause.is_instance_of::<PyException>(py) {
            return cause;
        }
        PyTypeError::new_err(format!("{name} has no numbers: {cause}"))
    };
    let numpy = py.import("numpy")?;
    let array = numpy.call_method1("asarray", (argument,));
    let array = array.map_err(no_numbers)?;
    match array.cast::<PyUntypedArray>()?.dtype().kind() {
        // Numbers of any size.
        b'f' | b'i' | b'u' => {}
        b'b' => return Err(got("truth values")),
        b'c' => return Err(got("complex numbers")),
        b'U' | b'S' => return Err(got("text")),
        _ => {
            for part in array.getattr("flat")?.try_iter()? {
                let part = part?;
                if part.is_none() {
                    return Err(got("None"));
                }
                if part.is_instance_of::<PyString>() {
                    return Err(got("text"));
                }
            }
        }
    }
    let array = array.call_method1("astype", ("float64",));
    Ok(array.map_err(no_numbers)?.cast_into()?)
}

/// Reads `N` numbers from the argument `name`.
///
/// # Errors
/// `ValueError` for another shape or numbers that are not finite; `TypeError`.
pub(crate) fn vector<const N: usize>(
    name: &str,
    argument: &Bound<'_, PyAny>,
) -> PyResult<[f64; N]> {
    let Numbers { shape, values } = Numbers::read(name, argument)?;
    let vector: [f64; N] = match values.try_into() {
        Ok(vector) if shape.len() == 1 => vector,
        _ => return Err(unexpected_shape(name, &shape, &format!("({N},)"))),
    };
    check_finite(name, &vector)?;
    Ok(vector)
}

/// Returns a new array of `length` numbers from the argument `name`.
#[pyfunction]
pub(crate) fn _row<'py>(
    name: &str,
    argument: &Bound<'py, PyAny>,
    length: usize,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let Numbers { shape, values } = Numbers::read(name, argument)?;
    if shape != [length] {
        return Err(unexpected_shape(name, &shape, &format!("({length},)")));
    }
    check_finite(name, &values)?;
    Ok(array(argument.py(), &values))
}

/// Reads rows of `N` numbers each from the argument `name`; a single row needs no outer axis.
///
/// # Errors
/// The errors of [`vector`].
pub(crate) fn rows<const N: usize>(
    name: &str,
    argument: &Bound<'_, PyAny>,
) -> PyResult<Vec<[f64; N]>> {
    let Numbers { shape, values } = Numbers::read(name, argument)?;
    if !matches!(*shape, [width] | [_, width] if width == N) {
        return Err(unexpected_shape(
            name,
            &shape,
            &format!("({N},) or (n, {N})"),
        ));
    }
    check_finite(name, &values)?;
    Ok(values.as_chunks::<N>().0.to_vec())
}

/// Reads a pose, `(4, 4)` with the translation in the last column, or 3 + 4 numbers: position `[m]`
/// and quaternion `x y z w`.
///
/// # Errors
/// `ValueError` for another shape, numbers that are not finite, a matrix that is not rigid and a
/// quaternion of no length; `TypeError`.
pub(crate) fn pose(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Pose> {
    let Numbers { shape, values } = Numbers::read(name, argument)?;
    pose_of(name, &shape, &values)?.ok_or_else(|| {
        unexpected_shape(
            name,
            &shape,
            "(4, 4) or (7,): x y z and a quaternion x y z w",
        )
    })
}

/// Returns the pose in these numbers; `None` for another shape.
///
/// # Errors
/// The errors of [`pose`].
pub(crate) fn pose_of(name: &str, shape: &[usize], values: &[f64]) -> PyResult<Option<Pose>> {
    check_finite(name, values)?;
    match *shape {
        [4, 4] => {
            let matrix = Matrix4::from_row_slice(values);
            let pose = pose::from_matrix(&matrix).map_err(|error| {
                let error = match error {
                    NotRigid::RowMajor => "got column by column".to_owned(),
                    error => error.to_string(),
                };
                PyValueError::new_err(format!(
                    "{name} is not a rigid transformation, row by row: {error}; expected a rotation matrix, \
                     a translation in the last column and 0 0 0 1 in the last row, got\n{matrix:.4}"
                ))
            });
            pose.map(Some)
        }
        [7] => {
            let [x, y, z, quaternion @ ..] = <[f64; 7]>::try_from(values).expect("seven numbers");
            from_xyzw(name, [x, y, z], quaternion).map(Some)
        }
        _ => Ok(None),
    }
}

/// Returns the pose of this position and quaternion `x y z w`, of any non-zero length.
///
/// # Errors
/// `ValueError`.
pub(crate) fn from_xyzw(name: &str, position: [f64; 3], quaternion: [f64; 4]) -> PyResult<Pose> {
    pose::from_xyzw(position, quaternion).ok_or_else(|| {
        let text = format!("{name} has the quaternion {quaternion:?}, expected a length above 0");
        PyValueError::new_err(text)
    })
}

/// Reads a pose like [`pose`], but accepts any `(4, 4)` matrix unchanged.
///
/// # Errors
/// The errors of [`pose`], except for a matrix that is not rigid.
pub(crate) fn pose_matrix(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Matrix4<f64>> {
    let Numbers { shape, values } = Numbers::read(name, argument)?;
    check_finite(name, &values)?;
    match *shape {
        [4, 4] => Ok(Matrix4::from_row_slice(&values)),
        _ => pose(name, argument).map(|pose| pose.to_homogeneous()),
    }
}

/// Returns the error for an argument of the wrong shape.
pub(crate) fn unexpected_shape(name: &str, got: &[usize], expected: &str) -> PyErr {
    PyValueError::new_err(format!("{name} has the shape {got:?}, expected {expected}"))
}

pub(crate) fn check_finite(name: &str, values: &[f64]) -> PyResult<()> {
    match values.iter().find(|value| !value.is_finite()) {
        None => Ok(()),
        Some(value) => Err(PyValueError::new_err(format!(
            "{name} holds {value}, expected finite numbers"
        ))),
    }
}

/// Returns a new array of these numbers.
pub(crate) fn array<'py>(py: Python<'py>, values: &[f64]) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, values)
}

/// Returns a new array of a matrix.
pub(crate) fn matrix<'py, const R: usize, const C: usize>(
    py: Python<'py>,
    matrix: &SMatrix<f64, R, C>,
) -> Bound<'py, PyArray2<f64>> {
    // Row-major: the memory of the transposed.
    table(py, matrix.transpose().as_slice(), C)
}

/// Returns a new `(4, 4)` array of a pose, with the translation in the last column.
pub(crate) fn pose_array<'py>(py: Python<'py>, pose: &Pose) -> Bound<'py, PyArray2<f64>> {
    matrix(py, &pose.to_homogeneous())
}

/// Returns a new array of a column-major matrix of the robot.
pub(crate) fn columns<'py, const R: usize, const C: usize>(
    py: Python<'py>,
    values: &[f64],
) -> Bound<'py, PyArray2<f64>> {
    matrix(py, &SMatrix::<f64, R, C>::from_column_slice(values))
}

/// Returns a new array with rows of `width` numbers each, from row-major `values`.
pub(crate) fn table<'py>(
    py: Python<'py>,
    values: &[f64],
    width: usize,
) -> Bound<'py, PyArray2<f64>> {
    let rows = values.len() / width.max(1);
    array(py, values)
        .reshape([rows, width])
        .expect("as many numbers as the shape has")
}
