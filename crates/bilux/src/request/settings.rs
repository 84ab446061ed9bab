//! The settings of a request. Generated from their table by `cargo xtask docs`; do not edit by hand.

settings! {
    /// The algorithm that computes the light (`bilux list integrators`); default `auto`.
    integrator: &str,
    /// The acceleration structure for ray queries (`bilux list accels`); default `auto`.
    accel: &str,
    /// Samples per pixel; 0 for the integrator's own choice; default `0`.
    spp: u32,
    /// Stop when the noise is, on average, at most this fraction of the light; 0 for no limit; default `0`.
    noise: f32,
    /// Finish within this time, including reading and denoising; 0 for no limit (s); default `0`.
    time_limit: f32,
    /// The seed of the random numbers; a different seed gives different noise; default `0`.
    seed: u64,
    /// The maximum number of bounces after the camera; those inside skin and milk do not count; 0 shows only emitters; if nothing is said, 100 with `fog`, and 8 with --fast; default `16`.
    max_depth: u32,
    /// The number of threads; 0 uses all cores; default `0`.
    threads: u32,
    /// The camera of the scene, by name or by number from 0; default `0`.
    camera: &str,
    /// Move the camera to this point, as X,Y,Z in metres; camera leaves it where it is; default `camera`.
    eye: bilux_math::Vec3,
    /// Turn the camera to this point, as X,Y,Z in metres; camera leaves it as it is; default `camera`.
    look_at: bilux_math::Vec3,
    /// Magnify the picture by this factor; default `1`.
    zoom: f32,
    /// What the model stands on: an invisible ground that shows only its shadow, a mirror, or nothing; auto is a matte backdrop, if the file has neither camera nor lights: `auto`, `shadow`, `mirror`, `none`; default `auto`.
    ground: &str,
    /// Put fog around everything, in which people see this far; 0 is none (m); default `0`.
    fog: f32,
    /// Look from AZ degrees to the right of the model's front and EL degrees above it, as AZ,EL; if nothing is said, at a flat model from up to 40 degrees above; default `26.5,17.8`.
    orbit: [f32; 2],
    /// The model's up axis; auto infers it from the format and the shape: `auto`, `x`, `y`, `z`, `-x`, `-y`, `-z`; default `auto`.
    up: &str,
    /// The model's front axis, the side that the studio's camera sees; auto infers it from the format and the shape: `auto`, `x`, `y`, `z`, `-x`, `-y`, `-z`; default `auto`.
    front: &str,
    /// The focal length of the studio's camera, for a picture 24 mm high (mm); default `45`.
    focal: f32,
    /// The time to show, for animated scenes (s); default `0`.
    time: f32,
    /// How long the shutter is open (s); default `0`.
    shutter: f32,
    /// How much later a rolling shutter exposes the last row than the first (s); default `0`.
    readout: f32,
    /// Frames per second, for --frames (1/s); default `24`.
    fps: f32,
    /// The pixel reconstruction filter; default `box`.
    filter: &str,
    /// How image textures are filtered: over a footprint of half a pixel, for less noise, or not at all: `footprint`, `none`; default `footprint`.
    texture_filter: &str,
    /// Where pixel (0, 0) is sampled: `centre`, `corner`; default `centre`.
    pixel_anchor: &str,
    /// Brightens display formats by this many stops (powers of two); if it is not given, a picture by the light of a glTF or OBJ file, where that is too bright or too dim for a display, is exposed to show it (EV); default `0`.
    exposure: f32,
    /// Also expose display formats automatically, to the brightness of a photograph; default `false`.
    auto_exposure: bool,
    /// The background: surroundings, transparent, or a colour (white, #rrggbb or R,G,B); default `surroundings`.
    background: &str,
    /// The tone-mapping curve for display formats (`bilux list tonemaps`); auto is neutral if the studio lights the model, unless all of it is unlit, else none; default `auto`.
    tonemap: &str,
    /// The denoiser; display uses the best one for display formats when noise or time ends the render: `display`, `auto`, `oidn`, `builtin`, `off`; default `display`.
    denoise: &str,
    /// The transfer function from linear light to bytes: `srgb`, `linear`; default `srgb`.
    transfer: &str,
    /// Which faces of closed, opaque meshes to cull: `none`, `back`; default `none`.
    culling: &str,
    /// How much time building the acceleration structure may take; auto is best for bvh8 from 64 samples per triangle on, else balanced: `auto`, `fast`, `balanced`, `best`; default `auto`.
    build: &str,
    /// The instruction set that kernels may use: `auto`, `baseline`, `sse4.2`, `avx2`, `avx512`; default `auto`.
    cpu: &str,
    /// How `bsp` chooses its splitting planes: `mean`, `fuchs`; default `mean`.
    bsp_split: &str,
    /// Whether `bsp` groups polygons or whole objects: `polygons`, `objects`; default `polygons`.
    bsp_group: &str,
    /// End a traversal at the first hit that no closer hit can replace; default `true`.
    early_out: bool,
    /// Reject back faces by the side of their partition plane; default `true`.
    cull_by_partition: bool,
}
