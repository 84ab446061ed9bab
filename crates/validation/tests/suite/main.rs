//! Contracts of all variants in the tables, and pictures whose answers are known.

mod agreement;
mod analytic;
mod bsdf_contract;
mod camera_contract;
mod convergence;
mod course;
mod formats_agree;
mod light_contract;
mod pbrt_scenes;
mod phase_contract;
mod principled_contract;
mod shared_scenes;
mod vertex_looks;
