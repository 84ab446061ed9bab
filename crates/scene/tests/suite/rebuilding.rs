//! A scene that is built with what earlier builds left equals one that is built from nothing, bit for bit, whatever was
//! edited in between; and what was not edited is not built again.

use bilux_math::motion::{Motion, MotionKey};
use bilux_math::{Rgb, Transform, Vec2, Vec3, glam::Quat, hash};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{
    AccelChoice, BuiltParts, Mesh, Object, Ray, Scene, SceneBuilder, Spec, StrokeWidths, Texture, Tracer,
    TreeWork, Value,
};
use bilux_testing::effort;
use std::sync::Arc;

const SHUTTER: [f32; 2] = [0.0, 0.5];

/// Numbers that look random.
struct Numbers(u64, u64);

impl Numbers {
    fn unit(&mut self) -> f32 {
        self.1 += 1;
        hash::unit_f32(hash::hash_words([self.0, self.1]) as u32)
    }

    fn below(&mut self, end: usize) -> usize {
        ((self.unit() * end as f32) as usize).min(end - 1)
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    fn place(&mut self) -> Transform {
        Transform::translate(self.vector()).unwrap()
    }
}

fn rough_quad() -> Mesh {
    let mut mesh = Mesh::quad(Vec3::splat(-0.5), Vec3::X, Vec3::new(0.0, 1.0, 0.3));
    mesh.name = "quad".to_owned();
    mesh
}

/// Objects of every kind; some at the same place, so that hits tie.
fn builder() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let texels = (0..64).map(|i| Rgb::grey((i * 37 % 64) as f32 / 64.0)).collect();
    builder.textures.push(Arc::new(Texture::new("holes", 8, 8, texels, true)));
    let opacity = Value::Texture(0);
    for spec in [
        Spec::new("grey", "diffuse"),
        Spec::new("glow", "diffuse").with("emission", Rgb::new(1.0, 2.0, 3.0)),
        Spec::new("leaf", "diffuse").with("opacity", opacity),
        Spec::new("front", "diffuse").with("visible_sides", "front"),
        Spec::new("both", "mix").with("a", Value::Material(0)).with("b", Value::Material(0)),
    ] {
        builder.add_material(spec);
    }
    let (ball, quad) = (Arc::new(Mesh::sphere(Vec3::ZERO, 0.4, 8)), Arc::new(rough_quad()));
    let strokes = Mesh { points: vec![0, 1], lines: vec![[1, 2]], triangles: vec![], ..rough_quad() };
    let strokes = Arc::new(strokes);
    let mut numbers = Numbers(1, 0);
    for i in 0..9 {
        let object = Object::new("", if i % 2 == 0 { ball.clone() } else { quad.clone() }, [0, 2, 3][i % 3]);
        builder.objects.push(object.placed(numbers.place()));
    }
    // A sheet of two shells.
    let back = Mesh::quad(Vec3::splat(-0.5), Vec3::new(0.0, 1.0, 0.3), Vec3::X);
    for shell in [quad.clone(), Arc::new(back)] {
        builder.objects.push(Object::new("", shell, 3).placed(Transform::translate(Vec3::Z).unwrap()));
    }
    // The same again: the lower numbers win.
    builder.objects.extend_from_within(2..4);
    builder.objects.push(Object { instanced: true, ..Object::new("", ball, 0) }.placed(numbers.place()));
    builder.objects.push(Object::new("", strokes, 0).placed(numbers.place()));
    builder.objects.push(Object::new("glow", quad.clone(), 1).placed(numbers.place()));
    builder.objects.push(Object { motion: moving(), ..Object::new("", quad, 0) });
    let position = |at: f32| Vec3::new(0.0, 2.0, at);
    builder.add_light(Spec::new("", "rect").with("position", position(0.0)).with("intensity", 9.0f32));
    builder.add_light(Spec::new("", "sphere").with("position", position(1.0)).with("intensity", 3.0f32));
    builder.add_light(Spec::new("", "environment").with("radiance", Value::Texture(0)));
    builder.cameras.push(CameraSpec::new(Spec::new("", "perspective").with("position", Vec3::Z * 4.0)));
    builder
}

fn moving() -> Motion {
    let key = |time_seconds: f32, x: f32| MotionKey {
        time_seconds,
        translation: Vec3::X * x,
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    };
    Motion::from_keys(vec![key(0.0, 0.0), key(1.0, 1.0)]).unwrap()
}

/// Changes something.
fn edit(builder: &mut SceneBuilder, numbers: &mut Numbers) {
    let object = numbers.below(builder.objects.len());
    match numbers.below(13) {
        0..=3 => builder.objects[object] = builder.objects[object].clone().placed(numbers.place()),
        4 => drop(builder.objects.remove(object)),
        5 => builder.objects.insert(object, builder.objects[object].clone()),
        6 => {
            let other = numbers.below(builder.objects.len());
            builder.objects.swap(object, other);
        }
        7 => builder.objects[object].material = numbers.below(5),
        8 => builder.materials[0].parameters.set("reflectance", numbers.unit()),
        9 => builder.lights[0].parameters.set("position", numbers.vector() + Vec3::Y * 3.0),
        10 => {
            let mut mesh = (*builder.objects[object].mesh).clone();
            mesh.positions.iter_mut().for_each(|p| *p *= 1.25);
            builder.objects[object].mesh = Arc::new(mesh);
        }
        11 => builder.objects[object].instanced = !builder.objects[object].instanced,
        // Nothing: only another address.
        _ => builder.objects[object].mesh = Arc::new((*builder.objects[object].mesh).clone()),
    }
}

fn rays(seed: u64) -> Vec<Ray> {
    let mut numbers = Numbers(seed, 0);
    let ray = |_| {
        let (origin, target) = (numbers.vector() * 3.0, numbers.vector());
        let time = numbers.unit() * SHUTTER[1];
        Ray { time, ..Ray::new(origin.to_array(), (target - origin).to_array()) }
    };
    (0..400).map(ray).collect()
}

/// All that rays and light samples find in a scene, as text, which has all digits.
fn answers(scene: &Scene) -> Vec<String> {
    let (rays, mut tracer) = (rays(7), Tracer::new(scene, false));
    let mut answers = vec![format!("{:?} {}", scene.bounds(), scene.lights().len())];
    let from_camera: Vec<Ray> = rays.iter().map(|ray| scene.from_camera(*ray)).collect();
    let mut hits = vec![None; rays.len()];
    tracer.hits(&from_camera, &mut hits);
    for (ray, hit) in from_camera.iter().zip(hits) {
        assert_eq!(hit, tracer.hit(ray), "in a batch as alone");
        let surface = hit.map(|hit| tracer.surface(ray, &hit));
        let material = surface.as_ref().map(|s| scene.material(s).classic(s).kd);
        let emission = surface.as_ref().map(|s| scene.emission(s, -Vec3::from(ray.direction)));
        let excluded = hit.map(|hit| tracer.hit(&Ray { exclude: hit.primitive(), ..*ray }));
        answers.push(format!("{hit:?} {surface:?} {material:?} {emission:?} {excluded:?}"));
        if let Some(surface) = &surface {
            // Leaves the surface, past the other shell if it is one of a sheet.
            let back = surface.spawn_to(Vec3::from(ray.origin));
            answers.push(format!("{} {:?}", tracer.occluded(&back), tracer.hit(&back)));
        }
        if let Some(surface) = &surface
            && let Some(light) = scene.light_of(surface.object)
        {
            let (from, wi) = (ray.origin.into(), Vec3::from(ray.direction).normalize());
            answers.push(light.light.li_pdf_solid_angle(from, wi, Some(surface)).to_string());
        }
    }
    for ray in &rays {
        answers.push(format!("{} {:?}", tracer.occluded(ray), scene.background(ray.direction.into(), 0)));
        let (from, u) = (Vec3::from(ray.origin), Vec2::new(ray.time, 0.5));
        let sample = |light: &bilux_scene::scene::SceneLight| {
            light
                .light
                .sample_li(from, ray.time, u)
                .map(|s| format!("{:?} {} {:?}", s.wi, s.pdf_solid_angle, s.li))
        };
        answers.extend(
            scene.lights().iter().map(|light| format!("{:?} {}", sample(light), light.classic_colour.r)),
        );
    }
    answers
}

fn built(builder: &SceneBuilder, parts: &mut BuiltParts, accel: &AccelChoice) -> Scene {
    builder.build_with(parts, accel, SHUTTER, 1.0).unwrap()
}

#[test]
fn after_any_edits_the_scene_is_that_of_a_fresh_build() {
    for seed in 0..effort(4, 12) {
        let (mut builder, mut parts, mut numbers) = (builder(), BuiltParts::default(), Numbers(seed, 0));
        let name = ["auto", "kd", "auto", "bsp-sah"][seed as usize % 4];
        let accel = AccelChoice { name: name.to_owned(), ..AccelChoice::default() };
        built(&builder, &mut parts, &accel);
        for step in 0..40 {
            for _ in 0..=numbers.below(3) {
                edit(&mut builder, &mut numbers);
            }
            let reused = answers(&built(&builder, &mut parts, &accel));
            let fresh = answers(&builder.build(&accel, SHUTTER, 1.0).unwrap());
            for (i, (reused, fresh)) in reused.iter().zip(&fresh).enumerate() {
                assert_eq!(reused, fresh, "{name}, seed {seed}, step {step}, answer {i}");
            }
        }
    }
}

/// The work of a build.
fn work(builder: &SceneBuilder, parts: &mut BuiltParts) -> TreeWork {
    let before = parts.tree_work();
    built(builder, parts, &AccelChoice::default());
    let after = parts.tree_work();
    TreeWork { trees: after.trees - before.trees, triangles: after.triangles - before.triangles }
}

#[test]
fn what_was_not_edited_is_not_built_again() {
    let (mut builder, mut parts) = (builder(), BuiltParts::default());
    // Otherwise they depend on the size of the scene.
    builder.stroke_widths = StrokeWidths { points: 0.1, lines: 0.05 };
    let all = work(&builder, &mut parts);
    assert!(all.trees > 3, "{all:?}");
    let none = TreeWork::default();
    assert_eq!(work(&builder, &mut parts), none);
    builder.cameras[0].spec.parameters.set("position", Vec3::X);
    builder.materials[0].parameters.set("reflectance", 0.1f32);
    builder.lights[2].parameters.set("rotation", 30.0f32);
    builder.objects[1].material = 0;
    assert_eq!(work(&builder, &mut parts), none, "cameras, materials and environments have no trees");
    let copies = builder.objects.iter().map(|o| Object { mesh: Arc::new((*o.mesh).clone()), ..o.clone() });
    builder.objects = copies.collect();
    assert_eq!(work(&builder, &mut parts), none, "equal meshes are the same");

    let triangles = builder.objects[0].mesh.triangles.len() as u64;
    let mut moved = |parts: &mut BuiltParts, x: f32| {
        let place = Transform::translate(Vec3::X * x).unwrap();
        builder.objects[0] = builder.objects[0].clone().placed(place);
        work(&builder, parts)
    };
    let first = moved(&mut parts, 1.0);
    assert!(first.trees == 2 && first.triangles < all.triangles, "the others once, and this one: {first:?}");
    for x in [2.0, 3.0, 4.0] {
        assert_eq!(moved(&mut parts, x), TreeWork { trees: 1, triangles }, "the moved one only");
    }
}

#[test]
fn memory_stays_flat_and_a_failed_build_changes_nothing() {
    let (mut builder, mut parts, mut numbers) = (builder(), BuiltParts::default(), Numbers(3, 0));
    work(&builder, &mut parts);
    let before = parts.len();
    for _ in 0..300 {
        builder.objects[0] = builder.objects[0].clone().placed(numbers.place());
        let mesh = Arc::new(Mesh::sphere(numbers.vector(), 0.3, 6));
        builder.objects[1].mesh = mesh;
        builder.materials[1].parameters.set("emission", numbers.unit());
        builder.lights[0].parameters.set("position", numbers.vector() + Vec3::Y * 4.0);
        work(&builder, &mut parts);
    }
    assert!(parts.len() <= before + 4, "{} parts, and {before} at first", parts.len());
    let (weak, kept) = (Arc::downgrade(&builder.objects[1].mesh), parts.len());
    for _ in 0..20 {
        let mut wrong = builder.clone();
        wrong.objects[1].mesh = Arc::new(Mesh::sphere(numbers.vector(), 0.3, 6));
        wrong.materials[1].parameters.set("emission", numbers.unit());
        wrong.lights[1].parameters.set("radius", -1.0f32);
        assert!(wrong.build_with(&mut parts, &AccelChoice::default(), SHUTTER, 1.0).is_err());
    }
    assert_eq!(parts.len(), kept, "a failed build leaves nothing");
    assert_eq!(work(&builder, &mut parts), TreeWork::default(), "and takes nothing away");
    builder.objects.remove(1);
    work(&builder, &mut parts);
    assert_eq!(weak.strong_count(), 0, "a mesh that is not used is let go");
}

#[test]
fn shells_that_become_a_sheet_are_found() {
    let mut builder = SceneBuilder::default();
    builder.add_material(Spec::new("both", "diffuse"));
    builder.add_material(Spec::new("front", "diffuse").with("visible_sides", "front"));
    // In front of the other by less than the gap of a sheet.
    let corner = Vec3::splat(-0.5) + Vec3::new(0.0, -0.3, 1.0) * 0.0005;
    let back = Mesh::quad(corner, Vec3::new(0.0, 1.0, 0.3), Vec3::X);
    for (shell, material) in
        [(rough_quad(), 0), (back, 0), (Mesh::quad(Vec3::NEG_Y * 2.0, Vec3::Z, Vec3::X), 1)]
    {
        builder.objects.push(Object::new("", Arc::new(shell), material));
    }
    let (accel, mut parts) = (AccelChoice::default(), BuiltParts::default());
    for material in [0, 1, 0, 1] {
        builder.objects[0].material = material;
        builder.objects[1].material = material;
        let reused = answers(&built(&builder, &mut parts, &accel));
        assert!(reused == answers(&builder.build(&accel, SHUTTER, 1.0).unwrap()), "material {material}");
    }
}

/// Two meshes that differ only in what their vertices let through, or in the widths of points, are two meshes, in whichever
/// order they are built.
#[test]
fn meshes_that_differ_in_opacity_or_width_alone_are_not_taken_for_each_other() {
    let quad = |opacity: f32| Mesh {
        vertex_opacity: vec![opacity; 4],
        ..Mesh::quad(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0)
    };
    let cloud = |width: f32| Mesh {
        positions: vec![Vec3::ZERO],
        points: vec![0],
        point_widths: vec![width],
        ..Mesh::default()
    };
    let hits = |mesh: Mesh, at: f32, parts: &mut BuiltParts| {
        let mut builder = SceneBuilder::default();
        builder.add_material(Spec::new("", "diffuse"));
        builder.objects.push(Object { instanced: true, ..Object::new("", Arc::new(mesh), 0) });
        let scene = built(&builder, parts, &AccelChoice::default());
        let ray = Ray::new([at, 0.0, 5.0], [0.0, 0.0, -1.0]);
        Tracer::new(&scene, false).closest(&ray).is_some()
    };
    let mut parts = BuiltParts::default();
    let seen = [0.0, 1.0, 0.0].map(|opacity| hits(quad(opacity), 0.3, &mut parts));
    assert_eq!(seen, [false, true, false]);
    let seen = [0.2, 1.0, 0.2].map(|width| hits(cloud(width), 0.3, &mut parts));
    assert_eq!(seen, [false, true, false]);
}
