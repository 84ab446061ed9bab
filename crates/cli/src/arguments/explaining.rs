//! The options of `bilux explain`.

use crate::arguments::choices::Posed;
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
    pub posed: Posed,
}
