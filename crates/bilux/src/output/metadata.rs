//! The keys of what pictures say about themselves.

/// The program and its version.
pub const SOFTWARE: &str = "Software";
/// [`Job::fingerprint`](crate::Job::fingerprint).
pub const FINGERPRINT: &str = "bilux.fingerprint";
/// The options of the command line that make the picture again.
pub const SETTINGS: &str = "bilux.settings";

/// The quantity that the pixels measure, if it is not what an eye sees.
pub const MEASURES: &str = "bilux.measures";
/// The value of [`MEASURES`] where they are the light that a surface receives, over π.
pub const IRRADIANCE: &str = "irradiance over pi";

/// The width of a pixel over its height, unless that is 1.
pub const PIXEL_SHAPE: &str = "pixelAspectRatio";

/// In the metadata of a partial render: the samples per pixel of the picture that it is a part of.
pub const ASKED: &str = "bilux.spp";

/// The metadata that parts of a picture hand on to what they are merged into.
pub fn is_handed_on(key: &str) -> bool {
    let own =
        [SOFTWARE, "software", FINGERPRINT, SETTINGS, MEASURES, "worldToCamera", "worldToNDC", PIXEL_SHAPE];
    own.contains(&key) || key.starts_with("cryptomatte/") || key.starts_with("bilux.group_")
}
