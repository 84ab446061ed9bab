//! Returns that a scanner makes of the echoes of a pulse.

use super::echoes::Echo;
use super::{Keep, Return, Scanner};
use bilux_math::Stream;

impl Scanner {
    /// Adds the returns of a pulse with these echoes, which are sorted.
    pub(super) fn returns(&self, pulse: usize, echoes: &mut [Echo], found: &mut Vec<Return>) {
        echoes.sort_by(|a, b| a.range.total_cmp(&b.range).then(a.object.cmp(&b.object)));
        let begin = found.len();
        // Each begins with an echo that is farther than this from the one before it.
        for group in echoes.chunk_by(|a, b| b.range - a.range <= self.separation) {
            let intensity: f64 = group.iter().map(|echo| echo.power).sum();
            let range = group.iter().map(|echo| echo.power * echo.range).sum::<f64>() / intensity;
            let is_measured = (self.range[0]..=self.range[1]).contains(&range) && intensity >= self.threshold;
            if let Some(object) = most_of(group).filter(|_| is_measured) {
                found.push(Return { pulse, number: 0, count: 0, range, intensity, object });
            }
        }
        let count = (found.len() - begin) as u32;
        for (number, one) in (1..).zip(&mut found[begin..]) {
            let mut noise = Stream::new([self.seed, pulse as u64, number]);
            (one.number, one.count) = (number as u32, count);
            one.range += self.range_noise * noise.normal();
            one.intensity *= (1.0 + self.intensity_noise * noise.normal()).max(0.0);
        }
        let all = &found[begin..];
        let kept = match self.keep {
            Keep::All => return,
            Keep::First => all.first(),
            Keep::Last => all.last(),
            Keep::Strongest => all.iter().max_by(|a, b| a.intensity.total_cmp(&b.intensity)),
        };
        let kept = kept.copied();
        found.truncate(begin);
        found.extend(kept);
    }
}

/// The object that sends back most of these echoes' power, all of its own together; of equal ones the nearest.
fn most_of(group: &[Echo]) -> Option<u32> {
    let mut sums: Vec<(u32, f64)> = Vec::new();
    for Echo { object, power, .. } in group {
        match sums.iter_mut().find(|(known, _)| known == object) {
            Some((_, sum)) => *sum += power,
            None => sums.push((*object, *power)),
        }
    }
    sums.into_iter().rev().max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(object, _)| object)
}
