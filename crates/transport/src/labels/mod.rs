//! Labels of pixels: what is there, where, how it is turned and how it moves, each exactly, of one surface.
//!
//! Ids, positions, distances, normals, texture coordinates and motion are labels: a mean of them describes nothing that is
//! there. All labels of a pixel come from a single ray, through the centre of the pixel and of the lens, when the shutter
//! opens. It depends on the camera alone: not on seed, samples, filter or integrator. It stops at the first surface that
//! is there for the camera:
//!
//! - at opaque surfaces, and at mirrors and glass like at any other;
//! - at a surface with an opacity mask where its opacity is at least one half;
//! - not at backs that the camera sees through, nor at boundaries of nested media that separate nothing; of those that
//!   coincide, at the one of the stronger medium.

mod channels;
mod flow;
mod silhouettes;
mod surface;

use crate::film::aovs::Aov;
use crate::film::error::{FilmError, RenderError};
use crate::film::window::{TILE, Window};
use crate::film::zeroed;
use crate::schedule::progress::Progress;
use crate::schedule::settings::{RenderSettings, threads};
use bilux_math::parallel::{install, map};
use bilux_math::{DVec2, Mat4, Vec3};
use bilux_pictures::Picture;
use bilux_scene::{Camera, Scene, Tracer};
use channels::{Channel, Label, Value, channels};
use flow::Flow;
pub use flow::Moment;
pub use silhouettes::{Mask, Silhouette, silhouettes};
pub(crate) use surface::visible_normal;
use surface::{LabelRays, Labelled};

/// Labels that are wanted, and what they need.
#[derive(Clone, Copy, Default)]
pub struct Wanted<'a> {
    /// The labels; others are passed over.
    pub aovs: &'a [Aov],
    /// For each object and sphere of the scene its number among those of its name, from 1.
    pub instances: &'a [u32],
    /// And the number of its category, from 1; 0 for none.
    pub categories: &'a [u32],
    /// The next frame, for motion.
    pub next: Option<Moment<'a>>,
    /// The previous frame.
    pub previous: Option<Moment<'a>>,
}

/// The wanted labels of each pixel of the window, as channels of a picture that has nothing else. Where nothing is visible
/// distances are infinite and all others 0. `None` when it was cancelled.
///
/// # Errors
/// When the size or the crop is invalid, or there is not enough memory or no threads.
pub fn labels(
    scene: &Scene,
    camera: &dyn Camera,
    settings: &RenderSettings,
    wanted: &Wanted,
    progress: &dyn Progress,
) -> Result<Option<Picture>, RenderError> {
    settings.check()?;
    let window = settings.window();
    let rays = LabelRays { scene, camera, settings };
    let look = Look {
        flows: [wanted.next, wanted.previous].map(|moment| Some(Flow::new(&rays, moment?))),
        follows: wanted.aovs.contains(&Aov::Occluded),
        to_camera: camera.matrices(rays.opens()).to_camera,
        channels: channels(wanted.aovs),
        rays,
        wanted,
    };
    let of_tile = |tile: Window| (!progress.is_cancelled()).then(|| look.tile(tile));
    let tiles = install(&threads(settings)?, || map(window.tiles(TILE), of_tile));
    let Some(tiles) = tiles.into_iter().collect::<Option<Vec<Vec<u32>>>>() else { return Ok(None) };
    Ok(Some(look.assembled(window, &tiles)?))
}

/// Everything that stays the same while the pixels are looked at.
struct Look<'a> {
    rays: LabelRays<'a>,
    wanted: &'a Wanted<'a>,
    /// To the next frame and to the previous one.
    flows: [Option<Flow<'a>>; 2],
    /// Whether it is asked what is hidden there.
    follows: bool,
    /// To the space of the camera when the shutter opens.
    to_camera: Mat4,
    channels: Vec<Channel>,
}

impl Look<'_> {
    /// The bits of the numbers of a tile: its pixels in rows, channel by channel.
    fn tile(&self, tile: Window) -> Vec<u32> {
        let mut tracer = Tracer::new(self.rays.scene, false);
        let found = self.rays.of_tile(&tile, &mut tracer);
        let mut others =
            self.flows.each_ref().map(|flow| Some(Tracer::new(flow.as_ref()?.moment.scene, false)));
        let label = |(i, found): (usize, &Option<Labelled>)| {
            let (x, y) = tile.position(i);
            let film = self.rays.on_film(x.into(), y.into());
            found.map_or_else(Label::default, |found| self.label(&found, film, &mut others))
        };
        let labels: Vec<Label> = found.iter().enumerate().map(label).collect();
        let mut bits = Vec::with_capacity(labels.len() * self.channels.len());
        for channel in &self.channels {
            match channel.value {
                Value::Float(of) => bits.extend(labels.iter().map(|label| of(label).to_bits())),
                Value::Integer(of) => bits.extend(labels.iter().map(of)),
            }
        }
        bits
    }

    fn label<'t>(&self, labelled: &Labelled, film: DVec2, others: &mut [Option<Tracer<'t>>; 2]) -> Label
    where
        Self: 't,
    {
        let geometry = self.rays.scene.geometry();
        let (surface, normal) = (&labelled.surface, labelled.normal());
        let object = surface.object;
        let of_object = |numbers: &[u32]| numbers.get(object as usize).copied().unwrap_or_default();
        let (triangle, hit) = (geometry.triangle_of(&labelled.hit), &labelled.hit);
        let to_camera = self.to_camera_at(surface.time);
        let turned = to_camera.transform_vector3(normal);
        let mut label = Label {
            depth: surface.t,
            z_depth: to_camera.transform_point3(surface.p).z,
            normal,
            camera_normal: Vec3::new(turned.x, turned.y, -turned.z),
            object: object + 1,
            material: geometry.material_of(object) + 1,
            instance: of_object(self.wanted.instances),
            category: of_object(self.wanted.categories),
            position: surface.p,
            uv: surface.uv,
            primitive: triangle.map_or(0, |[_, triangle]| triangle + 1),
            barycentric: triangle.map_or([0.0; 2], |_| [hit.u, hit.v]),
            ..Label::default()
        };
        for (i, (flow, tracer)) in self.flows.iter().zip(others).enumerate() {
            let Some((flow, tracer)) = flow.as_ref().zip(tracer.as_mut()) else { continue };
            let there = flow.followed(&self.rays, (labelled, film), tracer, self.follows);
            (label.motion[i], label.occluded[i]) = (there.motion, there.is_hidden);
        }
        label
    }

    /// To the space of the camera when a row is exposed: with a rolling shutter it may have moved on.
    fn to_camera_at(&self, time: f32) -> Mat4 {
        if time == self.rays.opens() { self.to_camera } else { self.rays.camera.matrices(time).to_camera }
    }

    fn assembled(&self, window: Window, tiles: &[Vec<u32>]) -> Result<Picture, FilmError> {
        let mut picture = Picture::new(window.width as usize, window.height as usize)?;
        for (index, channel) in self.channels.iter().enumerate() {
            let mut plane = zeroed::<u32>(window.pixels())?;
            for (tile, bits) in window.tiles(TILE).iter().zip(tiles) {
                let pixels = &bits[index * tile.pixels()..(index + 1) * tile.pixels()];
                for (row, bits) in pixels.chunks(tile.width as usize).enumerate() {
                    if let Some(at) = window.index(tile.x, tile.y + row as u32) {
                        plane[at..at + bits.len()].copy_from_slice(bits);
                    }
                }
            }
            match channel.value {
                Value::Integer(_) => picture.push_integer_plane(&*channel.name, plane)?,
                Value::Float(_) => {
                    picture.push_channel(&*channel.name, plane.into_iter().map(f32::from_bits).collect())?;
                }
            }
        }
        Ok(picture)
    }
}
