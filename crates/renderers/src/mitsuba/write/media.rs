//! Writes what fills shapes.

use super::document::{Document, Inside};
use bilux_import::output::values::{colour, number};
use bilux_import::output::writing::Writing;
use bilux_math::transcendental::ln;
use bilux_math::{DMat4, DVec3, Rgb};
use bilux_scene::media::Grid;
use bilux_scene::{Spec, Value};

/// The medium inside of a material, if it changes anything.
pub(super) fn inside(spec: &Spec) -> Option<Inside> {
    let part = |key| colour(spec, key).unwrap_or(Rgb::BLACK);
    let mut inside = Inside {
        absorption: part("absorption"),
        scattering: part("scattering"),
        anisotropy: number(spec, "scattering_anisotropy").unwrap_or(0.0),
        density: match spec.parameters.find("density") {
            Some((Value::Grid(grid), _)) => Some(grid.clone()),
            _ => None,
        },
    };
    let depth = number(spec, "transmission_depth").filter(|depth| *depth > 0.0);
    if let (Some(depth), Some(1.0)) = (depth, number(spec, "transmission_weight")) {
        let shade = colour(spec, "transmission_color").unwrap_or(Rgb::WHITE);
        inside.absorption = shade.map(|c| -ln(c.max(1e-6)) / depth);
    }
    (!(inside.absorption.is_black() && inside.scattering.is_black())).then_some(inside)
}

impl Document<'_> {
    /// Writes the medium inside of a shape with this transform to the world.
    pub(super) fn interior(&mut self, inside: &Inside, to_world: DMat4, writing: &mut Writing) {
        let extinction = inside.absorption + inside.scattering;
        let albedo = inside.scattering.to_array();
        let shares = std::array::from_fn(|i| {
            let all = extinction.to_array()[i];
            if all > 0.0 { albedo[i] / all } else { 0.0 }
        });
        let kind = if inside.density.is_some() { "heterogeneous" } else { "homogeneous" };
        self.open(&format!("medium type=\"{kind}\" name=\"interior\""));
        match &inside.density {
            None => {
                // Colours of volumes are at most 1 there.
                let most = extinction.max_channel().max(1.0);
                self.number("scale", most);
                self.rgb("sigma_t", extinction * (1.0 / most));
            }
            Some(grid) => {
                if extinction != Rgb::grey(extinction.r) {
                    writing
                        .warn("Mitsuba's media that vary extinguish all colours alike: the mean is written");
                }
                let mean = (extinction.r + extinction.g + extinction.b) / 3.0;
                self.number("scale", mean);
                self.volume(grid, to_world, writing);
            }
        }
        self.rgb("albedo", Rgb::from_array(shares));
        if inside.anisotropy != 0.0 {
            self.open("phase type=\"hg\"");
            self.number("g", inside.anisotropy);
            self.close("phase");
        }
        self.close("medium");
    }

    /// A grid, which fills the unit cube before its transform.
    fn volume(&mut self, grid: &Grid, to_world: DMat4, writing: &mut Writing) {
        let size = DVec3::from(grid.size().map(|side| side as f64));
        let place = to_world * grid.to_object().matrix().as_dmat4() * DMat4::from_scale(size);
        let file = writing.add_numbered("grid", writing.count() + 1, "vol", encoded(grid));
        self.open("volume type=\"gridvolume\" name=\"sigma_t\"");
        self.text("filename", &file);
        self.matrix("to_world", place.as_mat4());
        self.close("volume");
    }
}

/// Floats of one channel, x first, in the unit cube. [Jakob 2022]
fn encoded(grid: &Grid) -> Vec<u8> {
    let [width, height, depth] = grid.size();
    let mut out = b"VOL\x03".to_vec();
    let header = [1, width as i32, height as i32, depth as i32, 1];
    out.extend(header.iter().flat_map(|number| number.to_le_bytes()));
    out.extend([0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().flat_map(|number| number.to_le_bytes()));
    for (z, y) in (0..depth).flat_map(|z| (0..height).map(move |y| (z, y))) {
        out.extend((0..width).flat_map(|x| grid.voxel([x, y, z]).to_le_bytes()));
    }
    out
}
