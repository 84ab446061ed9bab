//! Picture files as users have them, tone curves, metrics and denoisers.

mod corpus;
mod damaged_and_turned;
mod denoise;
mod files;
mod hostile;
mod jpeg_scans;
mod metrics;
mod profiles;
mod round_trips;
mod sensor;
mod shared_files;
mod stated_meaning;
mod textures_of_old;
mod tone_maps;
