//! Whether all unbiased integrators find the same light: shipped scenes as small pictures, compared block by block.
//!
//! Each technique renders [`PICTURES`] pictures that differ only in their seeds. For every block of [`BLOCK`]² pixels
//! and every channel, Welch's test gives the probability that two techniques with the same mean differ by as much as
//! these. [Jung 2020]
//!
//! Only light that both find is compared:
//! - `light` finds nothing that is seen in a mirror or through glass: it is compared in blocks where no visible surface
//!   has a delta lobe.
//! - `path` (and `auto`, which may choose it) finds no light that lights without extent send through a mirror or
//!   through glass. In scenes with such lights it is compared under lights that have an extent.
//!
//! The mean of a few unequal contributions is not normally distributed, and Welch's test is wrong for such means: cells
//! whose light is not known to 3% yet, or whose pictures are skewed, stay undecided. The whole picture is a cell too.

use crate::chi_square::uniforms;
use crate::judging::{CellVerdict, Judge, judge, judge_known};
use crate::statistics::sidak;
use bilux::Error;
use bilux::formats::ReadOptions;
use bilux::gallery::GENERATORS;
use bilux_math::transcendental::{acos, atan2, sin_cos};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{
    AccelChoice, CameraSample, Reader, Scene, SceneBuilder, Spec, Texture, Tracer, TransportMode, Value,
};
use bilux_transport::{DEFAULT_MAX_DEPTH, PixelIntegrator, RenderSettings, Silent, integrators, render};
use std::f32::consts::{PI, TAU};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Number of pictures per technique.
pub const PICTURES: usize = 32;

/// Side of a block, in pixels.
pub const BLOCK: usize = 8;

/// A technique for finding light.
#[derive(Clone, Debug)]
pub struct Technique {
    /// Name of the technique.
    pub name: &'static str,
    /// The integrator and its parameters.
    pub spec: Spec,
    /// True if the technique finds the light that lights without extent send through mirrors and glass.
    pub finds_points: bool,
    /// True if the technique finds what is seen in mirrors or through glass.
    pub finds_mirrored: bool,
}

/// All unbiased techniques.
pub fn techniques() -> Vec<Technique> {
    let technique =
        |name, spec, finds_points, finds_mirrored| Technique { name, spec, finds_points, finds_mirrored };
    vec![
        technique("path", Spec::new("", "path"), false, true),
        technique("light", Spec::new("", "light"), true, false),
        technique("bdpt", Spec::new("", "bdpt"), true, true),
        technique("vcm", Spec::new("", "vcm").with("radius", 0.0f32), true, true),
        technique("auto", Spec::new("", "auto").with("merge", "never"), false, true),
    ]
}

/// A scene to be rendered at a small size.
pub struct Stage {
    /// Name of the stage.
    pub name: String,
    /// Scene and camera.
    pub scene: Scene,
    /// Size and depth; samples and seed are set for each picture.
    pub settings: RenderSettings,
    /// Some of its lights have no extent.
    pub has_points: bool,
    /// Blocks in which no mirror and no glass is visible.
    plain: Vec<bool>,
    /// For each cell, the directly visible light of lights and sky, which all techniques find alike.
    seen: Vec<f64>,
}

/// All scenes that we ship: those in the folder, and those that have a generator and no file there, by name.
///
/// # Errors
/// When one cannot be read or generated.
pub fn shipped(folder: &Path) -> Result<Vec<(String, SceneBuilder)>, Error> {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    files.sort();
    let mut all = Vec::new();
    for path in files {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        all.push((name, bilux::load(&path, &ReadOptions::default())?));
    }
    // Covered by `cornell.toml`, `teapots.toml` and `teapots-trio.toml`.
    let in_files = ["cornell-spheres", "teapots", "trio"];
    for row in GENERATORS.iter().filter(|row| !in_files.contains(&row.entry.name)) {
        all.push((row.entry.name.to_owned(), bilux::generate(&Spec::new("", row.entry.name))?));
    }
    Ok(all)
}

/// The scene as it is, and where lights of it have no extent, also a version in which they have.
///
/// # Errors
/// When something in it is wrong.
pub fn stages(name: &str, scene: &SceneBuilder, size: [u32; 2]) -> Result<Vec<Stage>, Error> {
    let scene = bilux::presets::completed(scene, &Default::default());
    let mut stages = vec![Stage::new(name, &scene, size)?];
    if scene.lights.iter().any(is_point) {
        stages[0].has_points = true;
        stages.push(Stage::new(&format!("{name}, wide lights"), &with_wide_lights(&scene)?, size)?);
    }
    Ok(stages)
}

fn is_point(light: &Spec) -> bool {
    ["point", "spot", "directional"].contains(&light.kind.as_str())
}

/// Suns become discs in the sky, a few degrees wide; points and spots are left out.
fn with_wide_lights(scene: &SceneBuilder) -> Result<SceneBuilder, Error> {
    const ROWS: usize = 32;
    let mut wide = scene.clone();
    wide.lights.retain(|light| !is_point(light));
    let row = bilux_scene::LIGHTS.iter().find(|row| row.entry.name == "directional");
    for sun in scene.lights.iter().filter(|light| light.kind == "directional") {
        let Some(row) = row else { continue };
        let reader = Reader::new(sun, &row.entry)?;
        let towards = -reader.vector("direction").normalize();
        let u = 0.5 + atan2(towards.x, -towards.z) / TAU;
        let v = acos(towards.y.clamp(-1.0, 1.0)) / PI;
        let at = |part: f32, count: usize| ((part * count as f32) as usize).min(count - 1);
        let solid_angle = (PI / ROWS as f32) * (PI / ROWS as f32) * sin_cos(PI * v).0.max(0.05);
        let mut texels = vec![Rgb::BLACK; 2 * ROWS * ROWS];
        texels[at(v, ROWS) * 2 * ROWS + at(u, 2 * ROWS)] = reader.colour("irradiance") / solid_angle;
        let picture = Texture::new("", 2 * ROWS, ROWS, texels, false);
        wide.textures.push(Arc::new(picture));
        let radiance = Value::Texture(wide.textures.len() - 1);
        wide.lights.push(Spec::new("sun", "environment").with("radiance", radiance));
    }
    Ok(wide)
}

impl Stage {
    fn new(name: &str, scene: &SceneBuilder, [width, height]: [u32; 2]) -> Result<Stage, Error> {
        let built = scene.build(&AccelChoice::default(), [0.0, 0.0], width as f32 / height as f32)?;
        let max_depth = match scene.settings.find("max_depth") {
            Some((Value::Integer(depth), _)) => *depth as u32,
            _ => DEFAULT_MAX_DEPTH,
        };
        let settings = RenderSettings { max_depth, ..RenderSettings::new(width, height, 1) };
        let (name, plain, seen) = (name.to_owned(), Vec::new(), Vec::new());
        let mut stage = Stage { name, scene: built, settings, has_points: false, plain, seen };
        stage.plain = (0..stage.blocks()).map(|block| stage.is_plain(block)).collect();
        let emission_only = RenderSettings { max_depth: 0, ..stage.settings.clone() };
        let path = integrators::build(&Spec::new("", "path"))?;
        let emission_only =
            stage.evidence(&*path, &RenderSettings { spp: 256, samples: 0..256, ..emission_only }, 0, 1)?;
        stage.seen = emission_only.cells.into_iter().map(|cell| cell[0]).collect();
        Ok(stage)
    }

    fn across(&self) -> usize {
        self.settings.width as usize / BLOCK
    }

    fn blocks(&self) -> usize {
        self.across() * (self.settings.height as usize / BLOCK)
    }

    /// True where no surface that is visible in a block has a delta lobe, as far as many rays show.
    fn is_plain(&self, block: usize) -> bool {
        const RAYS: u64 = 4096;
        let corner = Vec2::new((block % self.across()) as f32, (block / self.across()) as f32);
        let size = Vec2::new(self.settings.width as f32, self.settings.height as f32);
        let mut tracer = Tracer::new(&self.scene, false);
        (0..RAYS).all(|i| {
            let film = (corner + uniforms(block as u64, i).1) * BLOCK as f32 / size;
            let sample = CameraSample { film, lens: uniforms(u64::MAX, i).1, time: 0.0 };
            let ray = self.scene.cameras()[0].1.ray(&sample);
            let Some(surface) = tracer.closest(&ray) else { return true };
            let bsdf = self.scene.material(&surface).bsdf(&surface);
            let wo = -Vec3::from(ray.direction);
            let scattered = |k: u8| {
                let u_choice = (f32::from(k) + 0.5) / 16.0;
                bsdf.sample(wo, u_choice, Vec2::splat(0.37), TransportMode::Radiance)
            };
            (0..16).filter_map(scattered).all(|sample| !sample.is_delta)
        })
    }

    /// True where two techniques can be compared here.
    pub fn compares(&self, a: &Technique, b: &Technique) -> bool {
        !self.has_points || (a.finds_points && b.finds_points)
    }

    /// Sums of all blocks and channels over pictures of this many samples.
    ///
    /// # Errors
    /// When memory is short.
    pub fn render(
        &self,
        integrator: &dyn PixelIntegrator,
        spp: u32,
        first_seed: u64,
        pictures: usize,
    ) -> Result<Evidence, Error> {
        let settings = RenderSettings { spp, samples: 0..spp, ..self.settings.clone() };
        self.evidence(integrator, &settings, first_seed, pictures)
    }

    fn evidence(
        &self,
        integrator: &dyn PixelIntegrator,
        settings: &RenderSettings,
        first_seed: u64,
        pictures: usize,
    ) -> Result<Evidence, Error> {
        let mut cells = vec![Vec::new(); self.blocks() * 3];
        for seed in (first_seed..).take(pictures) {
            let settings = RenderSettings { seed, ..settings.clone() };
            let camera = &*self.scene.cameras()[0].1;
            let pixels = render(&self.scene, camera, integrator, &settings, &Silent)?.film.to_rgb();
            let mut sums = vec![0.0; cells.len()];
            for (i, pixel) in pixels.into_iter().enumerate() {
                let (x, y) = (i % settings.width as usize, i / settings.width as usize);
                let block = y / BLOCK * self.across() + x / BLOCK;
                (0..3).for_each(|c| sums[block * 3 + c] += f64::from(pixel[c]));
            }
            cells.iter_mut().zip(sums).for_each(|(cell, sum)| cell.push(sum));
        }
        Ok(Evidence { cells, spp: settings.spp })
    }

    /// The pictures of a technique, with as many samples as it takes in about this many seconds by the clock.
    ///
    /// # Errors
    /// As [`Stage::render`].
    pub fn render_for(
        &self,
        technique: &Technique,
        seconds: f64,
        first_seed: u64,
    ) -> Result<Evidence, Error> {
        let integrator = integrators::build(&technique.spec)?;
        let mut spp = 1;
        loop {
            let begun = Instant::now();
            self.render(&*integrator, spp, u64::MAX / 2, 2)?;
            let took = begun.elapsed().as_secs_f64() / 2.0;
            let goal = seconds / PICTURES as f64;
            if took > 0.3 * goal || spp > 1 << 12 {
                let spp = ((f64::from(spp) * goal / took).round() as u32).max(1);
                return self.render(&*integrator, spp, first_seed, PICTURES);
            }
            spp *= 2;
        }
    }

    /// Compares two techniques, on the light that both find.
    pub fn compare(
        &self,
        (a, of_a): (&Technique, &Evidence),
        (b, of_b): (&Technique, &Evidence),
    ) -> Comparison {
        let everywhere = a.finds_mirrored && b.finds_mirrored;
        self.comparison(&of_a.cells, &of_b.cells, |cell| everywhere || self.plain[cell / 3], judge)
    }

    /// As [`Stage::compare`], in those cells only that each half of each technique's pictures knows by itself. Where rare paths bring much
    /// of the light, as where light subpaths end at a glossy surface, a few pictures without any of them look as if they knew it.
    pub fn compare_known(
        &self,
        (a, of_a): (&Technique, &Evidence),
        (b, of_b): (&Technique, &Evidence),
    ) -> Comparison {
        let everywhere = a.finds_mirrored && b.finds_mirrored;
        let is_common = |cell: usize| everywhere || self.plain[cell / 3];
        self.comparison(&of_a.cells, &of_b.cells, is_common, judge_known)
    }

    /// Whether a technique renders this: not all find what shines in media.
    ///
    /// # Errors
    /// When the technique cannot be made.
    pub fn renders(&self, technique: &Technique) -> Result<bool, Error> {
        Ok(!self.scene.has_glowing_media() || integrators::build(&technique.spec)?.sees_glow())
    }

    /// Compares the first half of a technique's pictures with the second: any difference there is chance.
    pub fn against_itself(&self, of: &Evidence) -> Comparison {
        let half = |first: bool| -> Vec<Vec<f64>> {
            let of_cell = |cell: &Vec<f64>| {
                let (a, b) = cell.split_at(cell.len() / 2);
                if first { a.to_vec() } else { b.to_vec() }
            };
            of.cells.iter().map(of_cell).collect()
        };
        self.comparison(&half(true), &half(false), |_| true, judge)
    }

    fn comparison(
        &self,
        a: &[Vec<f64>],
        b: &[Vec<f64>],
        is_common: impl Fn(usize) -> bool,
        judge: Judge,
    ) -> Comparison {
        let mut found = Comparison::default();
        let common: Vec<usize> = (0..a.len()).filter(|&cell| is_common(cell)).collect();
        let mut resolutions = Vec::new();
        for &cell in &common {
            match judge([&a[cell], &b[cell]], self.seen[cell], false) {
                CellVerdict::Empty => {}
                CellVerdict::Undecided => found.undecided += 1,
                CellVerdict::Decided { p, error } => {
                    found.p_values.push(p);
                    found.green.extend((cell % 3 == 1).then_some(p));
                    resolutions.push(error);
                }
            }
        }
        resolutions.sort_by(f64::total_cmp);
        found.error = resolutions.get(resolutions.len() / 2).copied();
        for channel in 0..3 {
            let cells = || common.iter().copied().filter(|cell| cell % 3 == channel);
            let whole = |of: &[Vec<f64>]| -> Vec<f64> {
                let pictures = of.first().map_or(0, Vec::len);
                (0..pictures).map(|k| cells().map(|cell| of[cell][k]).sum()).collect()
            };
            match judge([&whole(a), &whole(b)], cells().map(|cell| self.seen[cell]).sum(), true) {
                CellVerdict::Empty => {}
                CellVerdict::Undecided => found.undecided += 1,
                CellVerdict::Decided { p, .. } => found.p_values.push(p),
            }
        }
        found
    }
}

/// The evidence of one technique's pictures.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// `[block * 3 + channel][picture]`: sums over the block.
    pub cells: Vec<Vec<f64>>,
    /// Samples per pixel in each picture.
    pub spp: u32,
}

/// The comparison of two sets of pictures.
#[derive(Clone, Debug, Default)]
pub struct Comparison {
    /// P-values of all decided cells, the whole picture included.
    pub p_values: Vec<f64>,
    /// P-values of single blocks' green channel, which are nearly independent of each other.
    pub green: Vec<f64>,
    /// Number of cells that are not decided yet.
    pub undecided: usize,
    /// The median of one standard error of a block's difference, as a fraction of its light.
    pub error: Option<f64>,
}

impl Comparison {
    /// The minimum p-value, corrected for the number of cells; 1 where none could be decided.
    pub fn least(&self) -> f64 {
        sidak(self.p_values.iter().copied().fold(1.0, f64::min), self.p_values.len().max(1))
    }
}
