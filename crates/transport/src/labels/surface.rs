//! The surface that all labels of a pixel describe.

use crate::film::window::Window;
use crate::media::Media;
use crate::schedule::settings::RenderSettings;
use bilux_accel::Hit;
use bilux_math::{DVec2, Vec2, Vec3};
use bilux_scene::{Camera, CameraSample, Ray, Scene, Surface, Tracer};

/// Surface that a pixel is labelled with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Labelled {
    pub(crate) hit: Hit,
    pub(crate) surface: Surface,
    /// The unit direction of the ray.
    direction: Vec3,
}

impl Labelled {
    /// The shading normal, on the visible side.
    pub(crate) fn normal(&self) -> Vec3 {
        visible_normal(&self.surface, self.direction)
    }
}

/// The shading normal of a surface that a ray of this direction hits, on the side of the ray.
pub(crate) fn visible_normal(surface: &Surface, direction: Vec3) -> Vec3 {
    if surface.n_geom.dot(direction) < 0.0 { surface.n_shade } else { -surface.n_shade }
}

/// The rays of labels: of a scene, a camera, and a film.
#[derive(Clone, Copy)]
pub(super) struct LabelRays<'a> {
    pub(super) scene: &'a Scene,
    pub(super) camera: &'a dyn Camera,
    pub(super) settings: &'a RenderSettings,
}

impl LabelRays<'_> {
    /// When the shutter opens, in seconds.
    pub(super) fn opens(&self) -> f32 {
        self.scene.shutter()[0]
    }

    /// The point of the film that stands for a pixel.
    pub(super) fn on_film(&self, x: i64, y: i64) -> DVec2 {
        let place = f64::from(self.settings.pixel_anchor.offset());
        let sides = [self.settings.width, self.settings.height].map(f64::from);
        (DVec2::new(x as f64, y as f64) + place) / DVec2::from(sides)
    }

    /// The ray of a pixel, which may be beside the film: through the centre of the pixel and of the lens, when
    /// the exposure of its row begins.
    pub(super) fn of_pixel(&self, x: i64, y: i64) -> Ray {
        let place = self.settings.pixel_anchor.offset();
        let RenderSettings { width, height, .. } = *self.settings;
        let film = Vec2::new((x as f32 + place) / width as f32, (y as f32 + place) / height as f32);
        let time = self.opens() + self.settings.exposure(self.scene).delay(film);
        let sample = CameraSample { film, lens: Vec2::ZERO, time };
        self.scene.for_labels(self.camera.ray(&sample))
    }

    /// Surface that labels each pixel of a tile; `None` where nothing is visible.
    pub(super) fn of_tile<'s>(&self, tile: &Window, tracer: &mut Tracer<'s>) -> Vec<Option<Labelled>> {
        let places = (0..tile.pixels()).map(|i| tile.position(i));
        let rays: Vec<Ray> = places.map(|(x, y)| self.of_pixel(x.into(), y.into())).collect();
        let mut hits = vec![None; rays.len()];
        tracer.hits(&rays, &mut hits);
        rays.iter().zip(hits).map(|(ray, hit)| labelled(tracer, ray, hit?)).collect()
    }

    /// Surface that labels the pixel of one ray.
    pub(super) fn first(&self, ray: &Ray, tracer: &mut Tracer) -> Option<Labelled> {
        let hit = tracer.hit(ray)?;
        labelled(tracer, ray, hit)
    }
}

/// The first surface that separates two media, given what the ray hits first.
fn labelled(tracer: &mut Tracer, ray: &Ray, mut hit: Hit) -> Option<Labelled> {
    let direction = Vec3::from(ray.direction);
    let mut surface = tracer.surface(ray, &hit);
    if !tracer.scene.has_nested() {
        return Some(Labelled { hit, surface, direction });
    }
    let mut media = Media::at_start(tracer, ray);
    loop {
        match media.end_or_rest(tracer, ray, surface) {
            Ok(end) => {
                // Of faces that coincide it may be another than the one that was hit first.
                let faces = tracer.all_hits(&Ray { t_min: surface.t, t_max: end.t, ..*ray });
                let hit = faces.into_iter().find(|face| face.primitive() == end.primitive).unwrap_or(hit);
                return Some(Labelled { hit, surface: end, direction });
            }
            Err(rest) => {
                hit = tracer.hit(&rest)?;
                surface = tracer.surface(&rest, &hit);
            }
        }
    }
}
