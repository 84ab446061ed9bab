//! Single triangles in world space.

use super::Geometry;
use bilux_accel::Primitive;
use bilux_math::Vec3;

impl Geometry {
    /// Along the normal of a triangle's front (corners counter-clockwise) at a time; `None` for other primitives.
    pub(crate) fn front(&self, primitive: Primitive, time: f32) -> Option<Vec3> {
        let is_triangle = primitive != Primitive::NONE && self.is_triangle(primitive);
        is_triangle.then(|| self.front_of(self.object_of_primitive(primitive), primitive, time))?
    }

    /// [`Geometry::front`] for a primitive of an object.
    #[inline]
    pub(crate) fn front_of(&self, object: u32, primitive: Primitive, time: f32) -> Option<Vec3> {
        let normal = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a);
        if let Some(still) = self.still.as_ref().filter(|_| primitive.instance == 0) {
            let n = normal(still.triangles()[primitive.index as usize].map(Vec3::from));
            return Some(n * if self.mirrored[object as usize] { -1.0 } else { 1.0 });
        }
        if !self.is_triangle(primitive) {
            return None;
        }
        let (_, corners, mirrors) = self.in_world(primitive, time);
        Some(normal(corners) * if mirrors { -1.0 } else { 1.0 })
    }

    /// A triangle's index in its mesh, its world-space corners at a time, and whether it is mirrored.
    pub(crate) fn in_world(&self, primitive: Primitive, time: f32) -> (u32, [Vec3; 3], bool) {
        let (object, triangle) = self.locate(primitive);
        let mesh = &*self.objects[object as usize].mesh;
        let (to_world, mirrors) = self.place(object, time);
        let corners = match self.still.as_ref().filter(|_| primitive.instance == 0) {
            Some(still) => still.triangles()[primitive.index as usize].map(Vec3::from),
            None => mesh.triangles[triangle as usize].map(|i| to_world.point(mesh.positions[i as usize])),
        };
        (triangle, corners, mirrors)
    }
}
