//! The table of the settings: what each is called, which values it takes, and what of a picture depends on it.

use super::view::OF_CAMERA;
use bilux_math::registry::{Entry, Parameter, ParameterKind, choice, integer};
use bilux_transport::MAX_DEPTH;

/// A setting, what of a picture depends on it, and how the command line calls it.
#[derive(Clone, Copy, Debug)]
pub struct SettingRow {
    /// Name, values and default.
    pub parameter: Parameter,
    /// Part of a picture that depends on it.
    pub effect: Effect,
    /// Option of `bilux render` that sets it; `None` if only `--set` does.
    pub option: Option<&'static str>,
}

impl SettingRow {
    /// Row of the setting of this name; `None` if there is none in [`RENDER`].
    pub fn named(key: &str) -> Option<&'static SettingRow> {
        ROWS.iter().find(|row| row.parameter.name == key)
    }

    const fn by(self, option: &'static str) -> SettingRow {
        SettingRow { option: Some(option), ..self }
    }
}

/// Part of a picture that depends on a setting. Fingerprints, checkpoints and sessions have to agree with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Each sample: fingerprints and checkpoints read the setting itself.
    Samples,
    /// The scene as it is rendered, with its camera and its studio: fingerprints and checkpoints read the scene.
    Scene,
    /// The number of samples.
    Count,
    /// The times of an animation's frames, each of which is a picture of its own.
    Frames,
    /// The finished picture on a display.
    Display,
    /// The time for the same samples.
    Work,
    /// The trees by which rays find surfaces: the samples are the same, but the scene is built anew.
    Building,
}
use Effect::{Building, Count, Display, Frames, Samples, Scene, Work};

impl Effect {
    /// Effect of the setting of this name; `None` if there is none in [`RENDER`].
    pub fn of(key: &str) -> Option<Effect> {
        SettingRow::named(key).map(|row| row.effect)
    }
}

/// The values of the setting `denoise`.
pub const DENOISE: &[&str] = &["display", "auto", "oidn", "builtin", "off"];

/// The settings that `[render]` and `--set` accept, besides the integrator's parameters.
pub const RENDER: Entry =
    Entry { name: "render", summary: "how the picture is made", source: "", parameters: &PARAMETERS };

/// The parameters of [`ROWS`], in their order.
const PARAMETERS: [Parameter; ROWS.len()] = {
    let mut all = [ROWS[0].parameter; ROWS.len()];
    let mut i = 1;
    while i < all.len() {
        all[i] = ROWS[i].parameter;
        i += 1;
    }
    all
};

/// The rows of [`RENDER`], each with its effect.
pub static ROWS: &[SettingRow] = &[
    row(
        Samples,
        text("integrator", "the algorithm that computes the light (`bilux list integrators`)", "auto"),
    )
    .by("--integrator"),
    row(Building, text("accel", "the acceleration structure for ray queries (`bilux list accels`)", "auto"))
        .by("--accel"),
    row(Samples, text("size", "the width and height of the picture in pixels, as WxH", "512x512"))
        .by("--size"),
    row(Count, integer("spp", "samples per pixel; 0 for the integrator's own choice", 0, 1 << 31, "0"))
        .by("--spp"),
    row(
        Count,
        number(
            "noise",
            "stop when the noise is, on average, at most this fraction of the light; 0 for no limit",
            "",
            0.0,
            10.0,
            "0",
        ),
    )
    .by("--noise"),
    row(
        Count,
        number(
            "time_limit",
            "finish within this time, including reading and denoising; 0 for no limit",
            "s",
            0.0,
            1e9,
            "0",
        ),
    )
    .by("--time-limit"),
    row(
        Samples,
        integer(
            "seed",
            "the seed of the random numbers; a different seed gives different noise",
            0,
            i64::MAX,
            "0",
        ),
    )
    .by("--seed"),
    row(
        Samples,
        integer(
            "max_depth",
            "the maximum number of bounces after the camera; those inside skin and milk do not count; 0 \
             shows only emitters; if nothing is said, 100 with `fog`, and 8 with --fast",
            0,
            MAX_DEPTH as i64,
            "16",
        ),
    )
    .by("--max-depth"),
    row(Work, integer("threads", "the number of threads; 0 uses all cores", 0, 4096, "0")).by("--threads"),
    row(Samples, text("camera", "the camera of the scene, by name or by number from 0", "0")).by("--camera"),
    row(
        Scene,
        text(
            "eye",
            "move the camera to this point, as X,Y,Z in metres; camera leaves it where it is",
            OF_CAMERA,
        ),
    )
    .by("--eye"),
    row(
        Scene,
        text(
            "look_at",
            "turn the camera to this point, as X,Y,Z in metres; camera leaves it as it is",
            OF_CAMERA,
        ),
    )
    .by("--look-at"),
    row(Scene, number("zoom", "magnify the picture by this factor", "", 1e-3, 1e3, "1")).by("--zoom"),
    row(
        Scene,
        choice(
            "ground",
            "what the model stands on: an invisible ground that shows only its shadow, a mirror, or \
             nothing; auto is a matte backdrop, if the file has neither camera nor lights",
            GROUNDS,
            "auto",
        ),
    )
    .by("--ground"),
    // Deeper paths too, unless `max_depth` is said.
    row(
        Scene,
        number(
            "fog",
            "put fog around everything, in which people see this far; 0 is none",
            "m",
            0.0,
            1e6,
            "0",
        ),
    )
    .by("--fog"),
    row(
        Scene,
        text(
            "orbit",
            "look from AZ degrees to the right of the model's front and EL degrees above it, as AZ,EL; if \
             nothing is said, at a flat model from up to 40 degrees above",
            "26.5,17.8",
        ),
    )
    .by("--orbit"),
    row(
        Scene,
        choice("up", "the model's up axis; auto infers it from the format and the shape", AXES, "auto"),
    )
    .by("--up"),
    row(
        Scene,
        choice(
            "front",
            "the model's front axis, the side that the studio's camera sees; auto infers it from the \
             format and the shape",
            AXES,
            "auto",
        ),
    )
    .by("--front"),
    row(
        Scene,
        number(
            "focal",
            "the focal length of the studio's camera, for a picture 24 mm high",
            "mm",
            1.0,
            10_000.0,
            "45",
        ),
    )
    .by("--focal"),
    row(Samples, number("time", "the time to show, for animated scenes", "s", -1e9, 1e9, "0")).by("--at"),
    row(Samples, number("shutter", "how long the shutter is open", "s", 0.0, 1e9, "0")),
    row(
        Samples,
        number(
            "readout",
            "how much later a rolling shutter exposes the last row than the first",
            "s",
            0.0,
            1e9,
            "0",
        ),
    ),
    row(Frames, number("fps", "frames per second, for --frames", "1/s", 1e-6, 1e6, "24")),
    row(Samples, text("filter", "the pixel reconstruction filter", "box")),
    row(
        Samples,
        choice(
            "texture_filter",
            "how image textures are filtered: over a footprint of half a pixel, for less noise, or \
             not at all",
            &["footprint", "none"],
            "footprint",
        ),
    ),
    row(Samples, choice("pixel_anchor", "where pixel (0, 0) is sampled", &["centre", "corner"], "centre")),
    row(
        Display,
        number(
            "exposure",
            "brightens display formats by this many stops (powers of two); if it is not given, a \
             picture by the light of a glTF or OBJ file, where that is too bright or too dim for a \
             display, is exposed to show it",
            "EV",
            -64.0,
            64.0,
            "0",
        ),
    )
    .by("--exposure"),
    row(
        Display,
        Parameter {
            name: "auto_exposure",
            summary: "also expose display formats automatically, to the brightness of a photograph",
            unit: "",
            kind: ParameterKind::Bool,
            default: "false",
        },
    ),
    // Among colours, nothing but the display: what is behind the scene is cut out for each of them.
    row(
        Scene,
        text(
            "background",
            "the background: surroundings, transparent, or a colour (white, #rrggbb or R,G,B)",
            "surroundings",
        ),
    )
    .by("--background"),
    row(
        Display,
        text(
            "tonemap",
            "the tone-mapping curve for display formats (`bilux list tonemaps`); auto is \
             neutral if the studio lights the model, unless all of it is unlit, else none",
            "auto",
        ),
    )
    .by("--tonemap"),
    row(
        Display,
        choice(
            "denoise",
            "the denoiser; display uses the best one for display formats when noise or time ends the \
             render",
            DENOISE,
            "display",
        ),
    )
    .by("--denoise"),
    row(
        Display,
        choice("transfer", "the transfer function from linear light to bytes", &["srgb", "linear"], "srgb"),
    ),
    row(
        Samples,
        choice("culling", "which faces of closed, opaque meshes to cull", &["none", "back"], "none"),
    ),
    row(
        Building,
        choice(
            "build",
            "how much time building the acceleration structure may take; auto is best for \
             bvh8 from 64 samples per triangle on, else balanced",
            &["auto", "fast", "balanced", "best"],
            "auto",
        ),
    )
    .by("--build"),
    row(
        Building,
        choice(
            "cpu",
            "the instruction set that kernels may use",
            &["auto", "baseline", "sse4.2", "avx2", "avx512"],
            "auto",
        ),
    ),
    row(Building, choice("bsp_split", "how `bsp` chooses its splitting planes", &["mean", "fuchs"], "mean"))
        .by("--bsp-split"),
    row(
        Building,
        choice(
            "bsp_group",
            "whether `bsp` groups polygons or whole objects",
            &["polygons", "objects"],
            "polygons",
        ),
    )
    .by("--bsp-group"),
    row(Building, switch("early_out", "end a traversal at the first hit that no closer hit can replace")),
    row(Building, switch("cull_by_partition", "reject back faces by the side of their partition plane")),
];

const fn row(effect: Effect, parameter: Parameter) -> SettingRow {
    SettingRow { parameter, effect, option: None }
}

const fn text(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Text, default }
}

const fn switch(name: &'static str, summary: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Bool, default: "true" }
}

const fn number(
    name: &'static str,
    summary: &'static str,
    unit: &'static str,
    min: f64,
    max: f64,
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit, kind: ParameterKind::Number { min, max }, default }
}

const AXES: &[&str] = &["auto", "x", "y", "z", "-x", "-y", "-z"];

const GROUNDS: &[&str] = &["auto", "shadow", "mirror", "none"];
