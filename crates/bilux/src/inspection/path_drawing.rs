//! Draws the path of a sample into a picture, in the colours of the viewer: the more light a segment brings, the wider it is.

use crate::Error;
use crate::inspection::light_path::{LightPath, PathSegment};
use bilux_math::{Rgb, Vec2};
use bilux_pictures::{ColourSpace, Picture};
use bilux_transport::VertexKind;

/// Half the width of what brings no light, in pixels of a picture 640 pixels wide.
const THIN: f32 = 0.75;
/// Half the width that is added for what brings the most.
const WIDEST: f32 = 1.5;
/// The dark border around lines and vertices, so that they are seen before any background.
const BORDER: f32 = 0.9;
/// The radius of a vertex.
const VERTEX: f32 = 2.6;

/// A picture for a display with the path over it, and a mark at the pixel that it belongs to.
///
/// # Errors
/// If the picture has no colour, or memory is short.
pub fn with_path(picture: &Picture, path: &LightPath) -> Result<Picture, Error> {
    let size = [picture.width(), picture.height()];
    let crop = picture.crop;
    let mut canvas = Canvas {
        size,
        pixels: picture.main().into_srgb().to_rgb().unwrap_or_default(),
        corner: crop.map_or(Vec2::ZERO, |crop| Vec2::new(crop.x as f32, crop.y as f32)),
        whole: crop.map_or(size, |crop| crop.whole).map(|side| side as f32).into(),
        scale: (size[0] as f32 / 640.0).max(1.0),
    };
    canvas.pixels.resize(size[0] * size[1], Rgb::BLACK);
    let most = path.segments.iter().map(|segment| segment.light.luminance()).fold(1e-12, f32::max);
    // From the camera, a segment is seen end on.
    let shown = || path.segments.iter().filter(|segment| !segment.from_camera);
    for segment in shown() {
        let [a, b] = segment.ends.map(|end| canvas.place(end));
        let half = canvas.scale * (half_width(segment, most) + BORDER);
        canvas.line([a, b], half, Rgb::BLACK, 0.55 * strength(segment, most));
    }
    for segment in shown() {
        let [a, b] = segment.ends.map(|end| canvas.place(end));
        let half = canvas.scale * half_width(segment, most);
        let colour = colour(segment.kind, segment.light);
        canvas.line([a, b], half, colour, strength(segment, most));
    }
    for (event, place) in path.replay.events.iter().zip(&path.places) {
        let (Some(vertex), Some(place)) = (event.vertex, *place) else { continue };
        let at = canvas.place(place);
        canvas.line([at, at], canvas.scale * (VERTEX + BORDER), Rgb::BLACK, 0.7);
        canvas.line([at, at], canvas.scale * VERTEX, colour(vertex.kind, vertex.light), 1.0);
    }
    canvas.mark(path);
    let mut drawn = Picture::from_rgb(size[0], size[1], canvas.pixels)?;
    drawn.colour_space = ColourSpace::Srgb;
    drawn.crop = crop;
    Ok(drawn)
}

fn half_width(segment: &PathSegment, most: f32) -> f32 {
    let share = (segment.light.luminance() / most).max(0.0);
    if share > 0.0 { THIN + WIDEST * share.sqrt() } else { THIN }
}

/// Opacity of a segment: by the light that it brings or, if it brings none, by how early it comes.
fn strength(segment: &PathSegment, most: f32) -> f32 {
    let share = (segment.light.luminance() / most).max(0.0);
    match share > 0.0 {
        true => 0.45 + 0.55 * share.sqrt(),
        false => (0.9 - 0.15 * segment.depth as f32).max(0.3),
    }
}

/// The colour of a kind of vertex, sRGB-encoded.
fn colour(kind: VertexKind, light: Rgb) -> Rgb {
    let bytes: [u8; 3] = match kind {
        _ if light.luminance() > 0.0 => [0xff, 0xc4, 0x4d],
        VertexKind::Emitter | VertexKind::LightSample | VertexKind::DistantLight => [0xb8, 0x8a, 0x30],
        VertexKind::Surface | VertexKind::Reflection => [0xdf, 0xe9, 0xf5],
        VertexKind::Transmission => [0x7f, 0xd4, 0xee],
        VertexKind::Absorption | VertexKind::Escape => [0x9a, 0xa1, 0xaa],
        VertexKind::Medium => [0xff, 0xff, 0xff],
        VertexKind::LightPath => [0xd7, 0x9b, 0xff],
    };
    Rgb::from_array(bytes.map(|byte| f32::from(byte) / 255.0))
}

/// Pixels that are drawn on, in sRGB.
struct Canvas {
    size: [usize; 2],
    pixels: Vec<Rgb>,
    /// The corner of the canvas in the whole picture, whose size is `whole`.
    corner: Vec2,
    whole: Vec2,
    /// Pixels for each of a picture 640 pixels wide.
    scale: f32,
}

impl Canvas {
    /// The place of a point of the film, in pixels.
    fn place(&self, film: [f32; 2]) -> Vec2 {
        Vec2::from(film) * self.whole - self.corner
    }

    /// A line with round ends, or a disc where both are the same. Its edge fades out over a pixel.
    fn line(&mut self, [a, b]: [Vec2; 2], half: f32, colour: Rgb, opacity: f32) {
        let range = |a: f32, b: f32, side: usize| {
            let (low, high) = (a.min(b) - half - 1.0, a.max(b) + half + 1.0);
            (low.max(0.0) as usize).min(side)..(high.max(0.0).ceil() as usize).min(side)
        };
        let (columns, rows) = (range(a.x, b.x, self.size[0]), range(a.y, b.y, self.size[1]));
        let along = b - a;
        for y in rows {
            for x in columns.clone() {
                let from_a = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - a;
                let t = (from_a.dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
                let covered = (half + 0.5 - (from_a - along * t).length()).clamp(0.0, 1.0);
                let pixel = &mut self.pixels[y * self.size[0] + x];
                *pixel = pixel.lerp(colour, covered * opacity);
            }
        }
    }

    /// A cross around the pixel of the sample, open in the middle.
    fn mark(&mut self, path: &LightPath) {
        let place = path.replay.place;
        let at = Vec2::new(place.x as f32 + 0.5, place.y as f32 + 0.5) - self.corner;
        for (half, colour, opacity) in [(1.8, Rgb::BLACK, 0.6), (0.9, Rgb::WHITE, 1.0)] {
            for way in [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y] {
                let ends = [at + way * (4.5 * self.scale), at + way * (11.0 * self.scale)];
                self.line(ends, half * self.scale, colour, opacity);
            }
        }
    }
}
