//! Placement of textures: the texture coordinates of nodes, and what is done to them.

use super::draft::Draft;
use super::network::{Input, constant, input, kind};
use crate::layers::value::Text;
use bilux_import::FormatError;
use bilux_math::glam::{DAffine2, DMat2, DVec2};
use bilux_math::transcendental::sin_cos_f64;
use bilux_scene::texture::UvTransform;

/// The primvar of texture coordinates, and what is done to them.
pub(super) struct Placing {
    pub(super) name: Text,
    pub(super) transform: Option<UvTransform>,
}

/// Nodes in a row that only move texture coordinates.
const MAX_CHAIN: usize = 16;

/// Source of the texture coordinates of a node.
pub(super) fn placing(draft: &mut Draft, node: u32, is_preview: bool) -> Result<Placing, FormatError> {
    let stage = draft.stage;
    let mut name: Text = "st".into();
    let mut whole = if is_preview { DAffine2::IDENTITY } else { tiles(draft, node)? };
    let key = if is_preview { "st" } else { "texcoord" };
    let mut next = input(stage, node, key, &mut draft.reading.budget)?;
    for _ in 0..MAX_CHAIN {
        let Input::Node(node, _) = next else { break };
        let budget = &mut draft.reading.budget;
        let id = kind(stage, node, budget)?;
        let id = id.strip_prefix("ND_").unwrap_or(&id).to_owned();
        for key in ["varname", "geomprop"] {
            let found = constant(stage, node, key, budget)?;
            if let Some(found) = found.as_ref().and_then(|found| found.value.text()) {
                name = found.clone();
            }
        }
        if id.starts_with("texcoord") {
            let index = constant(stage, node, "index", budget)?.and_then(|found| found.value.number());
            if index.is_some_and(|index| index >= 1.0) {
                name = format!("st{}", index.unwrap_or(1.0)).into();
            }
        }
        let own = own(draft, node, &id)?;
        whole = own.map_or(whole, |own| whole * own);
        let budget = &mut draft.reading.budget;
        next = Input::Nothing;
        for key in ["in", "texcoord", "in1", "in2"] {
            if !matches!(next, Input::Node(..)) {
                next = input(stage, node, key, budget)?;
            }
        }
    }
    let transform = (whole != DAffine2::IDENTITY && whole.is_finite()).then(|| downwards(whole));
    Ok(Placing { name, transform })
}

/// Texture coordinates with v upwards, as ours with v downwards.
fn downwards(whole: DAffine2) -> UvTransform {
    let [a, c, b, d] = whole.matrix2.to_cols_array();
    let [x, y] = whole.translation.to_array();
    UvTransform::from_array([a, -c, -b, d, b + x, 1.0 - d - y].map(|x| x as f32))
}

/// Two numbers of a node, or one for both.
fn pair(draft: &mut Draft, node: u32, name: &str, unstated: f64) -> Result<DVec2, FormatError> {
    let found = constant(draft.stage, node, name, &mut draft.reading.budget)?;
    let found = found.and_then(|found| {
        found.value.tuple::<2>().map(DVec2::from).or_else(|| found.value.number().map(DVec2::splat))
    });
    Ok(found.filter(|pair| pair.is_finite()).unwrap_or(DVec2::splat(unstated)))
}

fn number(draft: &mut Draft, node: u32, name: &str) -> Result<f64, FormatError> {
    let found = constant(draft.stage, node, name, &mut draft.reading.budget)?;
    Ok(found.and_then(|found| found.value.number()).filter(|x| x.is_finite()).unwrap_or(0.0))
}

/// The tiles of a node `tiledimage`. [MaterialX: tiledimage]
fn tiles(draft: &mut Draft, node: u32) -> Result<DAffine2, FormatError> {
    let (tiling, offset) = (pair(draft, node, "uvtiling", 1.0)?, pair(draft, node, "uvoffset", 0.0)?);
    let real = [pair(draft, node, "realworldimagesize", 1.0)?, pair(draft, node, "realworldtilesize", 1.0)?];
    let size = DAffine2::from_scale(inverse(real[0]) * real[1]);
    Ok(size * DAffine2::from_translation(-offset) * DAffine2::from_scale(tiling))
}

fn inverse(pair: DVec2) -> DVec2 {
    DVec2::select(pair.cmpeq(DVec2::ZERO), DVec2::ONE, pair.recip())
}

/// Counter-clockwise.
fn turn(degrees: f64) -> DAffine2 {
    let (sin, cos) = sin_cos_f64(degrees.to_radians());
    DAffine2::from_mat2(DMat2::from_cols_array(&[cos, sin, -sin, cos]))
}

/// Transform that a node applies to texture coordinates; `None` if none that is known.
fn own(draft: &mut Draft, node: u32, id: &str) -> Result<Option<DAffine2>, FormatError> {
    if id.starts_with("UsdTransform2d") {
        // Scaled, turned and moved. [UsdPreviewSurface]
        let (scale, by) = (pair(draft, node, "scale", 1.0)?, pair(draft, node, "translation", 0.0)?);
        let turn = turn(number(draft, node, "rotation")?);
        return Ok(Some(DAffine2::from_translation(by) * turn * DAffine2::from_scale(scale)));
    }
    if id.starts_with("place2d") {
        // About a pivot: the picture is scaled, turned and moved, so the coordinates the other way around. [MaterialX: place2d]
        let pivot = pair(draft, node, "pivot", 0.0)?;
        let scale = DAffine2::from_scale(inverse(pair(draft, node, "scale", 1.0)?));
        let turn = turn(-number(draft, node, "rotate")?);
        let by = DAffine2::from_translation(-pair(draft, node, "offset", 0.0)?);
        let is_moved_first = number(draft, node, "operationorder")? == 1.0;
        let inner = if is_moved_first { scale * turn * by } else { by * turn * scale };
        return Ok(Some(DAffine2::from_translation(pivot) * inner * DAffine2::from_translation(-pivot)));
    }
    if id.starts_with("rotate2d") {
        return Ok(Some(turn(-number(draft, node, "amount")?)));
    }
    for (start, is_factor) in [("multiply_", true), ("divide_", true), ("add_", false), ("subtract_", false)]
    {
        if id.starts_with(start) {
            let unstated = if is_factor { 1.0 } else { 0.0 };
            let (a, b) = (pair(draft, node, "in1", unstated)?, pair(draft, node, "in2", unstated)?);
            return Ok(Some(match start {
                "multiply_" => DAffine2::from_scale(a * b),
                "divide_" => DAffine2::from_scale(inverse(b)),
                "add_" => DAffine2::from_translation(a + b),
                _ => DAffine2::from_translation(-b),
            }));
        }
    }
    Ok(None)
}
