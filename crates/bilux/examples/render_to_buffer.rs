//! A scene that the program builds itself, rendered into bytes that a window or a web page can show.
//!
//! ```text
//! cargo run --release -p bilux --example render_to_buffer
//! ```
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux::prelude::*;
use std::sync::Arc;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = SceneBuilder::default();
    let clay = scene.add_material(materials::Diffuse::new("clay").reflectance(Rgb::new(0.6, 0.3, 0.2)));
    let metal =
        scene.add_material(materials::Principled::new("metal").base_metalness(1.0).specular_roughness(0.2));
    let floor = Mesh::quad(Vec3::new(-3.0, 0.0, -3.0), Vec3::Z * 6.0, Vec3::X * 6.0);
    let ball = Mesh::sphere(Vec3::Y, 1.0, 48);
    scene.objects.push(Object::new("floor", Arc::new(floor), clay));
    scene.objects.push(Object::new("ball", Arc::new(ball), metal));
    scene.add_light(lights::Rect::new("panel").position(Vec3::new(0.0, 4.0, 1.0)).intensity(Rgb::grey(30.0)));
    scene.add_camera(cameras::Perspective::new("eye").position(Vec3::new(0.0, 2.0, 6.0)).look_at(Vec3::Y));

    let request = JobRequest::new().integrator("path").size(48, 32).spp(8);
    let picture = Job::new(&scene, request)?.render(&Quiet)?.picture()?;
    let bytes = picture.to_rgba8().ok_or("a rendered picture has colours")?;
    let brightest = bytes.chunks(4).map(|pixel| pixel[1]).max();
    println!(
        "{} x {} pixels, {} bytes, green up to {brightest:?}",
        picture.width(),
        picture.height(),
        bytes.len()
    );
    assert_eq!(bytes.len(), 48 * 32 * 4);
    assert!(brightest > Some(100), "it is lit");
    Ok(())
}
