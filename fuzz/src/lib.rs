//! Shared code of the fuzz targets: read any bytes, within bounded memory, without a panic.

/// Meshes and rays, on which all acceleration structures must agree.
#[path = "../../crates/accel/tests/suite/support/fuzzed.rs"]
pub mod rays;

use bilux_formats::{FormatError, ReadOptions};
use bilux_pictures::{Limits, format_named};
use bilux_scene::{AccelChoice, SceneBuilder, Spec};
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

/// The memory limit for decoding a picture.
///
/// With `-rss_limit_mb` and `-malloc_limit_mb` slightly above it, the fuzzer detects any excess.
const LIMITS: Limits = Limits::new(64 << 20);

/// Reads the bytes as this picture format, whatever they begin with.
///
/// The result must be consistent: within the limits, with every plane of the picture's size.
pub fn read_picture(format: &str, bytes: &[u8]) {
    let_guarded_panics_pass();
    let row = format_named(format).expect("a format of the table");
    let Ok(picture) = (row.read)(bytes, &LIMITS) else { return };
    let pixels = picture.width() * picture.height();
    let planes = picture.channels().iter().map(|channel| channel.samples.len());
    let planes: Vec<usize> =
        planes.chain(picture.integer_planes().iter().map(|plane| plane.samples.len())).collect();
    assert!(planes.iter().all(|length| *length == pixels));
    assert!((planes.len() * pixels * 4) as u64 <= LIMITS.max_bytes);
}

/// Reads the bytes as this scene format, without a folder, so that no other file is opened; then builds the scene,
/// which may fail.
pub fn read_scene(format: &str, bytes: &[u8]) {
    let_guarded_panics_pass();
    build(bilux_formats::read_bytes(bytes, format, None, "scene", &options()));
}

/// The fuzzer ends at every panic, also at those in decoders of others that become errors.
fn let_guarded_panics_pass() {
    static HOOK: LazyLock<()> = LazyLock::new(|| {
        let ends = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !bilux_pictures::is_decoding() {
                ends(panic);
            }
        }));
    });
    *HOOK
}

/// Reads the bytes as the materials of a triangle, in a folder with one picture, `t.ppm`.
pub fn read_materials(bytes: &[u8]) {
    static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
        let folder = std::env::temp_dir().join(format!("bilux-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for temporary files");
        std::fs::write(folder.join("t.ppm"), b"P6 2 2 255\n\xff\x80\x00012\x00\x40\x80abc")
            .expect("room for a picture");
        folder
    });
    std::fs::write(FOLDER.join("x.mtl"), bytes).expect("room for the bytes");
    let triangle =
        b"mtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n";
    build(bilux_formats::read_bytes(triangle, "obj", Some(&FOLDER), "scene", &options()));
}

/// Reads the bytes as a file of a lamp, and makes its light.
pub fn read_luminaire(bytes: &[u8]) {
    match bilux_formats::read_distribution(bytes, "lamp", &options()) {
        Ok((distribution, _)) => {
            let spec = Spec::new("", "luminaire").with("distribution", Arc::new(distribution));
            let _ = bilux_scene::lights::build(&spec, &[]);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fn options() -> ReadOptions {
    ReadOptions { max_memory: 64 << 20, time: 0.5, whole_movement: true, ..ReadOptions::default() }
}

fn build(read: Result<SceneBuilder, FormatError>) {
    let scene = match read {
        Ok(scene) => scene,
        Err(error) => {
            // Every error must have a message.
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
    if triangles < 10_000 {
        let _ = scene.build(&AccelChoice::default(), [0.0, 1.0], 1.0).map(|built| built.bounds());
    }
}
