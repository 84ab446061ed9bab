//! Command lines that are wrong.

use super::Case;

/// A scene that can be rendered.
const BALL: &[u8] = b"[[model]]\nshape = \"sphere\"\n";

/// Each in a folder with `triangle.obj`.
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
    // Where the picture goes.
    Case::command("a picture of an unknown format", 2, "render triangle.obj -o out.pgn"),
    Case::command("a picture in a folder that is not there", 2, "render triangle.obj -o none/out.png"),
    Case::file("one picture for two scenes", 2, &[("a.toml", BALL)], "render a.toml triangle.obj -o out.png"),
    Case::command(
        "a part of the samples in a PNG",
        2,
        "render triangle.obj -o out.png --spp 4 --samples 0..2",
    ),
    // Other commands.
    Case::command("a scene that is to become a picture", 2, "convert triangle.obj -o out.png"),
    Case::command("a picture to compare that is not there", 2, "compare none.png other.png"),
];
