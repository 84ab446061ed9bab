//! Arrays that all threads fill, and that are then Python's.

use numpy::{Element, PyArrayMethods, PyReadwriteArrayDyn};
use pyo3::prelude::*;

/// An array whose numbers are yet to be written.
///
/// The memory is numpy's, which is in large pages where the system has them. In small pages, the first write to each takes
/// longer than tracing coherent rays does.
pub(crate) struct Output<'py, T: Element>(PyReadwriteArrayDyn<'py, T>);

impl<'py, T: Element> Output<'py, T> {
    /// An array (n,).
    pub(crate) fn column(py: Python<'py>, count: usize) -> PyResult<Output<'py, T>> {
        Output::new(py, vec![count])
    }

    /// An array (n, 3).
    pub(crate) fn rows(py: Python<'py>, count: usize) -> PyResult<Output<'py, T>> {
        Output::new(py, vec![count, 3])
    }

    fn new(py: Python<'py>, shape: Vec<usize>) -> PyResult<Output<'py, T>> {
        let array = py.import("numpy")?.call_method1("empty", (shape, T::get_dtype(py)))?;
        Ok(Output(array.cast_into::<numpy::PyArrayDyn<T>>()?.readwrite()))
    }

    /// Numbers of the array, row by row.
    pub(crate) fn numbers(&mut self) -> &mut [T] {
        self.0.as_slice_mut().unwrap_or_default()
    }

    /// Rows of three numbers.
    pub(crate) fn triples(&mut self) -> &mut [[T; 3]] {
        self.numbers().as_chunks_mut().0
    }

    pub(crate) fn into_python(self) -> Bound<'py, PyAny> {
        self.0.as_any().clone()
    }
}
