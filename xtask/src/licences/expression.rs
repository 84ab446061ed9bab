//! Licence expressions, as manifests contain them. [SPDX 2022, annex D]
//!
//! ```text
//! any  = all { ("OR" | "/") all }
//! all  = term { "AND" term }
//! term = "(" any ")" | NAME [ "WITH" EXCEPTION ]
//! ```

use std::iter::Peekable;
use std::vec::IntoIter;

/// Whether the licences in `permitted` alone satisfy the expression. An exception (`WITH …`) only ever permits more, so
/// it does not matter here. `/` is cargo's old way of writing `OR`.
///
/// # Errors
/// If the expression cannot be parsed; the error says where.
pub(crate) fn allows(expression: &str, permitted: &[&str]) -> Result<bool, String> {
    let mut parser = Parser { words: words(expression).into_iter().peekable(), permitted };
    let allowed = parser.any()?;
    match parser.words.next() {
        None => Ok(allowed),
        Some(word) => Err(format!("'{word}' was not expected")),
    }
}

fn words(expression: &str) -> Vec<String> {
    let spaced = expression.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
    spaced.split_whitespace().map(str::to_owned).collect()
}

struct Parser<'a> {
    words: Peekable<IntoIter<String>>,
    permitted: &'a [&'a str],
}

impl Parser<'_> {
    fn any(&mut self) -> Result<bool, String> {
        let mut allowed = self.all()?;
        while self.words.next_if(|word| word == "OR").is_some() {
            allowed |= self.all()?;
        }
        Ok(allowed)
    }

    fn all(&mut self) -> Result<bool, String> {
        let mut allowed = self.term()?;
        while self.words.next_if(|word| word == "AND").is_some() {
            allowed &= self.term()?;
        }
        Ok(allowed)
    }

    fn term(&mut self) -> Result<bool, String> {
        let name = self.name()?;
        if name == "(" {
            let allowed = self.any()?;
            return match self.words.next() {
                Some(word) if word == ")" => Ok(allowed),
                _ => Err("a ')' is missing".to_owned()),
            };
        }
        if self.words.next_if(|word| word == "WITH").is_some() {
            self.name()?;
        }
        Ok(self.permitted.contains(&name.as_str()))
    }

    fn name(&mut self) -> Result<String, String> {
        match self.words.next() {
            Some(word) if !["OR", "AND", "WITH", ")"].contains(&word.as_str()) => Ok(word),
            Some(word) => Err(format!("a licence was expected before '{word}'")),
            None => Err("a licence was expected at the end".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERMITTED: &[&str] = &["MIT", "Apache-2.0", "Zlib", "Unicode-3.0"];

    #[test]
    fn and_binds_closer_than_or() {
        let allows = |expression| allows(expression, PERMITTED);
        assert_eq!(allows("MIT"), Ok(true));
        assert_eq!(allows("GPL-3.0-only"), Ok(false));
        assert_eq!(allows("GPL-3.0-only OR MIT"), Ok(true));
        assert_eq!(allows("GPL-3.0-only AND MIT"), Ok(false));
        assert_eq!(allows("MIT OR GPL-3.0-only AND Zlib"), Ok(true));
        assert_eq!(allows("(MIT OR GPL-3.0-only) AND LGPL-2.1-only"), Ok(false));
        assert_eq!(allows("(MIT OR Apache-2.0) AND Unicode-3.0"), Ok(true));
        assert_eq!(allows("MIT/Apache-2.0"), Ok(true));
        assert_eq!(allows("Apache-2.0 WITH LLVM-exception OR GPL-2.0"), Ok(true));
    }

    #[test]
    fn unreadable_expressions_are_errors() {
        for expression in ["", "MIT OR", "AND MIT", "(MIT", "MIT)", "MIT Zlib", "Apache-2.0 WITH", "()"] {
            assert!(allows(expression, PERMITTED).is_err(), "{expression}");
        }
    }
}
