//! Kind of thing that a prim is. [OpenUSD, UsdSemanticsLabelsAPI]

use crate::layers::value::{Text, Value};
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;

/// The attributes with labels, before the name of their taxonomy.
const PREFIX: &str = "semantics:labels:";

/// The first label of a prim: of the taxonomy `category`, or else of the first one by name.
pub(crate) fn category(stage: &Stage, prim: u32, budget: &mut Budget) -> Result<Option<Text>, FormatError> {
    let mut names = stage.names(prim, PREFIX);
    names.sort_by_key(|name| (&name[PREFIX.len()..] != "category", name.clone()));
    for name in names {
        let labels = stage.value(prim, &name, budget)?.as_ref().and_then(Value::texts);
        if let Some(label) = labels.and_then(|labels| labels.first().cloned()) {
            return Ok(Some(label));
        }
    }
    Ok(None)
}
