//! Scenes, from what describes them to what rays meet.

mod cameras;
mod conventions;
mod generators;
mod irradiance;
mod normal_maps;
mod orientation;
mod presets;
mod principled;
mod rebuilding;
mod scene;
mod strokes;
mod typed;
