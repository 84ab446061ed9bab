//! The optical length of a path while it grows, for pictures that are divided by it. Nothing else follows it.

use bilux_math::Vec3;

/// A vertex, as far as lengths need it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathPoint {
    pub(crate) p: Vec3,
    /// The direction that the path came from, a unit vector.
    pub(crate) wo: Vec3,
    /// The normal on the outside of a surface; zero in a medium.
    pub(crate) n: Vec3,
    /// The index of refraction behind the surface over that in front of it.
    pub(crate) eta: f32,
}

/// A path from its start to its last vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpticalPath {
    /// Optical length, in metres; infinite if the path comes from infinity.
    length: f64,
    p: Vec3,
    /// The index of refraction on the side that it came from, over that around its start.
    index: f64,
    /// The last vertex, once there is one.
    last: Option<PathPoint>,
}

impl OpticalPath {
    /// A path that starts at a point.
    pub(crate) fn from(p: Vec3) -> OpticalPath {
        OpticalPath { length: 0.0, p, index: 1.0, last: None }
    }

    /// A path that comes from infinity, through this point.
    pub(crate) fn from_infinity(p: Vec3) -> OpticalPath {
        OpticalPath { length: f64::INFINITY, ..OpticalPath::from(p) }
    }

    /// Optical length so far, in metres.
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// The index of refraction of what it goes on through in a direction.
    fn index_towards(&self, direction: Vec3) -> f64 {
        match self.last {
            Some(PathPoint { wo, n, eta, .. }) if wo.dot(n) * direction.dot(n) < 0.0 => {
                let eta = f64::from(eta);
                if direction.dot(n) < 0.0 { self.index * eta } else { self.index / eta }
            }
            _ => self.index,
        }
    }

    /// Optical length up to a point along its next ray.
    pub(crate) fn length_to(&self, p: Vec3) -> f64 {
        let on = p - self.p;
        self.length + f64::from(on.length()) * self.index_towards(on)
    }

    /// Optical length up to a point along its next ray, or its last vertex, and from there on in a direction for this distance;
    /// infinite without one.
    pub(crate) fn length_by(&self, from: Vec3, direction: Vec3, distance: Option<f32>) -> f64 {
        let ray = if from == self.p { direction } else { from - self.p };
        let on = distance.map_or(f64::INFINITY, |distance| f64::from(distance) * self.index_towards(ray));
        self.length_to(from) + on
    }

    /// Goes on to its next vertex.
    pub(crate) fn reach(&mut self, place: PathPoint) {
        (self.length, self.index) = (self.length_to(place.p), self.index_towards(place.p - self.p));
        (self.p, self.last) = (place.p, Some(place));
    }
}

/// Intervals of optical length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LengthBins {
    /// Start of the first interval, in metres.
    pub begin: f64,
    /// Length of each interval, in metres.
    pub width: f64,
    /// Number of intervals.
    pub count: u32,
}

impl LengthBins {
    /// The interval of a length; their number for a length outside of all.
    pub(crate) fn of(&self, length: f64) -> usize {
        let place = ((length - self.begin) / self.width).floor();
        if place >= 0.0 && place < f64::from(self.count) { place as usize } else { self.count as usize }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_counts_by_its_index_on_the_way_in_and_not_after_it() {
        let mut way = OpticalPath::from(Vec3::new(0.0, 0.0, 5.0));
        let face = |z: f32, n: Vec3| PathPoint { p: Vec3::Z * z, wo: Vec3::Z, n, eta: 1.5 };
        way.reach(face(3.0, Vec3::Z));
        assert_eq!((way.length(), way.length_to(Vec3::Z * 4.0)), (2.0, 3.0));
        way.reach(face(1.0, -Vec3::Z));
        assert_eq!(way.length(), 2.0 + 2.0 * 1.5);
        assert_eq!(way.length_to(Vec3::Z * -1.0), 7.0);
        assert_eq!(way.length_by(Vec3::Z, Vec3::Z, Some(2.0)), 5.0 + 3.0);
        assert_eq!(way.length_by(Vec3::Z, -Vec3::Z, None), f64::INFINITY);
    }

    #[test]
    fn lengths_outside_belong_to_no_interval() {
        let bins = LengthBins { begin: 1.0, width: 0.5, count: 4 };
        let found = [0.9, 1.0, 1.49, 2.99, 3.0, f64::INFINITY, f64::NAN].map(|length| bins.of(length));
        assert_eq!(found, [4, 0, 0, 3, 4, 4, 4]);
    }
}
