//! The surfaces of a scene: static triangles in one tree of the whole scene, moving or instanced ones in trees of their
//! own, points and lines in separate trees, and spheres in a last one.
pub(crate) mod accel_choice;
pub(crate) mod axis;
pub(crate) mod corners;
mod corners_in_world;
pub(crate) mod footprint;
mod moved;
mod object_trees;
pub(crate) mod placed;
pub mod spheres;
mod still;
mod still_triangles;
pub mod strokes;
mod surface_point;
mod trees;

use crate::geometry::accel_choice::AccelChoice;
use crate::geometry::corners::{tangents, transform_with_error, triangle_uvs, uv_pairs, world_corners};
pub use crate::geometry::placed::Placed;
use crate::geometry::spheres::{PlacedSphere, Spheres};
use crate::geometry::strokes::{StrokeWidths, Strokes};
use crate::kept::{Place, Same};
use crate::messages::error::SceneError;
use crate::surface::Surface;
use crate::texture::UvPair;
use bilux_accel::instancing::{Instance, TopLevel, TwoLevel};
use bilux_accel::primitives::PrimitiveTree;
use bilux_accel::{Accelerator, Hit, Primitive, Query, Ray, TriangleMesh};
use bilux_math::motion::Motion;
use bilux_math::{Rgb, Transform, Vec2, Vec3};
pub use object_trees::TreeWork;
use std::borrow::Cow;
use std::sync::Arc;
use still::Still;
pub use surface_point::{PointAndNormals, StillTriangle};
use surface_point::{normal_at, normals_of, point_with_error};
pub(crate) use trees::Trees;

/// All surfaces, and the trees over them.
pub struct Geometry {
    objects: Vec<Placed>,
    /// All static triangles, in world space, in one mesh: the first instance.
    still: Option<Arc<TriangleMesh>>,
    /// The index in `still` of each static object's first triangle, with the object; ascending.
    still_objects: Vec<(u32, u32)>,
    /// For each triangle of `still`, the index of its object in `still_objects`.
    still_owners: Arc<[u32]>,
    /// The object of each instance; the entry of `still` is unused.
    instance_objects: Vec<u32>,
    instances: Vec<Instance>,
    /// The trees of points and lines, whose instances come after those of triangles, and whether each is in world
    /// space.
    strokes: Vec<(Arc<PrimitiveTree<Strokes>>, bool)>,
    /// Whether each object is mirrored, if it does not move.
    mirrored: Vec<bool>,
    /// Numbered after the objects.
    spheres: Spheres,
}

impl Geometry {
    /// Builds the trees that `trees` does not have yet.
    ///
    /// Static objects are transformed to world space and share one tree, or a few where some were edited since. Moving
    /// or instanced objects keep trees of their own, one per mesh. All spheres share one tree. The points and lines of
    /// each object have one, with the given widths in world space.
    ///
    /// # Errors
    /// When there are too many triangles, or no accelerator has the name.
    pub(crate) fn build(
        objects: Vec<Placed>,
        spheres: Vec<PlacedSphere>,
        widths: StrokeWidths,
        accel: &AccelChoice,
        trees: &mut Trees,
    ) -> Result<Geometry, SceneError> {
        let accel = &trees.only(accel);
        let in_own_tree = |o: &Placed| o.in_own_tree() && !o.mesh.triangles.is_empty();
        let (mut still_objects, mut keys, mut first) = (Vec::new(), Vec::new(), 0u32);
        for (i, object) in objects.iter().enumerate().filter(|(_, o)| !o.in_own_tree()) {
            still_objects.push((first, i as u32));
            first = first.wrapping_add(object.mesh.triangles.len() as u32);
            keys.extend(Place::of(&object.motion).map(|place| (Same(object.mesh.clone()), place)));
        }
        let still = Still::build(keys, trees.still.take(), &mut trees.of_objects, accel)?;
        trees.still.clone_from(&still);
        let (mut instances, mut instance_objects) = (Vec::new(), Vec::new());
        if let Some(still) = &still {
            instances.push(Instance::new(still.tree.clone(), Motion::REST));
            instance_objects.push(u32::MAX);
        }
        for (i, object) in objects.iter().enumerate().filter(|(_, o)| in_own_tree(o)) {
            instances.push(Instance::new(trees.of_mesh(&object.mesh, accel)?, object.motion.clone()));
            instance_objects.push(i as u32);
        }
        let mut strokes = Vec::new();
        for (object, tree, motion, is_baked) in trees.of_all_strokes(&objects, widths) {
            instances.push(Instance::new(tree.clone(), motion));
            instance_objects.push(object);
            strokes.push((tree, is_baked));
        }
        let mirrored =
            objects.iter().map(|o| o.motion.static_transform().is_some_and(Transform::mirrors)).collect();
        let spheres = trees.of_spheres(spheres, objects.len() as u32, instances.len() as u32);
        instances.extend(spheres.tree());
        let (still, still_owners) = match still {
            Some(still) => (Some(still.mesh), still.owners),
            None => (None, Arc::from([])),
        };
        Ok(Geometry {
            objects,
            still,
            still_objects,
            still_owners,
            instance_objects,
            instances,
            strokes,
            mirrored,
            spheres,
        })
    }

    /// The top level for a shutter interval: cheap, since all trees are shared.
    pub fn top_level(&self, accel: &AccelChoice, shutter: [f32; 2]) -> TwoLevel {
        let top = if accel.name.starts_with("brute") { TopLevel::List } else { TopLevel::Bvh };
        TwoLevel::new(&self.instances, shutter, top)
    }

    /// The closest hit in the only tree of triangles, which is in world space, and the spheres.
    ///
    /// The result equals that of the top level, but it is faster.
    #[inline]
    pub(crate) fn closest_hit(&self, triangles: &dyn Accelerator, ray: &Ray, query: &Query) -> Option<Hit> {
        if self.spheres.all().is_empty() {
            return triangles.closest_hit(ray, query);
        }
        let hit = triangles.closest_hit(&Spheres::aside(ray), query);
        let t_max = hit.map_or(ray.t_max, |hit| hit.t);
        // The triangle wins a tie.
        self.spheres
            .closest_hit(ray, t_max, query)
            .filter(|sphere| hit.is_none_or(|hit| sphere.t < hit.t))
            .or(hit)
    }

    /// Whether the ray hits any of them.
    #[inline]
    pub(crate) fn any_hit(&self, triangles: &dyn Accelerator, ray: &Ray, query: &Query) -> bool {
        if self.spheres.all().is_empty() {
            return triangles.any_hit(ray, query);
        }
        triangles.any_hit(&Spheres::aside(ray), query) || self.spheres.any_hit(ray, query)
    }

    /// The objects.
    pub fn objects(&self) -> &[Placed] {
        &self.objects
    }

    /// The spheres, which come after the objects.
    pub fn spheres(&self) -> &[PlacedSphere] {
        self.spheres.all()
    }

    /// The index of an object's sphere; `None` for an object of triangles.
    #[inline]
    pub fn sphere_of(&self, object: u32) -> Option<u32> {
        object.checked_sub(self.objects.len() as u32)
    }

    /// The primitive of a sphere, as in a [`Hit`].
    pub fn sphere_primitive(&self, sphere: u32) -> Primitive {
        self.spheres.primitive(sphere)
    }

    /// The index of an object's material.
    #[inline]
    pub fn material_of(&self, object: u32) -> u32 {
        match self.objects.get(object as usize) {
            Some(placed) => placed.material,
            None => self.spheres.material(object),
        }
    }

    /// The trees of triangles, each with its transform.
    pub(crate) fn triangle_instances(&self) -> &[Instance] {
        &self.instances[..self.first_strokes()]
    }

    /// The first instance of the trees of points and lines.
    fn first_strokes(&self) -> usize {
        self.instance_objects.len() - self.strokes.len()
    }

    /// True when the scene has points or lines.
    pub(crate) fn has_strokes(&self) -> bool {
        !self.strokes.is_empty()
    }

    /// The points and lines of an instance, and whether they are in world space.
    fn strokes_of(&self, instance: u32) -> Option<(&Strokes, bool)> {
        let (tree, is_baked) = self.strokes.get((instance as usize).checked_sub(self.first_strokes())?)?;
        Some((tree.primitives(), *is_baked))
    }

    /// True for a triangle.
    #[inline]
    pub(crate) fn is_triangle(&self, primitive: Primitive) -> bool {
        (primitive.instance as usize) < self.first_strokes()
    }

    /// The trees, each with its transform.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The first triangle of an object, as in a [`Hit`].
    pub fn first_primitive(&self, object: u32) -> Primitive {
        // Both lists are in the order of the objects.
        if let Ok(i) = self.still_objects.binary_search_by_key(&object, |(_, o)| *o) {
            return Primitive { instance: 0, index: self.still_objects[i].0 };
        }
        let still = usize::from(self.still.is_some());
        let moving = &self.instance_objects[still..self.first_strokes()];
        let instance = moving.binary_search(&object).ok();
        instance.map_or(Primitive::NONE, |i| Primitive { instance: (still + i) as u32, index: 0 })
    }

    /// An object's triangles and its motion to world space.
    ///
    /// The triangles of a static object in the common tree are in world space already.
    pub fn object_triangles(&self, object: u32) -> (Vec<[Vec3; 3]>, Motion) {
        let placed = &self.objects[object as usize];
        let is_still = self.still_objects.binary_search_by_key(&object, |(_, o)| *o).is_ok();
        let own = if is_still { placed.motion.at(0.0) } else { Transform::IDENTITY };
        let motion = if is_still { Motion::REST } else { placed.motion.clone() };
        let triangles = world_corners(&placed.mesh, &own).map(|t| t.map(Vec3::from)).collect();
        (triangles, motion)
    }

    /// The object of a hit.
    pub fn object_of(&self, hit: &Hit) -> u32 {
        self.object_of_primitive(hit.primitive())
    }

    /// The object of a triangle or sphere.
    pub(crate) fn object_of_primitive(&self, primitive: Primitive) -> u32 {
        self.locate(primitive).0
    }

    /// The object and the triangle within its mesh, or the sphere.
    fn locate(&self, Primitive { instance, index }: Primitive) -> (u32, u32) {
        if self.still.is_some() && instance == 0 {
            let (first, object) = self.still_objects[self.still_owners[index as usize] as usize];
            (object, index - first)
        } else if instance == self.spheres.instance() {
            (self.spheres.object(index), index)
        } else {
            (self.instance_objects[instance as usize], index)
        }
    }

    /// The opacity at a hit: that of its material, which `of_material` gives for its index and the texture coordinates
    /// (spheres have none here), times that of the vertices.
    pub(crate) fn opacity_at(&self, hit: &Hit, of_material: impl Fn(u32, UvPair) -> f32) -> f32 {
        let (object, triangle) = self.locate(hit.primitive());
        let material = self.material_of(object);
        if let Some((strokes, _)) = self.strokes_of(hit.instance) {
            let own = of_material(material, strokes.uv(hit.primitive, hit.u).into());
            return strokes.opacity(hit.primitive, hit.u, own);
        }
        let Some(placed) = self.objects.get(object as usize) else {
            return of_material(material, Vec2::ZERO.into());
        };
        let (mesh, weights) = (&*placed.mesh, [1.0 - hit.u - hit.v, hit.u, hit.v]);
        let corners = mesh.triangles[triangle as usize];
        mesh.opacity(
            of_material(material, UvPair::between(uv_pairs(mesh, corners), weights)),
            corners,
            weights,
        )
    }

    /// An object's transform at a time, and whether it mirrors.
    #[inline]
    fn place(&self, object: u32, time: f32) -> (Cow<'_, Transform>, bool) {
        let motion = &self.objects[object as usize].motion;
        match motion.static_transform() {
            Some(to_world) => (Cow::Borrowed(to_world), self.mirrored[object as usize]),
            None => {
                let to_world = motion.at(time);
                (Cow::Owned(to_world), to_world.mirrors())
            }
        }
    }

    /// All that shading needs about a hit, except for the texture footprint.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        if self.is_triangle(hit.primitive()) {
            self.triangle_surface(ray, hit)
        } else {
            self.other_surface(ray, hit)
        }
    }

    #[inline(never)]
    fn other_surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let Some((strokes, is_baked)) = self.strokes_of(hit.instance) else {
            return self.spheres.surface(ray, hit);
        };
        let object = self.instance_objects[hit.instance as usize];
        let to_world = match is_baked {
            true => Cow::Borrowed(&Transform::IDENTITY),
            false => self.place(object, ray.time).0,
        };
        strokes.surface(ray, hit, &to_world, object)
    }

    fn triangle_surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let (object, triangle) = self.locate(hit.primitive());
        let placed = &self.objects[object as usize];
        let mesh = &*placed.mesh;
        let indices = mesh.triangles[triangle as usize].map(|i| i as usize);
        let (to_world, mirrors) = self.place(object, ray.time);
        let to_world = &*to_world;
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let baked = self.still.as_ref().filter(|_| hit.instance == 0);
        let corners = match baked {
            Some(still) => still.triangles()[hit.primitive as usize].map(Vec3::from),
            None => indices.map(|i| mesh.positions[i]),
        };
        let blend = |v: [Vec3; 3]| v[0] * weights[0] + v[1] * weights[1] + v[2] * weights[2];
        let (p, p_error) = {
            let (p, error) = point_with_error(corners, weights);
            if baked.is_some() { (p, error) } else { transform_with_error(to_world, p, error) }
        };
        let in_world = if baked.is_some() { corners } else { corners.map(|v| to_world.point(v)) };
        let normal = normal_at(mesh, mesh.triangles[triangle as usize], weights, to_world);
        let [n_geom, n_shade] = normals_of(in_world, mirrors, normal);
        let between = |[a, b, c]: [Vec2; 3]| a * weights[0] + b * weights[1] + c * weights[2];
        let uv = between(triangle_uvs(mesh, mesh.triangles[triangle as usize]));
        let uv2 = if mesh.uvs2.is_empty() { uv } else { between(indices.map(|i| mesh.uvs2[i])) };
        let (tangent, handedness) = if placed.has_tangents && !mesh.tangents.is_empty() {
            let given = indices.map(|i| mesh.tangents[i]);
            let turn = if mirrors { -1.0 } else { 1.0 };
            (to_world.vector(blend(given.map(|t| t.truncate()))), turn * 1f32.copysign(given[0].w))
        } else if placed.has_tangents {
            tangents(in_world, indices.map(|i| mesh.uvs.get(i).copied()))
                .map(|(along_u, along_v)| (along_u, 1f32.copysign(n_shade.cross(along_u).dot(along_v))))
                .unwrap_or_else(|| (to_world.vector(Vec3::Y).cross(n_shade), 1.0))
        } else {
            (Vec3::ZERO, 1.0)
        };
        let vertex_colour = |colours: &[Rgb]| {
            if colours.is_empty() {
                return None;
            }
            let [a, b, c] = indices.map(|i| colours.get(i).copied());
            Some(a? * weights[0] + b? * weights[1] + c? * weights[2])
        };
        Surface {
            t: hit.t,
            p,
            p_error,
            n_geom,
            n_shade,
            n_smooth: n_shade,
            tangent,
            handedness,
            uv,
            uv2,
            uv_width: [Vec2::ZERO; 2],
            vertex_kd: vertex_colour(&mesh.vertex_kd),
            vertex_ks: vertex_colour(&mesh.vertex_ks),
            primitive: hit.primitive(),
            object,
            time: ray.time,
        }
    }
}
