//! Every field of a scene, each changed alone: the fingerprint changes with all that a sample depends on. The structures are
//! taken apart without `..`, so that a new field does not compile before it has its place here.

use crate::fingerprint::full_mesh;
use bilux::fingerprint::fingerprint;
use bilux::math::motion::{Motion, MotionKey};
use bilux::math::registry::{Parameter, ParameterKind};
use bilux::math::{Quat, Rgb, Vec3};
use bilux::prelude::*;
use bilux::scene::cameras::{CAMERAS, CameraSpec};
use bilux::scene::lights::LIGHTS;
use bilux::scene::materials::MATERIALS;
use bilux::scene::texture::{Image, TEXTURES, Texels, Texture, UvTransform};
use std::collections::HashMap;
use std::sync::Arc;

fn plain() -> Settings {
    Settings::resolve(&Parameters::default()).unwrap()
}

/// A mesh and two images with every list that they can have.
fn scene() -> SceneBuilder {
    let mut scene = SceneBuilder::default();
    let floats = Texels::Floats { colours: vec![Rgb::new(0.1, 0.2, 0.3); 2], alpha: vec![0.4, 0.5] };
    let bytes = Texels::Bytes(vec![[1, 2, 3, 4], [5, 6, 7, 8]]);
    for texels in [floats, bytes] {
        let image = Arc::new(Image { width: 2, height: 1, texels });
        let transform = Some(UvTransform::new([0.1, 0.2], 0.3, [1.5, 2.5]));
        scene.textures.push(Arc::new(Texture {
            transform,
            threshold: Some(0.25),
            ..Texture::of("", image, false)
        }));
    }
    scene.add_material(Spec::new("", "diffuse").with("reflectance", Value::Texture(0)));
    scene.objects.push(Object::new("", Arc::new(full_mesh()), 0));
    scene.stroke_widths.points = 0.5;
    scene.stroke_widths.lines = 0.25;
    scene
}

/// Every number of the scene that a sample depends on.
fn numbers(scene: &mut SceneBuilder) -> Vec<&mut f32> {
    let SceneBuilder {
        textures,
        objects,
        stroke_widths,
        // Specs, which other tests go through.
        materials: _,
        lights: _,
        cameras: _,
        // These take effect by what a job adds to the scene.
        environment_unspecified: _,
        exposure_unspecified: _,
        describes_all_light: _,
        has_faint_emitters: _,
        up: _,
        unit: _,
        settings: _,
        movement: _,
        // An offset of everything, and what is only said.
        origin: _,
        warnings: _,
        notes: _,
        inventory: _,
        written_by: _,
        files: _,
    } = scene;
    let mut all: Vec<&mut f32> = vec![&mut stroke_widths.points, &mut stroke_widths.lines];
    for texture in textures {
        let Texture { image, factor, threshold, .. } = Arc::make_mut(texture);
        all.extend([&mut factor.r, &mut factor.g, &mut factor.b]);
        all.extend(threshold);
        if let Texels::Floats { colours, alpha } = &mut Arc::make_mut(image).texels {
            all.extend(colours.iter_mut().flat_map(|c| [&mut c.r, &mut c.g, &mut c.b]));
            all.extend(alpha);
        }
    }
    for object in objects {
        let Object { mesh, name: _, material: _, motion: _, instanced: _, category: _, visibility: _ } =
            object;
        let Mesh {
            positions,
            normals,
            uvs,
            uvs2,
            tangents,
            vertex_kd,
            vertex_ks,
            vertex_opacity,
            opacity_threshold,
            point_widths,
            emission_by_kd: _,
            name: _,
            triangles: _,
            points: _,
            lines: _,
        } = Arc::make_mut(mesh);
        all.extend(positions.iter_mut().chain(normals).flat_map(|v| [&mut v.x, &mut v.y, &mut v.z]));
        all.extend(uvs.iter_mut().chain(uvs2).flat_map(|v| [&mut v.x, &mut v.y]));
        all.extend(tangents.iter_mut().flat_map(|v| AsMut::<[f32; 4]>::as_mut(v).iter_mut()));
        all.extend(vertex_opacity.iter_mut().chain(opacity_threshold).chain(point_widths));
        all.extend(vertex_kd.iter_mut().chain(vertex_ks).flat_map(|c| [&mut c.r, &mut c.g, &mut c.b]));
    }
    all
}

/// Every index and byte of the scene.
fn changed_integers() -> Vec<SceneBuilder> {
    let mut all = Vec::new();
    let mut change = |make: &dyn Fn(&mut SceneBuilder)| {
        let mut scene = scene();
        make(&mut scene);
        all.push(scene);
    };
    for corner in 0..3 {
        change(&|scene| Arc::make_mut(&mut scene.objects[0].mesh).triangles[0][corner] = 7);
    }
    change(&|scene| Arc::make_mut(&mut scene.objects[0].mesh).points[0] = 2);
    for end in 0..2 {
        change(&|scene| Arc::make_mut(&mut scene.objects[0].mesh).lines[0][end] = 2);
    }
    for at in 0..8 {
        change(&|scene| {
            let texture = Arc::make_mut(&mut scene.textures[1]);
            let Texels::Bytes(texels) = &mut Arc::make_mut(&mut texture.image).texels else {
                panic!("bytes")
            };
            texels[at / 4][at % 4] = 99;
        });
    }
    for (width, height) in [(1, 2), (2, 2)] {
        change(&|scene| {
            let texture = Arc::make_mut(&mut scene.textures[1]);
            let image = Arc::make_mut(&mut texture.image);
            (image.width, image.height) = (width, height);
        });
    }
    change(&|scene| Arc::make_mut(&mut scene.textures[0]).is_data = true);
    change(&|scene| Arc::make_mut(&mut scene.objects[0].mesh).emission_by_kd = true);
    for [x, y, turn, u, v] in [
        [0.5, 0.2, 0.3, 1.5, 2.5],
        [0.1, 0.5, 0.3, 1.5, 2.5],
        [0.1, 0.2, 0.5, 1.5, 2.5],
        [0.1, 0.2, 0.3, 0.5, 2.5],
        [0.1, 0.2, 0.3, 1.5, 0.5],
    ] {
        let transform = UvTransform::new([x, y], turn, [u, v]);
        change(&|scene| Arc::make_mut(&mut scene.textures[0]).transform = Some(transform));
    }
    all
}

#[test]
fn each_number_of_a_scene_counts() {
    let settings = plain();
    let mut seen = HashMap::from([(fingerprint(&scene(), &settings), "nothing".to_owned())]);
    let count = numbers(&mut scene()).len();
    // 18 of two images and their placements, 67 of a mesh with three vertices.
    assert_eq!(count, 85);
    let changed = (0..count).map(|i| {
        let mut scene = scene();
        *numbers(&mut scene)[i] += 0.375;
        scene
    });
    for (i, scene) in changed.chain(changed_integers()).enumerate() {
        let what = format!("change {i}");
        if let Some(other) = seen.insert(fingerprint(&scene, &settings), what.clone()) {
            panic!("{what} of {count} numbers and then integers has the fingerprint of {other}");
        }
    }
}

#[test]
fn each_number_of_a_movement_counts() {
    let settings = plain();
    let keys = || {
        [0.0, 1.0].map(|t| MotionKey {
            time_seconds: t,
            translation: Vec3::new(t, 0.5, 0.25),
            rotation: Quat::from_xyzw(0.5, 0.5, 0.5, 0.5),
            scale: Vec3::new(1.0, 2.0, 3.0),
        })
    };
    let of = |keys: [MotionKey; 2]| {
        let mut scene = scene();
        scene.objects[0].motion = Motion::from_keys(keys.to_vec()).unwrap();
        fingerprint(&scene, &settings)
    };
    let changes: [fn(&mut MotionKey); 8] = [
        |key| key.time_seconds += 1.0,
        |key| key.translation.x += 1.0,
        |key| key.translation.y += 1.0,
        |key| key.translation.z += 1.0,
        |key| key.rotation = Quat::from_xyzw(0.5, -0.5, 0.5, 0.5),
        |key| key.scale.x += 1.0,
        |key| key.scale.y += 1.0,
        |key| key.scale.z += 1.0,
    ];
    let mut seen = HashMap::from([(of(keys()), usize::MAX)]);
    for (i, change) in changes.into_iter().enumerate() {
        let mut keys = keys();
        change(&mut keys[1]);
        assert_eq!(seen.insert(of(keys), i), None, "change {i}");
    }
}

/// A value that differs from the default.
fn other(parameter: &Parameter) -> Value {
    match parameter.kind {
        ParameterKind::Bool => Value::Bool(parameter.default != "true"),
        ParameterKind::Integer { .. } => Value::Integer(977),
        ParameterKind::Choice(_) | ParameterKind::Text => Value::Text("another".to_owned()),
        _ => Value::from(0.977f32),
    }
}

/// Each parameter of each row of the tables, of materials, lights, cameras and textures.
#[test]
fn each_parameter_of_the_tables_counts() {
    let settings = plain();
    let mut seen = HashMap::new();
    let mut check = |what: String, scene: &SceneBuilder| {
        if let Some(other) = seen.insert(fingerprint(scene, &settings), what.clone()) {
            panic!("{what} and {other} have one fingerprint");
        }
    };
    let materials = MATERIALS.iter().map(|row| ("material", &row.entry));
    let lights = LIGHTS.iter().map(|row| ("light", &row.entry));
    let cameras = CAMERAS.iter().map(|row| ("camera", &row.entry));
    for (kind, entry) in materials.chain(lights).chain(cameras) {
        for parameter in [None].into_iter().chain(entry.parameters.iter().map(Some)) {
            let mut spec = Spec::new("", entry.name);
            if let Some(parameter) = parameter {
                spec.parameters.set(parameter.name, other(parameter));
            }
            let mut scene = scene();
            match kind {
                "material" => scene.materials.push(spec),
                "light" => scene.lights.push(spec),
                _ => scene.cameras.push(CameraSpec { spec, keyframes: Vec::new() }),
            }
            check(format!("{kind} {}: {}", entry.name, parameter.map_or("-", |p| p.name)), &scene);
        }
    }
    let mut textures = 0;
    for row in TEXTURES {
        for parameter in [None].into_iter().chain(row.entry.parameters.iter().map(Some)) {
            let mut spec = Spec::new("", row.entry.name);
            if let Some(parameter) = parameter {
                spec.parameters.set(parameter.name, within(parameter));
            }
            // Some need more than one parameter.
            let Ok(texture) = Texture::by_formula(spec, Vec::new(), false) else { continue };
            textures += 1;
            let mut scene = scene();
            scene.textures.push(Arc::new(texture));
            check(format!("texture {}: {}", row.entry.name, parameter.map_or("-", |p| p.name)), &scene);
        }
    }
    assert!(textures >= 8, "{textures}");
}

/// A value that a texture accepts and that is not the default.
fn within(parameter: &Parameter) -> Value {
    match parameter.kind {
        ParameterKind::Bool => Value::Bool(parameter.default != "true"),
        ParameterKind::Integer { min, max } => {
            Value::Integer(if parameter.default == min.to_string() { max.min(min + 1) } else { min })
        }
        ParameterKind::Choice(words) => {
            Value::Text(words.iter().find(|word| **word != parameter.default).unwrap().to_string())
        }
        ParameterKind::Number { min, max } => Value::Number(0.4 * min.max(-1.0) + 0.6 * max.min(1.0)),
        _ => Value::from(0.4375f32),
    }
}
