//! A pair of pictures, how they differ, and whether that is within bounds.

use crate::arguments::{Common, Compare};
use crate::commands::shared::pictures::{read_picture, with_main};
use crate::process::output;
use bilux::pictures::metrics::{HeatMap, Pair, Report, heat_map};
use bilux::pictures::{Limits, Picture, TONEMAPS};
use serde_json::Value;
use std::path::Path;

/// The exit status when a bound is exceeded.
pub(super) const BEYOND: u8 = 1;
/// The exit status when there is no answer.
pub(super) const TROUBLE: u8 = 2;

/// Two pictures, and how they differ.
pub(super) struct Compared {
    /// The name that people call them by.
    pub(super) name: String,
    pub(super) picture: Picture,
    pub(super) reference: Picture,
    pub(super) report: Report,
}

impl Compared {
    /// Reads and compares them; warns of samples that are not finite.
    pub(super) fn of(
        name: &str,
        paths: [&Path; 2],
        layer: Option<&str>,
        common: &Common,
    ) -> anyhow::Result<Compared> {
        let [picture, reference] = read_pair(paths, layer, common)?;
        let report = bilux::pictures::compare(&picture, &reference)?;
        if report.non_finite != [0, 0] {
            let ([a, b], of) = (report.non_finite, if name.is_empty() { "" } else { ": " });
            output::warning(format_args!(
                "{name}{of}{a} samples of the picture and {b} of the reference are not finite"
            ));
        }
        Ok(Compared { name: name.to_owned(), picture, reference, report })
    }

    /// Map of where they differ.
    pub(super) fn heat_map(&self) -> anyhow::Result<Picture> {
        let pair = Pair::new(&self.picture, &self.reference, 0.0, &TONEMAPS[0])?;
        Ok(heat_map(&pair, HeatMap::Flip)?)
    }
}

/// Reads two pictures: of two crops only these, but as the picture that a crop belongs to if the other one is that.
fn read_pair(paths: [&Path; 2], layer: Option<&str>, common: &Common) -> anyhow::Result<[Picture; 2]> {
    // Two pictures are read at a time.
    let limits = Limits::new(common.max_memory / 2);
    let read = |path: &Path| {
        let picture = read_picture(path, &limits, common)?;
        with_main(picture, layer, path, common)
    };
    let (a, b) = (read(paths[0])?, read(paths[1])?);
    if [a.width(), a.height()] == [b.width(), b.height()]
        && (a.crop == b.crop || a.crop.is_none() || b.crop.is_none())
    {
        return Ok([a, b]);
    }
    let whole = |path: &Path| anyhow::Ok(bilux::pictures::read_with(path, &limits)?.with_main(layer)?);
    Ok([whole(paths[0])?, whole(paths[1])?])
}

/// The values of the metrics.
pub(super) fn as_json(report: &Report) -> Value {
    let values = report.values.iter().map(|(name, _)| ((*name).to_owned(), report.finite(name).into()));
    Value::Object(values.collect())
}

/// Every bound that does not hold; NaN satisfies no bound.
pub(super) fn broken_bounds(arguments: &Compare, report: &Report) -> Vec<String> {
    let most = [
        ("flip", arguments.max_flip),
        ("rmse", arguments.max_rmse),
        ("relmse", arguments.max_relmse),
        ("max", arguments.max_error),
    ];
    let least = [("ssim", arguments.min_ssim), ("psnr", arguments.min_psnr)];
    let value = |name| report.value(name).unwrap_or(f64::NAN);
    let above = most.iter().filter_map(|&(name, bound)| {
        let (value, bound) = (value(name), bound?);
        let holds = value <= bound;
        (!holds).then(|| format!("{name} is {value}, more than {bound}"))
    });
    let below = least.iter().filter_map(|&(name, bound)| {
        let (value, bound) = (value(name), bound?);
        let holds = value >= bound;
        (!holds).then(|| format!("{name} is {value}, less than {bound}"))
    });
    above.chain(below).collect()
}
