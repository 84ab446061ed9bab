//! Light, by closed forms, by agreement between integrators, and bit by bit.

mod absorption;
mod auto;
mod both_ends;
mod checkpoint;
mod classic_modes;
mod common;
mod dispersion;
mod features;
mod footprint;
mod holes;
mod interval;
mod known_mistakes;
mod light_parts;
mod many_lights;
mod nested;
mod occlusion;
mod one_picture;
mod path_tracing;
mod queue;
mod random_numbers;
mod sides;
mod stop;
mod strategies;
mod strokes;
mod visible;
mod work;
