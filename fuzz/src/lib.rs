//! What the targets have in common: read any bytes, within bounded memory, without a panic.

/// Meshes and rays, for every structure to agree on.
#[path = "../../crates/accel/tests/support/fuzzed.rs"]
pub mod rays;

use bilux_formats::ReadOptions;
use bilux_pictures::{Limits, format_named};
use bilux_scene::AccelChoice;

/// What a picture may take while it is decoded. With `-rss_limit_mb` and `-malloc_limit_mb` a little above
/// it, the fuzzer finds whatever goes beyond.
const LIMITS: Limits = Limits::new(64 << 20);

/// Reads the bytes as this picture format, whatever they begin with. What is read has to be whole: within
/// the limits, every plane of the picture's size.
pub fn read_picture(format: &str, bytes: &[u8]) {
    let row = format_named(format).expect("a format of the table");
    let Ok(picture) = (row.read)(bytes, &LIMITS) else { return };
    let pixels = picture.width() * picture.height();
    let planes = picture.channels().iter().map(|channel| channel.samples.len());
    let planes: Vec<usize> =
        planes.chain(picture.integer_planes().iter().map(|plane| plane.samples.len())).collect();
    assert!(planes.iter().all(|length| *length == pixels));
    assert!((planes.len() * pixels * 4) as u64 <= LIMITS.max_bytes);
}

/// Reads the bytes as this scene format, from no folder, so that no other file is opened; and builds what
/// was read, which may be refused.
pub fn read_scene(format: &str, bytes: &[u8]) {
    let options =
        ReadOptions { max_memory: 64 << 20, time: 0.5, whole_movement: true, ..ReadOptions::default() };
    let scene = match bilux_formats::read_bytes(bytes, format, None, "scene", &options) {
        Ok(scene) => scene,
        Err(error) => {
            // Whoever reads the message needs one.
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
    if triangles < 10_000 {
        let _ = scene.build(&AccelChoice::default(), [0.0, 1.0], 1.0).map(|built| built.bounds());
    }
}
