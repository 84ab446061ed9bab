//! The transform directives.

use super::directive::Directive;
use super::lexer::{Token, shown};
use bilux_import::FormatError;
use bilux_import::input::names::unknown;
use bilux_import::world::placement::{look_at, rotation};
use bilux_math::glam::DVec4;
use bilux_math::{DMat4, DVec3};

impl Directive<'_, '_, '_, '_> {
    pub(super) fn transform(&mut self, word: &[u8]) -> Result<(), FormatError> {
        match word {
            b"CoordinateSystem" => {
                let (name, _) = self.lexer.text("the name of a coordinate system")?;
                self.parser.graphics.systems.insert(name, self.parser.graphics.state.matrices);
                return Ok(());
            }
            b"CoordSysTransform" => {
                let (name, at) = self.lexer.text("the name of a coordinate system")?;
                let Some(matrices) = self.parser.graphics.systems.get(&name) else {
                    let names = self.parser.graphics.systems.keys().map(String::as_str);
                    let at = self.lexer.place(at);
                    return Err(unknown("coordinate system", &name, names, &at));
                };
                self.parser.graphics.state.matrices = *matrices;
                return Ok(());
            }
            b"ActiveTransform" => return self.active_transform(),
            b"TransformTimes" => {
                self.parser.document.options.times =
                    [self.lexer.number("a time")?, self.lexer.number("a time")?];
                return Ok(());
            }
            b"Identity" => self.parser.graphics.state.change(|_| DMat4::IDENTITY),
            b"Transform" => {
                let matrix = self.matrix()?;
                self.parser.graphics.state.change(|_| matrix);
            }
            _ => {
                let matrix = self.step(word)?;
                self.parser.graphics.state.change(|before| before * matrix);
            }
        }
        if self.parser.graphics.state.matrices.iter().all(DMat4::is_finite) {
            return Ok(());
        }
        self.error("this transform overflows")
    }

    fn active_transform(&mut self) -> Result<(), FormatError> {
        let (token, at) = self.lexer.need("All, StartTime or EndTime")?;
        self.parser.graphics.state.is_active = match token {
            Token::Word(b"All") => [true, true],
            Token::Word(b"StartTime") => [true, false],
            Token::Word(b"EndTime") => [false, true],
            _ => {
                let message = format!("All, StartTime or EndTime is expected here, not {}", shown(&token));
                return Err(self.lexer.error(message, at));
            }
        };
        Ok(())
    }

    /// The matrix that a directive multiplies the current transform by.
    fn step(&mut self, word: &[u8]) -> Result<DMat4, FormatError> {
        let step = match word {
            b"Translate" => Some(DMat4::from_translation(self.vector("a shift")?)),
            b"Scale" => Some(DMat4::from_scale(self.vector("a scale")?)),
            b"Rotate" => {
                let degrees = self.lexer.number("an angle")?;
                rotation(degrees, self.vector("the axis of a rotation")?)
            }
            b"LookAt" => {
                let [eye, at, up] = [
                    self.vector("the eye")?,
                    self.vector("the point to look at")?,
                    self.vector("the up direction")?,
                ];
                look_at(eye, at, up)
            }
            _ => Some(self.matrix()?),
        };
        match step {
            Some(step) => Ok(step),
            None if word == b"Rotate" => self.error("this rotation has no axis: it must not be 0 0 0"),
            None => self.error("a camera must not look along its own up direction, nor at its own position"),
        }
    }

    fn vector(&mut self, what: &str) -> Result<DVec3, FormatError> {
        let mut number = || self.lexer.number(what);
        Ok(DVec3::new(number()?, number()?, number()?))
    }

    /// 16 numbers in column-major order.
    fn matrix(&mut self) -> Result<DMat4, FormatError> {
        let mut numbers = [0.0; 16];
        let bracket = matches!(self.lexer.peek()?, Some((Token::Open, _)));
        if bracket {
            self.lexer.next()?;
        }
        for number in &mut numbers {
            *number = self.lexer.number("one of 16 numbers of a matrix")?;
        }
        if bracket {
            let (token, at) = self.lexer.need("']' after 16 numbers")?;
            if token != Token::Close {
                let message = format!("a matrix has 16 numbers; ']' is expected here, not {}", shown(&token));
                return Err(self.lexer.error(message, at));
            }
        }
        Ok(self.affine_part(DMat4::from_cols_array(&numbers)))
    }

    /// Forces the last row to be 0 0 0 1. Some exporters leave a 0 in the corner of a matrix that only transforms
    /// directions.
    fn affine_part(&mut self, matrix: DMat4) -> DMat4 {
        let last = matrix.row(3);
        if last == DVec4::W {
            return matrix;
        }
        let what = "a matrix does not end in the row 0 0 0 1: its affine part is used";
        self.parser.loader.note(what, || self.at.clone());
        // Points are divided by their homogeneous coordinate, so a single number there scales all of them.
        let is_scale = last.truncate() == DVec3::ZERO && last.w != 0.0;
        let affine = if is_scale { matrix * last.w.recip() } else { matrix };
        let column = |i: usize| affine.col(i).truncate().extend(if i == 3 { 1.0 } else { 0.0 });
        DMat4::from_cols(column(0), column(1), column(2), column(3))
    }
}
