//! Scenes, from what describes them to what rays meet.

mod cameras;
mod conventions;
mod irradiance;
mod normal_maps;
mod orientation;
mod presets;
mod principled;
mod rebuilding;
mod scene;
mod shapes;
mod strokes;
mod typed;
