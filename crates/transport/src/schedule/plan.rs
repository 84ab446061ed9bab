//! The choice of an integrator that chooses, and the reasons for it.

use std::fmt;

/// The chosen set of techniques, and its rivals.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Index of the chosen candidate.
    pub chosen: usize,
    /// All sets to choose from.
    pub candidates: Vec<Candidate>,
}

/// A set of techniques, and the estimates for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Name of the set.
    pub name: &'static str,
    /// Value of the parameter `techniques` of `auto`.
    pub techniques: &'static str,
    /// Expected relative variance of one sample of a pixel.
    pub error: f64,
    /// The fraction of the light that it cannot find, 0..=1.
    pub lost: f64,
    /// Cost of one sample of a pixel, in nanoseconds of no machine in particular.
    pub nanoseconds: f64,
}

/// Differences up to this fraction of the light are ignored.
const MAY_BE_LOST: f64 = 1e-4;

impl Candidate {
    /// Proportional to the time that a picture of a given error takes.
    pub fn time_to_error(&self) -> f64 {
        self.error * self.nanoseconds
    }

    /// True when it misses light that the other finds.
    pub fn misses_more_than(&self, other: &Candidate) -> bool {
        self.lost > other.lost + MAY_BE_LOST
    }
}

impl Choice {
    /// The chosen set.
    pub fn best(&self) -> &Candidate {
        &self.candidates[self.chosen]
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.best().name)?;
        let best = self.best().time_to_error();
        // Without any light there is nothing to compare.
        if best <= 0.0 || self.candidates.len() < 2 {
            return Ok(());
        }
        write!(f, " (to the same noise")?;
        let mut mark = "";
        for (_, candidate) in self.candidates.iter().enumerate().filter(|(i, _)| *i != self.chosen) {
            let factor = candidate.time_to_error() / best;
            write!(f, "{mark} {} takes {factor:.2} times as long", candidate.name)?;
            if candidate.misses_more_than(self.best()) {
                write!(f, " and misses {:.2}% of the light", candidate.lost * 100.0)?;
            }
            mark = ",";
        }
        write!(f, ")")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each rival has its own time, and its own loss of light, as far as that counts.
    #[test]
    fn a_choice_says_what_its_rivals_take_and_miss() {
        let of =
            |name, error, lost, nanoseconds| Candidate { name, techniques: "", error, lost, nanoseconds };
        let candidates = vec![
            of("paths", 3.0, 0.25, 100.0),
            of("both ends", 0.5, 0.005, 400.0),
            of("photons", 2.0, 0.00505, 800.0),
        ];
        let choice = Choice { chosen: 1, candidates };
        let wanted = "both ends (to the same noise paths takes 1.50 times as long and misses 25.00% of the light, photons \
                      takes 8.00 times as long)";
        assert_eq!(choice.to_string(), wanted);
    }
}
