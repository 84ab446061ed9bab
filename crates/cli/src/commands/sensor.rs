//! `bilux sensor`: what the sensor of a camera reads of a picture's light.

use crate::arguments::values::Exposure;
use crate::arguments::{Common, Sensor};
use crate::commands::DONE;
use crate::commands::shared::checks::check_folder;
use crate::commands::shared::checks::check_not_input;
use crate::commands::shared::checks::check_quality;
use crate::commands::shared::checks::warn_lost_alpha;
use crate::commands::shared::pictures::{read_picture, with_main};
use crate::commands::shared::sandbox_paths::SandboxPaths;
use crate::process::output::{counted, eprint};
use crate::process::usage;
use anyhow::Context;
use bilux::pictures::formats::{BitDepth, format_of_path};
use bilux::pictures::{ColourSpace, Limits, Picture, WriteOptions, auto_exposure, tone_map};
use bilux::sensing::{Sensed, Sensing};

pub fn run(arguments: &Sensor, common: &Common) -> anyhow::Result<u8> {
    let (input, output) = (&arguments.input, &arguments.output);
    check_folder(output).map_err(usage::wrong)?;
    check_not_input(output, [&**input]).map_err(usage::wrong)?;
    let format = format_of_path(output).map_err(usage::wrong)?;
    check_quality(arguments.quality, output).map_err(usage::wrong)?;
    let confines = SandboxPaths::default().reading(input).writing(output);
    confines.check_written(output, common).map_err(usage::wrong)?;
    let tone_map = tone_map(&arguments.tonemap).context("--tonemap").map_err(usage::wrong)?;
    let sensing = Sensing::new(&arguments.sensor.0)?;
    confines.enter(common)?;
    let light = read_picture(input, &Limits::new(common.max_memory), common)?;
    let light = with_main(light, arguments.layer.as_deref(), input, common)?;
    let Sensed { mut picture, saturated } = sensing.sensed(&light)?;
    let mut options = WriteOptions { tone_map, ..WriteOptions::default() };
    options.quality = arguments.quality.unwrap_or(options.quality);
    if !sensing.is_raw {
        options.exposure = match arguments.exposure {
            Exposure::Stops(stops) => stops,
            Exposure::Auto => auto_exposure(&picture),
        };
    } else if format.for_display {
        picture = numbers_as_they_are(&picture)?;
        (options.bit_depth, options.tone_map) = (BitDepth::Sixteen, WriteOptions::default().tone_map);
    }
    warn_lost_alpha(&picture, output, None, common)?;
    bilux::pictures::write(output, &picture, &options)?;
    if !common.quiet {
        let full = counted(saturated, "pixel is", "pixels are");
        eprint(format_args!("{}: {}; {full} saturated", output.display(), sensing.summary()));
    }
    Ok(DONE)
}

/// Digital numbers for a file of 16 bits a sample, which then holds them as they are.
fn numbers_as_they_are(raw: &Picture) -> anyhow::Result<Picture> {
    let mut picture = Picture::new(raw.width(), raw.height())?;
    (picture.metadata, picture.colour_space) = (raw.metadata.clone(), ColourSpace::Srgb);
    for plane in raw.channels() {
        let samples = plane.samples.iter().map(|&number| number / f32::from(u16::MAX)).collect();
        picture.push_channel(plane.name.clone(), samples)?;
    }
    Ok(picture)
}
