//! Scene files as users have them: real ones, broken ones, and round trips.

#![allow(clippy::print_stdout, reason = "tests say what they skip")]

mod archives;
mod asc;
mod bounded;
mod calibrations;
mod clouds;
mod colours;
mod dae;
mod displacement;
mod fbx;
mod fbx_truth;
mod foreign;
mod frames;
mod gltf;
mod gltf_choices;
mod gltf_conventions;
mod gltf_files;
mod gltf_motion;
mod gltf_nodes;
#[cfg(all(feature = "draco", feature = "ktx2"))]
mod gltf_packed;
mod gltf_scattering;
mod gltf_validated;
mod gltf_written;
mod grids;
mod grids_in_scenes;
mod hostile;
mod instances;
mod left_out;
mod left_unread;
mod luminaires;
mod materials_of_exporters;
mod messages;
mod mitsuba;
mod mitsuba_written;
mod native;
mod obj;
mod off;
mod oracles;
mod overlay;
mod packages;
mod patterns;
mod pbrt;
mod pbrt_written;
mod ply;
mod ply_types;
mod public_reports;
mod radiance;
mod round_trips;
mod schema;
mod shared_files;
mod step;
mod step_truth;
mod stl;
mod subdivision;
mod threemf;
mod threemf_written;
mod tolerance;
mod usd;
mod usd_clips;
mod usd_instancers;
mod usd_materialx;
mod usd_skeletons;
mod usd_textures;
mod usd_truth;
mod usd_volumes;
mod usd_written;
mod witness;
mod wrong_files;

use bilux_formats::{FormatError, ReadOptions, read_bytes};
use bilux_scene::SceneBuilder;

/// Reads a text without a folder.
fn read_text(format: &str, text: impl AsRef<[u8]>) -> Result<SceneBuilder, FormatError> {
    read_bytes(text.as_ref(), format, None, &format!("scene.{format}"), &ReadOptions::default())
}

/// The message of an error.
#[track_caller]
fn refusal(format: &str, text: impl AsRef<[u8]>) -> String {
    read_text(format, text).expect_err("this should be refused").to_string()
}

/// The warnings, one per line.
fn warnings(scene: &SceneBuilder) -> String {
    scene.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}
