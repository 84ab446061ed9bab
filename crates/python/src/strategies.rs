//! Pictures of the strategies of an integrator, as layers of a picture.

use bilux::Job;
use bilux::strategies::Light;
use bilux::transport::Strategies;

/// Refuses an integrator without strategies.
pub(crate) fn check_strategies(job: &Job) -> Result<(), bilux::Error> {
    if job.has_strategies() {
        return Ok(());
    }
    let name = job.settings().integrator.entry.name;
    let others = bilux::transport::integrators::with_strategies();
    Err(bilux::Error::Settings(format!(
        "integrator: '{name}' has no separate strategies: choose one of {}",
        others.collect::<Vec<_>>().join(", ")
    )))
}

/// Adds what each strategy finds: `strategy_NAME`, weighted, whose sum is the picture, and `unweighted_NAME`.
pub(crate) fn push_strategies(
    found: &Strategies,
    picture: &mut bilux::pictures::Picture,
) -> Result<(), bilux::Error> {
    for one in &found.pictures {
        for (light, beginning) in [(Light::Weighted, "strategy"), (Light::Unweighted, "unweighted")] {
            picture.push_rgb(&format!("{beginning}_{}", one.strategy), light.of(one))?;
        }
    }
    Ok(())
}
