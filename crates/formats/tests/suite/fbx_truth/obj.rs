//! Contents of OBJ files, for comparison.

use bilux_math::DVec3;
use std::path::Path;

/// A corner of a face: position, normal and texture coordinates, as far as it has them.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) p: DVec3,
    pub(super) n: Option<DVec3>,
    pub(super) uv: Option<[f64; 2]>,
}

/// Contents of an OBJ file.
pub(super) struct Truth {
    pub(super) corners: Vec<Corner>,
    /// The end of each face's corners.
    pub(super) ends: Vec<usize>,
    pub(super) tolerance: f64,
    pub(super) ignores_normals: bool,
    pub(super) ignores_uvs: bool,
    pub(super) ignores_extra: bool,
    /// True if the program that wrote it moves what bones have moved by the node once more, which the SDK's viewer does not.
    pub(super) moves_skins_again: bool,
    /// The objects that it has, if it names them; others are not compared.
    pub(super) names: Vec<String>,
}

pub(super) fn truth(path: &Path) -> Truth {
    let bytes = std::fs::read(path).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let (mut p, mut n, mut uv) = (Vec::new(), Vec::new(), Vec::new());
    let mut truth = Truth {
        corners: Vec::new(),
        ends: Vec::new(),
        tolerance: 1e-3,
        ignores_normals: false,
        ignores_uvs: false,
        ignores_extra: false,
        moves_skins_again: false,
        names: Vec::new(),
    };
    let mut scale = 1.0;
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        let key = words.next().unwrap_or_default();
        let mut number = || words.next().and_then(|word| word.parse().ok()).unwrap_or(f64::NAN);
        match key {
            "v" => p.push(DVec3::new(number(), number(), number())),
            "o" => truth.names.push(line[1..].trim().to_owned()),
            "vn" => n.push(DVec3::new(number(), number(), number())),
            "vt" => uv.push([number(), number()]),
            "f" => {
                for corner in words {
                    let mut indices = corner.split('/').map(|index| index.parse::<i64>().ok());
                    let mut index = |count: usize| {
                        let index = indices.next().flatten()?;
                        usize::try_from(if index < 0 { count as i64 + index } else { index - 1 }).ok()
                    };
                    let (at_p, at_uv, at_n) = (index(p.len()), index(uv.len()), index(n.len()));
                    let of_n = at_n.and_then(|i| n.get(i).copied());
                    truth.corners.push(Corner {
                        p: p[at_p.unwrap()],
                        n: of_n,
                        uv: at_uv.and_then(|i| uv.get(i).copied()),
                    });
                }
                truth.ends.push(truth.corners.len());
            }
            "#" | "#ufbx:" => {
                truth.ignores_normals |= line.contains("ufbx:bad_normals");
                truth.moves_skins_again |= line.contains("ufbx:transform_skin");
                truth.ignores_uvs |= line.contains("ufbx:bad_uvs");
                truth.ignores_extra |= line.contains("ufbx:ignore") || line.contains("ufbx:line_faces");
                let value = |key: &str| line.split_once(key)?.1.trim().parse::<f64>().ok();
                truth.tolerance = value("ufbx:tolerance=").unwrap_or(truth.tolerance);
                scale = value("ufbx:position_scale=").unwrap_or(scale);
            }
            _ => {}
        }
    }
    if truth.corners.is_empty() {
        // One file has no faces.
        truth.corners.extend(p.iter().map(|&p| Corner { p, n: None, uv: None }));
    }
    truth.tolerance /= scale;
    truth
}
