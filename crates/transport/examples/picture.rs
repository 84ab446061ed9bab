//! Renders a procedural scene: `picture SCENE INTEGRATOR SAMPLES SIZE OUT.png`, where SCENE is `still-life` (a plastic,
//! a mirror and a glass ball) or a row of `bilux_gallery::GENERATORS`.

#[path = "../tests/suite/common/mod.rs"]
mod common;

use bilux_pictures::{WriteOptions, write};
use bilux_scene::Spec;
use bilux_transport::RenderSettings;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, integrator, samples, size, out] = &arguments[..] else {
        return Err("usage: picture SCENE INTEGRATOR SAMPLES SIZE OUT.png".into());
    };
    let builder = match scene.as_str() {
        "still-life" => common::still_life(),
        name => bilux_gallery::generate(&Spec::new("", name))?,
    };
    let size = size.parse()?;
    let settings = RenderSettings::new(size, size, samples.parse()?);
    let rendered = common::shoot(&common::built(&builder), &*common::integrator(integrator), &settings);
    write(out, &rendered.film.to_picture()?, &WriteOptions::default())?;
    Ok(())
}
