//! Direction of the sun: by a date and an hour at a place, or by its angles.

use super::Options;
use bilux_import::FormatError;
use bilux_math::DVec3;
use bilux_math::transcendental::{asin_f64, atan2_f64, sin_cos_f64, sin_f64};
use std::f64::consts::{PI, TAU};

/// A place on earth, in radians to the north and to the west.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub(super) latitude: f64,
    pub(super) longitude: f64,
    /// Meridian of its standard time.
    pub(super) meridian: f64,
}

impl Default for Site {
    /// Site of the generators unless they are told otherwise: Berkeley.
    fn default() -> Site {
        Site { latitude: 0.66, longitude: 2.13, meridian: 120f64.to_radians() }
    }
}

/// When a sky is to be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Moment {
    Date {
        month: usize,
        day: u32,
        hour: f64,
        /// The hour is that of the sun.
        is_solar: bool,
        /// The meridian of the time zone that was named with the hour, in radians to the west.
        meridian: Option<f64>,
    },
    /// In radians; the azimuth from the south to the west.
    Angles { altitude: f64, azimuth: f64 },
}

/// Angles of the sun, in radians; the azimuth from the south to the west.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Angles {
    pub(super) altitude: f64,
    azimuth: f64,
}

/// Time zones that the generators know, and their meridians in degrees to the west. A few names are there twice; the first counts.
const ZONES: &[(&str, f64)] = &[
    ("YST", 135.0),
    ("YDT", 120.0),
    ("PST", 120.0),
    ("PDT", 105.0),
    ("MST", 105.0),
    ("MDT", 90.0),
    ("CST", 90.0),
    ("CDT", 75.0),
    ("EST", 75.0),
    ("EDT", 60.0),
    ("AST", 60.0),
    ("ADT", 45.0),
    ("NST", 52.5),
    ("NDT", 37.5),
    ("GMT", 0.0),
    ("BST", -15.0),
    ("CET", -15.0),
    ("CEST", -30.0),
    ("EET", -30.0),
    ("EEST", -45.0),
    ("GST", -60.0),
    ("GDT", -75.0),
    ("IST", -82.5),
    ("IDT", -97.5),
    ("JST", -135.0),
    ("NZST", -180.0),
    ("NZDT", -195.0),
];

/// Days before each month, without a leap day.
const BEFORE: [u32; 12] = [0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334];

impl Moment {
    /// The first words of a generator: a month, a day and an hour, or `-ang` with the sun's altitude and azimuth.
    pub(super) fn read(options: &mut Options) -> Result<Moment, FormatError> {
        let month = options.next().unwrap_or_default();
        if month == "-ang" {
            let (altitude, azimuth) = (options.number("-ang")?, options.number("-ang")?);
            return Ok(Moment::Angles { altitude: altitude.to_radians(), azimuth: azimuth.to_radians() });
        }
        let (day, hour) = (options.next().unwrap_or_default(), options.next().unwrap_or_default());
        let month = month.parse().ok().filter(|month| (1..=12).contains(month));
        let day = day.parse().ok().filter(|day| (1..=31).contains(day));
        match (month, day, clock(hour)) {
            (Some(month), Some(day), Some((hour, is_solar, meridian))) => {
                Ok(Moment::Date { month, day, hour, is_solar, meridian })
            }
            _ => options
                .error("needs a month, a day and an hour, such as 6 21 14:30EST, or -ang ALTITUDE AZIMUTH"),
        }
    }

    /// The day of the year; without a date the first.
    pub(super) fn day_of_year(&self) -> f64 {
        match self {
            Moment::Date { month, day, .. } => f64::from(BEFORE[month - 1] + day),
            Moment::Angles { .. } => 0.0,
        }
    }

    /// Angles of the sun. The year counts where it is given. [IES 1984; Michalsky 1988]
    pub(super) fn sun(&self, site: &Site, year: Option<i32>) -> Angles {
        match *self {
            Moment::Angles { altitude, azimuth } => Angles { altitude, azimuth },
            Moment::Date { month, hour, is_solar, meridian, .. } => {
                let meridian = meridian.unwrap_or(site.meridian);
                let (declination, true_hour) = match year {
                    Some(year) => {
                        let leaps = f64::from(u8::from(month > 2 && year % 4 == 0));
                        let years = f64::from((year - 1949) * 365 + (year - 1949).div_euclid(4));
                        let days = self.day_of_year() + leaps + years + (hour + meridian * 12.0 / PI) / 24.0;
                        of_almanac(days + (2_432_916.5 - 2_451_545.0), site.longitude)
                    }
                    None => of_day(self.day_of_year(), hour, meridian - site.longitude),
                };
                seen_from(site.latitude, declination, if is_solar { hour } else { true_hour })
            }
        }
    }
}

/// The declination of the sun and the solar time in hours on a day of the year, so far to the east of the meridian of the clock.
/// [IES 1984]
fn of_day(day: f64, hour: f64, east: f64) -> (f64, f64) {
    let equation =
        0.170 * sin_f64(4.0 * PI / 373.0 * (day - 80.0)) - 0.129 * sin_f64(TAU / 355.0 * (day - 8.0));
    (0.4093 * sin_f64(TAU / 365.0 * (day - 81.0)), hour + equation + 12.0 / PI * east)
}

/// The angles of the sun at a latitude, by its declination and the solar time in hours.
fn seen_from(latitude: f64, declination: f64, hour: f64) -> Angles {
    let ((sin_l, cos_l), (sin_d, cos_d)) = (sin_cos_f64(latitude), sin_cos_f64(declination));
    let (sin_h, cos_h) = sin_cos_f64(hour * PI / 12.0);
    Angles {
        altitude: asin_f64((sin_l * sin_d - cos_l * cos_d * cos_h).clamp(-1.0, 1.0)),
        azimuth: -atan2_f64(cos_d * sin_h, -cos_l * sin_d - sin_l * cos_d * cos_h),
    }
}

impl Angles {
    /// Angles of a sun that is not higher than 87 degrees: the formulas of clear skies do not bear more.
    pub(super) fn below_zenith(self) -> Angles {
        Angles { altitude: self.altitude.min(87f64.to_radians()), ..self }
    }

    /// Towards the sun: x is east, y north, z up.
    pub(super) fn direction(self) -> DVec3 {
        let ((sin_a, cos_a), (sin_e, cos_e)) = (sin_cos_f64(self.azimuth), sin_cos_f64(self.altitude));
        DVec3::new(-sin_a * cos_e, -cos_a * cos_e, sin_e)
    }
}

/// The declination of the sun and the solar time in hours, so many days after noon of the first of January 2000. [Michalsky 1988]
fn of_almanac(days: f64, longitude: f64) -> (f64, f64) {
    let mean = (280.460 + 0.985_647_4 * days).rem_euclid(360.0);
    let anomaly = (357.528 + 0.985_600_3 * days).rem_euclid(360.0).to_radians();
    let ecliptic = (mean + 1.915 * sin_f64(anomaly) + 0.020 * sin_f64(2.0 * anomaly)).to_radians();
    let ((sin, cos), (sin_o, cos_o)) =
        (sin_cos_f64(ecliptic), sin_cos_f64((23.439 - 4e-7 * days).to_radians()));
    let ascension = atan2_f64(sin * cos_o, cos);
    let universal = 24.0 * (days - days.floor()) + 12.0;
    let sidereal = 6.697_375 + 0.065_709_824_2 * days + universal - longitude * 12.0 / PI;
    (asin_f64(sin_o * sin), (sidereal - ascension * 12.0 / PI + 12.0).rem_euclid(24.0))
}

/// An hour such as `14.5`, `14:30`, `14:30EST`, or `+14.5` by the sun: the hour, whether it is the sun's, and the meridian of its
/// time zone in radians.
fn clock(text: &str) -> Option<(f64, bool, Option<f64>)> {
    let (text, is_solar) = text.strip_prefix('+').map_or((text, false), |text| (text, true));
    let end = text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | ':'))).unwrap_or(text.len());
    let (time, zone) = text.split_at(end);
    let hour: f64 = match time.split_once(':') {
        Some((hours, minutes)) => {
            hours.parse::<u32>().ok().map(f64::from)? + minutes.parse::<u32>().ok().map(f64::from)? / 60.0
        }
        None => time.parse().ok()?,
    };
    let meridian = match zone {
        "" => None,
        zone if is_solar || zone.is_empty() => return None,
        zone => {
            let (_, west) = ZONES.iter().find(|(known, _)| known.eq_ignore_ascii_case(zone))?;
            Some(west.to_radians())
        }
    };
    (hour.is_finite() && hour <= 24.0).then_some((hour, is_solar, meridian))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_scene::Span;
    use std::rc::Rc;

    /// Altitude and azimuth as Radiance's `gensky` prints them.
    #[test]
    fn the_sun_stands_where_gensky_has_it() {
        let paris = Site {
            latitude: 48.86f64.to_radians(),
            longitude: -2.35f64.to_radians(),
            meridian: -15f64.to_radians(),
        };
        for (words, site, year, wanted) in SUNS {
            let words: Vec<Rc<str>> = words.split(' ').map(Rc::from).collect();
            let at = Span::default();
            let moment = Moment::read(&mut Options::new(&words, "gensky", &at)).unwrap();
            let site = if *site { paris } else { Site::default() };
            let Angles { altitude, azimuth } = moment.sun(&site, *year);
            let off =
                [altitude, azimuth].map(f64::to_degrees).into_iter().zip(wanted).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 0.051, "{words:?}: {altitude} {azimuth}");
        }
    }

    const SUNS: &[(&str, bool, Option<i32>, [f64; 2])] = &[
        ("6 21 12", false, None, [75.5, -8.8]),
        ("3 1 9.5", false, None, [29.1, -50.1]),
        ("12 21 15:30", false, None, [12.2, 47.0]),
        ("3 20 +10", false, None, [42.5, -42.7]),
        ("6 21 14:30EST", false, None, [73.3, -33.3]),
        ("7 4 8", false, Some(2026), [34.5, -93.6]),
        ("2 29 9", false, Some(2024), [24.9, -57.0]),
        ("10 1 16", true, None, [21.5, 55.1]),
        ("1 15 11:15CET", true, Some(2020), [16.2, -25.4]),
    ];

    #[test]
    fn hours_are_read_in_every_form() {
        assert_eq!(clock("14.5"), Some((14.5, false, None)));
        assert_eq!(clock("+14:30"), Some((14.5, true, None)));
        assert_eq!(clock("9:15CET"), Some((9.25, false, Some((-15f64).to_radians()))));
        for wrong in ["", "noon", "14:", "+9EST", "9XYZ", "1e9", "25"] {
            assert_eq!(clock(wrong), None, "{wrong}");
        }
    }
}
