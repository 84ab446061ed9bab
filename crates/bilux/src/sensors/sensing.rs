//! Sensors as users describe them: parameters of the row [`SENSOR`].

use crate::Error;
use bilux_math::photometry::LUMENS_PER_WATT;
use bilux_pictures::Picture;
use bilux_pictures::sensor::{Pattern, Reading, SENSOR, Sensor};
use bilux_scene::{Parameters, Reader, SceneError, Spec};

/// A sensor, and what is wanted of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensing {
    /// The sensor.
    pub sensor: Sensor,
    /// Whether digital numbers are wanted, not the light that they stand for.
    pub is_raw: bool,
}

/// A picture as a sensor sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensed {
    /// Digital numbers, or light in the unit of the picture that was read.
    pub picture: Picture,
    /// The number of pixels that have the largest number, in all planes.
    pub saturated: u64,
}

impl Sensing {
    /// A sensor with these parameters; all others have their defaults.
    ///
    /// # Errors
    /// If a parameter has a wrong name or a value out of range, or both `iso` and `gain` are given.
    pub fn new(parameters: &Parameters) -> Result<Sensing, Error> {
        let mut spec = Spec::new("", SENSOR.name);
        spec.parameters = parameters.clone();
        let reader = Reader::new(&spec, &SENSOR)?;
        if ["iso", "gain"].iter().all(|key| reader.number(key) > 0.0) {
            let message =
                "iso and gain both set how many digital numbers an electron makes: give one of them";
            return Err(SceneError::invalid(message, reader.span("gain")).into());
        }
        let number = |key: &str| reader.number_f64(key);
        let triple = |key: &str| reader.vector_f64(key).to_array();
        let sensor = Sensor {
            unit: if reader.text("unit") == "cd/m2" { 1.0 / f64::from(LUMENS_PER_WATT) } else { 1.0 },
            exposure_time: number("exposure_time"),
            f_number: number("f_number"),
            transmission: number("transmission"),
            pixel_pitch: number("pixel_pitch") * 1e-6,
            wavelength: triple("wavelength").map(|nanometres| nanometres * 1e-9),
            quantum_efficiency: triple("quantum_efficiency"),
            full_well: number("full_well"),
            dark_current: number("dark_current"),
            read_noise: number("read_noise"),
            dark_nonuniformity: number("dark_nonuniformity"),
            response_nonuniformity: number("response_nonuniformity"),
            gain: number("gain"),
            iso: number("iso"),
            black_level: number("black_level"),
            bit_depth: reader.integer("bit_depth") as u32,
            pattern: Pattern::named(&reader.text("pattern")).unwrap_or(Pattern::Mono),
            seed: reader.integer("seed") as u64,
        };
        Ok(Sensing { sensor, is_raw: reader.text("output") == "raw" })
    }

    /// Picture that the sensor makes of a picture's light.
    ///
    /// # Errors
    /// As [`Sensor::read`].
    pub fn sensed(&self, picture: &Picture) -> Result<Sensed, Error> {
        let Reading { raw, saturated } = self.sensor.read(picture)?;
        let picture = if self.is_raw { raw } else { self.sensor.developed(&raw)? };
        Ok(Sensed { picture, saturated })
    }

    /// The numbers that follow from the parameters, in a sentence.
    pub fn summary(&self) -> String {
        let sensor = &self.sensor;
        format!(
            "{:.4} DN/e-, ISO {:.0} (saturation), a grey of {:.4} cd/m2 saturates",
            sensor.system_gain(),
            sensor.iso_speed(),
            sensor.saturating_luminance()
        )
    }
}
