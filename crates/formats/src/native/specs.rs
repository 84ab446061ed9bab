//! Materials, lights and cameras: a kind, and the parameters of its table row.

use super::document::{Item, Table, TomlValue};
use super::include::Part;
use super::pictures::{PICTURE, placed};
use super::plain::{missing, plain_value};
use super::reader::Native;
use bilux_import::FormatError;
use bilux_import::input::reading::Texels;
use bilux_math::glam::DVec4;
use bilux_math::registry::{Entry, ParameterKind};
use bilux_math::{DMat4, Transform};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::media::{DENSITIES, Grid};
use bilux_scene::texture::Channel;
use bilux_scene::{
    CAMERAS, LIGHTS, MATERIALS, Parameters, Reader, SceneError, Spec, TEXTURES, Texture, Value,
};
use std::sync::Arc;

/// The keys that all of them have.
pub(super) const KEYS: [&str; 2] = ["name", "kind"];

impl Native<'_, '_> {
    pub(super) fn material(&mut self, table: &Table, part: &Part) -> Result<Spec, FormatError> {
        let rows: Vec<&Entry> = MATERIALS.iter().map(|row| &row.entry).collect();
        self.spec(table, part, "material", None, &rows, &[])
    }

    /// True if this key of a material refers to another material.
    fn is_material_reference(row: &Entry, key: &str) -> bool {
        row.parameters.iter().any(|p| p.name == key && p.kind == ParameterKind::Material)
    }

    pub(super) fn light(&mut self, table: &Table, part: &Part) -> Result<Spec, FormatError> {
        let rows: Vec<&Entry> = LIGHTS.iter().map(|row| &row.entry).collect();
        self.spec(table, part, "light", None, &rows, &[])
    }

    pub(super) fn camera(&mut self, table: &Table, part: &Part) -> Result<CameraSpec, FormatError> {
        let rows: Vec<&Entry> = CAMERAS.iter().map(|row| &row.entry).collect();
        let spec = self.spec(table, part, "camera", Some("perspective"), &rows, &["keyframes"])?;
        let row = rows.iter().find(|row| row.name == spec.kind);
        let mut keyframes = Vec::new();
        for frame in table.tables("keyframes")? {
            let time =
                frame.find("time").ok_or_else(|| missing("time (of the keyframe, in seconds)", frame))?;
            let time = time.number("time")? as f32;
            let names = row.iter().flat_map(|row| row.parameters).map(|p| p.name);
            frame.check_keys("a camera's keyframe", names.chain(["time"]))?;
            let mut changes = Parameters::default();
            for (key, at, item) in frame.entries.iter().filter(|(key, ..)| key != "time") {
                changes.set_at(key, plain_value(key, item)?, at.clone());
            }
            keyframes.push((time, changes));
        }
        Ok(CameraSpec { spec, keyframes })
    }

    /// Reads a spec that its table row accepts.
    fn spec(
        &mut self,
        table: &Table,
        part: &Part,
        what: &str,
        default_kind: Option<&str>,
        rows: &[&Entry],
        more_keys: &[&str],
    ) -> Result<Spec, FormatError> {
        let kinds = || rows.iter().map(|row| row.name);
        let (kind, at) = match table.find("kind") {
            Some(item) => (item.text("kind")?, &item.at),
            None => {
                let kind = default_kind.ok_or_else(|| missing_kind(what, kinds(), table))?;
                (kind, &table.at)
            }
        };
        let Some(row) = rows.iter().find(|row| row.name == kind) else {
            return Err(SceneError::unknown(what, kind, kinds(), at).into());
        };
        let structural = || KEYS.iter().chain(more_keys).copied();
        let names = row.parameters.iter().map(|p| p.name);
        table.check_keys(&format!("the {what} '{kind}'"), structural().chain(names))?;
        let name = table.text("name")?.unwrap_or_default();
        let mut spec = Spec { span: table.at.clone(), ..Spec::new(name, kind) };
        for (key, at, item) in table.entries.iter().filter(|(key, ..)| !structural().any(|k| k == key)) {
            let value = if Self::is_material_reference(row, key) {
                Some(Value::Material(self.material_named(item)?))
            } else {
                let kind = row.parameters.iter().find(|p| p.name == key).map(|p| p.kind);
                self.value(key, kind, item, part)?
            };
            if let Some(value) = value {
                spec.parameters.set_at(key, value, at.clone());
            }
        }
        Reader::new(&spec, row)?;
        Ok(spec)
    }

    /// The value of a parameter; `None` for a missing texture, so that the default applies.
    pub(super) fn value(
        &mut self,
        key: &str,
        kind: Option<ParameterKind>,
        item: &Item,
        part: &Part,
    ) -> Result<Option<Value>, FormatError> {
        if kind == Some(ParameterKind::Distribution) {
            let file = item.text(key)?;
            let distribution = self.reading.distribution(part.folder.as_deref(), file, &item.at)?;
            return Ok(Some(Value::Distribution(distribution)));
        }
        let TomlValue::Table(table) = &item.node else {
            check_texture(key, kind, item)?;
            return plain_value(key, item).map(Some);
        };
        if kind == Some(ParameterKind::Grid) {
            return self.grid(key, table, part).map(|grid| Some(Value::Grid(grid)));
        }
        let Some(texture) = self.texture(key, kind, Texels::Colours, table, part)? else { return Ok(None) };
        self.scene.textures.push(texture);
        Ok(Some(Value::Texture(self.scene.textures.len() - 1)))
    }

    /// Reads a grid of a file, or computes one.
    fn grid(&mut self, key: &str, table: &Table, part: &Part) -> Result<Arc<Grid>, FormatError> {
        let grid = match table.find("kind") {
            Some(kind) => self.computed_grid(kind.text("kind")?, table)?,
            None => self.grid_of_file(key, table, part)?,
        };
        let Some(item) = table.find("place") else { return Ok(grid) };
        let place = place(item).ok_or_else(|| item.wrong("place", PLACE))?;
        Ok(Arc::new(Grid::clone(&grid).placed(&place)))
    }

    /// A density that is a formula.
    fn computed_grid(&mut self, kind: &str, table: &Table) -> Result<Arc<Grid>, FormatError> {
        let mut spec = Spec { span: table.at.clone(), ..Spec::new("", kind) };
        for (key, at, item) in table.entries.iter().filter(|(key, ..)| key != "kind" && key != "place") {
            spec.parameters.set_at(key, plain_value(key, item)?, at.clone());
        }
        self.reading.computed_grid(spec, &table.at.file)
    }

    fn grid_of_file(&mut self, key: &str, table: &Table, part: &Part) -> Result<Arc<Grid>, FormatError> {
        table.check_keys(&format!("the grid of '{key}'"), ["grid", "name", "place"].into_iter())?;
        let file = table.find("grid").ok_or_else(|| {
            let kinds: Vec<&str> = DENSITIES.iter().map(|row| row.entry.name).collect();
            missing(&format!("grid (a file), or kind ({}),", kinds.join(", ")), table)
        })?;
        let name = table.text("name")?.unwrap_or_default();
        self.reading.grid(part.folder.as_deref(), (file.text("grid")?, name), &file.at)
    }

    /// Reads a texture for a parameter of this kind. If the kind does not determine colours or numbers, `around`
    /// does.
    pub(super) fn texture(
        &mut self,
        key: &str,
        kind: Option<ParameterKind>,
        around: Texels,
        table: &Table,
        part: &Part,
    ) -> Result<Option<Arc<Texture>>, FormatError> {
        let is_tone = matches!(kind, Some(ParameterKind::ColourTexture { .. }));
        let is_number = matches!(kind, Some(ParameterKind::NumberTexture { .. }));
        let has_channels = is_number || (is_tone && around != Texels::Colours);
        let holds = match kind {
            _ if has_channels => Texels::Numbers(channel(table)?),
            Some(ParameterKind::Texture) => Texels::Numbers(None),
            _ => around,
        };
        if let Some(item) = table.find("kind") {
            return self.formula(item.text("kind")?, holds, table, part).map(Some);
        }
        let keys = ["texture", "layer", "channel"].into_iter().take(if has_channels { 3 } else { 2 });
        let more = PICTURE.parameters.iter().map(|p| p.name);
        table.check_keys(&format!("the texture of '{key}'"), keys.chain(more))?;
        let file = table.find("texture").ok_or_else(|| {
            let kinds: Vec<&str> = TEXTURES.iter().map(|row| row.entry.name).collect();
            missing(&format!("texture (a file), or kind ({}),", kinds.join(", ")), table)
        })?;
        let name = file.text("texture")?;
        let layer = table.find("layer").map(|item| item.text("layer")).transpose()?;
        let is_plain = |key: &str| matches!(key, "texture" | "layer" | "channel");
        match self.reading.texture_of_layer(part.folder.as_deref(), name, layer, holds, &file.at) {
            Ok(texture) if table.entries.iter().all(|(key, ..)| is_plain(key)) => Ok(Some(texture)),
            Ok(texture) => Ok(Some(Arc::new(placed(&texture, table)?))),
            Err(error @ FormatError::TooLarge { .. }) => Err(error),
            Err(error) => {
                // Magenta light would tint the whole scene.
                let (stands_in, texture) = match holds {
                    Texels::Colours if key == "radiance" => (
                        "a texture is replaced by a uniform grey of 0.5".to_owned(),
                        Some(Texture::missing_light(name)),
                    ),
                    Texels::Colours | Texels::Unsaid => (
                        "a texture is replaced by a magenta checker".to_owned(),
                        Some(Texture::missing(name)),
                    ),
                    Texels::Numbers(_) => (format!("a texture is replaced by the default of '{key}'"), None),
                };
                let message = format!("{stands_in}: {}", error.without_place());
                self.scene.warn(message, file.at.clone());
                Ok(texture.map(Arc::new))
            }
        }
    }

    /// A procedural texture with the textures that it contains.
    fn formula(
        &mut self,
        kind: &str,
        holds: Texels,
        table: &Table,
        part: &Part,
    ) -> Result<Arc<Texture>, FormatError> {
        let kinds = TEXTURES.iter().map(|row| row.entry.name);
        let at = table.find("kind").map_or(&table.at, |item| &item.at);
        let Some(row) = TEXTURES.iter().find(|row| row.entry.name == kind) else {
            return Err(SceneError::unknown("texture", kind, kinds, at).into());
        };
        let names = row.entry.parameters.iter().map(|p| p.name);
        table.check_keys(&format!("the texture '{kind}'"), names.chain(["kind"]))?;
        let mut spec = Spec { span: table.at.clone(), ..Spec::new("", kind) };
        let mut parts = Vec::new();
        for (key, at, item) in table.entries.iter().filter(|(key, ..)| key != "kind") {
            let value = if let TomlValue::Table(inner) = &item.node {
                let kind = row.entry.parameters.iter().find(|p| p.name == key).map(|p| p.kind);
                let around = if holds == Texels::Colours { holds } else { Texels::Numbers(None) };
                let Some(texture) = self.texture(key, kind, around, inner, part)? else { continue };
                parts.push(texture);
                Value::Texture(parts.len() - 1)
            } else {
                plain_value(key, item)?
            };
            spec.parameters.set_at(key, value, at.clone());
        }
        Ok(Arc::new(Texture::by_formula(spec, parts, holds != Texels::Colours)?))
    }
}

/// Value of a grid's key `place`, in words.
const PLACE: &str =
    "12 numbers: the steps of a voxel along x, y and z in the object, and the corner of the first one";

fn place(item: &Item) -> Option<Transform> {
    let Ok(Value::List(list)) = plain_value("place", item) else { return None };
    let number = |value: &Value| match value {
        Value::Integer(i) => Some(*i as f64),
        Value::Number(x) => Some(*x),
        _ => None,
    };
    let numbers: Vec<f64> = list.iter().map(number).collect::<Option<_>>()?;
    let [x, y, z, w]: [[f64; 3]; 4] =
        numbers.as_chunks().0.try_into().ok().filter(|_| numbers.len() == 12)?;
    let column = |[x, y, z]: [f64; 3], w: f64| DVec4::new(x, y, z, w);
    Transform::from_matrix(DMat4::from_cols(column(x, 0.0), column(y, 0.0), column(z, 0.0), column(w, 1.0)))
}

/// The channels that can provide a number.
pub(super) const CHANNELS: [&str; 4] = ["r", "g", "b", "a"];

/// `channel = "g"`: the channel that provides a number.
fn channel(table: &Table) -> Result<Option<Channel>, FormatError> {
    let Some(item) = table.find("channel") else { return Ok(None) };
    let name = item.text("channel")?;
    match CHANNELS.iter().position(|known| *known == name) {
        Some(index) => Ok(Some([Channel::R, Channel::G, Channel::B, Channel::A][index])),
        None => Err(SceneError::unknown("channel", name, CHANNELS, &item.at).into()),
    }
}

fn missing_kind<'k>(what: &str, kinds: impl Iterator<Item = &'k str>, table: &Table) -> FormatError {
    let kinds: Vec<&str> = kinds.collect();
    missing(&format!("kind (of the {what}: {})", kinds.join(", ")), table)
}

/// Says how a texture is written where a text seems to be the name of one.
fn check_texture(key: &str, kind: Option<ParameterKind>, item: &Item) -> Result<(), FormatError> {
    use ParameterKind::{ColourTexture, NumberTexture, Texture};
    let TomlValue::Text(name) = &item.node else { return Ok(()) };
    let is_file = bilux_import::tables::formats::extension(name.as_ref())
        .is_some_and(|extension| bilux_pictures::format_named(&extension).is_some());
    if is_file && matches!(kind, Some(ColourTexture { .. } | NumberTexture { .. } | Texture)) {
        let message = format!("a texture is written as {key} = {{ texture = {name:?} }}");
        return Err(SceneError::invalid(message, &item.at).into());
    }
    Ok(())
}
