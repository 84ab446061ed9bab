//! Converts the prims of a stage to a scene.

pub(crate) mod cameras;
pub(crate) mod copies;
pub(crate) mod instancer;
pub(crate) mod labels;
pub(crate) mod volumes;
pub(crate) mod wearing;

use crate::geometry::meshes::{
    Part, Piece, Subset, add_normals, name_of, note_subdivision, pieces, points, polygons,
};
use crate::geometry::primvars::{Place, Primvar};
use crate::geometry::refined;
use crate::geometry::shapes;
use crate::geometry::strokes;
use crate::geometry::subdivision::Subdivision;
use crate::layers::value::Text;
use crate::lights;
use crate::shading;
use crate::skeletons::{Bent, Binding, Pose, Rig};
use crate::stage::Stage;
use crate::stage::context::{Context, Worn};
use crate::stage::transforms;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_import::{FormatError, geometry::flat};
use bilux_math::{DMat4, Rgb};
use bilux_scene::Object;
use std::collections::HashMap;
use std::sync::Arc;

/// State that a prim has from those above it.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) world: DMat4,
    pub(crate) is_visible: bool,
    pub(crate) purpose: Option<Text>,
    pub(crate) category: Text,
    pub(crate) binding: Option<Binding>,
}

/// Key of a mesh, which says all of it: the same opinions make the same mesh, for materials that need the same of it.
type Key = (Vec<[u64; 4]>, Vec<Worn>, Vec<[u64; 4]>);

/// Key of a volume, which says all of it.
pub(crate) type VolumeKey = (Vec<[u64; 4]>, Option<u32>, Vec<[u64; 4]>);

/// A scene while prims are added to it.
pub(crate) struct Scene<'r, 'o> {
    pub(crate) context: Context<'r, 'o>,
    meshes: HashMap<Key, Arc<[Piece]>>,
    /// Volumes by what says all of them, with their materials.
    pub(crate) volumes: HashMap<VolumeKey, Option<Part>>,
    /// Of surfaces without a material, by their colours and opacities.
    pub(crate) plain: HashMap<([u32; 3], u32, bool), usize>,
    /// Materials that use the colours of vertices, as they are for meshes that have none.
    pub(crate) uncoloured: HashMap<usize, usize>,
    /// Materials of prims `Material`; `None` for one that says nothing that can be read.
    pub(crate) materials: HashMap<u32, Option<Worn>>,
    /// Materials by all that is said of them.
    pub(crate) alike: HashMap<Vec<[u32; 2]>, Option<Worn>>,
    /// Skeletons.
    poses: HashMap<u32, Arc<Pose>>,
    /// The prims above the current one.
    pub(crate) lineage: Vec<u32>,
    /// Of instancers among these, the colour and the opacity of the copy that is made.
    pub(crate) looks: Vec<(u32, [Option<Primvar>; 2])>,
}

impl<'r, 'o> Scene<'r, 'o> {
    pub(crate) fn new(reading: &'r mut Reading<'o>, sink: Sink) -> Scene<'r, 'o> {
        let (meshes, volumes, plain, uncoloured, materials, alike, poses) = Default::default();
        let context = Context { reading, sink, has_lamps: false };
        let (lineage, looks) = Default::default();
        Scene { context, meshes, volumes, plain, uncoloured, materials, alike, poses, lineage, looks }
    }

    /// Adds all prims, as they are at the time of the stage.
    pub(crate) fn add_all(&mut self, stage: &Stage) -> Result<(), FormatError> {
        let state = State {
            world: DMat4::IDENTITY,
            is_visible: true,
            purpose: None,
            category: Text::default(),
            binding: None,
        };
        self.children(stage, 0, &state)
    }

    fn children(&mut self, stage: &Stage, prim: u32, state: &State) -> Result<(), FormatError> {
        self.lineage.push(prim);
        for &child in &stage.prim(prim).children {
            if stage.prim(child).is_defined {
                self.prim(stage, child, state)?;
            }
        }
        self.lineage.pop();
        Ok(())
    }

    pub(crate) fn prim(&mut self, stage: &Stage, prim: u32, state: &State) -> Result<(), FormatError> {
        let state = self.state(stage, prim, state)?;
        let purpose = state.purpose.as_deref().unwrap_or("default");
        let is_shown = state.is_visible && matches!(purpose, "default" | "render");
        match &*stage.prim(prim).type_name {
            "PointInstancer" => {
                if is_shown {
                    self.copies(stage, prim, &state)?;
                }
                // Prototypes below it are not drawn themselves.
                return Ok(());
            }
            "Mesh" | "Sphere" | "Cube" | "Cone" | "Cylinder" | "Cylinder_1" | "Capsule" | "Capsule_1"
            | "Plane" | "Points" | "BasisCurves" | "NurbsCurves"
                if is_shown =>
            {
                let rig = self.rig(stage, prim, &state)?;
                let parts = self.parts(stage, prim, rig.as_ref())?;
                let world = rig.map_or(state.world, |rig| rig.place(&state.world));
                self.place(stage, prim, &parts, &world, &state.category)?;
            }
            "Volume" if is_shown => {
                let part = self.volume(stage, prim)?;
                self.place(stage, prim, part.as_slice(), &state.world, &state.category)?;
            }
            "Camera" => cameras::add(stage, prim, &state.world, &mut self.context)?,
            kind if lights::is_light(kind) && state.is_visible => {
                lights::add(stage, prim, &state.world, &mut self.context)?;
            }
            "NurbsPatch" | "TetMesh" | "HermiteCurves" if is_shown => {
                let what = format!("prims of type {}", stage.prim(prim).type_name);
                self.context.sink.diagnostics.not_shown(&what, || stage.at(prim));
            }
            _ => {}
        }
        self.children(stage, prim, &state)
    }

    fn state(&mut self, stage: &Stage, prim: u32, above: &State) -> Result<State, FormatError> {
        let budget = &mut self.context.reading.budget;
        let local = transforms::local(stage, prim, budget)?;
        let world = if local.is_reset { local.matrix } else { above.world * local.matrix };
        let hides = stage.text(prim, "visibility", budget)?.as_deref() == Some("invisible");
        let purpose = match &above.purpose {
            // A purpose is that of all below.
            Some(purpose) => Some(purpose.clone()),
            None => stage.text(prim, "purpose", budget)?.filter(|purpose| &**purpose != "default"),
        };
        let category = labels::category(stage, prim, budget)?.unwrap_or_else(|| above.category.clone());
        let binding = Binding::of(stage, prim, &world, above.binding);
        Ok(State { world, is_visible: above.is_visible && !hides, purpose, category, binding })
    }

    /// Rig that deforms a prim.
    fn rig(&mut self, stage: &Stage, prim: u32, state: &State) -> Result<Option<Rig>, FormatError> {
        let Some((binding, skeleton)) = state.binding.and_then(|b| Some((b, b.skeleton?))) else {
            return Ok(None);
        };
        let Context { reading, sink, .. } = &mut self.context;
        let pose = match self.poses.get(&skeleton) {
            Some(pose) => pose.clone(),
            None => {
                let pose = Pose::read(stage, skeleton, &mut reading.budget, &mut sink.diagnostics)?;
                self.poses.entry(skeleton).or_insert(Arc::new(pose)).clone()
            }
        };
        let rig = Rig::of(stage, prim, &binding, &pose, reading, sink)?;
        let can_bend = &*stage.prim(prim).type_name == "Mesh";
        if rig.as_ref().is_some_and(|rig| !can_bend && !rig.is_rigid()) {
            let what = "skins and blend shapes of prims that are not meshes";
            sink.diagnostics.not_shown(what, || stage.at(prim));
            return Ok(None);
        }
        Ok(rig)
    }

    /// The meshes of a prim, with their materials.
    fn parts(&mut self, stage: &Stage, prim: u32, rig: Option<&Rig>) -> Result<Vec<Part>, FormatError> {
        let rest = self.worn(stage, prim)?;
        let is_mesh = &*stage.prim(prim).type_name == "Mesh";
        let subsets = if is_mesh { self.subsets(stage, prim)? } else { Vec::new() };
        let rig = rig.filter(|rig| !rig.is_rigid());
        let mut by_others = rig.map_or(Vec::new(), |rig| rig.said(stage));
        // Copies below other prims may have other colours from these.
        let worn: Vec<Worn> =
            subsets.iter().map(|subset| subset.worn.clone()).chain([rest.clone()]).collect();
        if worn.iter().any(|worn| worn.uses_colours || worn.uses_opacities) {
            let shown = self.shown(stage, prim)?;
            let first = |primvar: &Primvar| primvar.at::<3>(Place::ONLY).map(|x| u64::from(x.to_bits()));
            by_others.extend(shown.iter().flatten().map(first).map(|[r, g, b]| [r, g, b, u64::MAX]));
        }
        let needs = worn.iter().map(|worn| Worn { index: 0, ..worn.clone() }).collect();
        let key = (stage.said(prim).collect(), needs, by_others);
        let part = |piece: &Piece| Part { mesh: piece.mesh.clone(), material: worn[piece.group].index };
        if let Some(known) = self.meshes.get(&key) {
            return Ok(known.iter().map(part).collect());
        }
        let spent = self.context.reading.budget.spent();
        let made: Arc<[Piece]> = match is_mesh {
            true => self.polygon_parts(stage, prim, subsets, &rest, rig)?.into(),
            false => self.other_part(stage, prim, &rest)?.into_iter().collect(),
        };
        // What was read for the meshes is no longer held; they are.
        let now = self.context.reading.budget.spent();
        self.context.reading.budget.release(now.saturating_sub(spent));
        let bytes: u64 = made.iter().map(|piece| piece.mesh.size()).sum();
        self.context.reading.budget.take_bytes(bytes, &stage.layers[0].name)?;
        let parts = made.iter().map(part).collect();
        self.meshes.insert(key, made);
        Ok(parts)
    }

    fn polygon_parts(
        &mut self,
        stage: &Stage,
        prim: u32,
        subsets: Vec<Subset>,
        rest: &Worn,
        rig: Option<&Rig>,
    ) -> Result<Vec<Piece>, FormatError> {
        let Some(array) = stage.array(prim, "points", &mut self.context.reading.budget)? else {
            return Ok(Vec::new());
        };
        self.context.reading.budget.take_bytes(12 * array.len() as u64, &stage.layers[0].name)?;
        let mut vertices = points(&array);
        drop(array);
        let Context { reading, sink, .. } = &mut self.context;
        let bent = match rig {
            Some(rig) => rig.bend(stage, prim, &mut vertices, reading, sink)?,
            None => Bent::default(),
        };
        let Some(mut polygons) = polygons(stage, prim, vertices, &mut self.context)? else {
            return Ok(Vec::new());
        };
        let subdivision = Subdivision::read(stage, prim, &mut self.context.reading.budget)?;
        add_normals(stage, prim, &mut polygons, &subdivision, &mut self.context)?;
        bent.turn(stage, &mut polygons, self.context.reading)?;
        [polygons.colours, polygons.opacities] = self.shown(stage, prim)?;
        let refined =
            refined::pieces(stage, prim, &polygons, &subdivision, &subsets, rest, &mut self.context)?;
        if let Some(pieces) = refined {
            return Ok(pieces);
        }
        note_subdivision(stage, prim, &subdivision, &mut self.context);
        pieces(stage, prim, &mut polygons, subsets, rest, &mut self.context)
    }

    fn other_part(&mut self, stage: &Stage, prim: u32, worn: &Worn) -> Result<Option<Piece>, FormatError> {
        let mut mesh = match &*stage.prim(prim).type_name {
            "Points" => strokes::points(stage, prim, worn, &mut self.context)?,
            "BasisCurves" | "NurbsCurves" => strokes::curves(stage, prim, worn, &mut self.context)?,
            _ => shapes::mesh(stage, prim, &mut self.context.reading.budget)?.unwrap_or_default(),
        };
        if mesh.is_empty() {
            return Ok(None);
        }
        mesh.name = name_of(stage, prim).to_owned();
        if mesh.vertex_kd.is_empty()
            && worn.uses_colours
            && let [Some(colour), _] = self.shown(stage, prim)?
        {
            let bytes = size_of::<Rgb>() * mesh.positions.len();
            self.context.reading.budget.take_bytes(bytes as u64, &stage.layers[0].name)?;
            mesh.vertex_kd = vec![Rgb::from_array(colour.at::<3>(Place::ONLY)); mesh.positions.len()];
        }
        self.context.finish_mesh(&mut mesh, worn)?;
        Ok(Some(Piece { mesh: Arc::new(mesh), group: 0 }))
    }

    /// Adds the parts of a prim.
    fn place(
        &mut self,
        stage: &Stage,
        prim: u32,
        parts: &[Part],
        world: &DMat4,
        category: &Text,
    ) -> Result<(), FormatError> {
        let name = name_of(stage, prim);
        let bytes = (size_of::<[Object; 2]>() + name.len() + category.len()) * parts.len();
        self.context.reading.budget.take_bytes(bytes as u64, &stage.layers[0].name)?;
        for part in parts {
            let budget = &mut self.context.reading.budget;
            let placed = flat::placed(&part.mesh, world, budget, &stage.layers[0].name)?;
            let Some((mesh, motion)) = placed else {
                let what = "a prim is scaled to a line or a point, or its place is not finite: left out";
                self.context.sink.diagnostics.note(what, || stage.at(prim));
                continue;
            };
            let object =
                Object { motion, category: category.to_string(), ..Object::new(name, mesh, part.material) };
            self.context.sink.scene.objects.push(object);
        }
        Ok(())
    }

    /// The faces of a mesh with materials of their own.
    fn subsets(&mut self, stage: &Stage, prim: u32) -> Result<Vec<Subset>, FormatError> {
        let mut subsets = Vec::new();
        self.lineage.push(prim);
        for &child in &stage.prim(prim).children {
            let faces = shading::subset_faces(stage, child, &mut self.context.reading.budget)?;
            if let Some(faces) = faces {
                let worn = self.worn(stage, child)?;
                subsets.push(Subset { faces, worn });
            }
        }
        self.lineage.pop();
        Ok(subsets)
    }
}
