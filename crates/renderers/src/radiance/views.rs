//! Views, as `rpict` and the files of `rvu` have them. [Ward 1994]

use super::world::{World, turned};
use bilux_import::bytes::float::parse_f64;
use bilux_import::world::placement::half_tangent;
use bilux_math::DVec3;
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Span, Spec};

/// Words with which programs start lines of views.
const STARTS: [&str; 4] = ["rvu", "rview", "rpict", "VIEW="];

/// A view, with z up.
struct View {
    form: char,
    position: DVec3,
    direction: DVec3,
    up: DVec3,
    /// The width and the height of the picture: angles in degrees, or lengths of a parallel view.
    size: [f64; 2],
    /// To the right and upwards, in sizes of the picture.
    shift: [f64; 2],
}

impl Default for View {
    fn default() -> View {
        View {
            form: 'v',
            position: DVec3::ZERO,
            direction: DVec3::Y,
            up: DVec3::Z,
            size: [45.0; 2],
            shift: [0.0; 2],
        }
    }
}

/// The last view of a file of views, with the number of its line.
pub(super) fn last_of(text: &str) -> Option<(usize, &str)> {
    let is_view = |line: &&str| STARTS.iter().any(|start| line.trim_start().starts_with(start));
    (1..).zip(text.lines()).filter(|(_, line)| is_view(line)).last()
}

/// The camera of the last view of a file of views.
pub(super) fn of_file(text: &str, file: &str, world: &mut World) -> Option<CameraSpec> {
    let (number, line) = last_of(text)?;
    let at = Span { file: file.into(), line: u32::try_from(number).unwrap_or(u32::MAX), column: 0 };
    let words: Vec<&str> = line.split_whitespace().collect();
    camera(&words, "", &at, world)
}

/// The camera of the options of a view; `None`, with a warning, if they describe none.
pub(super) fn camera(words: &[&str], name: &str, at: &Span, world: &mut World) -> Option<CameraSpec> {
    let made = view(words, at, world).and_then(|view| view.spec(at, world));
    match made {
        Some(spec) => Some(CameraSpec::new(Spec { name: name.to_owned(), span: at.clone(), ..spec })),
        None => {
            let what = "a view has numbers that are missing, wrong or out of range: left out";
            world.diagnostics.note(what, || at.clone());
            None
        }
    }
}

/// Reads options; `None` if their numbers are wrong.
fn view(words: &[&str], at: &Span, world: &mut World) -> Option<View> {
    let mut view = View::default();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let mut number =
            || words.next().and_then(|word| parse_f64(word.as_bytes())).filter(|n| n.is_finite());
        let mut vector = || Some(DVec3::new(number()?, number()?, number()?));
        match *word {
            "-vp" => view.position = vector()?,
            "-vd" => view.direction = vector()?,
            "-vu" => view.up = vector()?,
            "-vh" => view.size[0] = number()?,
            "-vv" => view.size[1] = number()?,
            "-vs" => view.shift[0] = number()?,
            "-vl" => view.shift[1] = number()?,
            "-vo" | "-va" if number()? != 0.0 => {
                world.diagnostics.remark("planes that clip a view are not used", || at.clone());
            }
            word => {
                view.form = word.strip_prefix("-vt").and_then(|form| form.chars().next()).unwrap_or(view.form)
            }
        }
    }
    Some(view)
}

impl View {
    /// The width of its picture over its height, if it has one.
    fn aspect(&self) -> f64 {
        let [width, height] = self.size;
        match self.form {
            'v' => half_tangent(width as f32) / half_tangent(height as f32),
            'c' => width.to_radians() / (2.0 * half_tangent(height as f32)),
            _ => width / height,
        }
    }

    fn spec(&self, at: &Span, world: &mut World) -> Option<Spec> {
        let (forward, up) = (turned(self.direction).try_normalize()?, turned(self.up).try_normalize()?);
        let [width, height] = self.size;
        let aspect = self.aspect();
        if forward.cross(up).length() < 1e-6
            || !(width > 0.0 && height > 0.0 && aspect > 0.0 && aspect.is_finite())
        {
            return None;
        }
        let position = world.point(self.position);
        // Far from the origin, 32-bit floats may not resolve one metre.
        let ahead = position + forward * (1.0 + 1e-4 * position.abs().max_element());
        let placed = |kind: &str| {
            Spec::new("", kind)
                .with("position", position.as_vec3())
                .with("look_at", ahead.as_vec3())
                .with("up", up.as_vec3())
        };
        let fisheye = |mapping: &str, most: f64| {
            placed("fisheye").with("mapping", mapping).with("fov", width.clamp(1.0, most) as f32)
        };
        if matches!(self.form, 'h' | 'a' | 's') && width != height {
            world.diagnostics.note("a fisheye view is as high as wide", || at.clone());
        }
        if self.form != 'v' && self.shift != [0.0; 2] {
            world.diagnostics.note("only perspective views are shifted", || at.clone());
        }
        Some(match self.form {
            'l' => placed("orthographic").with("height", height.clamp(1e-9, 1e9) as f32),
            'h' => fisheye("orthographic", 180.0),
            'a' => fisheye("equidistant", 359.0),
            's' => fisheye("stereographic", 359.0),
            'c' => placed("panorama")
                .with("mapping", "cylindrical")
                .with("fov_x", width.clamp(1.0, 360.0) as f32)
                .with("fov", height.clamp(1.0, 179.0) as f32),
            _ => placed("perspective")
                .with("fov", height.clamp(0.01, 179.0) as f32)
                .with("frame", aspect.clamp(0.0, 1000.0) as f32)
                .with("principal_x", (0.5 - self.shift[0]).clamp(-100.0, 100.0) as f32)
                .with("principal_y", (0.5 + self.shift[1]).clamp(-100.0, 100.0) as f32),
        })
    }
}
