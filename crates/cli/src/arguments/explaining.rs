//! The options of `bilux explain`.

use crate::arguments::choices::Choices;
use crate::arguments::help;
use crate::arguments::studio::StudioArguments;
use clap::Args;
use std::path::PathBuf;

/// Explain why a scene is slow or noisy, what `auto` chooses for it, and what would help
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux explain scene.toml\n  \
    bilux explain model.glb --json\n  \
    bilux explain scene.toml --set camera=1")]
pub struct Explain {
    /// The scene file (`bilux list formats`); `-` reads it from standard input
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Print JSON instead of text
    #[arg(long, help_heading = help::OUTPUT)]
    pub json: bool,
    /// Change any setting of the picture (`bilux list settings`)
    #[arg(long = "set", value_name = "KEY=VALUE", help_heading = help::PICTURE)]
    pub set: Vec<String>,
    #[command(flatten)]
    pub studio: StudioArguments,
    #[command(flatten)]
    pub choices: Choices,
    /// The format of the scene on standard input; auto detects it from the first bytes
    #[arg(long, value_name = "NAME|auto", default_value = "auto", help_heading = help::WHAT)]
    pub input_format: String,
}
