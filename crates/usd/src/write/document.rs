//! A layer under construction.

use super::names::Names;
use super::text::Text;
use bilux_import::world::frame::metres;
use bilux_scene::texture::Image;
use bilux_scene::{Mesh, SceneBuilder};
use std::collections::HashMap;
use std::sync::Arc;

/// The prim that holds all others, and the scope of its materials.
pub(super) const ROOT: &str = "Root";
pub(super) const MATERIALS: &str = "Materials";
/// The classes of what occurs several times.
pub(super) const PROTOTYPES: &str = "Prototypes";

/// Time codes of a second.
pub(super) const RATE: f64 = 24.0;

/// The layer so far, in the order of its parts.
pub(super) struct Document<'s> {
    pub(super) scene: &'s SceneBuilder,
    pub(super) materials: Text,
    pub(super) prims: Text,
    pub(super) prototypes: Text,
    /// The names of prims in these three.
    pub(super) material_names: Names,
    pub(super) names: Names,
    pub(super) prototype_names: Names,
    /// Materials that are written, by their index and whether vertices have their colours.
    pub(super) looks: HashMap<(usize, bool), Look>,
    /// Classes by mesh and material.
    pub(super) classes: HashMap<(*const Mesh, usize), String>,
    /// The files of images, by whether their texels are numbers, and by the factor of those that are written as luminances.
    pub(super) images: Vec<(Arc<Image>, bool, Option<bilux_math::Rgb>, String)>,
    /// The last time code of any motion.
    pub(super) end: f64,
}

/// Properties that a surface has from its material.
#[derive(Clone, Debug, Default)]
pub(super) struct Look {
    /// The material's path; empty where colours alone say all.
    pub(super) path: String,
    /// Written with meshes that are not bound to a material.
    pub(super) colour: Option<bilux_math::Rgb>,
    pub(super) opacity: Option<f32>,
    /// The factor on the colours of vertices.
    pub(super) factor: bilux_math::Rgb,
    /// Both sides are seen.
    pub(super) has_two_sides: bool,
}

impl<'s> Document<'s> {
    pub(super) fn new(scene: &'s SceneBuilder) -> Document<'s> {
        let mut names = Names::default();
        names.unused(MATERIALS, "");
        Document {
            scene,
            materials: Text::at_depth(2),
            prims: Text::at_depth(1),
            prototypes: Text::at_depth(1),
            material_names: Names::default(),
            names,
            prototype_names: Names::default(),
            looks: HashMap::new(),
            classes: HashMap::new(),
            images: Vec::new(),
            end: 0.0,
        }
    }

    /// The whole layer.
    pub(super) fn finish(self) -> Vec<u8> {
        let is_z = matches!(self.scene.up, bilux_scene::UpHint::Is(bilux_scene::Axis::Z));
        let unit = metres(self.scene);
        let mut layer = Text { out: b"#usda 1.0\n".to_vec(), ..Text::at_depth(0) };
        layer.line("(");
        layer.line("    customLayerData = {");
        layer.line("        string creator = \"Bilux\"");
        layer.line("    }");
        layer.line(&format!("    defaultPrim = \"{ROOT}\""));
        if self.end > 0.0 {
            layer.line(&format!("    endTimeCode = {}", self.end));
        }
        layer.line(&format!("    metersPerUnit = {unit}"));
        if self.end > 0.0 {
            layer.line("    startTimeCode = 0");
            layer.line(&format!("    timeCodesPerSecond = {RATE}"));
        }
        layer.line(&format!("    upAxis = \"{}\"", if is_z { 'Z' } else { 'Y' }));
        layer.line(")\n");
        layer.open(&format!("def Xform \"{ROOT}\""), &[]);
        if !self.materials.out.is_empty() {
            layer.open(&format!("def Scope \"{MATERIALS}\""), &[]);
            layer.out.extend(self.materials.out);
            layer.close();
        }
        layer.out.extend(self.prims.out);
        layer.close();
        if !self.prototypes.out.is_empty() {
            layer.open(&format!("class \"{PROTOTYPES}\""), &[]);
            layer.out.extend(self.prototypes.out);
            layer.close();
        }
        layer.out
    }
}
