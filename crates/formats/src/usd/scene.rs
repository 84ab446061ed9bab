//! Converts the prims of a stage to a scene.

use super::context::{Context, Worn};
use super::instancer::Copies;
use super::meshes::{Part, Subset, add_normals, name_of, note_subdivision, parts, points, polygons};
use super::primvars::Primvar;
use super::shading;
use super::skeletons::{Bent, Binding, Pose, Rig};
use super::stage::Stage;
use super::subdivision::Subdivision;
use super::transforms;
use super::value::Text;
use super::{cameras, labels, lights, refined, shapes, strokes};
use crate::reading::Reading;
use crate::sink::Sink;
use crate::{FormatError, flat};
use bilux_math::{DMat4, Rgb};
use bilux_scene::Object;
use std::collections::HashMap;
use std::sync::Arc;

/// What a prim has from those above it.
#[derive(Clone, Debug)]
struct State {
    world: DMat4,
    is_visible: bool,
    purpose: Option<Text>,
    category: Text,
    binding: Option<Binding>,
}

/// What says all of a mesh: the same opinions make the same mesh.
type Key = (Vec<[u64; 4]>, Worn, Vec<usize>, Vec<[u64; 4]>);

/// A scene while prims are added to it.
pub(super) struct Scene<'r, 'o> {
    pub(super) context: Context<'r, 'o>,
    pub(super) meshes: HashMap<Key, Arc<[Part]>>,
    /// Of surfaces without a material, by their colours and opacities.
    pub(super) plain: HashMap<([u32; 3], u32, bool), usize>,
    /// What prims `Material` are, if something that can be read.
    pub(super) materials: HashMap<u32, Option<Worn>>,
    /// The same by all that is said of them.
    pub(super) alike: HashMap<Vec<[u32; 2]>, Option<Worn>>,
    /// Skeletons.
    poses: HashMap<u32, Arc<Pose>>,
    /// The prims above the current one.
    pub(super) lineage: Vec<u32>,
}

impl<'r, 'o> Scene<'r, 'o> {
    pub(super) fn new(reading: &'r mut Reading<'o>, sink: Sink) -> Scene<'r, 'o> {
        let (meshes, plain, materials, alike, poses) = Default::default();
        let context = Context { reading, sink };
        Scene { context, meshes, plain, materials, alike, poses, lineage: Vec::new() }
    }

    /// Adds all prims, as they are at the time of the stage.
    pub(super) fn add_all(&mut self, stage: &Stage) -> Result<(), FormatError> {
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

    fn prim(&mut self, stage: &Stage, prim: u32, state: &State) -> Result<(), FormatError> {
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
                let parts = self.volume(stage, prim)?;
                self.place(stage, prim, &parts, &state.world, &state.category)?;
            }
            "Camera" => cameras::add(stage, prim, &state.world, &mut self.context)?,
            kind if lights::is_light(kind) && state.is_visible => {
                lights::add(stage, prim, &state.world, &mut self.context)?;
            }
            "NurbsPatch" | "TetMesh" | "HermiteCurves" if is_shown => {
                let what = format!("prims of type {}", stage.prim(prim).type_name);
                self.context.sink.oddities.not_shown(&what, || stage.at(prim));
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

    /// What deforms a prim.
    fn rig(&mut self, stage: &Stage, prim: u32, state: &State) -> Result<Option<Rig>, FormatError> {
        let Some((binding, skeleton)) = state.binding.and_then(|b| Some((b, b.skeleton?))) else {
            return Ok(None);
        };
        let Context { reading, sink } = &mut self.context;
        let pose = match self.poses.get(&skeleton) {
            Some(pose) => pose.clone(),
            None => {
                let pose = Pose::read(stage, skeleton, &mut reading.budget, &mut sink.oddities)?;
                self.poses.entry(skeleton).or_insert(Arc::new(pose)).clone()
            }
        };
        let rig = Rig::of(stage, prim, &binding, &pose, reading, sink)?;
        let can_bend = &*stage.prim(prim).type_name == "Mesh";
        if rig.as_ref().is_some_and(|rig| !can_bend && !rig.is_rigid()) {
            let what = "skins and blend shapes of prims that are not meshes";
            sink.oddities.not_shown(what, || stage.at(prim));
            return Ok(None);
        }
        Ok(rig)
    }

    /// The meshes of a prim, with their materials.
    fn parts(&mut self, stage: &Stage, prim: u32, rig: Option<&Rig>) -> Result<Arc<[Part]>, FormatError> {
        let rest = self.worn(stage, prim)?;
        let is_mesh = &*stage.prim(prim).type_name == "Mesh";
        let subsets = if is_mesh { self.subsets(stage, prim)? } else { Vec::new() };
        let rig = rig.filter(|rig| !rig.is_rigid());
        let mut by_others = rig.map_or(Vec::new(), |rig| rig.said(stage));
        let of_subsets = subsets.iter().map(|subset| subset.worn.index).collect();
        // Copies below other prims may have other colours from these.
        if rest.uses_colours || rest.uses_opacities || subsets.iter().any(|subset| subset.worn.uses_colours) {
            let shown = self.shown(stage, prim)?;
            let first = |primvar: &Primvar| primvar.values.floats::<3>(0).map(|x| u64::from(x.to_bits()));
            by_others.extend(shown.iter().flatten().map(first).map(|[r, g, b]| [r, g, b, u64::MAX]));
        }
        let key = (stage.said(prim).collect(), rest.clone(), of_subsets, by_others);
        if let Some(known) = self.meshes.get(&key) {
            return Ok(known.clone());
        }
        let spent = self.context.reading.budget.spent();
        let made: Arc<[Part]> = match is_mesh {
            true => self.polygon_parts(stage, prim, subsets, &rest, rig)?.into(),
            false => self.other_part(stage, prim, &rest)?.into_iter().collect(),
        };
        // What was read for the meshes is no longer held; they are.
        let now = self.context.reading.budget.spent();
        self.context.reading.budget.release(now.saturating_sub(spent));
        let bytes: u64 = made.iter().map(|part| part.mesh.size()).sum();
        self.context.reading.budget.take_bytes(bytes, &stage.layers[0].name)?;
        self.meshes.insert(key, made.clone());
        Ok(made)
    }

    fn polygon_parts(
        &mut self,
        stage: &Stage,
        prim: u32,
        subsets: Vec<Subset>,
        rest: &Worn,
        rig: Option<&Rig>,
    ) -> Result<Vec<Part>, FormatError> {
        let Some(array) = stage.array(prim, "points", &mut self.context.reading.budget)? else {
            return Ok(Vec::new());
        };
        self.context.reading.budget.take_bytes(12 * array.len() as u64, &stage.layers[0].name)?;
        let mut vertices = points(&array);
        drop(array);
        let Context { reading, sink } = &mut self.context;
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
            refined::parts(stage, prim, &polygons, &subdivision, &subsets, rest, &mut self.context)?;
        if let Some(parts) = refined {
            return Ok(parts);
        }
        note_subdivision(stage, prim, &subdivision, &mut self.context);
        parts(stage, prim, &mut polygons, subsets, rest, &mut self.context)
    }

    fn other_part(&mut self, stage: &Stage, prim: u32, worn: &Worn) -> Result<Option<Part>, FormatError> {
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
            mesh.vertex_kd = vec![Rgb::from_array(colour.values.floats::<3>(0)); mesh.positions.len()];
        }
        self.context.finish_mesh(&mut mesh, worn)?;
        Ok(Some(Part { mesh: Arc::new(mesh), material: worn.index }))
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
                self.context.sink.oddities.note(what, || stage.at(prim));
                continue;
            };
            let object =
                Object { motion, category: category.to_string(), ..Object::new(name, mesh, part.material) };
            self.context.sink.scene.objects.push(object);
        }
        Ok(())
    }

    /// The copies of a `PointInstancer`.
    fn copies(&mut self, stage: &Stage, prim: u32, state: &State) -> Result<(), FormatError> {
        if self.lineage.contains(&prim) {
            self.context
                .sink
                .oddities
                .note("an instancer is its own prototype: left out there", || stage.at(prim));
            return Ok(());
        }
        let Some(copies) = Copies::read(stage, prim, &mut self.context.reading.budget)? else {
            return Ok(());
        };
        self.lineage.push(prim);
        let mut made: HashMap<u32, Vec<Object>> = HashMap::new();
        for &prototype in &copies.prototypes {
            let objects = std::mem::take(&mut self.context.sink.scene.objects);
            let state = State { world: DMat4::IDENTITY, purpose: None, binding: None, ..state.clone() };
            if prototype != 0 {
                self.prim(stage, prototype, &state)?;
            }
            let own = std::mem::replace(&mut self.context.sink.scene.objects, objects);
            made.insert(prototype, own);
        }
        self.lineage.pop();
        for i in 0..copies.len() {
            let Some((prototype, place)) = copies.copy(i) else { continue };
            let world = state.world * place;
            for object in made.get(&prototype).into_iter().flatten() {
                let whole = world * object.motion.at(0.0).matrix().as_dmat4();
                let bytes = size_of::<[Object; 2]>() + object.name.len() + object.category.len();
                self.context.reading.budget.take_bytes(bytes as u64, &stage.layers[0].name)?;
                let budget = &mut self.context.reading.budget;
                let placed = flat::placed(&object.mesh, &whole, budget, &stage.layers[0].name)?;
                if let Some((mesh, motion)) = placed {
                    self.context.sink.scene.objects.push(Object { mesh, motion, ..object.clone() });
                }
            }
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
