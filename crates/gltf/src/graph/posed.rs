//! A document as it is shown at one time.

use crate::document::data::DataReader;
use crate::document::json_document::Document;
use crate::graph::animation::Pose;
use crate::graph::nodes::Graph;
use crate::materials::variants::Variants;
use bilux_import::input::reading::Reading;
use bilux_import::{FormatError, input::diagnostics::Diagnostics};

/// Parts of a document that are read before anything is placed.
pub(crate) struct Posed<'d> {
    pub(crate) document: &'d Document<'d>,
    pub(crate) variants: Variants,
    pub(crate) pose: Pose,
    pub(crate) graph: Graph<'d>,
}

impl<'d> Posed<'d> {
    /// The document at a time in seconds, with the variant and the animation that the options name.
    pub(crate) fn read(
        document: &'d Document<'d>,
        time: f32,
        reading: &mut Reading,
        diagnostics: &mut Diagnostics,
    ) -> Result<Posed<'d>, FormatError> {
        let options = reading.options;
        let variants = Variants::read(document.root, options.variant.as_deref())?;
        let mut data = DataReader::new(document, &mut reading.budget, diagnostics);
        let pose = Pose::read(time, options.animation.as_deref(), &mut data)?;
        let graph = Graph::read(&pose, reading.origin, &mut data)?;
        Ok(Posed { document, variants, pose, graph })
    }
}
