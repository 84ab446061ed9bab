//! Deformation of a prim.

use super::binding::Binding;
use super::blend_shapes;
use super::influences::Influences;
use super::skeleton::Pose;
use crate::geometry::polygons::Polygons;
use crate::geometry::primvars::Place;
use crate::stage::Stage;
use crate::stage::transforms;
use bilux_import::FormatError;
use bilux_import::geometry::deformation::{are_mirrored, move_points, turned};
use bilux_import::geometry::normals::CornerNormals;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_math::{DMat4, Vec3};

/// The skeleton and the blend shapes of a prim.
pub(crate) struct Rig {
    influences: Option<Influences>,
    shapes: Vec<(u32, f64)>,
    /// Placement of the skeleton.
    world: DMat4,
    /// The prims that say all this, except for the prim itself.
    from: Vec<u32>,
}

/// Deformation of the points of a mesh, for what depends on them.
#[derive(Default)]
pub(crate) struct Bent {
    /// By joints, for each point; may be empty.
    matrices: Vec<DMat4>,
    /// Vectors that blend shapes add to the normal of each point; may be empty.
    turns: Vec<Vec3>,
}

impl Rig {
    /// Rig that deforms a prim; `None` if nothing does.
    pub(crate) fn of(
        stage: &Stage,
        prim: u32,
        binding: &Binding,
        pose: &Pose,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Option<Rig>, FormatError> {
        let (budget, diagnostics) = (&mut reading.budget, &mut sink.diagnostics);
        let influences = Influences::read(stage, prim, binding, pose, budget, diagnostics)?;
        let shapes = blend_shapes::used(stage, prim, pose, budget)?;
        if influences.is_none() && shapes.is_empty() {
            return Ok(None);
        }
        let skeleton = binding.skeleton.unwrap_or(binding.root);
        let world = match transforms::below(stage, skeleton, binding.root, budget)? {
            Some(local) => binding.root_world * local,
            None => transforms::below(stage, skeleton, 0, budget)?.unwrap_or(DMat4::IDENTITY),
        };
        let stated = [binding.joints, binding.indices, binding.weights, binding.shape];
        let mut from = pose.from.clone();
        from.extend(stated.into_iter().flatten().filter(|&at| at != prim));
        from.extend(shapes.iter().map(|(shape, _)| *shape));
        Ok(Some(Rig { influences, shapes, world, from }))
    }

    /// All that is said of the shape, besides what is said of the prim.
    pub(crate) fn said(&self, stage: &Stage) -> Vec<[u64; 4]> {
        self.from.iter().flat_map(|&prim| stage.said(prim)).collect()
    }

    /// Placement of the deformed prim, given that without the rig.
    pub(crate) fn place(&self, own: &DMat4) -> DMat4 {
        match &self.influences {
            // All points move alike: the prim does.
            Some(influences) => influences.rigid().map_or(self.world, |rigid| self.world * rigid),
            None => *own,
        }
    }

    /// True if all that happens is that the prim is elsewhere.
    pub(crate) fn is_rigid(&self) -> bool {
        self.shapes.is_empty() && self.influences.as_ref().is_some_and(|all| all.rigid().is_some())
    }

    /// Deforms points.
    pub(crate) fn bend(
        &self,
        stage: &Stage,
        prim: u32,
        points: &mut [Vec3],
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Bent, FormatError> {
        let mut bent = Bent::default();
        let (budget, diagnostics) = (&mut reading.budget, &mut sink.diagnostics);
        for &shape in &self.shapes {
            blend_shapes::add(stage, shape, points, &mut bent.turns, budget, diagnostics)?;
        }
        let Some(influences) = self.influences.as_ref().filter(|all| all.rigid().is_none()) else {
            return Ok(bent);
        };
        budget.take_bytes(influences.bytes(points.len()), &stage.layers[0].name)?;
        match influences.of_points(points.len()) {
            Some(matrices) => {
                move_points(points, &matrices);
                bent.matrices = matrices;
            }
            None => {
                let what = "a skinned mesh has joints for another number of points: it keeps the shape that it was bound in";
                diagnostics.note(what, || stage.at(prim));
            }
        }
        Ok(bent)
    }
}

impl Bent {
    /// Turns the normals of the file with their points, and faces that were mirrored.
    pub(crate) fn turn(
        &self,
        stage: &Stage,
        polygons: &mut Polygons,
        reading: &mut Reading,
    ) -> Result<(), FormatError> {
        polygons.is_left_handed ^= are_mirrored(&self.matrices);
        let Some(normals) = polygons.normals.take_if(|_| !self.matrices.is_empty() || !self.turns.is_empty())
        else {
            return Ok(());
        };
        let corners = polygons.corners.len();
        reading.budget.take_bytes(16 * corners as u64, &stage.layers[0].name)?;
        let mut all = Vec::with_capacity(corners);
        for face in 0..polygons.ends.len() {
            for corner in polygons.face(face) {
                let vertex = polygons.corners[corner] as usize;
                let mut normal = Vec3::from(normals.at::<3>(Place { corner, vertex, face }));
                if let Some(by) = self.turns.get(vertex) {
                    normal = (normal + by).normalize_or_zero();
                }
                all.push(self.matrices.get(vertex).map_or(normal, |by| turned(normal, by)));
            }
        }
        let of_corner = (0..corners as u32).collect();
        polygons.computed = Some(CornerNormals { normals: all, of_corner, position_of: Vec::new() });
        Ok(())
    }
}
