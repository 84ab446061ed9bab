//! The program `bilux` as people and farms run it.

mod bad_input;
mod command_line;
mod denoising;
mod farm;
mod hang_up;
mod layers;
mod manual;
mod output;
mod overwriting;
mod pairs;
mod picture_layers;
mod resume;
mod sensors;
mod serve;
mod servers;
mod strangers;
mod streams;
mod witness;
mod worker;
mod wrong_inputs;
