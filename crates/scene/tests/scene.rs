//! A scene is built from plain data, refuses what is wrong, and answers rays.

use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{AccelChoice, CameraSample, Mesh, Object, SceneBuilder, SceneError, Spec, Tracer};
use std::sync::Arc;

fn floor() -> Arc<Mesh> {
    Arc::new(Mesh {
        positions: [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
            .map(|(x, z)| Vec3::new(x, 0.0, z))
            .to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    })
}

fn builder() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let green = Spec::new("green", "diffuse").with("reflectance", Rgb::new(0.1, 0.7, 0.1));
    let material = builder.add_material(green);
    builder.objects.push(Object::new("floor", floor(), material));
    builder.lights.push(
        Spec::new("panel", "rect").with("position", Vec3::new(0.0, 2.0, 0.0)).with("intensity", 10.0f32),
    );
    let camera = Spec::new("eye", "perspective").with("position", Vec3::new(0.0, 1.0, 3.0));
    builder.cameras.push(CameraSpec { spec: camera, keyframes: Vec::new() });
    builder
}

#[test]
fn the_middle_of_the_picture_sees_what_the_camera_looks_at() {
    let scene = builder().build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let sample = CameraSample { film: Vec2::splat(0.5), lens: Vec2::ZERO, time: 0.0 };
    let ray = scene.cameras()[0].1.ray(&sample);
    let surface = Tracer::new(&scene, false).closest(&ray).expect("the floor is there");
    assert!(surface.p.length() < 1e-5, "{}", surface.p);
    assert_eq!(surface.n_geom, Vec3::Y);
    assert_eq!(scene.material(&surface).classic(&surface).kd, Rgb::new(0.1, 0.7, 0.1));
}

#[test]
fn a_panel_is_a_light_and_does_not_block_its_own_light() {
    let scene = builder().build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let mut tracer = Tracer::new(&scene, false);
    let up = tracer.closest(&bilux_scene::Ray::new([0.1, 1.0, 0.1], [0.0, 1.0, 0.0])).unwrap();
    assert!(scene.light_of(up.object).is_some());
    let down = tracer.closest(&bilux_scene::Ray::new([0.1, 1.0, 0.1], [0.0, -1.0, 0.0])).unwrap();
    let to_beyond = down.spawn_to(Vec3::new(0.1, 3.0, 0.1));
    assert!(tracer.occluded(&to_beyond) && !tracer.blocked(&to_beyond));
}

#[test]
fn misspelt_names_are_told_with_the_nearest() {
    let mut wrong = builder();
    wrong.materials[0] = Spec::new("", "difuse");
    let error = wrong.build(&AccelChoice::default(), [0.0, 0.0], 1.0).err().unwrap();
    assert!(error.to_string().contains("did you mean 'diffuse'?"), "{error}");
    wrong.materials[0] = Spec::new("", "diffuse").with("reflectence", 0.5f32);
    let error = wrong.build(&AccelChoice::default(), [0.0, 0.0], 1.0).err().unwrap();
    assert!(error.to_string().contains("did you mean 'reflectance'?"), "{error}");
    wrong.materials[0] = Spec::new("", "diffuse").with("reflectance", 1.5f32);
    assert!(matches!(
        wrong.build(&AccelChoice::default(), [0.0, 0.0], 1.0),
        Err(SceneError::BadValue { .. })
    ));
}
