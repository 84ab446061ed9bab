//! Which material each surface has, made once for all surfaces that have it.

use crate::geometry::primvars::{Interpolation, Place, Primvar};
use crate::scene::Scene;
use crate::shading::{self, Shaded};
use crate::stage::Stage;
use crate::stage::context::{Context, Worn};
use bilux_import::FormatError;
use bilux_import::geometry::displacement::Moved;
use bilux_import::input::reading::plain_material;
use bilux_math::Rgb;
use bilux_scene::Spec;

/// Memory of a material with a colour.
const PLAIN_BYTES: u64 = 2 * size_of::<Spec>() as u64 + 256;

impl Scene<'_, '_> {
    /// Material that a surface wears: the one that it is bound to, or else its own colour.
    pub(crate) fn worn(&mut self, stage: &Stage, prim: u32) -> Result<Worn, FormatError> {
        let Some(material) = shading::bound(stage, prim, &self.lineage) else {
            return self.plain(stage, prim);
        };
        if let Some(known) = self.materials.get(&material) {
            let known = known.clone();
            return self.of_material(stage, prim, known);
        }
        // Copies of a material have the same opinions.
        let said = self.said_below(stage, material);
        if let Some(known) = self.alike.get(&said).cloned() {
            self.materials.insert(material, known.clone());
            return self.of_material(stage, prim, known);
        }
        let Context { reading, sink, .. } = &mut self.context;
        let shaded = shading::material(stage, material, reading, sink)?;
        let worn = shaded.map(|shaded| {
            let Shaded {
                spec,
                uvs,
                uses_colours,
                uses_opacities,
                without_colours,
                has_direction,
                displacement,
            } = shaded;
            let without_colours = without_colours.map(|colour| colour.to_array().map(f32::to_bits));
            let index = sink.scene.add_material(spec);
            reading.displacements.extend(displacement.map(|map| (Moved::Material(index), map)));
            Worn { index, uvs, uses_colours, uses_opacities, without_colours, has_direction }
        });
        self.materials.insert(material, worn.clone());
        self.alike.insert(said, worn.clone());
        self.of_material(stage, prim, worn)
    }

    /// Material of a surface that is bound to `worn`; for `None`, which says nothing that is read, the surface's own colour. A
    /// material that uses the colours of vertices, where there are none, has the colour that it states for that.
    fn of_material(&mut self, stage: &Stage, prim: u32, worn: Option<Worn>) -> Result<Worn, FormatError> {
        let Some(worn) = worn else { return self.plain(stage, prim) };
        let Some(bits) = worn.without_colours.filter(|_| worn.uses_colours) else { return Ok(worn) };
        let colour = Rgb::from_array(bits.map(f32::from_bits));
        if self.shown(stage, prim)?[0].is_some() {
            return Ok(worn);
        }
        let index = match self.uncoloured.get(&worn.index) {
            Some(&known) => known,
            None => {
                self.context.reading.budget.take_bytes(PLAIN_BYTES, &stage.layers[0].name)?;
                let scene = &mut self.context.sink.scene;
                let mut spec = scene.materials[worn.index].clone();
                spec.parameters.set("base_color", colour.clamp(0.0, 1.0));
                let index = scene.add_material(spec);
                self.uncoloured.insert(worn.index, index);
                index
            }
        };
        Ok(Worn { index, uses_colours: false, ..worn })
    }

    /// `displayColor` and `displayOpacity` of a prim. Of those of the prims above it, only what is the same everywhere counts.
    pub(crate) fn shown(&mut self, stage: &Stage, prim: u32) -> Result<[Option<Primvar>; 2], FormatError> {
        let budget = &mut self.context.reading.budget;
        let lineage = std::iter::once(&prim).chain(self.lineage.iter().rev());
        let constant = Interpolation::Constant;
        let mut found = [None, None];
        for (number, slot) in found.iter_mut().enumerate() {
            let name = ["primvars:displayColor", "primvars:displayOpacity"][number];
            for &at in lineage.clone() {
                // Copies of an instancer have their own.
                let look = self.looks.iter().find(|(instancer, _)| *instancer == at);
                if let Some(own) = look.and_then(|(_, look)| look[number].clone()) {
                    *slot = Some(own);
                    break;
                }
                let primvar = Primvar::read(stage, at, name, constant, budget)?;
                *slot = primvar.filter(|p| at == prim || p.interpolation == constant);
                if slot.is_some() {
                    break;
                }
            }
        }
        Ok(found)
    }

    /// All opinions about a prim and those below it.
    fn said_below(&self, stage: &Stage, prim: u32) -> Vec<[u32; 2]> {
        let (mut all, mut waiting) = (Vec::new(), vec![prim]);
        while let Some(prim) = waiting.pop() {
            all.extend(stage.prim(prim).opinions.iter().map(|o| [o.layer, o.prim]));
            all.extend(stage.prim(prim).clips.iter().map(|clipped| [u32::MAX, clipped.set.number]));
            waiting.extend(&stage.prim(prim).children);
        }
        all
    }

    /// The material of a surface with nothing but a colour and an opacity.
    fn plain(&mut self, stage: &Stage, prim: u32) -> Result<Worn, FormatError> {
        let constant = Interpolation::Constant;
        let found = self.shown(stage, prim)?;
        let varies =
            |primvar: &Option<Primvar>| primvar.as_ref().is_some_and(|p| p.interpolation != constant);
        let (uses_colours, uses_opacities) = (varies(&found[0]), varies(&found[1]));
        let colour = match &found[0] {
            Some(colour) if !uses_colours => {
                colour.index(Place::ONLY).map(|index| colour.values.floats::<3>(index))
            }
            _ => None,
        };
        let opacity = match &found[1] {
            Some(opacity) if !uses_opacities => {
                let index = opacity.index(Place::ONLY);
                index.map_or(1.0, |index| opacity.values.floats::<1>(index)[0].clamp(0.0, 1.0))
            }
            _ => 1.0,
        };
        let key = (colour.unwrap_or([-1.0; 3]).map(f32::to_bits), opacity.to_bits(), uses_colours);
        if let Some(&index) = self.plain.get(&key) {
            return Ok(Worn { index, uses_colours, uses_opacities, ..Worn::default() });
        }
        self.context.reading.budget.take_bytes(PLAIN_BYTES, &stage.layers[0].name)?;
        let mut spec = plain_material(uses_colours, false);
        if let Some(colour) = colour {
            "displayColor".clone_into(&mut spec.name);
            spec.parameters.set("kd", Rgb::from_array(colour).clamp(0.0, 1.0));
        }
        if opacity < 1.0 {
            spec.parameters.set("opacity", opacity);
        }
        let index = self.context.sink.scene.add_material(spec);
        self.plain.insert(key, index);
        Ok(Worn { index, uses_colours, uses_opacities, ..Worn::default() })
    }
}
