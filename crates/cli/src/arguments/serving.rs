//! The options of `bilux serve`.

use crate::arguments::choices::Choices;
use crate::arguments::help;
use crate::arguments::studio::StudioArguments;
use clap::Args;
use std::net::IpAddr;
use std::path::PathBuf;

/// Watch a scene in the browser while it renders
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    bilux serve model.glb                        Open the address that it prints; Ctrl-C ends it\n  \
    bilux serve scene.toml --port 8000 --edit    Also change materials, lights and cameras\n  \
    bilux serve model.glb --listen 0.0.0.0       Let anyone watch who has the full address\n  \
    ssh -L 8000:localhost:8000 server bilux serve model.glb --port 8000")]
pub struct Serve {
    /// The scene file (`bilux list formats`)
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The port to listen on; 0 picks a free one
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true, help_heading = help::COMMON_OPTIONS)]
    pub port: u16,
    /// The address to listen on; if other machines can reach it, the printed address contains a secret token
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1", help_heading = help::COMMON_OPTIONS)]
    pub listen: IpAddr,
    /// Show all visitors the same view, which each of them may move; by default each has a view of their own
    #[arg(long, help_heading = help::COMMON_OPTIONS)]
    pub shared: bool,
    /// The maximum number of visitors at the same time [default: 24; with --shared 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), help_heading = help::COMMON_OPTIONS)]
    pub visitors: Option<u32>,
    /// Let viewers change materials, lights and cameras, and drop in other files; the scene file is not modified
    #[arg(long, help_heading = help::COMMON_OPTIONS)]
    pub edit: bool,
    #[command(flatten)]
    pub studio: StudioArguments,
    /// Change any setting of the picture (`bilux list settings`)
    #[arg(long = "set", value_name = "KEY=VALUE", help_heading = help::PICTURE)]
    pub set: Vec<String>,
    #[command(flatten)]
    pub choices: Choices,
}
