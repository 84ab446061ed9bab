//! Scenes: the lists of what they contain.

use super::code::{Coded, Decoder, Encoder, fields, words};
use super::error::EncodingError;
use super::values::check_references;
use bilux_math::Motion;
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{
    Animation, Axis, Inventory, Mesh, Object, SceneBuilder, StrokeWidths, UpHint, Visibility, Warning,
};
use std::collections::BTreeSet;
use std::sync::Arc;

words! { Visibility [Visibility::Full, Visibility::NoCamera, Visibility::Hidden] }

words! { Axis [Axis::X, Axis::Y, Axis::Z, Axis::NegX, Axis::NegY, Axis::NegZ] }

fields! {
    CameraSpec { spec, keyframes }
    StrokeWidths { points, lines }
    Warning { message, at }
    Animation { name, seconds, plays }
    Inventory { animations, variants, skins }
}

impl Coded for UpHint {
    fn write(&self, to: &mut Encoder) {
        let (is_usual, axis) = match self {
            UpHint::Is(axis) => (false, axis),
            UpHint::Usually(axis) => (true, axis),
        };
        is_usual.write(to);
        axis.write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let is_usual = bool::read(from)?;
        let axis = Axis::read(from)?;
        Ok(if is_usual { UpHint::Usually(axis) } else { UpHint::Is(axis) })
    }
}

impl Coded for Object {
    fn write(&self, to: &mut Encoder) {
        to.name(&self.name);
        self.mesh.write(to);
        self.material.write(to);
        self.motion.write(to);
        if !to.only_what_is_seen {
            self.instanced.write(to);
            self.category.write(to);
        }
        // Full visibility is left out, so that older fingerprints, made before objects had one, still agree.
        if !to.only_what_is_seen || self.visibility != Visibility::Full {
            self.visibility.write(to);
        }
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let name = String::read(from)?;
        let (mesh, material) = (Arc::<Mesh>::read(from)?, usize::read(from)?);
        let motion = Motion::read(from)?;
        let (instanced, category) = (Coded::read(from)?, Coded::read(from)?);
        Ok(Object { name, mesh, material, motion, instanced, category, visibility: Coded::read(from)? })
    }
}

/// The part of a scene that a picture shows.
pub(super) fn write_what_is_seen(scene: &SceneBuilder, to: &mut Encoder) {
    to.only_what_is_seen = true;
    scene.textures.write(to);
    scene.materials.write(to);
    scene.objects.write(to);
    scene.lights.write(to);
    scene.cameras.write(to);
    // Settings may choose a camera by its name.
    scene.cameras.iter().for_each(|camera| camera.spec.name.write(to));
    scene.stroke_widths.write(to);
    scene.has_faint_emitters.write(to);
}

impl Coded for SceneBuilder {
    /// All but the names of the files that it was read from, which another machine does not have, and of what wrote them.
    fn write(&self, to: &mut Encoder) {
        let SceneBuilder { textures, materials, objects, lights, cameras, .. } = self;
        textures.write(to);
        materials.write(to);
        objects.write(to);
        lights.write(to);
        cameras.write(to);
        let SceneBuilder { environment_unspecified, exposure_unspecified, describes_all_light, .. } = self;
        environment_unspecified.write(to);
        exposure_unspecified.write(to);
        describes_all_light.write(to);
        self.has_faint_emitters.write(to);
        let SceneBuilder { up, unit, origin, stroke_widths, .. } = self;
        up.write(to);
        unit.write(to);
        origin.write(to);
        stroke_widths.write(to);
        let SceneBuilder { settings, warnings, notes, inventory, movement, .. } = self;
        settings.write(to);
        warnings.write(to);
        notes.write(to);
        inventory.write(to);
        movement.is_some().write(to);
        movement.iter().for_each(|movement| movement.write(to));
    }

    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let scene = SceneBuilder {
            textures: Coded::read(from)?,
            materials: Coded::read(from)?,
            objects: Coded::read(from)?,
            lights: Coded::read(from)?,
            cameras: Coded::read(from)?,
            environment_unspecified: Coded::read(from)?,
            exposure_unspecified: Coded::read(from)?,
            describes_all_light: Coded::read(from)?,
            has_faint_emitters: Coded::read(from)?,
            up: Coded::read(from)?,
            unit: Coded::read(from)?,
            origin: Coded::read(from)?,
            stroke_widths: Coded::read(from)?,
            settings: Coded::read(from)?,
            warnings: Coded::read(from)?,
            notes: Coded::read(from)?,
            inventory: Coded::read(from)?,
            movement: if bool::read(from)? { Some(Arc::new(from.nested(Coded::read)?)) } else { None },
            written_by: String::new(),
            files: BTreeSet::new(),
        };
        check(&scene).map_err(|what| from.wrong(what))?;
        Ok(scene)
    }
}

/// Checks that whatever the scene refers to exists.
fn check(scene: &SceneBuilder) -> Result<(), String> {
    let (textures, materials) = (scene.textures.len(), scene.materials.len());
    if let Some(object) = scene.objects.iter().find(|object| object.material >= materials) {
        return Err(format!(
            "an object has the material {}, but there are only {materials}",
            object.material
        ));
    }
    let cameras = scene.cameras.iter().map(|camera| &camera.spec);
    let mut specs = scene.materials.iter().chain(&scene.lights).chain(cameras);
    specs.try_for_each(|spec| check_references(spec, textures, materials))
}
