//! The options for the studio around a model.

use crate::arguments::assignments::{change_of, from_flag};
use crate::arguments::help;
use crate::arguments::tables::TableOptions;
use crate::arguments::tables::settings::OfScene;
use crate::process::usage;
use anyhow::{Context, bail};
use bilux::formats::ReadOptions;
use bilux::scene::{SceneBuilder, SceneError};
use bilux::settings::Background;
use clap::Args;
use std::path::{Path, PathBuf};

/// The camera and the surroundings of a model.
#[derive(Args, Clone)]
pub struct StudioArguments {
    #[command(flatten)]
    pub settings: TableOptions<OfScene>,
    /// Take pictures with calibrated cameras in place of the scene's: a file of OpenCV (YAML or JSON, also of ROS or Kalibr), COLMAP's
    /// images.txt or cameras.txt (or .bin), or transforms.json; --camera says which one
    #[arg(long, value_name = "FILE", help_heading = help::STUDIO)]
    pub intrinsics: Option<PathBuf>,
    /// Light the scene with a longitude-latitude environment map (.hdr, .exr or any other picture), with a daylight sky,
    /// or with the studio in place of its own lights; none turns the studio's lights off for a glTF file with lights of
    /// its own
    #[arg(long, value_name = "FILE|sky|studio|none", help_heading = help::COMMON_OPTIONS)]
    pub env: Option<PathBuf>,
    /// The layer of the pictures of --env and --background, of an EXR that has several [default: its main picture]
    #[arg(long, value_name = "NAME", help_heading = help::STUDIO)]
    pub layer: Option<String>,
    /// A preset for the studio's camera (`bilux list presets`)
    #[arg(long, value_name = "NAME", help_heading = help::STUDIO)]
    pub preset: Option<String>,
    /// Change a parameter of a material, a light or a camera, named by its name or by its number from 0, such as
    /// light:0:intensity=5 or material:Paint:base_color=0.8,0,0
    #[arg(long = "change", value_name = "PART:NAME:KEY=VALUE", help_heading = help::WHAT)]
    pub change: Vec<String>,
}

impl StudioArguments {
    /// Adds to a scene the surroundings that the options ask for.
    pub fn set_up(&self, scene: &mut SceneBuilder, options: &ReadOptions) -> anyhow::Result<()> {
        if let Some(preset) = &self.preset {
            let names = bilux::presets::PRESETS.iter().map(|row| row.entry.name);
            if !names.clone().any(|name| name == preset) {
                return Err(SceneError::unknown("preset", preset, names, &from_flag("--preset")).into());
            }
            bilux::presets::apply(preset, scene).map_err(usage::wrong)?;
        }
        if let Some(file) = &self.intrinsics {
            bilux::presets::take_cameras(scene, file, options).context("--intrinsics")?;
        }
        let options = &ReadOptions { picture_layer: self.layer.clone(), ..options.clone() };
        surround(self.env.as_deref(), scene, options)?;
        if let Some(picture) = self.picture_behind() {
            bilux::presets::set_background(scene, picture, options).context("--background")?;
        }
        for change in &self.change {
            change_of(change).and_then(|change| Ok(change.make(scene)?)).map_err(usage::wrong)?;
        }
        Ok(())
    }

    /// The time that is shown, in seconds.
    pub fn time(&self) -> f32 {
        self.settings.number("time").unwrap_or(0.0)
    }

    /// These options with another environment, if there is one.
    pub fn with_env(&self, env: Option<PathBuf>) -> StudioArguments {
        StudioArguments { env: env.or(self.env.clone()), ..self.clone() }
    }

    /// The surroundings if they are a picture.
    pub fn picture_around(&self) -> Option<&Path> {
        self.env.as_deref().filter(|env| bilux::presets::surroundings_named(env).is_none())
    }

    /// The background if it is a picture instead of a colour.
    pub fn picture_behind(&self) -> Option<&Path> {
        let is_setting = |text: &str| Background::parse(text).is_some() || text.starts_with('#');
        self.settings.text("background").filter(|text| !is_setting(text)).map(Path::new)
    }

    /// Refuses a background that is neither a setting nor the name of a picture, and changes that cannot be read.
    pub fn check(&self) -> anyhow::Result<()> {
        let is_picture =
            |path: &&Path| path.exists() || bilux::pictures::format_named(extension(path)).is_some();
        if let Some(text) = self.picture_behind().filter(|path| !is_picture(path)) {
            bail!(
                "--background {}: write transparent, a colour (white, '#rrggbb', or R,G,B from 0 to 1), or the file of a picture",
                text.display()
            );
        }
        if self.layer.is_some() && self.picture_behind().is_none() && self.picture_around().is_none() {
            bail!("--layer is of the picture of --env or --background: name one, or leave it out");
        }
        self.change.iter().try_for_each(|change| change_of(change).map(drop))
    }

    /// Checks, before any work, that the pictures that options name can be opened.
    pub fn check_files(&self) -> anyhow::Result<()> {
        for (flag, path, what) in [
            ("--env", self.picture_around(), "picture"),
            ("--background", self.picture_behind(), "picture"),
            ("--intrinsics", self.intrinsics.as_deref(), "file"),
        ] {
            if let Some(path) = path {
                if path.is_dir() {
                    bail!("{flag}: {}: this is a folder: name a {what} in it", path.display());
                }
                std::fs::File::open(path)
                    .with_context(|| format!("{flag}: {}: cannot open it", path.display()))?;
            }
        }
        Ok(())
    }
}

/// Lights a scene with what `--env` says.
pub fn surround(env: Option<&Path>, scene: &mut SceneBuilder, options: &ReadOptions) -> anyhow::Result<()> {
    env.map_or(Ok(()), |env| bilux::presets::surround(scene, env, options).context("--env"))
}

fn extension(path: &Path) -> &str {
    path.extension().and_then(|extension| extension.to_str()).unwrap_or_default()
}
