//! Wrong command lines.

use super::Case;

/// A scene that can be rendered.
const BALL: &[u8] = b"[[model]]\nshape = \"sphere\"\n";

/// Each runs in a folder that contains `triangle.obj`.
pub(crate) const CASES: &[Case] = &[
    // Names.
    Case::command("a scene that is not there", 1, "render none.obj -o out.png"),
    Case::command("a command that is misspelt", 2, "rendr triangle.obj -o out.png"),
    Case::command("an option that is misspelt", 2, "render triangle.obj -o out.png --sise 64x64"),
    Case::command("no picture is named", 2, "render triangle.obj"),
    Case::command("an integrator that is misspelt", 2, "render triangle.obj -o out.png -i whited"),
    Case::command("an accelerator that is misspelt", 2, "render triangle.obj -o out.png --accel bhv"),
    Case::command("a setting that is misspelt", 2, "render triangle.obj -o out.png --set max_dept=3"),
    Case::command("a setting without a value", 2, "render triangle.obj -o out.png --set max_depth"),
    Case::command("a preset that is misspelt", 2, "render triangle.obj -o out.png --preset cours"),
    Case::command("a layer that is misspelt", 2, "render triangle.obj -o out.png --spp 1 --aov albdo"),
    Case::command("a list that is misspelt", 2, "list material"),
    Case::command("a generator that is misspelt", 2, "generate teapts -o out.toml"),
    Case::command("a camera that the scene does not have", 2, "render triangle.obj -o out.png --camera 5"),
    // Values.
    Case::command("a negative number of samples", 2, "render triangle.obj -o out.png --spp -3"),
    Case::command("no samples at all", 2, "render triangle.obj -o out.png --spp 0"),
    Case::command("a size of one number", 2, "render triangle.obj -o out.png --size 640"),
    Case::command("a size of nothing", 2, "render triangle.obj -o out.png --size 0x0"),
    Case::command("a negative time", 2, "render triangle.obj -o out.png --time-limit -1"),
    Case::command("a limit of memory without a unit", 2, "render triangle.obj -o out.png --max-memory 1X"),
    Case::command("frames that run backwards", 2, "render triangle.obj -o out.png --frames 5-2"),
    Case::command("a background that is nothing", 2, "render triangle.obj -o out.png --background whte"),
    Case::command("a sky that is not there", 1, "render triangle.obj -o out.png --env nowhere.hdr"),
    Case::command("noise in percent without the sign", 2, "render triangle.obj -o out.png --noise 2"),
    Case::command("noise as a word", 2, "render triangle.obj -o out.png --noise little"),
    Case::command("an orbit of one number", 2, "render triangle.obj -o out.png --orbit 40"),
    Case::command(
        "a window beyond the picture",
        2,
        "render triangle.obj -o out.png --size 64x64 --crop 40,0,30,9",
    ),
    Case::command(
        "a sample beyond the picture",
        2,
        "render triangle.obj -o out.png --size 8x8 --replay 9,0,0",
    ),
    Case::command("an animation that there is not", 2, "render triangle.obj -o out.png --animation Walk"),
    Case::command("a denoiser behind a space", 2, "render triangle.obj -o out.png --denoise builtin"),
    Case::command("a quality out of range", 2, "render triangle.obj -o out.jpg --quality 200"),
    Case {
        name: "standard input that is empty",
        files: &[],
        input: b"",
        command: "render - -o out.png",
        status: 1,
    },
    Case {
        name: "standard input of a format that is misspelt",
        files: &[],
        input: BALL,
        command: "render - -o out.png --input-format tmol",
        status: 2,
    },
    // Where the picture goes.
    Case::command("a picture of an unknown format", 2, "render triangle.obj -o out.pgn"),
    Case::command("a picture in a folder that is not there", 2, "render triangle.obj -o none/out.png"),
    Case::file("one picture for two scenes", 2, &[("a.toml", BALL)], "render a.toml triangle.obj -o out.png"),
    Case::command(
        "a part of the samples in a PNG",
        2,
        "render triangle.obj -o out.png --spp 4 --samples 0..2",
    ),
    Case::command("an unknown name in braces", 2, "render triangle.obj -o out-{foo}.png"),
    Case::command("a frame's number without frames", 2, "render triangle.obj -o out-{frame}.png"),
    Case::command("two results on standard output", 2, "render triangle.obj -o - --json"),
    Case::command("a quality of a PNG", 2, "render triangle.obj -o out.png --quality 80"),
    Case::command("16 bits in a JPEG", 2, "render triangle.obj -o out.jpg --bits 16"),
    Case::command(
        "statistics outside a sandbox",
        2,
        "render triangle.obj -o out.png --sandbox --stats ../out.json",
    ),
    Case::command(
        "a sandbox with files outside",
        2,
        "render triangle.obj -o out.png --sandbox --allow-outside",
    ),
    // Other commands.
    Case::command("a scene that is to become a picture", 2, "convert triangle.obj -o out.png"),
    Case::command("a picture to compare that is not there", 2, "compare none.png other.png"),
    Case::file(
        "a picture to merge that is no partial render",
        1,
        &[("a.ppm", b"P6 1 1 255\n\0\0\0")],
        "merge a.ppm -o out.png",
    ),
    Case::file(
        "partial renders merged into an unknown format",
        2,
        &[("a.ppm", b"P6 1 1 255\n\0\0\0")],
        "merge a.ppm -o out.xyz",
    ),
];
