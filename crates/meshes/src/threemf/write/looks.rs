//! Materials: base materials with the colours that displays show, colours of corners, and textures.

use super::meshes::Welded;
use super::model::{Look, Model, Properties};
use bilux_import::FormatError;
use bilux_import::bytes::xml::escaped;
use bilux_import::geometry::colours::encoded;
use bilux_import::output::values::{MaterialSupport, colour, nearest_principled, number, texture};
use bilux_import::output::writing::Writing;
use bilux_math::{Rgb, Vec2};
use bilux_scene::texture::{Filter, Wrap};
use bilux_scene::{Mesh, Spec, Texture};
use std::collections::HashMap;
use std::fmt::Write;

const HOLDS: MaterialSupport = MaterialSupport {
    format: "3MF",
    of_kinds: &[("principled", &["base_color"])],
    of_any: &["opacity"],
    textured: Some(&["base_color"]),
};

impl Model<'_> {
    /// Look of a mesh by its material, which is written on first use.
    pub(super) fn look(&mut self, material: usize, writing: &mut Writing) -> Result<Look, FormatError> {
        if let Some(known) = self.looks.get(&material) {
            return Ok(known.clone());
        }
        let original =
            self.scene.materials.get(material).cloned().unwrap_or_else(|| Spec::new("", "diffuse"));
        // Metal, gloss and the like are not what is printed, and colours of metal are those of its reflections.
        let spec = match is_plain(&original) {
            true => Spec::new("", "principled").with("base_color", original.value_or("kd", 0.7f32)),
            false => nearest_principled(&original, self.scene, "3MF", writing),
        };
        HOLDS.warn_unsupported(&spec, writing);
        let shade = colour(&spec, "base_color").unwrap_or(Rgb::grey(0.8));
        let opacity = number(&spec, "opacity").unwrap_or(1.0);
        let name = escaped(if original.name.is_empty() { "material" } else { &original.name });
        let group = self.id();
        let _ = writeln!(
            self.resources,
            "    <basematerials id=\"{group}\"><base name=\"{name}\" displaycolor=\"{}\"/></basematerials>",
            hex(shade, opacity)
        );
        let picture = match texture(&spec, "base_color").and_then(|i| self.scene.textures.get(i)).cloned() {
            Some(picture) => Some((picture.clone(), self.picture(&picture, writing)?)),
            None => None,
        };
        let look = Look { group, colour: shade, picture };
        self.looks.insert(material, look.clone());
        Ok(look)
    }

    fn picture(&mut self, texture: &Texture, writing: &mut Writing) -> Result<usize, FormatError> {
        let capped = texture.texels().any(bilux_import::input::images::is_bright);
        if capped {
            writing.warn("texels brighter than white are written as white");
        }
        let clamped = || texture.texels().map(|texel| texel.clamp(0.0, 1.0)).collect();
        let held = match capped {
            true => {
                Texture::new(&texture.name, texture.width(), texture.height(), clamped(), texture.is_data)
            }
            false => texture.clone(),
        };
        let file = writing.texture_file(&held)?;
        let id = self.id();
        let [u, v] = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => "wrap",
            Wrap::Mirror => "mirror",
            Wrap::Clamp => "clamp",
        });
        if texture.filter == Filter::Nearest {
            writing.warn(
                "3MF files written here do not state that the nearest texel counts: texels are blended",
            );
        }
        let _ = writeln!(
            self.resources,
            "    <m:texture2d id=\"{id}\" path=\"/3D/Textures/{}\" contenttype=\"image/png\" tilestyleu=\"{u}\" \
             tilestylev=\"{v}\"/>",
            escaped(&file)
        );
        Ok(id)
    }

    /// Textures or colours of the corners of a mesh, if it has any.
    pub(super) fn properties(
        &mut self,
        mesh: &Mesh,
        welded: &Welded,
        look: &Look,
        writing: &mut Writing,
    ) -> Option<Properties> {
        if let Some((picture, id)) = &look.picture {
            if !mesh.vertex_kd.is_empty() {
                writing.warn("3MF files cannot store colours of vertices on top of a texture: left out");
            }
            let uvs = if picture.second_uv { &mesh.uvs2 } else { &mesh.uvs };
            if uvs.is_empty() {
                return None;
            }
            return Some(self.coordinates(picture, *id, uvs, welded));
        }
        if mesh.vertex_kd.is_empty() {
            return None;
        }
        let group = self.id();
        let (mut known, mut list) = (HashMap::new(), String::new());
        let mut of = |i: u32| {
            let shade = hex(mesh.vertex_kd[i as usize] * look.colour, 1.0);
            let next = known.len();
            *known.entry(shade.clone()).or_insert_with(|| {
                let _ = write!(list, "<m:color color=\"{shade}\"/>");
                next
            })
        };
        let corners = welded.triangles.iter().map(|(_, corners)| corners.map(&mut of)).collect();
        let _ = writeln!(self.resources, "    <m:colorgroup id=\"{group}\">{list}</m:colorgroup>");
        Some((group, corners))
    }

    fn coordinates(&mut self, picture: &Texture, id: usize, uvs: &[Vec2], welded: &Welded) -> Properties {
        let group = self.id();
        let (mut known, mut list) = (HashMap::new(), String::new());
        let mut of = |i: u32| {
            let uv = placed(picture, uvs[i as usize]);
            let next = known.len();
            *known.entry(uv.to_array().map(f32::to_bits)).or_insert_with(|| {
                let _ = write!(list, "<m:tex2coord u=\"{}\" v=\"{}\"/>", uv.x, uv.y);
                next
            })
        };
        let corners = welded.triangles.iter().map(|(_, corners)| corners.map(&mut of)).collect();
        let _ = writeln!(
            self.resources,
            "    <m:texture2dgroup id=\"{group}\" texid=\"{id}\">{list}</m:texture2dgroup>"
        );
        (group, corners)
    }
}

/// True for the material of files without materials.
fn is_plain(spec: &Spec) -> bool {
    spec.kind == "phong" && spec.parameters.0.iter().all(|(key, ..)| key == "kd")
}

/// Coordinates in a picture, with v upwards; those that are not finite are the middle.
fn placed(picture: &Texture, uv: Vec2) -> Vec2 {
    let down = Vec2::new(uv.x, 1.0 - uv.y);
    let down = picture.transform.map_or(down, |transform| transform.apply(down));
    let up = Vec2::new(down.x, 1.0 - down.y);
    if up.is_finite() { up } else { Vec2::splat(0.5) }
}

/// `#RRGGBBAA` in sRGB.
fn hex(colour: Rgb, alpha: f32) -> String {
    let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    let [r, g, b] = encoded(colour).map(byte);
    format!("#{r:02X}{g:02X}{b:02X}{:02X}", byte(alpha))
}
