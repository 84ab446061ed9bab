//! How a model is photographed, as it is typed.

use crate::settings_from::from_flag;
use anyhow::Context;
use bilux::presets::Studio;
use bilux::scene::{Parameters, Value};
use clap::Args;
use std::path::PathBuf;

/// What is asked of the studio.
#[derive(Args)]
pub struct StudioArguments {
    /// How a bare file is seen (`bilux list presets`)
    #[arg(long, value_name = "NAME")]
    pub preset: Option<String>,
    /// From where a studio's camera looks: degrees to the right of the model's front, and above it
    #[arg(long, value_name = "AZ,EL", allow_hyphen_values = true)]
    pub orbit: Option<String>,
    /// Focal length of the studio's camera, in mm for a picture 24 mm high [default: 45]
    #[arg(long, value_name = "MM")]
    pub focal: Option<f32>,
    /// What a model stands on [default: a matt cove, where the file has neither camera nor light]
    #[arg(long, value_name = "shadow|mirror|none")]
    pub ground: Option<String>,
    /// Light all of it by a picture of its surroundings, in longitude and latitude: .hdr, .exr or any other
    #[arg(long, value_name = "FILE")]
    pub env: Option<PathBuf>,
    /// N pictures from all around, one by one; needs {frame} in OUT
    #[arg(long, value_name = "N", conflicts_with_all = ["frames", "samples"])]
    pub turntable: Option<u32>,
}

/// The same settings from farther around the model, in turns to the right.
pub fn turned(user: &Parameters, turns: f32) -> anyhow::Result<Parameters> {
    let orbit = match user.find("orbit") {
        Some((Value::Text(text), _)) => bilux::settings::parse_orbit(text)
            .with_context(|| format!("'{text}' is no orbit: write AZ,EL in degrees, such as 30,15"))?,
        _ => Studio::ORBIT,
    };
    let mut turned = user.clone();
    let text = format!("{},{}", orbit[0] + 360.0 * turns, orbit[1]);
    turned.set_at("orbit", Value::Text(text), from_flag("--turntable"));
    Ok(turned)
}
