//! Renders a matt, a mirror and a glass ball: `still_life INTEGRATOR SAMPLES SIZE OUT.png`.

#[path = "../tests/common/mod.rs"]
mod common;

use bilux_pictures::{WriteOptions, write};
use bilux_transport::RenderSettings;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, samples, size, out] = &arguments[..] else {
        return Err("usage: still_life INTEGRATOR SAMPLES SIZE OUT.png".into());
    };
    let size = size.parse()?;
    let scene = common::built(&common::still_life());
    let settings = RenderSettings::new(size, size, samples.parse()?);
    let rendered = common::shoot(&scene, &*common::integrator(name), &settings);
    write(out, &rendered.film.to_picture()?, &WriteOptions::default())?;
    Ok(())
}
