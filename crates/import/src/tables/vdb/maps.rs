//! Maps of OpenVDB grids: from indices to the space of the file.

use crate::FormatError;
use crate::tables::grids::Bytes;
use bilux_math::{DMat4, DVec3};

/// Reads a map by its name.
pub(super) fn read(bytes: &mut Bytes) -> Result<DMat4, FormatError> {
    let name = bytes.text()?;
    let vector = |numbers: &[f64]| DVec3::from_slice(numbers);
    // Voxel sizes, inverses and squares follow scales.
    Ok(match &*name {
        "UniformScaleMap" | "ScaleMap" => DMat4::from_scale(vector(&bytes.f64s::<15>()?)),
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let numbers = bytes.f64s::<18>()?;
            DMat4::from_translation(vector(&numbers)) * DMat4::from_scale(vector(&numbers[3..]))
        }
        "TranslationMap" => DMat4::from_translation(vector(&bytes.f64s::<3>()?)),
        // Matrices of row vectors.
        "AffineMap" | "UnitaryMap" => DMat4::from_cols_array(&bytes.f64s()?),
        "NonlinearFrustumMap" => {
            return Err(bytes.fail(
                "the voxels of the grid are spread over the view of a camera, which cannot be read: resample it to a uniform grid",
            ));
        }
        _ => {
            return Err(bytes.fail(format!(
                "the map '{}' of the grid is not known",
                crate::bytes::text::quoted(name.as_bytes())
            )));
        }
    })
}
