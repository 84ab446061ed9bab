//! Writes the native scene file, with its meshes as PLY files and its textures as PNG or EXR files.

use super::pictures::placement_keys;
use super::words::{is_bare, number, quoted};
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::output::bake::name_of;
use bilux_import::output::ply::encode;
use bilux_import::output::writing::{UnusedNames, Writing};
use bilux_import::tables::grids::file_of;
use bilux_import::tables::luminaires;
use bilux_math::{Motion, MotionKey, Rgb};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::media::{ComputedDensity, Grid};
use bilux_scene::{Mesh, Object, Parameters, SceneBuilder, Spec, Texture, Value, Visibility};
use std::collections::HashMap;
use std::sync::Arc;

pub(super) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    let mut out = String::new();
    if !scene.settings.0.is_empty() {
        out.push_str("[render]\n");
        parameters(&scene.settings, scene, writing, &mut out)?;
    }
    for camera in &scene.cameras {
        write_camera(camera, scene, writing, &mut out)?;
    }
    for light in &scene.lights {
        out.push_str("\n[[light]]\n");
        write_spec(light, &light.name, scene, writing, &mut out)?;
    }
    let names = material_names(&scene.materials);
    for (spec, name) in scene.materials.iter().zip(&names) {
        out.push_str("\n[[material]]\n");
        write_spec(spec, name, scene, writing, &mut out)?;
    }
    let mut files = ModelFiles::default();
    for object in &scene.objects {
        write_model(object, &names, &mut files, writing, &mut out)?;
    }
    writing.main = out.trim_start().as_bytes().to_vec();
    Ok(())
}

/// A unique name for each material.
fn material_names(materials: &[Spec]) -> Vec<String> {
    let mut names = UnusedNames::default();
    let name = |spec: &Spec| names.unused(if spec.name.is_empty() { &spec.kind } else { &spec.name });
    materials.iter().map(name).collect()
}

fn write_spec(
    spec: &Spec,
    name: &str,
    scene: &SceneBuilder,
    writing: &mut Writing,
    out: &mut String,
) -> Result<(), FormatError> {
    if !name.is_empty() {
        out.push_str(&format!("name = {}\n", quoted(name)));
    }
    out.push_str(&format!("kind = {}\n", quoted(&spec.kind)));
    parameters(&spec.parameters, scene, writing, out)
}

fn parameters(
    parameters: &Parameters,
    scene: &SceneBuilder,
    writing: &mut Writing,
    out: &mut String,
) -> Result<(), FormatError> {
    for (key, value, _) in &parameters.0 {
        if let Some(value) = value_text(value, scene, writing)? {
            let key = if is_bare(key) { key.clone() } else { quoted(key) };
            out.push_str(&format!("{key} = {value}\n"));
        }
    }
    Ok(())
}

fn write_camera(
    camera: &CameraSpec,
    scene: &SceneBuilder,
    writing: &mut Writing,
    out: &mut String,
) -> Result<(), FormatError> {
    out.push_str("\n[[camera]]\n");
    write_spec(&camera.spec, &camera.spec.name, scene, writing, out)?;
    for (time, changes) in &camera.keyframes {
        out.push_str(&format!("\n[[camera.keyframes]]\ntime = {}\n", number(f64::from(*time))));
        parameters(changes, scene, writing, out)?;
    }
    Ok(())
}

/// The files of models that are written already.
#[derive(Default)]
struct ModelFiles {
    meshes: HashMap<*const Mesh, String>,
    /// Models with a motion, by their content.
    moved: HashMap<String, String>,
}

impl ModelFiles {
    fn of_mesh(&mut self, mesh: &Arc<Mesh>, writing: &mut Writing) -> Result<String, FormatError> {
        if let Some(file) = self.meshes.get(&Arc::as_ptr(mesh)) {
            return Ok(file.clone());
        }
        let Some(bytes) = encode(&[mesh], writing.options.ascii, None) else {
            let message = "a mesh has more vertices than its file can hold";
            return Err(FormatError::malformed(message, whole_file(&writing.stem.as_str().into())));
        };
        let file = writing.add_numbered("mesh", self.meshes.len() + 1, "ply", bytes);
        self.meshes.insert(Arc::as_ptr(mesh), file.clone());
        Ok(file)
    }

    /// A scene file with the model of another file, and its motion.
    fn of_moved(&mut self, file: &str, motion: &Motion, writing: &mut Writing) -> String {
        let mut content = format!("[[model]]\nfile = {}\n", quoted(file));
        write_motion(motion, &mut content);
        let number = self.moved.len() + 1;
        let add =
            |content: &String| writing.add_numbered("moved", number, "toml", content.clone().into_bytes());
        self.moved.entry(content).or_insert_with_key(add).clone()
    }
}

fn write_model(
    object: &Object,
    materials: &[String],
    files: &mut ModelFiles,
    writing: &mut Writing,
    out: &mut String,
) -> Result<(), FormatError> {
    let mut file = files.of_mesh(&object.mesh, writing)?;
    // A model has one motion. What moves within something that moves is a model within a model.
    let (outer, inner) = object.motion.parts().split_last().unwrap_or((&Motion::REST, &[]));
    for motion in inner {
        file = files.of_moved(&file, motion, writing);
    }
    out.push_str(&format!("\n[[model]]\nname = {}\nfile = {}\n", quoted(name_of(object)), quoted(&file)));
    if let Some(name) = materials.get(object.material) {
        out.push_str(&format!("material = {}\n", quoted(name)));
    }
    if object.instanced {
        out.push_str("instance = true\n");
    }
    if !object.category.is_empty() {
        out.push_str(&format!("category = {}\n", quoted(&object.category)));
    }
    if object.visibility != Visibility::Full {
        out.push_str(&format!("visibility = {}\n", quoted(object.visibility.name())));
    }
    write_motion(outer, out);
    Ok(())
}

/// Writes a motion of one part.
fn write_motion(motion: &Motion, out: &mut String) {
    let (transform, keys) = (motion.at(0.0), motion.keys());
    if !keys.is_empty() {
        keys.iter().for_each(|key| write_key(key, out));
    } else if !transform.is_identity() {
        let rows = transform.matrix().transpose().to_cols_array_2d().map(|row| list(&row));
        out.push_str(&format!("matrix = [{}]\n", rows.join(", ")));
    }
}

fn write_key(key: &MotionKey, out: &mut String) {
    out.push_str(&format!(
        "\n[[model.keyframes]]\ntime = {}\ntranslate = {}\nrotate = {{ quaternion = {} }}\nscale = {}\n",
        number(f64::from(key.time_seconds)),
        list(&key.translation.to_array()),
        list(&key.rotation.to_array()),
        list(&key.scale.to_array()),
    ));
}

fn list(numbers: &[f32]) -> String {
    let all: Vec<String> = numbers.iter().map(|&x| number(f64::from(x))).collect();
    format!("[{}]", all.join(", "))
}

/// Returns `None` for a missing texture.
fn value_text(
    value: &Value,
    scene: &SceneBuilder,
    writing: &mut Writing,
) -> Result<Option<String>, FormatError> {
    Ok(Some(match value {
        Value::Bool(b) => b.to_string(),
        Value::Integer(i) => i.to_string(),
        Value::Number(x) => number(*x),
        Value::Text(text) => quoted(text),
        Value::List(items) => {
            let texts = items.iter().map(|item| value_text(item, scene, writing));
            let texts = texts.collect::<Result<Vec<_>, _>>()?;
            format!("[{}]", texts.into_iter().flatten().collect::<Vec<_>>().join(", "))
        }
        Value::Texture(index) => match scene.textures.get(*index) {
            Some(texture) => texture_text(texture, scene, writing)?,
            None => return Ok(None),
        },
        Value::Grid(grid) => return grid_text(grid, scene, writing),
        Value::Distribution(distribution) => quoted(&luminaires::file_of(distribution, writing)),
        Value::Material(index) => match material_names(&scene.materials).get(*index) {
            Some(name) => quoted(name),
            None => return Ok(None),
        },
    }))
}

/// A file, or a formula with its parameters; `None` for a grid that is left out.
fn grid_text(
    grid: &Arc<Grid>,
    scene: &SceneBuilder,
    writing: &mut Writing,
) -> Result<Option<String>, FormatError> {
    let formula = grid.origin().and_then(|origin| origin.of::<Spec>());
    let what = if let Some(formula) = formula {
        let mut out = format!("kind = {}", quoted(&formula.kind));
        for (key, value, _) in &formula.parameters.0 {
            if let Some(value) = value_text(value, scene, writing)? {
                out.push_str(&format!(", {key} = {value}"));
            }
        }
        out
    } else {
        let Some(name) = file_of(grid, writing) else { return Ok(None) };
        format!("grid = {}", quoted(&name))
    };
    let has_its_place = |formula: &Spec| {
        ComputedDensity::new(formula.clone()).is_ok_and(|own| *own.to_object() == grid.to_object())
    };
    if formula.is_some_and(has_its_place) {
        return Ok(Some(format!("{{ {what} }}")));
    }
    let matrix = *grid.to_object().matrix();
    let place = [matrix.x_axis, matrix.y_axis, matrix.z_axis, matrix.w_axis];
    let place = place.map(|column| column.truncate().to_array());
    Ok(Some(format!("{{ {what}, place = {} }}", list(place.as_flattened()))))
}

/// A file, or a procedural texture with the textures that it contains.
fn texture_text(
    texture: &Arc<Texture>,
    scene: &SceneBuilder,
    writing: &mut Writing,
) -> Result<String, FormatError> {
    let Some(formula) = texture.formula() else {
        if texture.second_uv {
            writing.warn(
                "the second texture coordinates of meshes cannot be written: the first are used instead",
            );
        }
        let texels = Texture { threshold: None, ..Texture::clone(texture) };
        let mut out = format!("{{ texture = {}", quoted(&writing.texture_file(&texels)?));
        placement_keys(texture)
            .into_iter()
            .for_each(|(key, value)| out.push_str(&format!(", {key} = {value}")));
        return Ok(out + " }");
    };
    let mut out = format!("{{ kind = {}", quoted(&formula.spec().kind));
    for (key, value, _) in &formula.spec().parameters.0 {
        let value = match value {
            Value::Texture(index) => match formula.part(*index) {
                Some(part) => Some(texture_text(part, scene, writing)?),
                None => None,
            },
            plain => value_text(plain, scene, writing)?,
        };
        if let Some(value) = value {
            out.push_str(&format!(", {key} = {value}"));
        }
    }
    out.push_str(" }");
    Ok(times(out, texture, writing))
}

/// A procedural texture with the factor that it has besides its formula.
fn times(formula: String, texture: &Texture, writing: &mut Writing) -> String {
    let factor = texture.factor;
    if factor == Rgb::WHITE {
        return formula;
    }
    if factor.to_array().iter().any(|c| *c < 0.0) {
        writing.warn("a negative factor on a procedural texture cannot be written: it is left out");
        return formula;
    }
    format!("{{ kind = \"scale\", a = {formula}, b = {} }}", list(&factor.to_array()))
}
