//! The options of `bilux serve`.

use crate::choices::Choices;
use crate::help;
use crate::studio::StudioArguments;
use clap::Args;
use std::net::IpAddr;
use std::path::PathBuf;

/// Watch a scene in the browser while it is rendered
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux serve model.glb                        Watch it at the address that is printed; Ctrl-C ends it\n  \
    bilux serve scene.toml --port 8000 --edit    Change materials, lights and cameras too\n  \
    bilux serve model.glb --listen 0.0.0.0       Let other machines watch, who know the whole address\n  \
    ssh -L 8000:localhost:8000 server bilux serve model.glb --port 8000")]
pub struct Serve {
    /// The scene file (`bilux list formats`)
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The port to listen on; 0 chooses one that is free
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true, help_heading = help::COMMON_OPTIONS)]
    pub port: u16,
    /// The address to listen on; anywhere but on this machine alone, the address that is printed has a secret in it
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1", help_heading = help::COMMON_OPTIONS)]
    pub listen: IpAddr,
    /// Let those who watch change materials, lights and cameras, and drop other files in; the scene file stays as it is
    #[arg(long, help_heading = help::COMMON_OPTIONS)]
    pub edit: bool,
    /// The time to show, in seconds, for animated scenes [default: 0]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = crate::values::parse_time, help_heading = help::WHAT)]
    pub at: Option<f32>,
    /// Change any setting of the picture (`bilux list settings`)
    #[arg(long = "set", value_name = "KEY=VALUE", help_heading = help::PICTURE)]
    pub set: Vec<String>,
    #[command(flatten)]
    pub studio: StudioArguments,
    #[command(flatten)]
    pub choices: Choices,
}
