//! Bump maps: normals, or heights that become normals.

use bilux_math::{Rgb, Vec3};
use bilux_scene::Texture;
use bilux_scene::texture::{Image, Texels};
use std::sync::Arc;

/// True for a normal map, which many files declare as a bump map: blue, with red and green near the middle.
pub fn holds_normals(texture: &Texture) -> bool {
    let count = texture.texels().count().max(1) as f32;
    let mean = texture.texels().sum::<Rgb>() / count;
    mean.b > 0.65 && (mean.r - 0.5).abs() < 0.15 && (mean.g - 0.5).abs() < 0.15
}

/// Converts a height map to a normal map; white is `bump` texels higher than black.
pub fn normals_of_heights(texture: &Texture, bump: f32) -> Texture {
    normals_of_stretched_heights(texture, [bump, bump])
}

/// Converts a height map to a normal map where texels are not square: white is higher than black by `along_u` widths of a texel,
/// and by `along_v` heights.
pub fn normals_of_stretched_heights(texture: &Texture, [along_u, along_v]: [f32; 2]) -> Texture {
    let (width, height) = (texture.width(), texture.height());
    let at = |x: usize, y: usize| texture.texel(x % width, y % height).luminance();
    let mut bytes = Vec::with_capacity(width * height);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let slope_u = 0.5 * along_u * (at(x + 1, y) - at(x + width - 1, y));
        // Rows run downwards, but v points upwards.
        let slope_v = 0.5 * along_v * (at(x, y + height - 1) - at(x, y + 1));
        let n = Vec3::new(-slope_u, -slope_v, 1.0).normalize();
        let [r, g, b] = (n * 0.5 + 0.5).to_array().map(|c| (c * 255.0).round() as u8);
        bytes.push([r, g, b, 255]);
    }
    let image = Image { width, height, texels: Texels::Bytes(bytes) };
    Texture::of(&texture.name, Arc::new(image), true)
}
