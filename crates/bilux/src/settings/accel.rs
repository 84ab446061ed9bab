//! The acceleration structure and its options.

use crate::Error;
use bilux_accel::registry::{BspGroup, BspSplit, Quality};
use bilux_accel::{CpuLevel, Culling, Query};
use bilux_scene::{AccelChoice, Reader, SceneError};

pub(super) fn accel_choice(reader: &Reader) -> Result<AccelChoice, Error> {
    let name = reader.text("accel");
    let names = || bilux_accel::ACCELERATORS.iter().map(|row| row.entry.name).chain(["auto"]);
    if !names().any(|n| n == name) {
        return Err(SceneError::unknown("accelerator", &name, names(), reader.span("accel")).into());
    }
    let mut choice = AccelChoice { name, ..AccelChoice::default() };
    choice.options.bsp_split =
        if reader.text("bsp_split") == "fuchs" { BspSplit::Fuchs } else { BspSplit::Mean };
    choice.options.bsp_group =
        if reader.text("bsp_group") == "objects" { BspGroup::Objects } else { BspGroup::Polygons };
    // `auto` is not a quality: it starts from the default.
    choice.options.quality = Quality::from_name(&reader.text("build")).unwrap_or_default();
    let wanted = CpuLevel::ALL.into_iter().find(|level| level.name() == reader.text("cpu"));
    choice.options.cpu_level = wanted.unwrap_or_default();
    choice.query = Query {
        culling: if reader.text("culling") == "back" { Culling::Back } else { Culling::None },
        early_out: reader.bool("early_out"),
        cull_by_partition: reader.bool("cull_by_partition"),
        filter: None,
    };
    Ok(choice)
}
