//! Arrays as arguments: what is not an array of numbers of the right shape is refused with a message that names the
//! argument. Any layout will do, read-only or not; all numbers become 32-bit floats or indices.

use bilux::math::glam::DMat4;
use bilux::math::{Transform, Vec2, Vec3};
use numpy::{PyReadonlyArray2, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::fmt::Debug;

/// An argument as an array of numbers of any shape.
pub(crate) fn numbers<'py>(name: &str, argument: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    let numpy = argument.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (argument,)).map_err(|error| {
        PyTypeError::new_err(format!("{name}: this is no array of numbers: {}", error.value(argument.py())))
    })?;
    let array = array.cast_into::<PyUntypedArray>()?;
    let kind: char = array.dtype().getattr("kind")?.extract()?;
    if !"fiu".contains(kind) {
        let dtype = array.dtype();
        return Err(PyTypeError::new_err(format!(
            "{name}: an array of {dtype} is no array of numbers: convert it with .astype('float32')"
        )));
    }
    // One whose numbers are not at multiples of their size, as in a packed file, cannot be read in place.
    if array.getattr("flags")?.getattr("aligned")?.is_truthy()? {
        return Ok(array);
    }
    Ok(array.call_method0("copy")?.cast_into()?)
}

/// The shape as Python writes it.
pub(crate) fn shape_of(array: &Bound<'_, PyUntypedArray>) -> String {
    let sides: Vec<String> = array.shape().iter().map(ToString::to_string).collect();
    let comma = if sides.len() == 1 { "," } else { "" };
    format!("({}{comma})", sides.join(", "))
}

/// The numbers as 32-bit floats, row by row, whatever the layout of the array.
pub(crate) fn floats(array: &Bound<'_, PyUntypedArray>) -> PyResult<Vec<f32>> {
    if let Ok(singles) = array.extract::<PyReadonlyArrayDyn<'_, f32>>() {
        let view = singles.as_array();
        return Ok(view.as_slice().map_or_else(|| view.iter().copied().collect(), <[f32]>::to_vec));
    }
    let array = array.call_method1("astype", ("float64", "C", "unsafe", false, false))?;
    let doubles = array.extract::<PyReadonlyArrayDyn<'_, f64>>()?;
    Ok(doubles.as_array().iter().map(|&number| number as f32).collect())
}

/// An array of rows of `N` numbers.
fn rows_of<'py, const N: usize>(
    name: &str,
    argument: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyUntypedArray>> {
    let array = numbers(name, argument)?;
    if array.ndim() != 2 || array.shape()[1] != N {
        let transposed = array.ndim() == 2 && array.shape()[0] == N;
        let advice = if transposed { format!("; transpose it: {name}.T") } else { String::new() };
        let shape = shape_of(&array);
        return Err(PyValueError::new_err(format!(
            "{name}: its shape is {shape}, but must be (n, {N}), one row for each{advice}"
        )));
    }
    Ok(array)
}

/// Rows of `N` finite numbers.
///
/// # Errors
/// `TypeError` if it is no array of numbers; `ValueError` if it has another shape, or a number is not finite.
pub(crate) fn rows<const N: usize>(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Vec<[f32; N]>> {
    let array = rows_of::<N>(name, argument)?;
    let rows = floats(&array)?.as_chunks::<N>().0.to_vec();
    match rows.iter().position(|row| row.iter().any(|x| !x.is_finite())) {
        None => Ok(rows),
        Some(bad) => Err(not_finite(name, bad, rows[bad])),
    }
}

/// The exception for a row that is not finite.
pub(crate) fn not_finite(name: &str, row: usize, numbers: impl Debug) -> PyErr {
    PyValueError::new_err(format!(
        "{name}: row {row} is {numbers:?}, which is not finite as 32-bit floats: leave it out, or correct it"
    ))
}

/// Rows of three numbers, finite or not. Those of 32- or 64-bit floats, one row after the other, are not copied.
pub(crate) enum Points<'py> {
    Singles(PyReadonlyArray2<'py, f32>),
    Doubles(PyReadonlyArray2<'py, f64>),
}

impl Points<'_> {
    pub(crate) fn rows(&self) -> Rows<'_> {
        match self {
            Points::Singles(array) => Rows::Singles(array.as_slice().unwrap_or_default().as_chunks().0),
            Points::Doubles(array) => Rows::Doubles(array.as_slice().unwrap_or_default().as_chunks().0),
        }
    }
}

/// Rows of [`Points`].
#[derive(Clone, Copy)]
pub(crate) enum Rows<'a> {
    Singles(&'a [[f32; 3]]),
    Doubles(&'a [[f64; 3]]),
}

impl Rows<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Rows::Singles(rows) => rows.len(),
            Rows::Doubles(rows) => rows.len(),
        }
    }

    #[inline]
    pub(crate) fn row(&self, i: usize) -> [f64; 3] {
        match self {
            Rows::Singles(rows) => rows[i].map(f64::from),
            Rows::Doubles(rows) => rows[i],
        }
    }

    /// The row of this number, or the only one.
    #[inline]
    pub(crate) fn shared(&self, i: usize) -> [f64; 3] {
        self.row(if self.len() == 1 { 0 } else { i })
    }
}

/// Rows of three numbers.
///
/// # Errors
/// `TypeError` if it is no array of numbers; `ValueError` if it has another shape.
pub(crate) fn points<'py>(name: &str, argument: &Bound<'py, PyAny>) -> PyResult<Points<'py>> {
    let array = rows_of::<3>(name, argument)?;
    if array.is_c_contiguous()
        && let Ok(singles) = array.extract()
    {
        return Ok(Points::Singles(singles));
    }
    let array = array.call_method1("astype", ("float64", "C", "unsafe", false, false))?;
    Ok(Points::Doubles(array.extract()?))
}

/// Points or directions.
pub(crate) fn vectors(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Vec<Vec3>> {
    Ok(rows::<3>(name, argument)?.into_iter().map(Vec3::from).collect())
}

/// Texture coordinates.
pub(crate) fn pairs(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Vec<Vec2>> {
    Ok(rows::<2>(name, argument)?.into_iter().map(Vec2::from).collect())
}

/// Triangles: rows of three indices below `count`, the number of vertices.
///
/// # Errors
/// As [`rows`]; also if the numbers are not whole, or an index is out of range.
pub(crate) fn triangles(name: &str, argument: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<[u32; 3]>> {
    let array = numbers(name, argument)?;
    let kind: char = array.dtype().getattr("kind")?.extract()?;
    if kind == 'f' && !array.shape().contains(&0) {
        return Err(PyTypeError::new_err(format!(
            "{name}: indices are whole numbers, but this is an array of {}: convert it with .astype('int64')",
            array.dtype()
        )));
    }
    if array.ndim() != 2 || array.shape()[1] != 3 {
        return Err(PyValueError::new_err(format!(
            "{name}: its shape is {}, but must be (n, 3), three indices of vertices for each triangle",
            shape_of(&array)
        )));
    }
    let array = array.call_method1("astype", ("int64", "C", "unsafe", false, false))?;
    let array = array.extract::<PyReadonlyArrayDyn<'_, i64>>()?;
    let view = array.as_array();
    let rows = view.as_slice().unwrap_or_default().as_chunks::<3>().0;
    let in_range = |index: i64| u32::try_from(index).ok().filter(|index| (*index as usize) < count);
    let index = |row: usize, index: i64| {
        in_range(index).ok_or_else(|| {
            let most = count.saturating_sub(1);
            PyValueError::new_err(format!(
                "{name}: row {row} has the index {index}, but there are {count} vertices: use 0 to {most}"
            ))
        })
    };
    let of_row = |(row, &[a, b, c]): (usize, &[i64; 3])| Ok([index(row, a)?, index(row, b)?, index(row, c)?]);
    rows.iter().enumerate().map(of_row).collect()
}

/// Transforms: one 4×4 matrix, or several, of column vectors: the last column is the translation.
///
/// # Errors
/// As [`rows`]; also if a matrix is not affine or cannot be inverted.
pub(crate) fn transforms(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Vec<Transform>> {
    let array = numbers(name, argument)?;
    let ends_in_matrix = matches!(array.shape(), [4, 4] | [_, 4, 4]);
    if !ends_in_matrix {
        let shape = shape_of(&array);
        return Err(PyValueError::new_err(format!(
            "{name}: its shape is {shape}, but must be (4, 4) or (n, 4, 4), matrices of column vectors"
        )));
    }
    let array = array.call_method1("astype", ("float64", "C", "unsafe", false, false))?;
    let array = array.extract::<PyReadonlyArrayDyn<'_, f64>>()?;
    let view = array.as_array();
    let matrices = view.as_slice().unwrap_or_default().as_chunks::<16>().0;
    let transform = |(i, numbers): (usize, &[f64; 16])| {
        // numpy's rows are the matrix's rows.
        Transform::from_matrix(DMat4::from_cols_array(numbers).transpose()).ok_or_else(|| {
            PyValueError::new_err(format!(
                "{name}: matrix {i} is not affine (its last row must be 0 0 0 1), not finite, or has no inverse"
            ))
        })
    };
    matrices.iter().enumerate().map(transform).collect()
}

/// Pixels: a picture's height, width, number of channels, and samples in rows from the top.
///
/// # Errors
/// As [`rows`]; also if the shape is neither (height, width) nor (height, width, channels).
pub(crate) fn pixels(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<([usize; 3], Vec<f32>)> {
    let array = numbers(name, argument)?;
    let shape = match *array.shape() {
        [height, width] => [height, width, 1],
        [height, width, channels @ 1..=4] => [height, width, channels],
        _ => {
            return Err(PyValueError::new_err(format!(
                "{name}: its shape is {}, but must be (height, width) or (height, width, channels), with 1 to 4 \
                 channels",
                shape_of(&array)
            )));
        }
    };
    Ok((shape, floats(&array)?))
}
