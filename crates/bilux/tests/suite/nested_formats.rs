//! Media within media, by the formats that have them: what is inside exists there, whichever a file names first.

use bilux::formats::{ReadOptions, read_bytes};
use bilux::math::transcendental::exp;
use bilux::prelude::*;

/// Absorption per metre of what is around, 3 m along the view, and of what is inside of it, 0.8 m.
const OUTER: Rgb = Rgb { r: 0.3, g: 0.9, b: 0.1 };
const INNER: Rgb = Rgb { r: 1.7, g: 0.2, b: 0.5 };

/// The half edges of both boxes.
const HALVES: [[f32; 3]; 2] = [[9.0, 8.0, 1.5], [7.0, 6.0, 0.4]];

fn ordered(parts: [String; 2], is_outer_first: bool) -> String {
    let [outer, inner] = parts;
    if is_outer_first { outer + &inner } else { inner + &outer }
}

fn numbers(rgb: Rgb) -> String {
    format!("{} {} {}", rgb.r, rgb.g, rgb.b)
}

fn toml(is_outer_first: bool) -> String {
    let part = |name: &str, rgb: Rgb, [x, y, z]: [f32; 3]| {
        let rgb = numbers(rgb).replace(' ', ", ");
        format!(
            "[[material]]\nname = '{name}'\nkind = 'interface'\nabsorption = [{rgb}]\n[[model]]\nshape = 'box'\nsize = [{}, {}, {}]\n\
             material = '{name}'\n",
            2.0 * x,
            2.0 * y,
            2.0 * z
        )
    };
    let head = "[[camera]]\nkind = 'orthographic'\nposition = [0, 0, 12]\nlook_at = [0, 0, 0]\nheight = 1\n[[light]]\nkind = 'environment'\n\
                radiance = 1\n";
    head.to_owned()
        + &ordered([part("outer", OUTER, HALVES[0]), part("inner", INNER, HALVES[1])], is_outer_first)
}

fn pbrt(is_outer_first: bool) -> String {
    let cube = "Shape \"trianglemesh\" \"point3 P\" [-1 -1 -1 -1 -1 1 -1 1 -1 -1 1 1 1 -1 -1 1 -1 1 1 1 -1 1 1 1] \"integer indices\" \
                [0 1 3 0 3 2 4 6 7 4 7 5 0 4 5 0 5 1 2 3 7 2 7 6 0 2 6 0 6 4 1 5 7 1 7 3]";
    let medium = |name: &str, rgb: Rgb| {
        let rgb = numbers(rgb);
        format!(
            "MakeNamedMedium \"{name}\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [0 0 0] \"rgb sigma_a\" [{rgb}]\n"
        )
    };
    let part = |interface: &str, [x, y, z]: [f32; 3]| {
        format!("AttributeBegin\nMediumInterface {interface}\nScale {x} {y} {z}\n{cube}\nAttributeEnd\n")
    };
    let parts = [part("\"outer\" \"\"", HALVES[0]), part("\"inner\" \"outer\"", HALVES[1])];
    format!(
        "Film \"rgb\" \"integer xresolution\" [8] \"integer yresolution\" [8]\nPixelFilter \"box\"\nLookAt 0 0 12 0 0 0 0 1 0\n\
         Camera \"orthographic\" \"float screenwindow\" [-.5 .5 -.5 .5]\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\n{}{}\
         Material \"interface\"\n{}",
        medium("outer", OUTER),
        medium("inner", INNER),
        ordered(parts, is_outer_first)
    )
}

fn mitsuba(is_outer_first: bool) -> String {
    let medium = |name: &str, rgb: Rgb| {
        let rgb = numbers(rgb);
        format!(
            "<medium type='homogeneous' id='{name}'><rgb name='albedo' value='0'/><rgb name='sigma_t' value='{rgb}'/></medium>"
        )
    };
    let part = |media: &str, [x, y, z]: [f32; 3]| {
        format!(
            "<shape type='cube'><transform name='to_world'><scale x='{x}' y='{y}' z='{z}'/></transform><bsdf type='null'/>{media}</shape>"
        )
    };
    let inside = |name: &str| format!("<ref name='interior' id='{name}'/>");
    let parts = [
        part(&inside("outer"), HALVES[0]),
        part(&(inside("inner") + "<ref name='exterior' id='outer'/>"), HALVES[1]),
    ];
    format!(
        "<scene version='3.0.0'><integrator type='volpath'/><sensor type='orthographic'><transform name='to_world'><scale x='.1' y='.1'/>\
         <lookat origin='0,0,20' target='0,0,0' up='0,1,0'/></transform><film type='hdrfilm'><integer name='width' value='8'/>\
         <integer name='height' value='8'/><rfilter type='box'/></film></sensor><emitter type='constant'><rgb name='radiance' value='1'/>\
         </emitter>{}{}{}</scene>",
        medium("outer", OUTER),
        medium("inner", INNER),
        ordered(parts, is_outer_first)
    )
}

/// By Beer's law: 2.2 m of the one, and 0.8 m of the other.
#[test]
fn what_is_inside_exists_in_every_format() {
    let wanted = Rgb::from_array([0, 1, 2].map(|c| exp(-2.2 * OUTER[c] - 0.8 * INNER[c])));
    type Written = fn(bool) -> String;
    let formats: [(&str, Written); 3] = [("toml", toml), ("pbrt", pbrt), ("xml", mitsuba)];
    for (format, text) in formats {
        for is_outer_first in [true, false] {
            let scene =
                read_bytes(text(is_outer_first).as_bytes(), format, None, "nested", &ReadOptions::default());
            let request = JobRequest::new().size(8, 8).integrator("path").spp(4);
            let job = Job::new(&scene.unwrap(), request).unwrap();
            let pixels = job.render(&Quiet).unwrap().picture().unwrap().to_rgb().unwrap();
            let found = pixels.iter().fold(Rgb::BLACK, |sum, pixel| sum + *pixel) * (1.0 / 64.0);
            let off = (0..3).map(|c| (found[c] / wanted[c] - 1.0).abs()).fold(0.0, f32::max);
            assert!(off < 5e-3, "{format}, outer first: {is_outer_first}: {found:?}, not {wanted:?}");
        }
    }
}
