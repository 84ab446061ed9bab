//! The trees of a scene, kept from one build to the next.

use super::object_trees::{ObjectTrees, TreeWork, failed, tree};
use super::still::Still;
use crate::geometry::accel_choice::AccelChoice;
use crate::geometry::placed::Placed;
use crate::geometry::spheres::{PlacedSphere, SphereTree, Spheres};
use crate::geometry::strokes::{StrokeWidths, Strokes, mean_scale};
use crate::kept::{Kept, Place, Same};
use crate::mesh::Mesh;
use crate::messages::error::SceneError;
use bilux_accel::primitives::PrimitiveTree;
use bilux_accel::{Accelerator, BuildOptions, TriangleMesh};
use bilux_math::motion::Motion;
use std::sync::Arc;

/// The trees of the last build, by what they were built over.
#[derive(Clone, Default)]
pub(crate) struct Trees {
    /// The structure that they are, and how it was built.
    accel: Option<(String, BuildOptions)>,
    /// Everything that does not move.
    pub(super) still: Option<Still>,
    /// Meshes in their own space, for instances.
    pub(super) of_meshes: Kept<Same<Mesh>, Arc<dyn Accelerator>>,
    /// Single objects in world space.
    pub(super) of_objects: ObjectTrees,
    /// Points and lines.
    of_strokes: Kept<StrokesKey, Arc<PrimitiveTree<Strokes>>>,
    /// All spheres, each with the bits of its centre and radius.
    spheres: Option<(Vec<[u32; 4]>, SphereTree)>,
}

/// The mesh of points and lines, the place of the object if they are in world space, and the bits of their radii.
type StrokesKey = (Same<Mesh>, Option<Place>, [u32; 2]);

/// An object, its tree of points and lines, the tree's motion, and whether the tree is in world space.
type StrokesPlacement = (u32, Arc<PrimitiveTree<Strokes>>, Motion, bool);

impl Trees {
    /// A build begins.
    pub(crate) fn begin(&mut self) {
        self.of_meshes.begin();
        self.of_objects.kept.begin();
        self.of_strokes.begin();
    }

    /// Drops trees of another structure, and those of less quality than is asked for now: all give the same hits, but
    /// not at the same speed. Returns how to build those that are added.
    pub(super) fn only(&mut self, accel: &AccelChoice) -> AccelChoice {
        let serves = |(name, options): &&(String, BuildOptions)| {
            let as_built = BuildOptions { quality: options.quality, ..accel.options.clone() };
            let is_enough = options.quality as u8 >= accel.options.quality as u8;
            *name == accel.name && *options == as_built && is_enough
        };
        let options = match self.accel.as_ref().filter(serves) {
            Some((_, options)) => options.clone(),
            None => {
                self.still = None;
                self.of_meshes.clear();
                self.of_objects.kept.clear();
                accel.options.clone()
            }
        };
        self.accel = Some((accel.name.clone(), options.clone()));
        AccelChoice { options, ..accel.clone() }
    }

    /// The trees that were built so far.
    pub(crate) fn work(&self) -> TreeWork {
        self.of_objects.work
    }

    /// Forgets all trees.
    pub(crate) fn clear(&mut self) {
        let of_objects = ObjectTrees { work: self.work(), ..ObjectTrees::default() };
        *self = Trees { of_objects, ..Trees::default() };
    }

    /// The number of trees.
    pub(crate) fn len(&self) -> usize {
        let still = usize::from(self.still.is_some()) + self.of_objects.kept.len();
        still + self.of_meshes.len() + self.of_strokes.len() + usize::from(self.spheres.is_some())
    }

    /// The build ends.
    pub(crate) fn end(&mut self, succeeded: bool) {
        self.of_meshes.end(succeeded);
        self.of_objects.kept.end(succeeded);
        self.of_strokes.end(succeeded);
    }

    /// The tree over a mesh in its own space.
    pub(super) fn of_mesh(
        &mut self,
        mesh: &Arc<Mesh>,
        accel: &AccelChoice,
    ) -> Result<Arc<dyn Accelerator>, SceneError> {
        let work = &mut self.of_objects.work;
        self.of_meshes.or_make(Same(mesh.clone()), || {
            let corners =
                crate::geometry::corners::world_corners(mesh, &bilux_math::Transform::IDENTITY).collect();
            let mesh = TriangleMesh::from_corners(corners).map_err(|e| failed(&e))?;
            tree(Arc::new(mesh), accel, work)
        })
    }

    /// The trees of all objects with points or lines: object, tree, its motion, and whether it is in world space.
    pub(super) fn of_all_strokes(
        &mut self,
        objects: &[Placed],
        widths: StrokeWidths,
    ) -> Vec<StrokesPlacement> {
        let mut all = Vec::new();
        for (i, object) in objects.iter().enumerate().filter(|(_, o)| o.mesh.stroke_count() > 0) {
            let place = Place::of(&object.motion).filter(|_| !object.in_own_tree());
            let (is_baked, scale) = match place {
                Some(_) => (true, 1.0),
                None => (false, mean_scale(&object.motion.at(0.0))),
            };
            let radii = Strokes::radii(widths, scale);
            let key =
                (Same(object.mesh.clone()), place.clone(), [radii.points, radii.lines].map(f32::to_bits));
            let work = &mut self.of_objects.work;
            let tree = self.of_strokes.or_make_surely(key, || {
                work.trees += 1;
                Arc::new(Strokes::tree(&object.mesh, place.as_ref().map(Place::transform), radii))
            });
            let motion = if is_baked { Motion::REST } else { object.motion.clone() };
            all.push((i as u32, tree, motion, is_baked));
        }
        all
    }

    /// The spheres with their tree.
    pub(super) fn of_spheres(&mut self, all: Vec<PlacedSphere>, first_object: u32, instance: u32) -> Spheres {
        let bits = |s: &PlacedSphere| [s.centre.x, s.centre.y, s.centre.z, s.radius].map(f32::to_bits);
        let key: Vec<[u32; 4]> = all.iter().map(bits).collect();
        let known = self.spheres.take().filter(|(known, _)| *known == key).map(|(_, tree)| tree);
        self.of_objects.work.trees += u64::from(known.is_none() && !all.is_empty());
        let spheres = Spheres::new(all, known, first_object, instance);
        self.spheres = Some((key, spheres.shared_tree()));
        spheres
    }
}
