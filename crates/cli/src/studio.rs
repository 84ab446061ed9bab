//! How a model is photographed, as it is typed.

use crate::settings_from::from_flag;
use crate::usage;
use anyhow::{Context, bail};
use bilux::formats::ReadOptions;
use bilux::presets::Studio;
use bilux::scene::{Parameters, SceneBuilder, Value};
use bilux::settings::Background;
use clap::Args;
use std::path::{Path, PathBuf};

/// What is asked of the studio.
#[derive(Args)]
pub struct StudioArguments {
    /// How a bare file is seen (`bilux list presets`)
    #[arg(long, value_name = "NAME")]
    pub preset: Option<String>,
    /// From where a studio's camera looks: degrees to the right of the model's front, and above it
    #[arg(long, value_name = "AZ,EL", allow_hyphen_values = true)]
    pub orbit: Option<String>,
    /// Which of the model's axes is up: x, y, z, -x, -y or -z [default: auto, by its format and its shape]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub up: Option<String>,
    /// Which of the model's axes is its front, which the studio's camera sees [default: auto]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub front: Option<String>,
    /// Focal length of the studio's camera, in mm for a picture 24 mm high [default: 45]
    #[arg(long, value_name = "MM")]
    pub focal: Option<f32>,
    /// What a model stands on [default: a matt cove, where the file has neither camera nor light]
    #[arg(long, value_name = "shadow|mirror|none")]
    pub ground: Option<String>,
    /// Light all of it by a picture of its surroundings, in longitude and latitude: .hdr, .exr or any other; none leaves a glTF's lamps
    /// alone, which else stand in the studio's surroundings
    #[arg(long, value_name = "FILE|none")]
    pub env: Option<PathBuf>,
    /// What is behind a model: transparent, or a colour (white, '#rrggbb', R,G,B), or a picture to be seen in place of what lights it
    #[arg(long, value_name = "transparent|COLOR|FILE")]
    pub background: Option<String>,
    /// N pictures from all around, one by one; needs {frame} in OUT
    #[arg(long, value_name = "N", conflicts_with_all = ["frames", "samples"])]
    pub turntable: Option<u32>,
}

impl StudioArguments {
    /// Puts around a scene what is asked for.
    pub fn set_up(&self, scene: &mut SceneBuilder, options: &ReadOptions) -> anyhow::Result<()> {
        if let Some(preset) = &self.preset {
            bilux::presets::apply(preset, scene).map_err(usage::wrong)?;
        }
        if self.env.as_deref() == Some(Path::new("none")) {
            scene.surroundings_unsaid = false;
        } else if let Some(picture) = &self.env {
            bilux::presets::surround(scene, picture, options).context("--env")?;
        }
        if let Some(picture) = self.picture_behind() {
            bilux::presets::set_behind(scene, picture, options).context("--background")?;
        }
        Ok(())
    }

    /// The background where it is a picture, and no colour.
    pub fn picture_behind(&self) -> Option<&Path> {
        let is_setting = |text: &str| Background::parse(text).is_some() || text.starts_with('#');
        self.background.as_deref().filter(|text| !is_setting(text)).map(Path::new)
    }

    /// Finds out before the work whether there is such a background.
    pub fn check(&self) -> anyhow::Result<()> {
        if let Some(picture) = self.picture_behind().filter(|picture| !picture.exists()) {
            let text = picture.display();
            bail!("--background: '{text}' is no file, nor transparent, white, '#rrggbb' or R,G,B of 0 to 1");
        }
        Ok(())
    }

    /// The background where it is a setting.
    pub fn background(&self) -> Option<String> {
        self.background.clone().filter(|_| self.picture_behind().is_none())
    }
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
