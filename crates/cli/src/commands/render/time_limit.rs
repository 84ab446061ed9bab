//! Whether a picture was done within its time limit, and where the time went if it was not.

use super::log::counted_samples;
use bilux::{Job, Outcome};
use std::time::Duration;

/// Time by which a picture may exceed its limit: the larger of a duration and a fraction of the limit.
const TOLERANCE: (Duration, f64) = (Duration::from_millis(200), 0.05);

/// Explains in one line why a picture took longer than its limit, if it did. The times are those since its begin: when
/// rendering began, when it ended, and when everything was done.
pub fn overrun(job: &Job, outcome: &Outcome, times: [Duration; 3]) -> Option<String> {
    let all = times[2];
    let limit = job.settings().stop.time_limit?;
    if outcome.rendered.cancelled || all <= limit + TOLERANCE.0.max(limit.mul_f64(TOLERANCE.1)) {
        return None;
    }
    // The limit was given as an f32, and prints as it was given only as one.
    let limit = limit.as_secs_f32();
    // Rounded before they are subtracted, so that the parts sum to the total.
    let [before, rendered, all] = times.map(|time| (time.as_secs_f64() * 10.0).round() / 10.0);
    let (rendering, after) = (rendered - before, all - rendered);
    let samples = counted_samples(outcome.samples_per_pixel());
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
        let after = |times: [f64; 3]| overrun(&job, &outcome, times.map(Duration::from_secs_f64));
        assert_eq!(after([0.5, 1.0, 1.19]), None);
        let line = after([0.5, 1.0, 1.5]).unwrap();
        let wanted = "took 1.5 s instead of 1 s: reading and building 0.5 s, 1 sample per pixel 0.5 s, denoising and \
                      writing 0.5 s";
        assert_eq!(line, wanted);
        // Each part rounded by itself would be 0.3, 0.9 and 0.5.
        let line = after([0.34, 1.28, 1.82]).unwrap();
        assert!(line.starts_with("took 1.8 s instead of 1 s: reading and building 0.3 s"), "{line}");
        assert!(line.contains("per pixel 1.0 s") && line.ends_with("writing 0.5 s"), "{line}");
    }
}
