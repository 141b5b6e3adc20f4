//! Functions of one or many joint vectors: `(7,)` gives one result, `(n, 7)` an array with a
//! leading axis of length n.

use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Numbers, check_finite, unexpected_shape};

/// Rows of `N` numbers each, from an argument with one row or many.
pub(crate) struct Batch<const N: usize> {
    name: &'static str,
    rows: Vec<[f64; N]>,
    /// True if the argument was one row without a leading axis.
    is_single: bool,
}

impl<const N: usize> Batch<N> {
    /// Reads `(N,)` or `(n, N)` finite numbers.
    ///
    /// # Errors
    /// `ValueError` for another shape or numbers that are not finite; `TypeError`.
    pub(crate) fn read(name: &'static str, argument: &Bound<'_, PyAny>) -> PyResult<Self> {
        let Numbers { shape, values } = Numbers::read(name, argument)?;
        let is_single = match *shape {
            [width] if width == N => true,
            [_, width] if width == N => false,
            _ => {
                let expected = format!("({N},) or (n, {N})");
                return Err(unexpected_shape(name, &shape, &expected));
            }
        };
        check_finite(name, &values)?;
        Ok(Self::new(
            name,
            values.as_chunks::<N>().0.to_vec(),
            is_single,
        ))
    }

    /// Like [`read`](Self::read), or one row of zeros for a missing argument.
    ///
    /// # Errors
    /// The errors of [`read`](Self::read).
    pub(crate) fn or_zeros(
        name: &'static str,
        argument: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        match argument {
            Some(argument) => Self::read(name, argument),
            None => Ok(Self::new(name, vec![[0.0; N]], true)),
        }
    }

    pub(crate) fn new(name: &'static str, rows: Vec<[f64; N]>, is_single: bool) -> Self {
        Self {
            name,
            rows,
            is_single,
        }
    }

    /// Returns row `index`; a single row is used for every index.
    pub(crate) fn row(&self, index: usize) -> &[f64; N] {
        &self.rows[if self.is_single { 0 } else { index }]
    }

    /// The number of rows; `None` for one without a leading axis.
    pub(crate) fn count(&self) -> Option<usize> {
        (!self.is_single).then_some(self.rows.len())
    }

    /// Returns its name and [`count`](Self::count), for [`common_count`].
    pub(crate) fn named_count(&self) -> (&str, Option<usize>) {
        (self.name, self.count())
    }

    /// Returns the common number of rows of this argument and another one; a single row is used
    /// with any number.
    ///
    /// # Errors
    /// `ValueError` if the numbers differ.
    pub(crate) fn count_with<const M: usize>(&self, other: &Batch<M>) -> PyResult<Option<usize>> {
        common_count(self.named_count(), other.named_count())
    }
}

/// Returns the common number of rows of two arguments, each with its name; an argument without a
/// leading axis matches any number.
///
/// # Errors
/// `ValueError` if the numbers differ.
pub(crate) fn common_count(
    (name, count): (&str, Option<usize>),
    (other, others): (&str, Option<usize>),
) -> PyResult<Option<usize>> {
    match (count, others) {
        (Some(one), Some(two)) if one != two => Err(PyValueError::new_err(format!(
            "{other} has {two} rows, expected {one} as in {name}, or one row"
        ))),
        (one, two) => Ok(one.or(two)),
    }
}

/// The duration of a function for one row.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cost {
    /// Some microseconds at most: a single call keeps the interpreter, because releasing and
    /// reacquiring it would take longer.
    Little,
    /// Longer.
    Much,
}

/// Returns new arrays of the results of `function`, with these shapes, after an axis of length
/// `count` if given. The interpreter is released meanwhile, except for one cheap result.
pub(crate) fn outputs<'py, const K: usize>(
    py: Python<'py>,
    count: Option<usize>,
    shapes: [&[usize]; K],
    cost: Cost,
    function: impl Fn(usize, [&mut [f64]; K]) + Send + Sync,
) -> [Bound<'py, PyArrayDyn<f64>>; K] {
    let arrays = shapes.map(|shape| {
        let whole: Vec<usize> = count.into_iter().chain(shape.iter().copied()).collect();
        PyArrayDyn::<f64>::zeros(py, whole, false)
    });
    {
        let mut writers = arrays.each_ref().map(|array| array.readwrite());
        let mut rows = writers.each_mut().into_iter().zip(shapes);
        let mut rows: [_; K] = std::array::from_fn(|_| {
            let (writer, shape) = rows.next().expect("an array for each shape");
            let values = writer
                .as_slice_mut()
                .expect("a new array is in one piece of memory");
            values.chunks_exact_mut(shape.iter().product())
        });
        let mut write = move || {
            for index in 0..count.unwrap_or(1) {
                let row = rows.each_mut();
                function(
                    index,
                    row.map(|rows| rows.next().expect("a row for each index")),
                );
            }
        };
        if count.is_none() && cost == Cost::Little {
            write();
        } else {
            py.detach(write);
        }
    }
    arrays
}

/// Like [`outputs`], with one array.
pub(crate) fn output<'py>(
    py: Python<'py>,
    count: Option<usize>,
    shape: &[usize],
    cost: Cost,
    function: impl Fn(usize, &mut [f64]) + Send + Sync,
) -> Bound<'py, PyArrayDyn<f64>> {
    let [array] = outputs(py, count, [shape], cost, |index, [row]| {
        function(index, row);
    });
    array
}

/// Writes a matrix row by row.
pub(crate) fn write_matrix<const R: usize, const C: usize>(
    matrix: &franka_async::nalgebra::SMatrix<f64, R, C>,
    row: &mut [f64],
) {
    row.copy_from_slice(matrix.transpose().as_slice());
}
