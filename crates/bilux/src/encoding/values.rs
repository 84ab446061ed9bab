//! Specs with their parameters, motions and textures.

use super::code::{Coded, Decoder, Encoder, fields, words};
use super::error::EncodingError;
use bilux_math::motion::Motion;
use bilux_math::motion::numbers::MotionNumbers;
use bilux_math::{DVec3, Rgb};
use bilux_scene::texture::{Channel, Filter, Formula, Image, Texels, UvTransform, Wrap};
use bilux_scene::{Goniometer, IntensityDistribution, Parameters, Span, Spec, Texture, Value};
use std::sync::Arc;

words! {
    Goniometer [Goniometer::C, Goniometer::B, Goniometer::A]
    Wrap [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp]
    Filter [Filter::Linear, Filter::Nearest]
    Channel [Channel::R, Channel::G, Channel::B, Channel::A]
}

impl Coded for Rgb {
    fn write(&self, to: &mut Encoder) {
        self.to_array().write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok(Rgb::from_array(Coded::read(from)?))
    }
}

impl Coded for DVec3 {
    fn write(&self, to: &mut Encoder) {
        self.to_array().write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok(DVec3::from_array(Coded::read(from)?))
    }
}

impl Coded for UvTransform {
    fn write(&self, to: &mut Encoder) {
        self.to_array().write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok(UvTransform::from_array(Coded::read(from)?))
    }
}

impl Coded for Span {
    fn write(&self, to: &mut Encoder) {
        if !to.only_what_is_seen {
            self.file.write(to);
            self.line.write(to);
            self.column.write(to);
        }
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok(Span { file: Coded::read(from)?, line: Coded::read(from)?, column: Coded::read(from)? })
    }
}

impl Coded for Value {
    fn write(&self, to: &mut Encoder) {
        let mut tagged = |tag: u8, value: &dyn Fn(&mut Encoder)| {
            tag.write(to);
            value(to);
        };
        match self {
            Value::Bool(value) => tagged(0, &|to| value.write(to)),
            Value::Integer(value) => tagged(1, &|to| value.write(to)),
            Value::Number(value) => tagged(2, &|to| value.write(to)),
            Value::Text(value) => tagged(3, &|to| value.write(to)),
            Value::List(values) => tagged(4, &|to| values.write(to)),
            Value::Texture(index) => tagged(5, &|to| index.write(to)),
            Value::Material(index) => tagged(6, &|to| index.write(to)),
            Value::Grid(grid) => tagged(7, &|to| grid.write(to)),
            Value::Distribution(distribution) => tagged(8, &|to| distribution.write(to)),
        }
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok(match u8::read(from)? {
            0 => Value::Bool(Coded::read(from)?),
            1 => Value::Integer(Coded::read(from)?),
            2 => Value::Number(Coded::read(from)?),
            3 => Value::Text(Coded::read(from)?),
            4 => Value::List(from.nested(Coded::read)?),
            5 => Value::Texture(Coded::read(from)?),
            6 => Value::Material(Coded::read(from)?),
            7 => Value::Grid(Coded::read(from)?),
            8 => Value::Distribution(Coded::read(from)?),
            tag => return Err(from.wrong(format!("no value has the tag {tag}"))),
        })
    }
}

impl Coded for Arc<IntensityDistribution> {
    fn write(&self, to: &mut Encoder) {
        to.name(&self.name().to_owned());
        self.goniometer().write(to);
        self.azimuths().to_vec().write(to);
        self.polar_angles().to_vec().write(to);
        self.candela().to_vec().write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let (name, goniometer) = (String::read(from)?, Coded::read(from)?);
        let (azimuths, polar, candela) = (Coded::read(from)?, Coded::read(from)?, Coded::read(from)?);
        let read = IntensityDistribution::new(&name, goniometer, azimuths, polar, candela);
        read.map(Arc::new).map_err(|why| from.wrong(why))
    }
}

/// A key, its value and where that was written.
struct Row(String, Value, Span);

impl Coded for Parameters {
    fn write(&self, to: &mut Encoder) {
        self.0.len().write(to);
        for (key, value, span) in &self.0 {
            key.write(to);
            value.write(to);
            span.write(to);
        }
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let rows = Vec::<Row>::read(from)?;
        Ok(Parameters(rows.into_iter().map(|Row(key, value, span)| (key, value, span)).collect()))
    }
}

impl Coded for Row {
    fn write(&self, to: &mut Encoder) {
        self.0.write(to);
        self.1.write(to);
        self.2.write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok(Row(Coded::read(from)?, Coded::read(from)?, Coded::read(from)?))
    }
}

impl Coded for Spec {
    fn write(&self, to: &mut Encoder) {
        to.name(&self.name);
        self.kind.write(to);
        self.parameters.write(to);
        self.span.write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok(Spec {
            name: Coded::read(from)?,
            kind: Coded::read(from)?,
            parameters: Coded::read(from)?,
            span: Coded::read(from)?,
        })
    }
}

impl Coded for Motion {
    fn write(&self, to: &mut Encoder) {
        self.numbers().write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let numbers = MotionNumbers::read(from)?;
        Motion::from_numbers(&numbers).ok_or_else(|| from.wrong("a motion that is not possible"))
    }
}

impl Coded for MotionNumbers {
    fn write(&self, to: &mut Encoder) {
        match self {
            MotionNumbers::Rest => 0u8.write(to),
            MotionNumbers::Still(numbers) => {
                1u8.write(to);
                numbers.write(to);
            }
            MotionNumbers::Keys(keys) => {
                2u8.write(to);
                keys.write(to);
            }
            MotionNumbers::Chain(parts) => {
                3u8.write(to);
                parts.write(to);
            }
        }
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok(match u8::read(from)? {
            0 => MotionNumbers::Rest,
            1 => MotionNumbers::Still(Coded::read(from)?),
            2 => MotionNumbers::Keys(Coded::read(from)?),
            3 => MotionNumbers::Chain(from.nested(Coded::read)?),
            tag => return Err(from.wrong(format!("no motion has the tag {tag}"))),
        })
    }
}

/// The maximum side of the image that stands for a procedural texture.
const MAX_SIDE: usize = 1 << 14;

/// Stored or computed texels: an image, or its size, description and parts.
struct Look(Arc<Image>);

/// The description of a procedural texture.
struct Description {
    width: usize,
    height: usize,
    spec: Spec,
    parts: Vec<Arc<Texture>>,
}

fields! { Description { width, height, spec, parts } }

impl Coded for Look {
    fn write(&self, to: &mut Encoder) {
        let Texels::Formula(computed) = &self.0.texels else {
            0u8.write(to);
            return self.0.write(to);
        };
        1u8.write(to);
        let any = &**computed as &dyn std::any::Any;
        match any.downcast_ref::<Formula>() {
            Some(formula) => Description {
                width: self.0.width,
                height: self.0.height,
                spec: formula.spec().clone(),
                parts: formula.parts().cloned().collect(),
            }
            .write(to),
            None => {
                let described = format!("{computed:?}");
                described.write(to);
                to.tables.computed_by_code = Some(described);
            }
        }
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        match u8::read(from)? {
            0 => Ok(Look(Coded::read(from)?)),
            1 => {
                let Description { width, height, spec, parts } = Coded::read(from)?;
                check_references(&spec, parts.len(), 0).map_err(|what| from.wrong(what))?;
                let formula = Formula::new(spec, parts).map_err(|error| from.wrong(error.to_string()))?;
                let texels = Texels::Formula(Arc::new(formula));
                if ![width, height].iter().all(|side| (1..=MAX_SIDE).contains(side)) {
                    return Err(from.wrong(format!("a procedural texture of {width} x {height} texels")));
                }
                Ok(Look(Arc::new(Image { width, height, texels })))
            }
            tag => Err(from.wrong(format!("no texture has the tag {tag}"))),
        }
    }
}

impl Coded for Texture {
    fn write(&self, to: &mut Encoder) {
        to.name(&self.name);
        Look(self.image.clone()).write(to);
        self.is_data.write(to);
        self.wrap.write(to);
        self.filter.write(to);
        self.transform.write(to);
        self.factor.write(to);
        self.channel.write(to);
        self.threshold.write(to);
        self.second_uv.write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let name = String::read(from)?;
        let Look(image) = Coded::read(from)?;
        let is_data = bool::read(from)?;
        Ok(Texture {
            wrap: Coded::read(from)?,
            filter: Coded::read(from)?,
            transform: Coded::read(from)?,
            factor: Coded::read(from)?,
            channel: Coded::read(from)?,
            threshold: Coded::read(from)?,
            second_uv: Coded::read(from)?,
            ..Texture::of(&name, image, is_data)
        })
    }
}

/// Checks that the textures and materials to which a spec refers exist.
pub(super) fn check_references(spec: &Spec, textures: usize, materials: usize) -> Result<(), String> {
    let wrong = |value: &Value| match value {
        Value::Texture(index) if *index >= textures => Some(format!("texture {index} of {textures}")),
        Value::Material(index) if *index >= materials => Some(format!("material {index} of {materials}")),
        _ => None,
    };
    match spec.parameters.0.iter().find_map(|(_, value, _)| wrong(value)) {
        Some(what) => Err(format!("'{}' refers to {what}", spec.kind)),
        None => Ok(()),
    }
}
