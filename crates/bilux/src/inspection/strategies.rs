//! All the strategies' pictures on one contact sheet: a pyramid with a row for each path length.
//! [Veach 1997, fig. 10.3]

use crate::Error;
use bilux_math::Rgb;
use bilux_pictures::{Picture, downscaled, label, side_by_side, stacked};
use bilux_transport::{Strategies, StrategyPicture};

/// The approximate width of a picture on the sheet, in pixels.
const PANEL: usize = 160;

/// The gap between two pictures, in pixels.
const GAP: usize = 4;

/// The height of a line of text, in pixels.
const LINE: usize = 12;

/// The maximum number of stops by which a row is brightened.
const MAX_STOPS: u32 = 30;

/// Which version of the strategies' light to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// Weighted by MIS: the sum over all strategies is the picture.
    Weighted,
    /// Everything that each strategy finds on its own.
    Unweighted,
}

impl Light {
    /// Both versions.
    pub const BOTH: [Light; 2] = [Light::Weighted, Light::Unweighted];

    /// The suffix of a strategy's file, and the name of the sheet.
    pub fn name(self) -> &'static str {
        match self {
            Light::Weighted => "weighted",
            Light::Unweighted => "unweighted",
        }
    }

    /// The pixels of a strategy's picture.
    pub fn of(self, picture: &StrategyPicture) -> &[Rgb] {
        match self {
            Light::Weighted => &picture.weighted,
            Light::Unweighted => &picture.unweighted,
        }
    }
}

/// A strategy's picture, in linear light.
///
/// # Errors
/// If memory is short.
pub fn picture(strategies: &Strategies, one: &StrategyPicture, light: Light) -> Result<Picture, Error> {
    let (width, height) = (strategies.window.width as usize, strategies.window.height as usize);
    Ok(Picture::from_rgb(width, height, light.of(one).to_vec())?)
}

/// Makes a sheet in linear light: a row for each path length, the shortest on top, with all strategies from s = 0 on;
/// strategies that merge vertices come after those that connect them. Rows of long paths are brightened by whole stops,
/// as written at their left end, so that all rows are about as bright as the row of direct light.
///
/// # Errors
/// If there is nothing to show, or memory is short.
pub fn sheet(strategies: &Strategies, light: Light) -> Result<Picture, Error> {
    let rows: Vec<&[StrategyPicture]> =
        strategies.pictures.chunk_by(|a, b| a.strategy.edges == b.strategy.edges).collect();
    let brightness: Vec<f64> = rows.iter().map(|row| row_brightness(row, light)).collect();
    // The row of direct light. The row of directly visible lights is too bright, and may be missing.
    let first = rows.iter().position(|row| row[0].strategy.edges > 1);
    let standard = first.map_or(0.0, |first| brightness[first]);
    let mut lines = Vec::new();
    for (row, brightness) in rows.iter().zip(brightness) {
        let stops = if row[0].strategy.edges > 2 { stops(standard / brightness) } else { 0 };
        lines.push(row_of_panels(strategies, row, light, stops)?);
    }
    let width = lines.iter().map(Picture::width).max().unwrap_or(0);
    for line in &mut lines {
        // A pyramid: each row is centred.
        *line = beside(line, (width - line.width()) / 2)?;
    }
    if lines.is_empty() {
        return Err(Error::Settings("no strategy found any light".to_owned()));
    }
    Ok(stacked(&lines, GAP)?)
}

fn row_of_panels(
    strategies: &Strategies,
    row: &[StrategyPicture],
    light: Light,
    stops: u32,
) -> Result<Picture, Error> {
    let mut shown = Vec::new();
    for one in row {
        let mut words = one.strategy.to_string();
        if one.strategy == row[0].strategy && stops != 0 {
            words += &format!("  +{stops} EV");
        }
        let factor = (1u32 << stops) as f32;
        let pixels = light.of(one).iter().map(|&pixel| pixel * factor).collect();
        let whole =
            Picture::from_rgb(strategies.window.width as usize, strategies.window.height as usize, pixels)?;
        let factor = (whole.width() / PANEL).max(1);
        let small = downscaled(&whole, factor)?;
        let mut ground = Picture::from_rgb(small.width(), LINE, vec![Rgb::BLACK; small.width() * LINE])?;
        label(&mut ground, 0, 0, &words, 1);
        shown.push(stacked(&[ground, small], 0)?);
    }
    Ok(side_by_side(&shown, GAP)?)
}

/// Adds `left` columns of black pixels to the left of a picture.
fn beside(picture: &Picture, left: usize) -> Result<Picture, Error> {
    if left == 0 {
        return Ok(picture.clone());
    }
    let black = Picture::from_rgb(left, 1, vec![Rgb::BLACK; left])?;
    Ok(side_by_side(&[black, picture.clone()], 0)?)
}

/// The mean light of all pictures together.
fn row_brightness(row: &[StrategyPicture], light: Light) -> f64 {
    let all = row.iter().flat_map(|one| light.of(one)).filter(|pixel| pixel.is_finite());
    all.map(|pixel| f64::from(pixel.luminance())).sum::<f64>() / row.len() as f64
}

/// The number of stops by which to brighten for this ratio, rounded.
fn stops(ratio: f64) -> u32 {
    let is_below =
        |&stops: &u32| ratio.is_finite() && ratio > f64::from(1u32 << stops) * std::f64::consts::SQRT_2;
    (0..MAX_STOPS).take_while(is_below).count() as u32
}
