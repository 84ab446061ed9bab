//! An independent implementation of what the course's renderer does to an `.asc` file: it draws triangle after triangle
//! into a depth buffer, in f64, and shares nothing with Bilux. `--preset course` with `cast` is compared with it.

#![allow(clippy::approx_constant, reason = "0.7071 is what that renderer has, not the square root of a half")]

/// Columns and rows of the picture.
pub const SIZE: usize = 256;

type V3 = [f64; 3];

const BACKGROUND: [u8; 3] = [128, 112, 96];

/// The picture's RGB bytes, row by row from the top; `None` unless every vertex has eight numbers.
///
/// The text consists of keywords, each with three vertices of `x y z nx ny nz u v`. Triangles that extend behind the
/// image plane are left out.
pub fn course_picture(asc: &str) -> Option<Vec<u8>> {
    picture_in(&OracleView::new([-10.0, 5.0, -10.0], [0.0; 3], [0.0, 1.0, 0.0], 35.0), asc)
}

fn picture_in(view: &OracleView, asc: &str) -> Option<Vec<u8>> {
    let mut depth = vec![f64::INFINITY; SIZE * SIZE];
    let mut picture = BACKGROUND.repeat(SIZE * SIZE);
    for triangle in triangles(asc)? {
        let corners = triangle.map(|(p, n)| view.corner(p, n));
        if corners.iter().all(|c| !c.is_behind) {
            draw(&corners, &mut depth, &mut picture);
        }
    }
    Some(picture)
}

/// Position and normal of each corner.
fn triangles(asc: &str) -> Option<Vec<[(V3, V3); 3]>> {
    let words = asc.split_whitespace().filter_map(|word| word.parse::<f64>().ok());
    let numbers: Vec<f64> = words.collect();
    let vertex = |v: &[f64]| ([v[0], v[1], v[2]], [v[3], v[4], v[5]]);
    let whole = numbers.len().is_multiple_of(24);
    whole.then(|| numbers.chunks(24).map(|t| [vertex(t), vertex(&t[8..]), vertex(&t[16..])]).collect())
}

/// A corner in screen space.
#[derive(Clone, Copy)]
struct Corner {
    /// In pixels, y down.
    x: f64,
    y: f64,
    /// Behind the image plane, which is at the camera's position.
    is_behind: bool,
    /// The divisor of x and y: 1 at the camera's position, and 0 at the eye behind it.
    divisor: f64,
    /// In camera space.
    normal: V3,
}

/// The transforms of model and camera in one.
struct OracleView {
    position: V3,
    axes: [V3; 3],
    tan_half: f64,
}

impl OracleView {
    fn new(position: V3, look_at: V3, up: V3, fov_degrees: f64) -> OracleView {
        let z = unit(subtract(look_at, position));
        let y = unit(subtract(up, scale(z, dot(up, z))));
        OracleView {
            position,
            axes: [cross(y, z), y, z],
            tan_half: bilux_math::transcendental::tan_f64(fov_degrees.to_radians() / 2.0),
        }
    }

    fn corner(&self, position: V3, normal: V3) -> Corner {
        let turned = turn(position);
        let world = [3.25 * turned[0], 3.25 * turned[1] - 3.25, 3.25 * turned[2] + 3.5];
        let [x, y, z] = self.axes.map(|axis| dot(axis, subtract(world, self.position)));
        let turned_normal = turn(normal);
        let half = SIZE as f64 / 2.0;
        let divisor = z * self.tan_half + 1.0;
        Corner {
            x: half + half * x / divisor,
            y: half - half * y / divisor,
            is_behind: z < 0.0,
            divisor,
            normal: self.axes.map(|axis| dot(axis, turned_normal)),
        }
    }
}

/// Rotates about x by 45 degrees, then about y by 30.
fn turn([x, y, z]: V3) -> V3 {
    let (y, z) = (0.7071 * y + 0.7071 * z, -0.7071 * y + 0.7071 * z);
    [0.866 * x - 0.5 * z, y, 0.5 * x + 0.866 * z]
}

fn draw([a, b, c]: &[Corner; 3], depth: &mut [f64], picture: &mut [u8]) {
    let twice_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if twice_area == 0.0 {
        return;
    }
    let range = |p: f64, q: f64, r: f64| {
        let last = (SIZE - 1) as f64;
        let (low, high) = (p.min(q).min(r).ceil().max(0.0), p.max(q).max(r).floor().min(last));
        if low > high { 0..0 } else { low as usize..high as usize + 1 }
    };
    for j in range(a.y, b.y, c.y) {
        for i in range(a.x, b.x, c.x) {
            let (x, y) = (i as f64, j as f64);
            let opposite =
                |p: &Corner, q: &Corner| ((q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x)) / twice_area;
            let weights = [opposite(b, c), opposite(c, a), opposite(a, b)];
            if weights.iter().any(|&w| w < 0.0) {
                continue;
            }
            // On the screen 1/divisor is linear, and so is everything divided by it.
            let over = [weights[0] / a.divisor, weights[1] / b.divisor, weights[2] / c.divisor];
            let divisor = 1.0 / over.iter().sum::<f64>();
            let pixel = j * SIZE + i;
            if divisor < depth[pixel] {
                depth[pixel] = divisor;
                let [ka, kb, kc] = over.map(|w| w * divisor);
                let normal = add(add(scale(a.normal, ka), scale(b.normal, kb)), scale(c.normal, kc));
                picture[3 * pixel..3 * pixel + 3].copy_from_slice(&shade(unit(normal)));
            }
        }
    }
}

/// Direction towards each light, in camera space, and its colour.
const LIGHTS: [(V3, V3); 3] = [
    ([-0.7071, 0.7071, 0.0], [0.5, 0.5, 0.9]),
    ([0.0, -0.7071, -0.7071], [0.9, 0.2, 0.3]),
    ([0.7071, 0.0, -0.7071], [0.2, 0.7, 0.3]),
];

fn shade(n: V3) -> [u8; 3] {
    let e = [0.0, 0.0, -1.0];
    let mut colour = [0.1 * 0.3; 3];
    for (l, light) in LIGHTS {
        let l = unit(l);
        // Viewer and light both behind: the normal is the wrong way round. One on each side: no light.
        let n = match (dot(n, l) >= 0.0, dot(n, e) >= 0.0) {
            (true, true) => n,
            (false, false) => scale(n, -1.0),
            _ => continue,
        };
        let r = subtract(scale(n, 2.0 * dot(n, l)), l);
        let shine = (0..5).fold(dot(r, e).clamp(0.0, 1.0), |x, _| x * x);
        for channel in 0..3 {
            colour[channel] += light[channel] * (0.7 * dot(n, l) + 0.3 * shine);
        }
    }
    colour.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8)
}

fn add(a: V3, b: V3) -> V3 {
    std::array::from_fn(|i| a[i] + b[i])
}

fn subtract(a: V3, b: V3) -> V3 {
    std::array::from_fn(|i| a[i] - b[i])
}

fn scale(a: V3, s: f64) -> V3 {
    a.map(|c| c * s)
}

fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: V3) -> V3 {
    scale(a, 1.0 / dot(a, a).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_across_the_view_is_shaded_by_hand() {
        // Model space is rotated back, so that the wall faces the camera: its world normal is the camera's -z.
        let view = OracleView::new([-10.0, 5.0, -10.0], [0.0; 3], [0.0, 1.0, 0.0], 35.0);
        let [x, y, z] = view.axes;
        let back = |v: V3| {
            [dot(v, turn([1.0, 0.0, 0.0])), dot(v, turn([0.0, 1.0, 0.0])), dot(v, turn([0.0, 0.0, 1.0]))]
        };
        let vertex = |a: f64, b: f64| {
            let world = subtract(add(scale(x, a), scale(y, b)), [0.0, -3.25, 3.5]);
            let (p, n) = (scale(back(world), 1.0 / 3.25), back(scale(z, -1.0)));
            format!("{} {} {} {} {} {} 0 0", p[0], p[1], p[2], n[0], n[1], n[2])
        };
        let asc = format!("triangle\n{}\n{}\n{}\n", vertex(-1.0, -1.0), vertex(3.0, -1.0), vertex(-1.0, 3.0));
        let picture = course_picture(&asc).unwrap();
        let pixel = |i: usize, j: usize| &picture[3 * (j * SIZE + i)..][..3];
        // N·L is 0, .7071, .7071. R·E, with R = 2 (N·L) N - L, is the same, and the 32nd power of .7071 is 2⁻¹⁶.
        let wanted = [0.9 + 0.2, 0.2 + 0.7, 0.3 + 0.3].map(|sum| 0.03 + 0.7 * 0.70711 * sum);
        for (found, wanted) in pixel(128, 128).iter().zip(wanted) {
            assert!((f64::from(*found) - 255.0 * wanted).abs() <= 1.0, "{found} for {wanted}");
        }
        assert_eq!(pixel(2, 2), [128, 112, 96]);
        // The corner at (-1, -1) lies left of the centre and below it, by 128 / (15 tan 17.5° + 1) = 22.3 pixels.
        assert_eq!(pixel(110, 146), pixel(128, 128));
        assert_eq!(pixel(146, 110), pixel(128, 128));
        assert_eq!(pixel(104, 140), BACKGROUND);
        assert_eq!(pixel(170, 100), BACKGROUND);
        assert_eq!(course_picture("triangle 1 2 3"), None);
    }

    /// First and last columns of a few rows in which an example picture that the course hands out, made by its own
    /// renderer, shows the square from 0 to 20 in x and z.
    #[test]
    fn a_square_is_where_a_picture_of_the_course_shows_it() {
        let view = OracleView::new([-3.0, -25.0, -4.0], [7.8, 0.7, 6.5], [-0.2, 1.0, 0.0], 63.7);
        let corner = |x: f64, z: f64| format!("{x} 0 {z} 0 1 0 0 0\n");
        let [a, b, c, d] = [corner(0.0, 0.0), corner(0.0, 20.0), corner(20.0, 20.0), corner(20.0, 0.0)];
        let picture = picture_in(&view, &format!("triangle\n{a}{b}{c}triangle\n{a}{d}{c}")).unwrap();
        for (j, first, last) in
            [(160, 40, 117), (180, 47, 119), (200, 58, 121), (220, 71, 123), (240, 84, 125), (255, 94, 127)]
        {
            let row = picture[3 * j * SIZE..3 * (j + 1) * SIZE].chunks(3);
            let seen: Vec<usize> =
                row.enumerate().filter(|(_, c)| **c != BACKGROUND).map(|(i, _)| i).collect();
            assert_eq!((seen.first(), seen.last()), (Some(&first), Some(&last)), "row {j}");
        }
    }
}
