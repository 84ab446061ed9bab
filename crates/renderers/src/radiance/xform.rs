//! `xform`: moves, turns, scales, mirrors and repeats what a file or the program before it says. [Ward 1994]

use bilux_import::FormatError;
use bilux_import::bytes::float::parse_f64;
use bilux_import::world::placement::rotation;
use bilux_math::{DMat4, DVec3};
use bilux_scene::Span;
use std::rc::Rc;

/// The arguments of `xform`.
#[derive(Clone, Debug)]
pub(super) struct Xform {
    /// Modifier of all surfaces, in place of their own modifiers.
    pub(super) modifier: Option<Rc<str>>,
    /// Prefix of the names of all surfaces.
    prefix: Option<Rc<str>>,
    /// Whether surfaces are turned inside out.
    pub(super) inverts: bool,
    groups: Vec<Group>,
    /// The files to read; without any, it transforms what the program before it writes.
    pub(super) files: Vec<Rc<str>>,
}

/// Transforms that are applied in their order, some number of times.
#[derive(Clone, Copy, Debug)]
struct Group {
    matrix: DMat4,
    /// Number of times that each copy has the transforms; in an array, once more than the copy before.
    times: u32,
    /// The number of copies, for an array.
    copies: Option<u32>,
}

impl Xform {
    /// Reads the arguments, without the program's name.
    pub(super) fn parse(words: &[Rc<str>], at: &Span) -> Result<Xform, FormatError> {
        let mut reader = Reader { words, next: 0, at };
        let mut xform = Xform {
            modifier: None,
            prefix: None,
            inverts: false,
            groups: vec![Group::ONCE],
            files: Vec::new(),
        };
        while let Some(word) = reader.peek() {
            match word {
                "-m" => xform.modifier = xform.modifier.or(Some(reader.text()?)),
                "-n" => {
                    let name = reader.text()?;
                    xform.prefix = Some(joined(xform.prefix.as_deref(), &name));
                }
                "-I" => xform.inverts = !xform.inverts,
                // Whether commands in the file are expanded makes no difference in the end.
                "-c" | "-e" => {}
                _ => break,
            }
            reader.next += 1;
        }
        reader.transforms(&mut xform)?;
        xform.files = words[reader.next.min(words.len())..].to_vec();
        match xform.files.iter().find(|file| file.starts_with('-')) {
            Some(file) => {
                let message = format!(
                    "'{file}' is no option of xform here: -m, -n and -I come first, then -t, -rx, -ry, -rz, -s, -mx, -my, -mz, -i and \
                     -a, then files"
                );
                Err(FormatError::malformed(message, at.clone()))
            }
            None => Ok(xform),
        }
    }

    /// The number of copies.
    pub(super) fn copies(&self) -> u64 {
        let of = |group: &Group| u64::from(group.copies.unwrap_or(1));
        self.groups.iter().map(of).fold(1, u64::saturating_mul)
    }

    /// The transform of a copy, and what precedes the names of its surfaces. The first array varies slowest.
    pub(super) fn copy(&self, mut number: u64) -> (DMat4, Option<Rc<str>>) {
        let mut powers: Vec<u32> = vec![0; self.groups.len()];
        for (power, group) in powers.iter_mut().zip(&self.groups).rev() {
            *power = group.times;
            if let Some(copies) = group.copies {
                *power = (number % u64::from(copies)) as u32;
                number /= u64::from(copies);
            }
        }
        let mut matrix = DMat4::IDENTITY;
        let mut prefix = self.prefix.clone();
        for (power, group) in powers.into_iter().zip(&self.groups) {
            matrix = power_of(group.matrix, power) * matrix;
            if group.copies.is_some() {
                prefix = Some(match prefix {
                    Some(prefix) => joined(Some(&*prefix), &power.to_string()),
                    None => format!("a{power}").into(),
                });
            }
        }
        (matrix, prefix)
    }
}

/// Two parts of a name.
pub(super) fn joined(first: Option<&str>, second: &str) -> Rc<str> {
    match first {
        Some(first) if !first.is_empty() => format!("{first}.{second}").into(),
        _ => second.into(),
    }
}

/// A matrix times itself, so often.
fn power_of(mut matrix: DMat4, mut times: u32) -> DMat4 {
    let mut power = DMat4::IDENTITY;
    while times > 0 {
        if times & 1 == 1 {
            power = matrix * power;
        }
        matrix = matrix * matrix;
        times >>= 1;
    }
    power
}

impl Group {
    const ONCE: Group = Group { matrix: DMat4::IDENTITY, times: 1, copies: None };
}

struct Reader<'a> {
    words: &'a [Rc<str>],
    next: usize,
    at: &'a Span,
}

impl Reader<'_> {
    fn peek(&self) -> Option<&str> {
        self.words.get(self.next).map(|word| &**word)
    }

    fn error<T>(&self, what: &str) -> Result<T, FormatError> {
        let word = self.words.get(self.next).map_or("", |word| word);
        Err(FormatError::malformed(format!("xform needs {what} at '{word}'"), self.at.clone()))
    }

    /// The word after an option.
    fn text(&mut self) -> Result<Rc<str>, FormatError> {
        self.next += 1;
        match self.words.get(self.next) {
            Some(word) => Ok(word.clone()),
            None => self.error("another word"),
        }
    }

    fn number(&mut self) -> Result<f64, FormatError> {
        let text = self.text()?;
        match parse_f64(text.as_bytes()) {
            Some(number) if number.is_finite() => Ok(number),
            _ => self.error("a number"),
        }
    }

    fn count(&mut self, least: u32) -> Result<u32, FormatError> {
        match self.text()?.parse() {
            Ok(count) if count >= least => Ok(count),
            _ => self.error("a whole number"),
        }
    }

    /// Reads transforms up to the first file.
    fn transforms(&mut self, xform: &mut Xform) -> Result<(), FormatError> {
        while let Some(word) = self.peek() {
            let mirror = |axis: DVec3| DMat4::from_scale(DVec3::ONE - 2.0 * axis);
            let matrix = match word {
                "-t" => DMat4::from_translation(DVec3::new(self.number()?, self.number()?, self.number()?)),
                "-rx" => self.turn(DVec3::X)?,
                "-ry" => self.turn(DVec3::Y)?,
                "-rz" => self.turn(DVec3::Z)?,
                "-s" => match self.number()? {
                    0.0 => return self.error("a factor that is not 0"),
                    factor => DMat4::from_scale(DVec3::splat(factor)),
                },
                "-mx" => mirror(DVec3::X),
                "-my" => mirror(DVec3::Y),
                "-mz" => mirror(DVec3::Z),
                "-i" => {
                    let times = self.count(0)?;
                    xform.groups.push(Group { times, ..Group::ONCE });
                    self.next += 1;
                    continue;
                }
                "-a" => {
                    let copies = self.count(1)?;
                    xform.groups.push(Group { copies: Some(copies), ..Group::ONCE });
                    self.next += 1;
                    continue;
                }
                _ => break,
            };
            if let Some(group) = xform.groups.last_mut() {
                group.matrix = matrix * group.matrix;
            }
            self.next += 1;
        }
        Ok(())
    }

    fn turn(&mut self, axis: DVec3) -> Result<DMat4, FormatError> {
        Ok(rotation(self.number()?, axis).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Xform {
        let words: Vec<Rc<str>> = text.split_whitespace().map(Rc::from).collect();
        Xform::parse(&words, &Span::default()).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[track_caller]
    fn moves(text: &str, copy: u64, from: [f64; 3], to: [f64; 3]) {
        let (matrix, _) = parse(text).copy(copy);
        let found = matrix.transform_point3(DVec3::from(from));
        assert!(found.distance(DVec3::from(to)) < 1e-12, "{text} {copy}: {found}");
    }

    /// By hand, and as the program itself writes them.
    #[test]
    fn transforms_apply_in_their_order() {
        moves("-t 1 2 3 -s 2", 0, [0.0; 3], [2.0, 4.0, 6.0]);
        moves("-s 2 -t 1 2 3", 0, [0.0; 3], [1.0, 2.0, 3.0]);
        moves("-rx 90", 0, [1.0, 2.0, 3.0], [1.0, -3.0, 2.0]);
        moves("-ry 90", 0, [1.0, 2.0, 3.0], [3.0, 2.0, -1.0]);
        moves("-rz 90", 0, [1.0, 2.0, 3.0], [-2.0, 1.0, 3.0]);
        moves("-mx -t 1 0 0", 0, [1.0, 2.0, 3.0], [0.0, 2.0, 3.0]);
        moves("-rz 30 -i 3 -t 1 0 0 -rz 90", 0, [0.0; 3], [-1.0, 0.0, 0.0]);
        moves("-i 5 -t 0 0 2 -i 1 -mz", 0, [0.0, 0.0, 1.0], [0.0, 0.0, -11.0]);
        moves("-i 0 -t 9 9 9 -i 1 -my", 0, [1.0, 2.0, 3.0], [1.0, -2.0, 3.0]);
    }

    #[test]
    fn arrays_of_arrays_vary_the_first_slowest() {
        let text = "-n chair -t 0 0 5 -a 2 -t 10 0 0 -a 3 -t 0 1 0 chair.rad";
        let xform = parse(text);
        assert_eq!((xform.copies(), &*xform.files[0]), (6, "chair.rad"));
        moves(text, 0, [0.0; 3], [0.0, 0.0, 5.0]);
        moves(text, 2, [0.0; 3], [0.0, 2.0, 5.0]);
        moves(text, 4, [0.0; 3], [10.0, 1.0, 5.0]);
        assert_eq!(xform.copy(4).1.as_deref(), Some("chair.1.1"));
        assert_eq!(parse("-a 4 -rz 90").copy(3).1.as_deref(), Some("a3"));
        assert_eq!(parse("-a 4294967295 -a 4294967295 -a 4294967295 -t 1 0 0").copies(), u64::MAX);
    }

    #[test]
    fn wrong_arguments_are_refused() {
        for text in
            ["-t 1 2", "-s 0", "-rx a", "-a 0", "-a -1", "-i", "-t 1 2 3 -n a", "-x f", "-t 1 2 1e999"]
        {
            let words: Vec<Rc<str>> = text.split_whitespace().map(Rc::from).collect();
            let message = Xform::parse(&words, &Span::default()).unwrap_err().to_string();
            assert!(message.contains("xform"), "{text}: {message}");
        }
    }
}
