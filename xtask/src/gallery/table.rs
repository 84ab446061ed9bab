//! The pictures of the manual: one line each.

use Scene::{BuiltIn, Converted, Made, Model, Page, Repository};

/// Scene of a picture.
#[derive(Clone, Copy)]
pub(super) enum Scene {
    /// A built-in scene, by the name of the file that `bilux generate` writes.
    BuiltIn(&'static str),
    /// A scene file of the repository.
    Repository(&'static str),
    /// A scene file of the repository, converted to a file of this name.
    Converted(&'static str, &'static str),
    /// A file that a page of the manual tells its readers to write: the page, and the file.
    Page(&'static str, &'static str),
    /// A model that is not ours, in the folder of models: a file, or the folder of a glTF sample model.
    Model(&'static str),
    /// A file that this chore makes.
    Made(&'static str),
}

/// A picture.
pub(super) struct Picture {
    /// File in `docs/gallery`.
    pub(super) file: &'static str,
    pub(super) scene: Scene,
    /// Options of `bilux render`, separated by spaces.
    pub(super) options: &'static str,
}

/// A heat map of the FLIP error of a picture.
pub(super) struct HeatMap {
    /// File in `docs/gallery`.
    pub(super) file: &'static str,
    /// Two other pictures of `docs/gallery`.
    pub(super) picture: &'static str,
    pub(super) reference: &'static str,
}

const GLASS: &str = "docs/tutorials/glass.md";
const PRODUCT: &str = "docs/tutorials/product.md";

/// Every picture that is rendered. Rows with a time limit were rendered on two cores.
pub(super) const PICTURES: &[Picture] = &[
    // The front page.
    picture("caustics.png", BuiltIn("caustics.toml"), "--size 640x480 --time-limit 100"),
    picture("lamp-lit.png", BuiltIn("indirect.toml"), "--size 640x480 --spp 96 --denoise=builtin"),
    picture(
        "metals.png",
        Repository("scenes/brushed-metals.toml"),
        "--size 640x480 --spp 256 --denoise=builtin",
    ),
    picture("pool.png", BuiltIn("pool.toml"), "--size 640x480 --spp 96 --denoise=builtin"),
    // Media, on the page about them; with Open Image Denoise.
    picture("fog.jpg", BuiltIn("fog.toml"), "-i bdpt --size 400x300 --spp 8 --denoise"),
    picture("milk.jpg", BuiltIn("milk.toml"), "-i path --size 512x384 --spp 48 --denoise"),
    picture("jade.jpg", BuiltIn("jade.toml"), "-i path --size 512x384 --spp 32 --denoise"),
    picture("piglet.jpg", BuiltIn("piglet.toml"), "-i path --size 512x384 --spp 32 --denoise"),
    picture("campfire.jpg", BuiltIn("campfire.toml"), "-i path --size 400x300 --spp 16 --denoise"),
    picture("cloud.jpg", BuiltIn("cloud.toml"), "-i path --size 512x384 --spp 16 --denoise"),
    // Models with default settings.
    picture("models/anisotropy.png", Model("gltf/AnisotropyStrengthTest"), ""),
    picture("models/bottle.png", Model("gltf/WaterBottle"), ""),
    picture("models/cloth.png", Model("gltf/SheenCloth"), ""),
    picture("models/cow.png", Model("obj/spot.obj"), ""),
    picture("models/cubes.png", Model("gltf/SimpleInstancing"), ""),
    picture("models/glass.png", BuiltIn("caustics.glb"), ""),
    picture("models/lamp.png", Converted("docs/gallery/models/lamp.toml", "lamp.glb"), ""),
    picture("models/machined.png", Model("stl/trimesh/featuretype.STL"), ""),
    picture("models/metals.png", Model("gltf/MetalRoughSpheresNoTextures"), ""),
    picture("models/monkey.png", Model("gltf/Suzanne"), ""),
    picture("models/shell.png", Made("shell.ply"), ""),
    picture("models/teapot.png", Model("obj/teapot.obj"), ""),
    picture("models/transmission.png", Model("gltf/TransmissionTest"), ""),
    // Lighting a product.
    picture("product/first.jpg", Page(PRODUCT, "pot.obj"), "--size 320x240 --spp 64 --denoise"),
    picture("product/view.jpg", Page(PRODUCT, "pot.obj"), FROM_THE_LEFT),
    picture("product/glaze.jpg", Page(PRODUCT, "product.toml"), FROM_THE_LEFT),
    picture("product/shadow.jpg", Page(PRODUCT, "product.toml"), ON_WHITE),
    picture(
        "product/mirror.jpg",
        Page(PRODUCT, "product.toml"),
        "--size 320x240 --spp 64 --denoise --ground mirror",
    ),
    picture("product/floating.jpg", Page(PRODUCT, "product.toml"), FLOATING),
    picture("product/key.jpg", Page(PRODUCT, "key.toml"), "--size 320x240 --spp 64 --denoise"),
    picture("product/fill.jpg", Page(PRODUCT, "fill.toml"), "--size 320x240 --spp 64 --denoise"),
    picture("product/rim.jpg", Page(PRODUCT, "rim.toml"), "--size 320x240 --spp 64 --denoise"),
    picture("product/softboxes.jpg", Page(PRODUCT, "softboxes.toml"), "--size 320x160 --spp 16"),
    picture("product/env.jpg", Page(PRODUCT, "product.toml"), IN_SOFTBOXES),
    picture("product/none.jpg", Page(PRODUCT, "rim.toml"), BRIGHT_NONE),
    picture("product/neutral.jpg", Page(PRODUCT, "rim.toml"), BRIGHT_NEUTRAL),
    picture("product/agx.jpg", Page(PRODUCT, "rim.toml"), BRIGHT_AGX),
    // Glass and caustics.
    picture("glass/kinds.jpg", Page(GLASS, "kinds.toml"), "--size 640x200 --spp 64 --denoise"),
    picture("glass/indices.jpg", Page(GLASS, "indices.toml"), "--size 640x200 --spp 64 --denoise"),
    picture("glass/absorption.jpg", Page(GLASS, "absorption.toml"), "--size 640x200 --spp 64 --denoise"),
    picture("glass/drink.jpg", Page(GLASS, "drink.toml"), "--size 300x300 --spp 64 --denoise"),
    picture("glass/no-priority.jpg", Page(GLASS, "drink.toml"), NO_PRIORITY),
    picture("glass/prism.jpg", Repository("scenes/prism.toml"), "--size 480x300 --spp 128 --denoise"),
    picture(
        "glass/path.jpg",
        BuiltIn("caustics.toml"),
        "--size 320x240 -i path --time-limit 20 --denoise=off --quality 88",
    ),
    picture(
        "glass/bdpt.jpg",
        BuiltIn("caustics.toml"),
        "--size 320x240 -i bdpt --time-limit 20 --denoise=off --quality 88",
    ),
    picture(
        "glass/sppm.jpg",
        BuiltIn("caustics.toml"),
        "--size 320x240 -i sppm --time-limit 20 --denoise=off --quality 88",
    ),
    picture(
        "glass/vcm.jpg",
        BuiltIn("caustics.toml"),
        "--size 320x240 -i vcm --time-limit 20 --denoise=off --quality 88",
    ),
    picture(
        "glass/auto.jpg",
        BuiltIn("caustics.toml"),
        "--size 320x240 -i auto --time-limit 20 --denoise=off --quality 88",
    ),
    // Reading the numbers.
    picture("numbers/1.jpg", BuiltIn("cornell-spheres.toml"), "--size 240x240 -i path --spp 1"),
    picture("numbers/16.jpg", BuiltIn("cornell-spheres.toml"), "--size 240x240 -i path --spp 16"),
    picture("numbers/256.jpg", BuiltIn("cornell-spheres.toml"), "--size 240x240 -i path --spp 256"),
    picture("numbers/reference.jpg", BuiltIn("cornell-spheres.toml"), "--size 240x240 --spp 512"),
];

const FROM_THE_LEFT: &str = "--size 320x240 --spp 64 --denoise --orbit -35,12 --focal 85";
const ON_WHITE: &str = "--size 320x240 --spp 64 --denoise --background white --ground shadow";
const FLOATING: &str = "--size 320x240 --spp 64 --denoise --background #203040 --ground none";
const IN_SOFTBOXES: &str =
    "--size 320x240 --spp 64 --denoise --env softboxes.hdr --background white --ground shadow";
const BRIGHT_NONE: &str = "--size 320x240 --spp 64 --denoise --exposure 1.5 --tonemap none";
const BRIGHT_NEUTRAL: &str = "--size 320x240 --spp 64 --denoise --exposure 1.5 --tonemap neutral";
const BRIGHT_AGX: &str = "--size 320x240 --spp 64 --denoise --exposure 1.5 --tonemap agx";
const NO_PRIORITY: &str = "--size 300x300 --spp 64 --denoise --change material:glass:priority=0 \
     --change material:air:priority=0 --change material:drink:priority=0";

/// Every heat map.
pub(super) const HEAT_MAPS: &[HeatMap] =
    &[HeatMap { file: "numbers/flip.jpg", picture: "numbers/16.jpg", reference: "numbers/reference.jpg" }];

const fn picture(file: &'static str, scene: Scene, options: &'static str) -> Picture {
    Picture { file, scene, options }
}
