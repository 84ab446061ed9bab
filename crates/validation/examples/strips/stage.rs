//! The scenes that the strips show, as native scene files.

use crate::values::Shown;
use std::fmt::Write;

/// Table of a scene file that a value is put into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Table {
    Materials,
    Textures,
    Lights,
}

/// The name of the folder of a table's strips.
pub(crate) const fn folder(table: Table) -> &'static str {
    match table {
        Table::Materials => "materials",
        Table::Textures => "textures",
        Table::Lights => "lights",
    }
}

/// The studio: a large soft panel to the left, a narrow one to the right, and a dim surrounding.
const STUDIO: &str = r#"
[[light]]
name = "key"
kind = "rect"
position = [-3.2, 4.6, 3.4]
edge_u = [1.46, 0, 1.37]
edge_v = [-0.75, -1.43, 0.8]
radiance = 9
[[light]]
name = "rim"
kind = "rect"
position = [4.2, 2.6, -1.2]
edge_u = [0.25, 0, 0.6]
edge_v = [0, 2.8, 0]
radiance = 10
[[light]]
name = "surroundings"
kind = "environment"
zenith = [0.75, 0.8, 0.86]
horizon = 0.42
ground = 0.2
"#;

/// Light from behind the camera.
const FRONT: &str = "
[[light]]
kind = \"directional\"
direction = [-0.05, -0.1, -1]
irradiance = 3
[[light]]
kind = \"environment\"
radiance = 0.08
";

/// A floor with squares, so that what glass bends can be seen.
const FLOOR: &str = r#"
[[material]]
name = "floor"
kind = "diffuse"
reflectance = { kind = "checker", a = 0.36, b = 0.27, u_scale = 40, v_scale = 40 }
[[model]]
shape = "floor"
side = 30
material = "floor"
"#;

/// Materials that others name.
const OTHERS: &str = r#"
[[material]]
name = "clay"
kind = "diffuse"
reflectance = [0.5, 0.16, 0.07]
[[material]]
name = "gold"
kind = "conductor"
metal = "gold"
roughness = 0.2
[[material]]
name = "glass"
kind = "dielectric"
[[material]]
name = "enamel"
kind = "principled"
base_color = [0.03, 0.1, 0.35]
specular_roughness = 0.1
[[material]]
name = "water"
kind = "dielectric"
eta = 1.33
priority = 2
"#;

const BALL: &str = "
[[model]]
shape = \"sphere\"
radius = 1
around = 160
along = 80
rotate = [0, -60, 0]
translate = [0, 1, 0]
material = \"shown\"
";

/// A card whose back faces the camera.
const CARD: &str = "
[[model]]
shape = \"disc\"
radius = 0.95
rotate = [-75, 25, 0]
translate = [0, 1, 0]
material = \"shown\"
";

const NORMALS: &str = "{ texture = \"bumps.png\", u_scale = 8, v_scale = 4 }";
/// Grids that fill the ball.
const SMOKE: &str =
    "{ grid = \"smoke.npy\", place = [0.0625, 0, 0, 0, 0.0625, 0, 0, 0, 0.0625, -1, -1, -1] }";
const HEAT: &str = "{ grid = \"heat.npy\", place = [0.0625, 0, 0, 0, 0.0625, 0, 0, 0, 0.0625, -1, -1, -1] }";
const SKY: &str = "{ texture = \"sky.hdr\" }";

/// The scene with one value of a parameter.
pub(crate) fn scene(table: Table, kind: &str, parameter: &str, value: &str, shown: &Shown) -> String {
    let stage = shown.stage.as_str();
    let camera = match table {
        Table::Materials => "position = [0, 1.75, 7.4]\nlook_at = [0, 0.93, 0]\nfov = 18.5",
        Table::Textures => "position = [0, 0, 5]\nlook_at = [0, 0, 0]\nfov = 11.2",
        Table::Lights => "position = [0, 1.9, 6.2]\nlook_at = [0, 0.72, 0]\nfov = 23",
    };
    let mut text = format!("[render]\nintegrator = \"{}\"\n[camera]\n{camera}\n", integrator(table, stage));
    let mut body = String::new();
    for setting in shown.settings.iter().map(String::as_str).chain([&*format!("{parameter} = {value}")]) {
        if let Some((key, value)) = setting.split_once(" = ").filter(|(_, value)| *value != "none") {
            let value = match value {
                "map" => NORMALS,
                "sky" => SKY,
                "smoke" => SMOKE,
                "heat" => HEAT,
                value => value,
            };
            // Writing into a text cannot fail.
            let _ = writeln!(body, "{key} = {value}");
        }
    }
    match table {
        Table::Materials => material(&mut text, kind, stage, &body),
        Table::Textures => {
            let inline = body.trim().replace('\n', ", ");
            let comma = if inline.is_empty() { "" } else { ", " };
            text += &format!(
                "[[material]]\nname = \"shown\"\nkind = \"diffuse\"\n\
                 reflectance = 0\nemission = {{ kind = \"{kind}\"{comma}{inline} }}\n[[model]]\nshape = \"quad\"\n\
                 material = \"shown\"\n"
            );
        }
        Table::Lights => light(&mut text, kind, stage, &body),
    }
    text
}

fn integrator(table: Table, stage: &str) -> &'static str {
    match (table, stage) {
        (_, "cook") => "cook",
        (_, "ambient") => "whitted",
        (_, "cast") => "cast",
        (Table::Materials, "dark") => "auto",
        _ => "path",
    }
}

fn material(text: &mut String, kind: &str, stage: &str, body: &str) {
    *text += match stage {
        "front" => FRONT,
        "ambient" => {
            "[[light]]\nkind = \"ambient\"\ncolour = 0.8\n[[light]]\nkind = \"point\"\nposition = [-3, 4, 4]\nclassic = 0.5\n"
        }
        "dark" => {
            "[[light]]\nkind = \"sphere\"\nposition = [-2.2, 3.2, 1]\nradius = 0.12\nintensity = 12\n\
             [[light]]\nkind = \"environment\"\nradiance = 0.02\n"
        }
        _ => STUDIO,
    };
    *text += FLOOR;
    *text += OTHERS;
    *text += &format!("[[material]]\nname = \"shown\"\nkind = \"{kind}\"\n{body}");
    match stage {
        "card" => *text += CARD,
        "overlap" => {
            *text += BALL;
            *text += "\n[[model]]\nshape = \"sphere\"\nradius = 0.7\ntranslate = [0.55, 1.25, 0.5]\nmaterial = \"water\"\n";
        }
        "lantern" => {
            *text += BALL;
            *text +=
                "[[light]]\nkind = \"sphere\"\nposition = [0.25, 1.15, 0]\nradius = 0.12\nintensity = 2.5\n";
        }
        _ => *text += BALL,
    }
}

fn light(text: &mut String, kind: &str, stage: &str, body: &str) {
    let needs_dusk = !["environment", "sky", "cie-sky", "perez-sky", "ambient"].contains(&kind);
    if needs_dusk {
        *text += "[[light]]\nkind = \"environment\"\nradiance = 0.03\n";
    }
    if stage == "backdrop" {
        *text += "[[light]]\nkind = \"environment\"\nradiance = 0.5\n";
    }
    *text += &format!("[[light]]\nkind = \"{kind}\"\n{body}");
    if stage != "floating" {
        *text += FLOOR;
    }
    *text += "[[material]]\nname = \"plaster\"\nkind = \"phong\"\nkd = 0.6\nks = 0.12\nexponent = 60\nreflectivity = 0\n";
    *text += "[[model]]\nshape = \"sphere\"\nradius = 0.6\naround = 160\nalong = 80\ntranslate = [0, 0.6, 0]\nmaterial = \"plaster\"\n";
}
