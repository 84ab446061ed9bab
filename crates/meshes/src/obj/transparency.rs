//! Opacity and glass. Exporters write `d`, `Tr`, `Tf` and `illum` in ways that contradict each other, so that a
//! library is interpreted as a whole, as `docs/formats/obj.md` describes.

use super::draft::Draft;
use super::library::Library;
use super::surface::is_of_pbr_extension;
use bilux_math::Rgb;

/// A diffuse colour up to this counts as black: many glasses are written with 0.01.
const DARK: f32 = 0.05;

impl Library<'_, '_, '_> {
    /// Decides for each material how much of the light passes straight through, and whether it is glass.
    pub(super) fn decide_transparency(&mut self, drafts: &mut [Draft]) {
        let tr_is_opacity = tr_is_opacity(drafts);
        for draft in drafts.iter_mut() {
            draft.opacity = stated_opacity(draft, tr_is_opacity).unwrap_or(1.0).clamp(0.0, 1.0);
            // The texture says where there are holes; a zero would leave nothing.
            if draft.maps.contains_key("map_d") && draft.opacity == 0.0 {
                draft.opacity = 1.0;
            }
            draft.is_glass = is_glass(draft);
            if tr_is_opacity && draft.number("d").is_none() && draft.number("Tr") == Some(1.0) {
                let what = "'Tr 1' without 'd' is read as opaque, as MeshLab, OpenMVS and others mean it: write 'd 1' or \
                            'd 0' to be clear";
                self.note_at(draft, "Tr", what);
            }
            let is_opaque = !draft.is_glass && draft.opacity == 1.0 && !draft.states("Kt");
            if has_illum_of_glass(draft) && is_opaque {
                let what = "'illum' 4, 6, 7 and 9 stand for glass, but this material is read as opaque, since nothing else \
                            in it lets light through: for glass, write a black 'Kd' with 'Ni' or 'Tf', or 'd' below 1";
                self.note_at(draft, "illum", what);
            }
        }
        self.keep_visible(drafts);
    }

    /// Makes a library visible again in which everything is wholly transparent.
    fn keep_visible(&mut self, drafts: &mut [Draft]) {
        let is_invisible = |draft: &Draft| draft.opacity == 0.0 && !draft.is_glass;
        let is_all = drafts.iter().all(|draft| is_invisible(draft) || draft.is_glass);
        for draft in drafts.iter_mut().filter(|draft| is_invisible(draft)) {
            let key = ["d", "Tr", "Tf"].into_iter().find(|key| draft.states(key)).unwrap_or("d");
            if is_all {
                draft.opacity = 1.0;
                let what = "all materials of this library are wholly transparent, which is read as opaque, as some \
                            exporters mean it";
                self.note_at(draft, key, what);
            } else {
                self.note_at(
                    draft,
                    key,
                    "this material is wholly transparent, so that its faces are invisible",
                );
            }
        }
    }

    fn note_at(&mut self, draft: &Draft, key: &str, what: &str) {
        let (places, offset) = (&self.places, draft.offset(key));
        self.diagnostics.note(what, || places.at(offset));
    }
}

/// True for `illum` 4, 6, 7 and 9, the models with glass or refraction.
fn has_illum_of_glass(draft: &Draft) -> bool {
    matches!(draft.illum(), 4 | 6 | 7 | 9)
}

/// True if `Tr` means opacity in this library. Usually it is 1 − d, but MeshLab, OpenMVS, mvs-texturing and others write
/// `Tr 1` for opaque: there is a `Tr 1` then, and no `Tr 0`, without `d` to contradict it.
fn tr_is_opacity(drafts: &[Draft]) -> bool {
    let near = |a: f32, b: f32| (a - b).abs() < 0.01;
    let is_rest = |draft: &Draft| match (draft.number("d"), draft.number("Tr")) {
        (Some(d), Some(tr)) => near(tr, 1.0 - d) && !near(tr, d),
        _ => false,
    };
    let alone = || drafts.iter().filter(|draft| draft.number("d").is_none()).filter_map(|d| d.number("Tr"));
    !drafts.iter().any(is_rest) && alone().any(|tr| tr == 1.0) && !alone().any(|tr| tr == 0.0)
}

/// The opacity that a material states, if it does.
fn stated_opacity(draft: &Draft, tr_is_opacity: bool) -> Option<f32> {
    let of_tr = |tr: f32| if tr_is_opacity { tr } else { 1.0 - tr };
    draft.number("d").or_else(|| draft.number("Tr").map(of_tr)).or_else(|| {
        // Maya writes 1 − transparency as Tf, and an Ni of 1 unless light is refracted.
        let is_of_maya = has_illum_of_glass(draft) && draft.states("Ni") && !refracts(draft);
        draft.colour("Tf").filter(|_| is_of_maya).map(|tf| tf.max_channel())
    })
}

/// True if light is refracted by a stated index.
fn refracts(draft: &Draft) -> bool {
    draft.eta().is_some_and(|eta| (eta - 1.0).abs() > 1e-3)
}

/// True if light enters the surface and is refracted. By `illum` alone that would be everything from Cinema 4D (7) and
/// Maya (4): something else has to say so too.
fn is_glass(draft: &Draft) -> bool {
    if !has_illum_of_glass(draft) || draft.states("Kt") {
        return false;
    }
    let tf = draft.colour("Tf");
    let is_tinted = tf.is_some_and(|tf| !tf.is_black());
    if is_of_pbr_extension(draft) && draft.opacity == 1.0 && is_tinted {
        return true;
    }
    if draft.maps.contains_key("map_Kd") {
        return false;
    }
    let Some(kd) = draft.colour("Kd") else { return true };
    if draft.states("Ni") && !refracts(draft) {
        return false;
    }
    if kd.max_channel() <= DARK {
        return refracts(draft) || is_tinted || draft.opacity < 1.0;
    }
    // White is the default of exporters; black is Maya's clear glass.
    let is_white = |tf: Rgb| tf.to_array().into_iter().all(|c| c > 0.999);
    refracts(draft) && (draft.opacity == 0.0 || draft.opacity == 1.0 && tf.is_some_and(|tf| !is_white(tf)))
}
