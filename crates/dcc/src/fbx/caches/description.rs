//! Description of a Maya cache, in an XML file.

use bilux_import::FormatError;
use bilux_import::bytes::xml::Xml;
use bilux_import::input::reading::Reading;
use bilux_scene::Span;
use std::path::Path;
use std::sync::Arc;

/// The files of a cache, and its channels.
pub(super) struct Description {
    /// True if all frames are in one file.
    pub(super) is_one_file: bool,
    /// The extension of the other files.
    pub(super) extension: &'static str,
    /// Units of time per frame, of which there are 6000 in a second.
    pub(super) per_frame: i64,
    pub(super) channels: Vec<Channel>,
}

/// Vectors of one mesh over time.
pub(super) struct Channel {
    pub(super) name: String,
    pub(super) is_normals: bool,
    /// When it begins and ends, and the time between its samples, in units of time.
    pub(super) start: i64,
    pub(super) end: i64,
    pub(super) step: i64,
}

impl Description {
    pub(super) fn read(path: &Path, at: &Span, reading: &mut Reading) -> Result<Description, FormatError> {
        let bytes = reading.load_text(path)?;
        let name: Arc<str> = path.file_name().unwrap_or_default().to_string_lossy().into();
        let fail = |what: &str| FormatError::malformed(format!("'{name}' {what}"), at.clone());
        let text =
            std::str::from_utf8(&bytes).map_err(|_| fail("is neither PC2 nor the XML file of a cache"))?;
        let spent = reading.budget.spent();
        let xml = Xml::parse(text, &name, &mut reading.budget).map_err(|error| match error {
            FormatError::TooLarge { .. } => error,
            error => fail(&format!("cannot be read: {}", error.without_place())),
        })?;
        let root = xml.root();
        if root.tag_name().name() != "Autodesk_Cache_File" {
            return Err(fail("is not the description of a cache (Autodesk_Cache_File)"));
        }
        let child = |name: &str| root.children().find(|child| child.tag_name().name() == name);
        let kind = |name: &str| child("cacheType").and_then(|kind| kind.attribute(name)).unwrap_or_default();
        let per_frame =
            child("cacheTimePerFrame").and_then(|time| time.attribute("TimePerFrame")?.parse().ok());
        let per_frame: i64 = per_frame.filter(|&ticks| ticks > 0).unwrap_or(250);
        let range = child("time").and_then(|time| time.attribute("Range")?.split_once('-'));
        let range = range.and_then(|(start, end)| Some((start.parse().ok()?, end.parse().ok()?)));
        let (first, last): (i64, i64) = range.unwrap_or((0, 0));
        let channels = child("Channels").into_iter().flat_map(|list| list.children());
        let channel = |node: roxmltree::Node| {
            let number = |name: &str| node.attribute(name)?.parse::<i64>().ok();
            Some(Channel {
                name: node.attribute("ChannelName")?.to_owned(),
                is_normals: node.attribute("ChannelInterpretation") == Some("normals"),
                start: number("StartTime").unwrap_or(first),
                end: number("EndTime").unwrap_or(last),
                step: number("SamplingRate").filter(|&step| step > 0).unwrap_or(per_frame),
            })
        };
        let channels = channels.filter_map(channel).collect();
        let described = Description {
            is_one_file: kind("Type") != "OneFilePerFrame",
            extension: if kind("Format") == "mcx" { "mcx" } else { "mc" },
            per_frame,
            channels,
        };
        reading.budget.release(reading.budget.spent() - spent);
        drop(xml);
        reading.release(bytes);
        Ok(described)
    }
}
