//! The sky in patches. [Tregenza 1983]

use bilux_math::Vec3;
use bilux_math::transcendental::turns_of_point;

/// A sky in rows of patches, from the horizon to the zenith, and the ground. Up is +y, north is -z, east is +x.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyPatches {
    rows: Vec<SkyRow>,
    count: usize,
}

/// A row of patches.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SkyRow {
    /// The sine of the elevation of its lower edge.
    height: f32,
    /// The number of its first patch.
    first: usize,
    patches: usize,
}

impl SkyPatches {
    /// From the sine of the elevation at which each row begins, the lowest first, and the number of its patches. The middle of
    /// the first patch of a row is in the north, that of the second to the east of it.
    pub fn new(rows: impl IntoIterator<Item = (f32, usize)>) -> SkyPatches {
        // The ground is number 0.
        let mut first = 1;
        let row = |(height, patches): (f32, usize)| {
            let row = SkyRow { height, first, patches: patches.max(1) };
            first += row.patches;
            row
        };
        let rows = rows.into_iter().map(row).collect();
        SkyPatches { rows, count: first }
    }

    /// The number of patches, with the ground.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The number of the patch in a direction, which need not be of unit length: 0 for the ground.
    pub fn number(&self, direction: Vec3) -> usize {
        let Some(d) = direction.try_normalize().filter(|d| d.y >= 0.0) else { return 0 };
        let Some(row) = self.rows.iter().rev().find(|row| d.y >= row.height) else { return 0 };
        let turns = turns_of_point(-d.z, d.x);
        let place = (turns * row.patches as f32 + 0.5).floor() as i64;
        row.first + place.rem_euclid(row.patches as i64) as usize
    }
}
