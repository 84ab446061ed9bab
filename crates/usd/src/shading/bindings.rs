//! Which material a prim has.

use crate::layers::value::{Text, Value};
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;

/// The kinds of bindings that a picture uses, each before those that follow it: one for a preview is better than none.
const PURPOSES: [&str; 3] = ["material:binding:full", "material:binding", "material:binding:preview"];

/// The material of a prim, given the prims above it from the root on: the nearest binding, unless one further up says that it is
/// stronger.
pub(crate) fn bound(stage: &Stage, prim: u32, above: &[u32]) -> Option<u32> {
    PURPOSES.iter().find_map(|purpose| {
        let mut found = None;
        for at in std::iter::once(&prim).chain(above.iter().rev()) {
            let Some((path, is_stronger)) = at_prim(stage, *at, prim, purpose) else { continue };
            if found.is_none() || is_stronger {
                found = Some(path);
            }
        }
        stage.named(&found?)
    })
}

/// Material that the prim `at` binds `prim` to, by a collection that `prim` is in, or by itself; and whether it is
/// stronger than the bindings of prims below.
fn at_prim(stage: &Stage, at: u32, prim: u32, purpose: &str) -> Option<(Text, bool)> {
    let strength = |name: &str| {
        let strength = stage.metadata(at, name, "bindMaterialAs");
        strength.as_ref().and_then(Value::text).is_some_and(|text| &**text == "strongerThanDescendants")
    };
    let prefix = format!("{purpose}:collection:");
    for name in stage.names(at, &prefix) {
        // Other purposes are further names in front of the last one.
        if name[prefix.len()..].contains(':') {
            continue;
        }
        let targets = stage.targets(at, &name);
        if let [collection, material] = &targets[..]
            && is_in(stage, collection, &stage.prim(prim).path)
        {
            return Some((material.clone(), strength(&name)));
        }
    }
    let target = stage.targets(at, purpose).into_iter().next()?;
    Some((target, strength(purpose)))
}

/// True if a collection has a path: the nearest of those that it includes and excludes decides.
fn is_in(stage: &Stage, collection: &str, path: &str) -> bool {
    let Some((owner, name)) = collection.split_once('.') else { return false };
    let Some(owner) = stage.named(owner) else { return false };
    let nearest = |list: &str| {
        let targets = stage.targets(owner, &format!("{name}:{list}"));
        let around = targets.iter().filter(|root| {
            path.strip_prefix(&***root).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        });
        around.map(|root| root.len()).max()
    };
    match (nearest("includes"), nearest("excludes")) {
        (Some(includes), Some(excludes)) => includes > excludes,
        (includes, _) => includes.is_some(),
    }
}

/// The faces of a prim `GeomSubset`; `None` if it is for something else than a material.
pub(crate) fn subset_faces(
    stage: &Stage,
    prim: u32,
    budget: &mut Budget,
) -> Result<Option<Vec<u32>>, FormatError> {
    if &*stage.prim(prim).type_name != "GeomSubset" {
        return Ok(None);
    }
    let kind = stage.text(prim, "elementType", budget)?;
    if kind.is_some_and(|kind| &*kind != "face") {
        return Ok(None);
    }
    let Some(indices) = stage.array(prim, "indices", budget)? else { return Ok(None) };
    Ok(Some((0..indices.len()).map(|i| indices.numbers.at(i) as u32).collect()))
}
