//! Why a scene is easy or hard to render, by what a few thousand rays find out: which strategies `auto` prefers and why,
//! where light has to pass on its way, and what would help.

use crate::job::Subject;
use crate::{Error, Job};
use bilux_math::{Frame, Vec2, Vec3, warp};
use bilux_scene::{CameraSample, ClassicMaterial, Ray, Surface, Tracer};
use bilux_transport::{Candidate, Choice, PixelSampler};

/// Rows and columns of points of the film that are looked at.
const GRID: u32 = 48;
/// Directions that are tried from each visible surface.
const DIRECTIONS: u32 = 8;
/// Rays from each light.
const LIGHT_RAYS: u32 = 256;
/// The maximum number of lights that rays are traced from: those that come first.
const MAX_LIGHTS: usize = 64;
/// Many lights: more than are all sampled at each event of a path.
const MANY_LIGHTS: usize = 16;
/// A texture of more texels than this on a side is huge.
const HUGE_TEXTURE: usize = 4096;

/// Measurements of a scene. Fractions are 0..=1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measures {
    /// The fraction of the film that shows surfaces.
    pub surfaces: f32,
    /// Of these, the fraction that is transparent.
    pub transparent: f32,
    /// Of these, the fraction that is opaque and shows its back, as its normals say.
    pub backs: f32,
    /// Of the directions around visible surfaces, the fraction in which nothing is hit; `None` if no surface is visible.
    pub open: Option<f32>,
    /// The number of lights that emit anything.
    pub lights: usize,
    /// The number of these that no ray can hit: points, spots and directions.
    pub points: usize,
    /// True if light comes from infinity.
    pub has_surroundings: bool,
    /// For lights whose rays hit transparent surfaces or mirrors first, the fraction that do, by name, the largest first.
    pub onto_glass: Vec<(String, f32)>,
    /// The textures of more than 4096 texels on a side: name, width, height.
    pub huge_textures: Vec<(String, usize, usize)>,
    /// Bytes of all textures.
    pub texture_bytes: u64,
}

/// Something that makes the scene hard, or is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The finding, with the figure that shows it.
    pub what: String,
    /// The options that help, each as they are written after the output file of `bilux render`; may be empty.
    pub options: Vec<String>,
    /// Further advice, if any.
    pub advice: Option<&'static str>,
}

/// All that is known of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// The set of techniques that `auto` chose, and its rivals; `None` if the integrator is another one.
    pub choice: Option<Choice>,
    /// The measurements.
    pub measures: Measures,
    /// The findings that follow from the choice and the measurements.
    pub findings: Vec<Finding>,
}

impl Explanation {
    /// Measures a scene as its camera sees it. A pure function of scene and settings: no clock is read.
    ///
    /// # Errors
    /// As [`Job::render`].
    pub fn of(job: &Job) -> Result<Explanation, Error> {
        let choice = job.plan()?.map(|plan| plan.choice.clone());
        let measures = job.subject.measures();
        let findings = findings(&measures, choice.as_ref());
        Ok(Explanation { choice, measures, findings })
    }
}

impl Subject {
    fn measures(&self) -> Measures {
        let scene = &*self.scene;
        let mut tracer = Tracer::new(scene, false);
        let (mut seen, mut transparent, mut backs, mut open) = (0u32, 0u32, 0u32, 0u32);
        for (x, y) in (0..GRID * GRID).map(|i| (i % GRID, i / GRID)) {
            let film = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / GRID as f32;
            let ray = self.camera.ray(&CameraSample { film, lens: Vec2::ZERO, time: scene.shutter()[0] });
            let ray = scene.from_camera(ray);
            let Some(surface) = tracer.closest(&ray) else { continue };
            let material = scene.material(&surface).classic(&surface);
            let wo = -Vec3::from(ray.direction);
            seen += 1;
            transparent += u32::from(is_transparent(&material));
            backs += u32::from(!is_transparent(&material) && surface.n_geom.dot(wo) < 0.0);
            open += escapes(&mut tracer, &surface, wo, [x, y]);
        }
        let share = |count: u32, of: u32| count as f32 / of.max(1) as f32;
        let bounds = scene.bounds();
        let shines = |light: &&bilux_scene::scene::SceneLight| light.light.power(&bounds) > 0.0;
        let lights: Vec<_> = scene.lights().iter().filter(shines).collect();
        let mut onto_glass: Vec<(String, f32)> = Vec::new();
        for (i, light) in lights.iter().take(MAX_LIGHTS).enumerate() {
            let share = self.first_onto_glass(&mut tracer, &*light.light, i as u32);
            if share > 0.0 {
                let name =
                    if light.name.is_empty() { format!("light {}", i + 1) } else { light.name.clone() };
                onto_glass.push((name, share));
            }
        }
        onto_glass.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
        let textures = &self.source.textures;
        let is_huge = |size: usize| size > HUGE_TEXTURE;
        Measures {
            surfaces: share(seen, GRID * GRID),
            transparent: share(transparent, seen),
            backs: share(backs, seen),
            open: (seen > 0).then(|| share(open, seen * DIRECTIONS)),
            lights: lights.len(),
            points: lights.iter().filter(|light| light.light.is_delta()).count(),
            has_surroundings: lights.iter().any(|light| light.light.is_infinite()),
            onto_glass,
            huge_textures: textures
                .iter()
                .filter(|t| t.formula().is_none() && (is_huge(t.width()) || is_huge(t.height())))
                .map(|t| (t.name.clone(), t.width(), t.height()))
                .collect(),
            texture_bytes: textures.iter().map(|texture| texture.image.size()).sum(),
        }
    }

    /// Of the rays that leave a light and hit something, the fraction that first hit something transparent or a mirror.
    fn first_onto_glass(
        &self,
        tracer: &mut Tracer,
        light: &dyn bilux_scene::lights::Light,
        index: u32,
    ) -> f32 {
        let scene = &*self.scene;
        let (bounds, time) = (scene.bounds(), scene.shutter()[0]);
        let (mut all, mut glass) = (0.0, 0.0);
        for i in 0..LIGHT_RAYS {
            let mut sampler = PixelSampler::new(0, index, 0, i);
            let (u_point, u_direction) = (sampler.next_2d(), sampler.next_2d());
            let Some(sample) = light.sample_le(&bounds, time, u_point, u_direction) else { continue };
            let Some(surface) = tracer.closest(&sample.spawn(time)) else { continue };
            let flux = sample.le.luminance() * sample.cos() / sample.pdf_emission;
            if !flux.is_finite() {
                continue;
            }
            let material = scene.material(&surface).classic(&surface);
            all += flux;
            glass += if is_transparent(&material) || is_mirror(&material) { flux } else { 0.0 };
        }
        if all > 0.0 { glass / all } else { 0.0 }
    }
}

fn is_transparent(material: &ClassicMaterial) -> bool {
    !material.kt.is_black()
}

/// True for what reflects like a mirror, and hardly otherwise.
fn is_mirror(material: &ClassicMaterial) -> bool {
    material.kd.luminance() < 0.05
        && material.ks.luminance() * material.reflectivity > 0.5
        && material.gloss < 0.05
}

/// The number of directions around a surface in which nothing is hit.
fn escapes(tracer: &mut Tracer, surface: &Surface, wo: Vec3, [x, y]: [u32; 2]) -> u32 {
    let n = if surface.n_geom.dot(wo) < 0.0 { -surface.n_geom } else { surface.n_geom };
    let around = Frame::from_normal(n);
    let is_free = |i: &u32| {
        let u = PixelSampler::new(1, x, y, *i).next_2d();
        let ray: Ray = surface.spawn(around.to_world(warp::sample_cosine_hemisphere(u)));
        tracer.closest(&ray).is_none()
    };
    (0..DIRECTIONS).filter(is_free).count() as u32
}

fn findings(m: &Measures, choice: Option<&Choice>) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut add = |what: String, options: &[&str], advice: Option<&'static str>| {
        let options = options.iter().map(|option| (*option).to_owned()).collect();
        found.push(Finding { what, options, advice });
    };
    let percent = |share: f32| format!("{:.0}%", share * 100.0);
    // Where `auto` has chosen already, only more samples help.
    let by_auto = if choice.is_some() { "--noise 0.02 --time-limit 120" } else { "-i auto" };
    if m.surfaces == 0.0 {
        add(
            "the camera sees no surface at all".to_owned(),
            &[],
            Some(
                "point the camera at the scene with --eye and --look-at, or let the studio frame it with --orbit 26.5,17.8",
            ),
        );
    }
    if m.lights == 0 {
        let what = "no light emits anything: the picture will be black".to_owned();
        add(what, &["--env FILE.hdr"], Some("or add a [[light]] to the scene file"));
    }
    for (name, share) in m.onto_glass.iter().filter(|(_, share)| *share > 0.3).take(3) {
        let what = format!(
            "{} of the light of '{name}' meets glass or a mirror first, and surfaces behind that cannot be connected with it",
            percent(*share)
        );
        add(what, &[by_auto], None);
    }
    if let Some(open) = m.open.filter(|open| m.has_surroundings && *open < 0.1 && *open > 0.0) {
        let what = format!(
            "a closed room: {:.1}% of the directions around visible surfaces lead outside, where light comes from",
            open * 100.0
        );
        add(what, &["--denoise", "--noise 0.02 --time-limit 120"], None);
    }
    if m.lights > MANY_LIGHTS {
        let what = format!("{} lights: each event of a path samples only some of them", m.lights);
        add(what, &[by_auto], None);
    }
    if m.backs > 0.02 {
        let what = format!("{} of the visible surfaces are opaque and show their backs", percent(m.backs));
        add(what, &[], Some("turn their normals round where the model was made, if they look wrong"));
    }
    if let Some((name, width, height)) = m.huge_textures.first() {
        let (count, megabytes) = (m.huge_textures.len(), m.texture_bytes as f64 / 1e6);
        let what = format!(
            "huge textures ({count}): '{name}' has {width} x {height} texels, and all textures take {megabytes:.0} MB of memory"
        );
        add(
            what,
            &[],
            Some("a smaller copy of the file renders the same picture faster, unless the camera is close"),
        );
    }
    if let Some((best, path)) = choice.map(|choice| (choice.best(), &choice.candidates[0])) {
        let factor = slower(path, best);
        if factor > 1.5 {
            let what = format!(
                "to the same noise, path tracing alone takes {factor:.1} times as long as '{}', which auto has chosen",
                best.name
            );
            add(what, &[], None);
        }
        if best.lost > 1e-3 {
            let what = format!("'{}' cannot find {:.1}% of the light", best.name, best.lost * 100.0);
            add(what, &["-i vcm"], None);
        }
    }
    found
}

/// Time that a candidate takes, as a multiple of another's, to the same noise; 1 where there is no light to compare.
pub fn slower(candidate: &Candidate, than: &Candidate) -> f64 {
    let factor = candidate.time_to_error() / than.time_to_error();
    if factor.is_finite() { factor } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_scene::{Parameters, Value};

    fn explained(scene: &bilux_scene::SceneBuilder) -> Explanation {
        let mut user = Parameters::default();
        user.set("size", "64x48");
        user.set("seed", Value::Integer(1));
        Explanation::of(&Job::new(scene, &user).unwrap()).unwrap()
    }

    fn generated(name: &str) -> bilux_scene::SceneBuilder {
        crate::generate(&bilux_scene::Spec::new("", name)).unwrap()
    }

    #[test]
    fn a_box_without_light_is_black() {
        let mut dark = generated("cornell");
        let lit = explained(&dark);
        assert!(lit.measures.lights > 0 && lit.choice.is_some());
        assert!(!lit.findings.iter().any(|finding| finding.what.contains("black")));
        // Without any light, the studio would bring its own.
        dark.lights = vec![bilux_scene::Spec::new("off", "point").with("intensity", 0.0f32)];
        dark.materials.iter_mut().for_each(|spec| spec.parameters.set("emission", 0.0f32));
        let found = explained(&dark);
        assert_eq!(found.measures.lights, 0);
        assert!(found.findings[0].what.contains("black"), "{:?}", found.findings);
    }

    #[test]
    fn a_light_in_glass_is_found_by_name() {
        use bilux_scene::{Object, Spec};
        let mut scene = generated("cornell");
        scene.lights = vec![
            Spec::new("bulb", "sphere")
                .with("position", Vec3::new(0.0, 1.0, 0.0))
                .with("radius", 0.05f32)
                .with("radiance", 50.0f32),
        ];
        let glass = scene.add_material(Spec::new("", "dielectric"));
        let ball = bilux_scene::mesh::shapes::icosphere(Vec3::new(0.0, 1.0, 0.0), 0.15, 3);
        scene.objects.push(Object::new("globe", std::sync::Arc::new(ball), glass));
        let found = explained(&scene);
        let bulb = found.measures.onto_glass.iter().find(|(name, _)| name == "bulb");
        assert!(bulb.is_some_and(|(_, share)| *share > 0.99), "{:?}", found.measures);
        assert!(found.findings.iter().any(|finding| finding.what.contains("'bulb'")), "{:?}", found.findings);
        let advises_auto = |found: &Explanation| found.findings.iter().any(|it| it.options == ["-i auto"]);
        assert!(!advises_auto(&found), "auto is used already");
        scene.settings.set("integrator", "path");
        assert!(advises_auto(&explained(&scene)));
        scene.objects.pop();
        assert!(explained(&scene).measures.onto_glass.iter().all(|(name, _)| name != "bulb"));
    }

    /// One of too many columns and one of too many rows; one that is just small enough is none.
    #[test]
    fn textures_are_huge_by_either_side() {
        let mut scene = generated("cornell");
        scene.settings.set("integrator", "path");
        for (name, width, height) in [("square", 4096, 2), ("wide", 4097, 2), ("high", 3, 4097)] {
            let texels = vec![bilux_math::Rgb::WHITE; width * height];
            scene.textures.push(bilux_scene::Texture::new(name, width, height, texels, false).into());
        }
        let Explanation { measures, findings, .. } = explained(&scene);
        let wanted = [("wide".to_owned(), 4097, 2), ("high".to_owned(), 3, 4097)];
        assert_eq!(measures.huge_textures, wanted);
        let said =
            |finding: &Finding| finding.what.starts_with("huge textures (2): 'wide' has 4097 x 2 texels");
        assert!(findings.iter().any(said), "{findings:?}");
    }
}
