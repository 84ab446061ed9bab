//! `bilux convert --heat-map`: one channel of a picture in false colours.

use crate::assignments::from_flag;
use crate::output;
use bilux::pictures::metrics::false_colours;
use bilux::pictures::{Channel, Picture};
use bilux::scene::SceneError;

/// The channel of this name, or the first of the layer of this name, in false colours up to `most`, or to its own maximum.
///
/// # Errors
/// If there is no such channel, or memory is short.
pub fn heat_map(picture: &Picture, name: &str, most: Option<f32>, quiet: bool) -> anyhow::Result<Picture> {
    let is_wanted =
        |channel: &str| channel == name || channel.split_once('.').is_some_and(|(l, _)| l == name);
    let channel = picture.channels().iter().find(|channel| is_wanted(&channel.name)).ok_or_else(|| {
        let short = |channel: &Channel| match channel.name.split_once('.') {
            Some((layer, _)) if !name.contains('.') => layer.to_owned(),
            _ => channel.name.clone(),
        };
        let mut names: Vec<String> = picture.channels().iter().map(short).collect();
        names.dedup();
        let names = names.iter().map(String::as_str);
        SceneError::unknown("channel", name, names, &from_flag("--heat-map"))
    })?;
    let finite = channel.samples.iter().copied().filter(|sample| sample.is_finite());
    let own = finite.fold(0.0, f32::max);
    let most = most.unwrap_or(own);
    if !quiet {
        output::eprint(format_args!(
            "{}: black is 0, pale yellow is {most} and more; the maximum is {own}",
            channel.name
        ));
    }
    Ok(false_colours((picture.width(), picture.height()), &channel.samples, most)?)
}
