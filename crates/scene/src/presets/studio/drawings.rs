//! Models of points and lines, and models without a material.

use crate::builder::{Object, SceneBuilder};
use crate::parameters::{Spec, Value};
use bilux_math::Rgb;

/// The luminance from which a colour is hardly visible on the studio's usual ground.
const PALE: f32 = 0.4;

/// Gives objects without a material one of clay, or of ink on pale ground if they are only lines or a few points.
pub(super) fn of_clay(scene: &mut SceneBuilder) {
    const FEW: usize = 5000;
    let is_drawing = |object: &Object| {
        let mesh = &object.mesh;
        mesh.triangles.is_empty() && mesh.points.len() < FEW && mesh.stroke_count() > 0
    };
    let drawings: Vec<usize> =
        scene.objects.iter().filter(|object| is_drawing(object)).map(|object| object.material).collect();
    let bare = |m: &Spec| m.kind == "phong" && m.parameters.0.is_empty();
    for (i, material) in scene.materials.iter_mut().enumerate().filter(|(_, m)| bare(m)) {
        let kd = if drawings.contains(&i) { Rgb::grey(0.06) } else { Rgb::new(0.62, 0.59, 0.55) };
        let clay = Spec::new(&material.name, "phong").with("kd", kd);
        *material = clay.with("ks", 0.05f32).with("exponent", 40.0f32).with("reflectivity", 0.0f32);
    }
}

/// True for a scene of nothing but points and lines, at least half of which are pale.
pub(super) fn is_pale(scene: &SceneBuilder) -> bool {
    let (mut pale, mut all) = (0, 0);
    for object in &scene.objects {
        let mesh = &object.mesh;
        if !mesh.triangles.is_empty() {
            return false;
        }
        let ink = scene.materials.get(object.material).map_or(0.0, luminance);
        let is_pale =
            |vertex: u32| ink * mesh.vertex_kd.get(vertex as usize).map_or(1.0, |c| c.luminance()) >= PALE;
        let vertices = mesh.points.iter().copied().chain(mesh.lines.iter().map(|line| line[0]));
        pale += vertices.filter(|&vertex| is_pale(vertex)).count();
        all += mesh.stroke_count();
    }
    pale > 0 && pale * 2 >= all
}

/// The luminance of a material's colour; 0 if a texture gives it, or nothing.
fn luminance(material: &Spec) -> f32 {
    let keys = ["kd", "base_color", "reflectance", "emission"];
    let of = |key| material.parameters.find(key).map_or(0.0, |(value, _)| grey(value));
    keys.into_iter().map(of).fold(0.0, f32::max)
}

fn grey(value: &Value) -> f32 {
    match value {
        Value::Integer(i) => *i as f32,
        Value::Number(x) => *x as f32,
        Value::List(list) => match list.iter().map(grey).collect::<Vec<_>>()[..] {
            [r, g, b] => Rgb::new(r, g, b).luminance(),
            _ => 0.0,
        },
        _ => 0.0,
    }
}
