//! `bilinearmesh`: bilinear patches with four corners.

use super::super::document::ShapeGeometry;
use super::super::parameters::ParameterList;
use super::maker::{ShapeMaker, corners, needed_points};
use bilux_import::FormatError;
use bilux_math::{Vec2, Vec3};
use bilux_scene::Mesh;

/// Subdivisions per side of a patch that is not flat.
const FINE: u32 = 8;
/// Subdivisions per side if there are very many patches.
const COARSE: u32 = 2;
/// The number of patches from which on `COARSE` applies.
const MANY: usize = 10_000;

pub(super) fn make(
    maker: &mut ShapeMaker,
    list: &ParameterList,
) -> Result<Option<ShapeGeometry>, FormatError> {
    let points = needed_points(list)?;
    let patches = corners::<4>(list, points.len())?;
    let normals = maker.normals_of(list, points.len())?;
    let uvs = maker.uvs_of(list, points.len())?;
    list.has("faceIndices");
    if list.has("emissionfilename") {
        let what = "'emissionfilename' is not used: give the area light a 'filename'";
        maker.loader.note(what, || list.place("emissionfilename"));
    }
    let cuts = if patches.len() > MANY { COARSE } else { FINE };
    let mut mesh = Mesh::default();
    for patch in patches {
        let corner = patch.map(|i| points[i as usize]);
        let cuts = if is_parallelogram(corner) { 1 } else { cuts };
        maker.loader.reading.budget.take::<[f32; 14]>(((cuts + 1) * (cuts + 1)) as usize, &list.at.file)?;
        let of = patch.map(|i| i as usize);
        let uv = if uvs.is_empty() { [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE] } else { of.map(|i| uvs[i]) };
        let normal = (!normals.is_empty()).then(|| of.map(|i| normals[i]));
        add(&mut mesh, corner, uv, normal, cuts);
    }
    maker.finished(mesh, list)
}

/// True if two flat triangles represent the patch exactly, including its texture coordinates.
fn is_parallelogram([p00, p10, p01, p11]: [Vec3; 4]) -> bool {
    let gap = (p11 - p10) - (p01 - p00);
    gap.length() <= 1e-5 * ((p10 - p00).length() + (p01 - p00).length())
}

fn add(mesh: &mut Mesh, corner: [Vec3; 4], uv: [Vec2; 4], normal: Option<[Vec3; 4]>, cuts: u32) {
    fn blend<T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T> + Copy>(
        c: [T; 4],
        u: f32,
        v: f32,
    ) -> T {
        (c[0] * (1.0 - u) + c[1] * u) * (1.0 - v) + (c[2] * (1.0 - u) + c[3] * u) * v
    }
    let first = mesh.positions.len() as u32;
    for (j, i) in (0..=cuts).flat_map(|j| (0..=cuts).map(move |i| (j, i))) {
        let (u, v) = (i as f32 / cuts as f32, j as f32 / cuts as f32);
        mesh.positions.push(blend(corner, u, v));
        mesh.uvs.push(blend(uv, u, v));
        let [p00, p10, p01, p11] = corner;
        let (along, across) =
            ((p10 - p00) * (1.0 - v) + (p11 - p01) * v, (p01 - p00) * (1.0 - u) + (p11 - p10) * u);
        mesh.normals.push(match normal {
            Some(normals) => blend(normals, u, v),
            None => along.cross(across).normalize_or_zero(),
        });
    }
    let at = |i: u32, j: u32| first + j * (cuts + 1) + i;
    for (j, i) in (0..cuts).flat_map(|j| (0..cuts).map(move |i| (j, i))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
}
