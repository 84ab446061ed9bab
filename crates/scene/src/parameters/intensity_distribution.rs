//! Measured luminous intensity distributions: what a goniometer found in the directions around a luminaire.

use bilux_math::transcendental::{cos_f64, sin_f64};

/// Orientation of a goniometer's planes about the luminaire. [CIE 121; IES LM-75]
///
/// The luminaire has three perpendicular directions: its axis, which a lamp that hangs points downwards; C0, from which the planes of
/// type C are counted; and C90, which is C0 × axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goniometer {
    /// Half planes about the axis: the polar angle is γ, from the axis, and the azimuth is C, from C0 to C90.
    C,
    /// Planes about C90, for floodlights, whose beam is the axis and whose upper side is C0: the polar angle is H + 90° from C90, and the
    /// azimuth is V, from the axis to C0.
    B,
    /// Planes about C0, for headlights, likewise: the polar angle is V + 90° from -C0, and the azimuth is H, from the axis to -C90.
    A,
}

impl Goniometer {
    /// All of them.
    pub const ALL: [Goniometer; 3] = [Goniometer::C, Goniometer::B, Goniometer::A];
}

/// Luminous intensity over direction, bilinear in the angles between the measured ones, and zero beyond them.
#[derive(Clone, Debug, PartialEq)]
pub struct IntensityDistribution {
    name: String,
    goniometer: Goniometer,
    /// Ascending, in degrees; the last is at most 360 above the first.
    azimuths: Vec<f64>,
    /// Ascending, in degrees, 0..=180.
    polar: Vec<f64>,
    /// In candela, all polar angles of the first azimuth first.
    candela: Vec<f32>,
}

/// The most angles of a kind, a tenth of a degree apart.
pub const MAX_ANGLES: usize = 3601;

/// The largest intensity, in candela: more than of any lighthouse.
const MAX_CANDELA: f32 = 1e12;

impl IntensityDistribution {
    /// A distribution from its angles in degrees and its intensities in candela, all polar angles of the first azimuth first. A single
    /// azimuth stands for all of them.
    ///
    /// # Errors
    /// What is wrong with the numbers: angles that do not ascend or are out of range, or as many as are no measurement; intensities
    /// that are negative, not finite, or not one for each pair of angles.
    pub fn new(
        name: &str,
        goniometer: Goniometer,
        mut azimuths: Vec<f64>,
        polar: Vec<f64>,
        mut candela: Vec<f32>,
    ) -> Result<IntensityDistribution, String> {
        let counts = [(azimuths.len(), 1, "azimuths"), (polar.len(), 2, "polar angles")];
        for (count, least, what) in counts {
            if !(least..=MAX_ANGLES).contains(&count) {
                return Err(format!("{count} {what}: there are {least} to {MAX_ANGLES}"));
            }
        }
        ascend(&azimuths, "azimuths", [-360.0, 720.0])?;
        ascend(&polar, "polar angles", [0.0, 180.0])?;
        let [first, last] = [azimuths[0], azimuths[azimuths.len() - 1]];
        if last - first > 360.0 {
            return Err(format!("azimuths from {first} to {last} go around more than once"));
        }
        let pairs = azimuths.len() * polar.len();
        if candela.len() != pairs {
            return Err(format!("{} intensities for {pairs} pairs of angles", candela.len()));
        }
        if let Some(wrong) = candela.iter().find(|value| !(0.0..=MAX_CANDELA).contains(*value)) {
            return Err(format!("an intensity of {wrong} cd: it is 0 to {MAX_CANDELA}"));
        }
        if azimuths.len() == 1 {
            azimuths = vec![0.0, 360.0];
            candela.extend_from_within(..);
        }
        Ok(IntensityDistribution { name: name.to_owned(), goniometer, azimuths, polar, candela })
    }

    /// Distribution of equal intensity in all directions, in candela.
    pub fn isotropic(candela: f32) -> IntensityDistribution {
        IntensityDistribution {
            name: "isotropic".to_owned(),
            goniometer: Goniometer::C,
            azimuths: vec![0.0, 360.0],
            polar: vec![0.0, 180.0],
            candela: vec![candela; 4],
        }
    }

    /// Name for people.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Orientation of the planes.
    pub fn goniometer(&self) -> Goniometer {
        self.goniometer
    }

    /// The azimuths of its planes in degrees, ascending, at least two.
    pub fn azimuths(&self) -> &[f64] {
        &self.azimuths
    }

    /// The polar angles in degrees, ascending within 0..=180, at least two.
    pub fn polar_angles(&self) -> &[f64] {
        &self.polar
    }

    /// The measured intensities in candela, all polar angles of the first azimuth first.
    pub fn candela(&self) -> &[f32] {
        &self.candela
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&self.candela[..]) + size_of_val(&self.azimuths[..]) + size_of_val(&self.polar[..]))
            as u64
    }

    /// The largest intensity, in candela.
    pub fn peak(&self) -> f32 {
        self.candela.iter().copied().fold(0.0, f32::max)
    }

    /// The intensity in candela at a polar angle and an azimuth in degrees; 0 where nothing was measured.
    pub fn at(&self, polar: f64, azimuth: f64) -> f64 {
        let first = self.azimuths[0];
        let turns = ((azimuth - first) / 360.0).floor();
        let Some((column, right)) = interval(&self.azimuths, azimuth - 360.0 * turns) else { return 0.0 };
        let Some((row, down)) = interval(&self.polar, polar) else { return 0.0 };
        let [above, below] = [0, 1].map(|lower| {
            let [a, b] = self.edge(row + lower, column);
            a + (b - a) * right
        });
        above + (below - above) * down
    }

    /// The intensities at a polar angle, at an azimuth and at the next.
    #[inline]
    pub(crate) fn edge(&self, row: usize, column: usize) -> [f64; 2] {
        [column, column + 1].map(|plane| f64::from(self.candela[plane * self.polar.len() + row]))
    }

    /// The luminous flux between two polar angles and two azimuths, each next to each other, in lumen: the integral of what
    /// [`IntensityDistribution::at`] interpolates, without an error.
    pub(crate) fn flux_of_cell(&self, row: usize, column: usize) -> f64 {
        let [top, bottom] = [row, row + 1].map(|row| self.edge(row, column).iter().sum::<f64>() * 0.5);
        let width = (self.azimuths[column + 1] - self.azimuths[column]).to_radians();
        width * Band::new([self.polar[row], self.polar[row + 1]], [top, bottom]).flux()
    }

    /// The luminous flux in lumen.
    pub fn lumens(&self) -> f64 {
        let cells = (0..self.polar.len() - 1)
            .flat_map(|row| (0..self.azimuths.len() - 1).map(move |column| self.flux_of_cell(row, column)));
        cells.sum()
    }
}

/// The interval of ascending numbers that has a number, and where in it that is, 0..=1.
#[inline]
fn interval(numbers: &[f64], x: f64) -> Option<(usize, f64)> {
    let last = numbers.len() - 1;
    if !(numbers[0]..=numbers[last]).contains(&x) {
        return None;
    }
    let i = numbers[..last].partition_point(|&number| number <= x) - 1;
    Some((i, (x - numbers[i]) / (numbers[i + 1] - numbers[i])))
}

fn ascend(angles: &[f64], what: &str, [least, most]: [f64; 2]) -> Result<(), String> {
    if let Some(pair) = angles.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(format!("the {what} do not ascend: {} is followed by {}", pair[0], pair[1]));
    }
    match angles.iter().find(|angle| !(least..=most).contains(*angle)) {
        Some(wrong) => Err(format!("one of the {what} is {wrong}: they are {least} to {most} degrees")),
        None => Ok(()),
    }
}

/// A band between two polar angles in which intensity is linear in the polar angle.
pub(crate) struct Band {
    /// In radians.
    angles: [f64; 2],
    /// The intensity, extrapolated to a polar angle of 0, and its slope per radian.
    line: [f64; 2],
}

impl Band {
    /// The band between two polar angles in degrees, with the intensity at each.
    pub(crate) fn new(degrees: [f64; 2], ends: [f64; 2]) -> Band {
        let angles = degrees.map(f64::to_radians);
        let slope = (ends[1] - ends[0]) / (angles[1] - angles[0]);
        Band { angles, line: [ends[0] - slope * angles[0], slope] }
    }

    /// An integral of (a + b θ) sin θ.
    fn integral(&self, angle: f64) -> f64 {
        let [a, b] = self.line;
        b * sin_f64(angle) - (a + b * angle) * cos_f64(angle)
    }

    /// The flux of a band one radian wide.
    pub(crate) fn flux(&self) -> f64 {
        (self.integral(self.angles[1]) - self.integral(self.angles[0])).max(0.0)
    }

    /// The polar angle in radians above which this share of the flux is: the inverse of the integral, by Newton's method between
    /// bounds.
    pub(crate) fn angle_of_share(&self, share: f64) -> f64 {
        let [mut low, mut high] = self.angles;
        let begin = self.integral(low);
        let wanted = begin + share * (self.integral(high) - begin);
        let mut angle = low + share * (high - low);
        for _ in 0..40 {
            let off = self.integral(angle) - wanted;
            if off > 0.0 {
                high = angle
            } else {
                low = angle
            }
            let slope = (self.line[0] + self.line[1] * angle) * sin_f64(angle);
            let next = angle - off / slope;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            let is_there = (next - angle).abs() < 1e-12;
            angle = next;
            if is_there {
                break;
            }
        }
        angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn of(azimuths: &[f64], polar: &[f64], candela: &[f32]) -> Result<IntensityDistribution, String> {
        IntensityDistribution::new("", Goniometer::C, azimuths.to_vec(), polar.to_vec(), candela.to_vec())
    }

    #[test]
    fn flux_is_the_integral_in_closed_form() {
        let same = IntensityDistribution::isotropic(100.0);
        assert!((same.lumens() - 400.0 * PI).abs() < 1e-9);
        // I = θ in degrees up to 90: the integral of θ sin θ is sin θ - θ cos θ.
        let rising = of(&[0.0], &[0.0, 90.0], &[0.0, 90.0]).unwrap();
        assert!((rising.lumens() - 2.0 * PI * 180.0 / PI).abs() < 1e-9);
        // A quarter of a half sphere whose intensity rises with the azimuth: its mean is 3.
        let wedge = of(&[10.0, 100.0], &[0.0, 90.0], &[2.0, 2.0, 4.0, 4.0]).unwrap();
        assert!((wedge.lumens() - 3.0 * 0.5 * PI).abs() < 1e-9);
    }

    #[test]
    fn intensity_is_bilinear_and_zero_where_nothing_was_measured() {
        let wedge = of(&[-30.0, 60.0], &[10.0, 90.0], &[0.0, 8.0, 4.0, 4.0]).unwrap();
        assert_eq!([wedge.at(10.0, -30.0), wedge.at(90.0, -30.0), wedge.at(50.0, 330.0)], [0.0, 8.0, 4.0]);
        assert_eq!([wedge.at(10.0, 15.0), wedge.at(50.0, 15.0), wedge.at(90.0, 60.0)], [2.0, 4.0, 4.0]);
        assert_eq!([wedge.at(9.9, 0.0), wedge.at(90.1, 0.0), wedge.at(50.0, 61.0)], [0.0; 3]);
        let around = of(&[0.0], &[0.0, 180.0], &[1.0, 1.0]).unwrap();
        assert!([-540.0, -0.1, 0.0, 359.9, 360.0, 1000.0].iter().all(|c| around.at(70.0, *c) == 1.0));
    }

    #[test]
    fn angles_are_found_from_shares_of_flux() {
        for ends in [[1.0, 1.0], [0.0, 5.0], [5.0, 0.0], [3.0, 3.1]] {
            for degrees in [[0.0, 180.0], [0.0, 1.0], [89.0, 90.0], [179.0, 180.0]] {
                let band = Band::new(degrees, ends);
                for share in [0.0, 1e-6, 0.25, 0.5, 0.999, 1.0] {
                    let angle = band.angle_of_share(share);
                    let above = Band { angles: [band.angles[0], angle], line: band.line };
                    assert!(
                        (above.flux() / band.flux() - share).abs() < 1e-6,
                        "{ends:?} {degrees:?} {share}"
                    );
                }
            }
        }
    }

    #[test]
    fn wrong_numbers_are_refused() {
        let polar = [0.0, 90.0];
        for (azimuths, polar, candela, why) in [
            (&[0.0][..], &[0.0][..], &[1.0][..], "1 polar angles"),
            (&[][..], &polar[..], &[][..], "0 azimuths"),
            (&[0.0, 90.0, 80.0], &polar, &[1.0; 6], "90 is followed by 80"),
            (&[0.0, 361.0], &polar, &[1.0; 4], "more than once"),
            (&[0.0], &[90.0, 181.0], &[1.0; 2], "181"),
            (&[0.0], &[0.0, f64::NAN], &[1.0; 2], "NaN"),
            (&[0.0], &polar, &[1.0, -1.0], "-1 cd"),
            (&[0.0], &polar, &[1.0, f32::NAN], "NaN cd"),
            (&[0.0], &polar, &[1.0], "1 intensities for 2"),
        ] {
            let error = of(azimuths, polar, candela).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
    }
}
