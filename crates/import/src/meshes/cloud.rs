//! Point clouds. Their coordinates may be large compared with their extent, so they are stored relative to an
//! origin of their own, where 32-bit floats suffice.

use crate::FormatError;
use crate::bytes::budget::Budget;
use crate::input::reading::plain_material;
use bilux_math::{DVec3, Rgb, Vec3};
use bilux_scene::{Mesh, Object, SceneBuilder};
use std::sync::Arc;

/// A point cloud while it is being read.
#[derive(Default)]
pub struct Cloud {
    origin: Option<DVec3>,
    pub positions: Vec<Vec3>,
    /// One colour per position, or none. Linear.
    pub colours: Vec<Rgb>,
}

/// Coordinates beyond this are stored relative to an origin. Below it, 32-bit floats resolve a tenth of a
/// millimetre if the unit is the metre.
const FAR: f64 = 1024.0;

/// The origin for coordinates such as these: whole numbers, and zero where they are small.
pub fn origin_for(p: DVec3) -> DVec3 {
    let of = |c: f64| if c.is_finite() && c.abs() >= FAR { c.round() } else { 0.0 };
    DVec3::new(of(p.x), of(p.y), of(p.z))
}

/// The number of points, spread over a file, that tell where most of them are.
pub const SAMPLES: usize = 9;

/// A first point that is farther than this from most others is not one of them: scanners write zeros where nothing
/// came back.
const OUTSIDE: f64 = 16.0 * FAR;

impl Cloud {
    /// An empty cloud, given its first point and some that are spread over the file.
    pub fn around(first: DVec3, samples: &[DVec3]) -> Cloud {
        let middle = |axis: usize| {
            let mut all: Vec<f64> = samples.iter().map(|p| p[axis]).filter(|c| c.is_finite()).collect();
            all.sort_by(f64::total_cmp);
            all.get(all.len() / 2).copied().unwrap_or(first[axis])
        };
        let middle = DVec3::new(middle(0), middle(1), middle(2));
        let is_one_of_them = (first - middle).abs().max_element() <= OUTSIDE;
        let origin = origin_for(if is_one_of_them { first } else { middle });
        Cloud { origin: Some(origin), ..Cloud::default() }
    }

    /// Reserves memory for points, with or without colours, and charges the budget for it.
    pub fn reserve(
        &mut self,
        count: u64,
        colours: bool,
        budget: &mut Budget,
        file: &str,
    ) -> Result<(), FormatError> {
        let each = size_of::<(Vec3, u32)>() + if colours { size_of::<Rgb>() } else { 0 };
        let bytes = count.saturating_mul(each as u64);
        budget.take_bytes(bytes, file)?;
        self.positions.reserve_exact(count as usize);
        self.colours.reserve_exact(if colours { count as usize } else { 0 });
        Ok(())
    }

    /// Adds a point.
    #[inline]
    pub fn push(&mut self, p: DVec3) {
        let origin = *self.origin.get_or_insert_with(|| origin_for(p));
        self.positions.push((p - origin).as_vec3());
    }

    /// Builds the scene of the cloud.
    pub fn into_scene(self, name: String) -> SceneBuilder {
        let count = self.positions.len();
        self.into_scene_of(vec![(name, count)])
    }

    /// Builds the scene of a cloud of several parts, each with its name and the number of its points.
    pub fn into_scene_of(mut self, parts: Vec<(String, usize)>) -> SceneBuilder {
        let mut scene = SceneBuilder { origin: self.origin.unwrap_or_default(), ..SceneBuilder::default() };
        let material = scene.add_material(plain_material(!self.colours.is_empty(), false));
        // From the last to the first, so that each is cut off at the end.
        for (name, count) in parts.into_iter().rev().filter(|(_, count)| *count > 0) {
            let first = self.positions.len().saturating_sub(count);
            let mesh = Mesh {
                name: name.clone(),
                positions: if first == 0 {
                    std::mem::take(&mut self.positions)
                } else {
                    self.positions.split_off(first)
                },
                vertex_kd: match first {
                    0 => std::mem::take(&mut self.colours),
                    _ => self.colours.split_off(first.min(self.colours.len())),
                },
                points: (0..count as u32).collect(),
                ..Mesh::default()
            };
            scene.objects.push(Object::new(&name, Arc::new(mesh), material));
        }
        scene.objects.reverse();
        scene
    }
}
