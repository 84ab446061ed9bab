//! Parts of the triangles of the common tree, which do not move. For many hits, read one part of all of them after the
//! other: then reads that miss the caches overlap.

use super::Geometry;
use bilux_accel::Hit;
use bilux_math::Vec3;

impl Geometry {
    /// True for a triangle of the common tree.
    #[inline(always)]
    pub(crate) fn is_still_triangle(&self, hit: &Hit) -> bool {
        hit.instance == 0 && self.still.is_some()
    }

    /// The corners of a triangle in world space.
    #[inline(always)]
    pub fn still_corners(&self, primitive: u32) -> [Vec3; 3] {
        let triangle = self.still.as_ref().map(|still| still.triangles()[primitive as usize]);
        triangle.unwrap_or_default().map(Vec3::from)
    }

    /// Vertices of a triangle in the mesh of its object.
    #[inline(always)]
    pub fn still_vertices(&self, object: u32, primitive: u32) -> [u32; 3] {
        let (first, _) = self.still_objects[self.still_owners[primitive as usize] as usize];
        self.objects[object as usize].mesh.triangles[(primitive - first) as usize]
    }

    /// The normals of an object's vertices in object space; zero where the mesh has none.
    #[inline(always)]
    pub fn still_normals(&self, object: u32, vertices: [u32; 3]) -> [Vec3; 3] {
        let normals = &self.objects[object as usize].mesh.normals;
        vertices.map(|i| normals.get(i as usize).copied().unwrap_or(Vec3::ZERO))
    }

    /// The axes of the inverse of an object's transform, and the orientation of its triangles' fronts: -1 if mirrored,
    /// otherwise 1.
    #[inline(always)]
    pub fn still_place(&self, object: u32) -> ([Vec3; 3], f32) {
        let turn = if self.mirrored[object as usize] { -1.0 } else { 1.0 };
        let Some(transform) = self.objects[object as usize].motion.static_transform() else {
            return (Vec3::AXES, turn);
        };
        let inverse = transform.inverse_matrix();
        ([inverse.x_axis, inverse.y_axis, inverse.z_axis].map(|axis| axis.truncate()), turn)
    }
}
