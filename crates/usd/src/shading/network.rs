//! Shaders and what is connected to them.

use super::arnold;
use crate::layers::value::Text;
use crate::stage::{Found, Stage};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;

/// Source of an input of a shader.
#[derive(Clone, Debug)]
pub(super) enum Input {
    Nothing,
    Value(Found),
    /// An output of another shader.
    Node(u32, Text),
}

/// Longer chains of connections are circles.
const MAX_CHAIN: usize = 32;

/// Source of an attribute, through the connections of node graphs.
pub(super) fn resolve(
    stage: &Stage,
    prim: u32,
    name: &str,
    budget: &mut Budget,
) -> Result<Input, FormatError> {
    let (mut prim, mut name) = (prim, Text::from(name));
    for _ in 0..MAX_CHAIN {
        let target = stage.targets(prim, &name).into_iter().next();
        let Some(target) = target else {
            return Ok(stage.found(prim, &name, budget)?.map_or(Input::Nothing, Input::Value));
        };
        let Some((path, property)) = target.split_once('.') else { return Ok(Input::Nothing) };
        let Some(next) = stage.named(path) else { return Ok(Input::Nothing) };
        if &*stage.prim(next).type_name == "Shader"
            && let Some(output) = property.strip_prefix("outputs:")
        {
            return Ok(Input::Node(next, output.into()));
        }
        (prim, name) = (next, property.into());
    }
    Ok(Input::Nothing)
}

/// Source of the input of a shader; `name` is what MaterialX calls it.
pub(super) fn input(
    stage: &Stage,
    shader: u32,
    name: &str,
    budget: &mut Budget,
) -> Result<Input, FormatError> {
    let found = resolve(stage, shader, &format!("inputs:{name}"), budget)?;
    let of_arnold = arnold::input(name).filter(|_| matches!(found, Input::Nothing));
    let Some(other) = of_arnold else { return Ok(found) };
    match stage.text(shader, "info:id", budget)?.is_some_and(|id| id.starts_with(arnold::PREFIX)) {
        true => resolve(stage, shader, &format!("inputs:{other}"), budget),
        false => Ok(found),
    }
}

/// A number or text of the input of a shader that no other shader gives.
pub(super) fn constant(
    stage: &Stage,
    shader: u32,
    name: &str,
    budget: &mut Budget,
) -> Result<Option<Found>, FormatError> {
    Ok(match input(stage, shader, name, budget)? {
        Input::Value(found) => Some(found),
        _ => None,
    })
}

/// The kind of a shader, such as `UsdUVTexture`, by its name in MaterialX if it has one; empty if it is of another kind than those
/// with an identifier.
pub(super) fn kind(stage: &Stage, shader: u32, budget: &mut Budget) -> Result<String, FormatError> {
    let id = stage.text(shader, "info:id", budget)?;
    Ok(id.map_or_else(String::new, |id| arnold::node(&id).map_or_else(|| id.to_string(), str::to_owned)))
}
