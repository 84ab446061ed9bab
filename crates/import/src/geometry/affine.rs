//! Transforms of normals by affine maps.

use bilux_math::{DMat3, DMat4};

/// The matrix for normals: the inverse transpose up to a positive factor, and finite if the inverse is not.
pub fn cofactors(m: &DMat4) -> DMat3 {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.truncate());
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    DMat3::from_cols(y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign)
}
