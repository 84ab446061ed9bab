//! Whether a picture was done within its time limit, and where the time went if it was not.

use crate::output;
use bilux::{Job, Outcome};
use std::time::Duration;

/// How much longer than its limit a picture may take: the larger of a duration and a fraction of the limit.
const TOLERANCE: (Duration, f64) = (Duration::from_millis(200), 0.05);

/// Explains in one line why a picture took longer than its limit, if it did. `before` is the time before rendering,
/// `rendering` the seconds of rendering, `all` the total.
pub fn overrun(
    job: &Job,
    outcome: &Outcome,
    before: Duration,
    rendering: f64,
    all: Duration,
) -> Option<String> {
    let limit = job.settings().stop.time_limit?;
    if outcome.cancelled || all <= limit + TOLERANCE.0.max(limit.mul_f64(TOLERANCE.1)) {
        return None;
    }
    let samples = outcome.reached.map_or(0, |reached| reached.spp);
    // The limit was given as an f32, and prints as it was given only as one.
    let limit = limit.as_secs_f32();
    let [before, all] = [before, all].map(|time| time.as_secs_f64());
    let after = (all - before - rendering).max(0.0);
    let samples = output::counted(samples, "sample", "samples");
    Some(format!(
        "took {all:.1} s instead of {limit} s: reading and building {before:.1} s, {samples} per pixel \
         {rendering:.1} s, denoising and writing {after:.1} s"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::scene::{Parameters, Spec, Value};
    use bilux::transport::Silent;

    #[test]
    fn an_overrun_beyond_the_tolerance_is_explained_in_one_line() {
        let scene = bilux::generate(&Spec::new("", "teapot")).unwrap();
        let mut user = Parameters::default();
        for (key, value) in
            [("size", Value::from("8x8")), ("time_limit", 1.0f32.into()), ("spp", Value::Integer(1))]
        {
            user.set(key, value);
        }
        let job = Job::new(&scene, &user).unwrap();
        let outcome = job.render(&Silent).unwrap();
        let after = |seconds: f64| {
            let all = Duration::from_secs_f64(seconds);
            overrun(&job, &outcome, Duration::from_millis(500), 0.5, all)
        };
        assert_eq!(after(1.19), None);
        let line = after(1.5).unwrap();
        let wanted = "took 1.5 s instead of 1 s: reading and building 0.5 s, 1 sample per pixel 0.5 s, denoising and \
                      writing 0.5 s";
        assert_eq!(line, wanted);
    }
}
