//! Media for tests.

use bilux_math::hash::{mix64, unit_f32};
use bilux_math::{Aabb, Transform, Vec3};
use bilux_scene::media::Grid;
use bilux_scene::mesh::shapes::cuboid;
use bilux_scene::{Mesh, Spec, Value};
use std::sync::Arc;

/// A grid that fills a box.
pub fn grid_in(min: Vec3, max: Vec3, size: [usize; 3], of: impl Fn([usize; 3]) -> f32) -> Arc<Grid> {
    let voxel = (max - min) / Vec3::from(size.map(|n| n as f32));
    let place = Transform::scale(voxel).unwrap().then(&Transform::translate(min).unwrap());
    let [nx, ny, nz] = size;
    let values: Vec<f32> = (0..nx * ny * nz).map(|i| of([i % nx, i / nx % ny, i / (nx * ny)])).collect();
    Arc::new(Grid::dense("smoke", size, &place, &values).unwrap())
}

pub fn smoke(absorption: impl Into<Value>, scattering: impl Into<Value>, grid: Arc<Grid>) -> Spec {
    let spec = Spec::new("", "interface").with("absorption", absorption).with("scattering", scattering);
    spec.with("density", grid)
}

pub fn boxed(min: Vec3, max: Vec3) -> Arc<Mesh> {
    Arc::new(cuboid(Aabb { min, max }))
}

/// A number from 0 to 1 for each voxel.
pub fn any([x, y, z]: [usize; 3]) -> f32 {
    unit_f32((mix64((z * 1000 + y) as u64 * 1000 + x as u64) >> 32) as u32)
}
