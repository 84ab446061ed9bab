//! Contract of every camera: it sees a point where its ray through that point began, with the density of its rays
//! there.

use crate::chi_square::uniforms;
use crate::tally::Tally;
use bilux_math::{DVec2, DVec3, Vec2, Vec3, warp};
use bilux_scene::{Camera, CameraConnection, CameraSample, Ray};

/// The checks, by name.
pub const CHECKS: [(&str, Check); 8] = [
    ("points on a ray project to its film position", rays_come_back),
    ("the density matches that of neighbouring rays", density_is_that_of_rays),
    ("a ray reports its own density", rays_know_their_density),
    ("every ray reaches the film once", importance_is_one),
    ("in double precision, pixels come back exactly", pixels_come_back),
    ("points of a plane are sampled as often as rays hit them", planes_are_sampled_as_hit),
    (
        "nothing behind the camera is visible, and what is beside the film is found beside it",
        only_what_is_ahead_is_seen,
    ),
    ("the matrices put points where the middle of the lens sees them", matrices_see_alike),
];

/// One check of a camera at a time in seconds; an error describes what is wrong.
pub type Check = fn(&dyn Camera, f32) -> Result<(), String>;

const SAMPLES: u64 = 40_000;
/// Probability of a false alarm of a check.
const SIGNIFICANCE: f64 = 1e-5;
/// Cells along each side of the film.
const CELLS: usize = 4;
/// The index that stands for all cells.
const ALL: usize = CELLS * CELLS;

fn sample(stream: u64, i: u64, time: f32) -> CameraSample {
    let film = uniforms(stream, i).1;
    CameraSample { film, lens: warp::sample_disc(uniforms(stream + 1, i).1), time }
}

/// Some rays, each with a distance along it; none where the film sees nothing.
fn some(camera: &dyn Camera, stream: u64, time: f32) -> impl Iterator<Item = (CameraSample, Ray, f32)> {
    (0..500)
        .map(move |i| {
            let sample = sample(stream, i, time);
            (sample, camera.ray(&sample), 0.5 + 8.0 * uniforms(stream + 2, i).0)
        })
        .filter(|(_, ray, _)| !ray.is_nowhere())
}

/// Connects a point through the lens of a sample, as the eye that sees the sample's point of the film.
fn connect(camera: &dyn Camera, point: Vec3, sample: &CameraSample) -> Option<CameraConnection> {
    camera.connect(point, camera.lens_of(sample.film, sample.lens), sample.time)
}

/// Two rays of one eye, beside each other.
fn beside_each_other(camera: &dyn Camera, time: f32) -> [Ray; 2] {
    let film = |x: f32| Vec2::new(x, 0.25);
    [0.2, 0.3].map(|x| camera.ray(&CameraSample { film: film(x), lens: Vec2::ZERO, time }))
}

/// The middle of the circle on which an eye turns, if it does.
fn middle_of_turning_eye(camera: &dyn Camera, time: f32) -> Option<Vec3> {
    let [a, b] = beside_each_other(camera, time);
    let middle = || camera.matrices(time).to_camera.inverse().transform_point3(Vec3::ZERO);
    (a.origin != b.origin && a.direction != b.direction).then(middle)
}

fn at(ray: &Ray, t: f32) -> Vec3 {
    Vec3::from(ray.at(t))
}

/// `connect` is the inverse of `ray`, except for rounding.
pub fn rays_come_back(camera: &dyn Camera, time: f32) -> Result<(), String> {
    for (sample, ray, t) in some(camera, 0, time) {
        let (point, origin) = (at(&ray, t), Vec3::from(ray.origin));
        let seen = connect(camera, point, &sample).ok_or(format!("{point} is not seen"))?;
        // The point is rounded in every coordinate, and so is everything on the way back.
        let size = point.abs().max_element() + origin.abs().max_element();
        let aside = 8.0 * f32::EPSILON * size;
        let on_film = 2.0 * aside * camera.density(&ray, t).sqrt() * edge(camera, time) + 8.0 * f32::EPSILON;
        let film = (seen.film - sample.film).abs().max_element();
        let same_ray = seen.p.distance(origin) <= aside
            && (seen.wi + Vec3::from(ray.direction)).length() <= aside / t + 8.0 * f32::EPSILON;
        if film > on_film || !same_ray {
            let d = seen.film - sample.film;
            return Err(format!("{sample:?} at {t} comes back as {seen:?}: {d} off, {on_film:e} allowed"));
        }
    }
    Ok(())
}

/// Matrices for compositors agree with the rays through the middle of the lens.
pub fn matrices_see_alike(camera: &dyn Camera, time: f32) -> Result<(), String> {
    let matrices = camera.matrices(time);
    let turning = middle_of_turning_eye(camera, time);
    for (sample, _, t) in some(camera, 30, time) {
        let ray = camera.ray(&CameraSample { lens: Vec2::ZERO, ..sample });
        let point = at(&ray, t);
        let by_matrix = matrices.to_film.map_or(sample.film, |to_film| {
            let on_film = to_film * point.extend(1.0);
            Vec2::new(on_film.x, on_film.y) / on_film.w
        });
        let seen = camera
            .project_beside(point.as_dvec3(), time, sample.film.as_dvec2())
            .ok_or(format!("{point} is not seen"))?
            .as_vec2();
        // Without the lens, rays of a small film go through few digits.
        let allowed = 1e-4 * edge(camera, time);
        if seen.distance(sample.film) > allowed || by_matrix.distance(sample.film) > allowed {
            return Err(format!("{sample:?} at {t} is seen at {seen}, by the matrix at {by_matrix}"));
        }
        let depth = (point - turning.unwrap_or(at(&ray, 0.0))).dot(camera.forward(time));
        let in_camera = (matrices.to_camera * point.extend(1.0)).z;
        if (in_camera - depth).abs() > 1e-4 * (1.0 + depth.abs()) {
            return Err(format!("{point} lies {in_camera} m ahead, not {depth}"));
        }
    }
    Ok(())
}

/// All importance that a film of area 1 has is on its rays: over all points of a sphere around them, or of a plane where they are
/// parallel, the density is 1, or as much of it as the film sees anything.
pub fn importance_is_one(camera: &dyn Camera, time: f32) -> Result<(), String> {
    const DIRECTIONS: u32 = 400_000;
    const SIDE: u32 = 256;
    let film = |i: u32| Vec2::new((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5) / SIDE as f32;
    let sample = |film: Vec2| CameraSample { film, lens: Vec2::ZERO, time };
    let sees = (0..SIDE * SIDE).filter(|i| !camera.ray(&sample(film(*i))).is_nowhere()).count();
    let expected = sees as f64 / f64::from(SIDE * SIDE);
    let [left, right] = beside_each_other(camera, time);
    let eye = Vec3::from(left.origin);
    let is_parallel = left.direction == right.direction;
    let sum: f64 = if !is_parallel {
        let (middle, radius) = middle_of_turning_eye(camera, time).map_or((eye, 1.0), |middle| (middle, 3.0));
        // Directions on a spiral, which is even over the sphere.
        let golden = std::f32::consts::TAU * 0.618_034;
        let on_sphere = |i: u32| {
            let z = 1.0 - (2 * i + 1) as f32 / DIRECTIONS as f32;
            let (sin, cos) = bilux_math::transcendental::sin_cos(golden * i as f32 % std::f32::consts::TAU);
            Vec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + Vec3::Z * z
        };
        let of = |i: u32| {
            let out = on_sphere(i);
            let seen = camera.connect(middle + out * radius, Vec2::ZERO, time)?;
            let on_area = -seen.wi.dot(out) * radius * radius;
            seen.is_on_film().then(|| f64::from(seen.density * on_area))
        };
        (0..DIRECTIONS).filter_map(of).sum::<f64>() * 4.0 * std::f64::consts::PI / f64::from(DIRECTIONS)
    } else {
        let forward = camera.forward(time);
        let u = (Vec3::from(right.origin) - eye).normalize();
        let (v, side, middle) = (forward.cross(u), 20.0, camera.ray(&sample(Vec2::splat(0.5))));
        let on_plane = |i: u32| {
            let place = (film(i) - 0.5) * side;
            at(&middle, 3.0) + u * place.x + v * place.y
        };
        let of = |i: u32| camera.connect(on_plane(i), Vec2::ZERO, time);
        let on_film = (0..SIDE * SIDE).filter_map(of).filter(CameraConnection::is_on_film);
        on_film.map(|seen| f64::from(seen.density)).sum::<f64>() * f64::from(side * side)
            / f64::from(SIDE * SIDE)
    };
    // What the spiral or the grid may miss at the edge of the film.
    let error = if is_parallel { 0.05 } else { 0.01 };
    match (sum - expected).abs() <= error {
        true => Ok(()),
        false => {
            Err(format!("the importance is {sum} in all, of a film that sees in {expected} of its area"))
        }
    }
}

/// `project_f64` is the inverse of `ray_f64` to a ten-thousandth of a pixel of a film of 1,000, and both are what single precision
/// rounds.
pub fn pixels_come_back(camera: &dyn Camera, time: f32) -> Result<(), String> {
    for (sample, ray, t) in some(camera, 70, time) {
        // Of two eyes, the left one answers.
        let [mine, left] = [sample.film, Vec2::ZERO].map(|film| camera.lens_of(film, Vec2::ZERO));
        if mine != left {
            continue;
        }
        let film = sample.film.as_dvec2();
        let [origin, direction] = camera.ray_f64(film, time).ok_or(format!("{film} has no ray"))?;
        let seen =
            camera.project_f64(origin + direction * f64::from(t), time).ok_or("a point is not seen")?;
        if (seen - film).abs().max_element() > 1e-7 {
            return Err(format!("{film} comes back as {seen}"));
        }
        let single = camera.ray(&CameraSample { lens: Vec2::ZERO, ..sample });
        let apart = direction.distance(Vec3::from(single.direction).as_dvec3());
        if apart > 1e-5 {
            return Err(format!(
                "{film} looks towards {direction}, in single precision {:?}",
                single.direction
            ));
        }
        let rough = camera.project((origin + direction * f64::from(t)).as_vec3(), time).map(Vec2::as_dvec2);
        if rough.is_none_or(|rough: DVec2| rough.distance(film) > 1e-4) || ray.is_nowhere() {
            return Err(format!("{film} comes back as {rough:?} in single precision"));
        }
    }
    Ok(())
}

/// The square root of the film's aspect ratio, longer side over shorter.
fn edge(camera: &dyn Camera, time: f32) -> f32 {
    let away = |x: f32, y: f32| {
        let ray = camera.ray(&CameraSample { film: Vec2::new(x, y), lens: Vec2::ZERO, time });
        at(&ray, 1.0)
    };
    let (middle, right, up) = (away(0.5, 0.5), away(0.51, 0.5), away(0.5, 0.51));
    let ratio = (right.distance(middle) / up.distance(middle)).sqrt();
    ratio.max(1.0 / ratio)
}

/// The density is one over the area, perpendicular to the ray, that neighbours on the film cover.
pub fn density_is_that_of_rays(camera: &dyn Camera, time: f32) -> Result<(), String> {
    const STEP: f32 = 1.0 / 512.0;
    const MAX_LEFT_OUT: u32 = 25;
    let mut left_out = 0;
    for (sample, ray, t) in some(camera, 10, time) {
        let (point, across) = (at(&ray, t).as_dvec3(), Vec3::from(ray.direction).as_dvec3());
        // None of a neighbour that sees nothing.
        let through = |step: Vec2| -> Option<DVec3> {
            let ray = camera.ray(&CameraSample { film: sample.film + step, ..sample });
            let (o, d) = (Vec3::from(ray.origin).as_dvec3(), Vec3::from(ray.direction).as_dvec3());
            (!ray.is_nowhere()).then(|| o + d * ((point - o).dot(across) / d.dot(across)))
        };
        let between = |step: Vec2| Some((through(step)? - through(-step)?) / f64::from(2.0 * step.length()));
        // Half the step has a quarter of the error. Next to where a lens folds over, differences are no derivatives.
        let along = |axis: Vec2| {
            let (half, whole) = (between(axis * STEP * 0.5)?, between(axis * STEP)?);
            (half.distance(whole) < 4e-3 * half.length()).then(|| (half * 4.0 - whole) / 3.0)
        };
        let Some((along_x, along_y)) = along(Vec2::X).zip(along(Vec2::Y)) else {
            left_out += 1;
            continue;
        };
        let area = along_x.cross(along_y).length();
        let seen = connect(camera, at(&ray, t), &sample).ok_or(format!("{point} is not seen"))?;
        // Of a pair, it is that of one eye, which has half of the film.
        let is_pair = camera.lens_of(sample.film, Vec2::ZERO) != Vec2::ZERO;
        let ratio = f64::from(seen.density) * area * if is_pair { 0.5 } else { 1.0 };
        if (ratio - 1.0).abs() > 2e-3 {
            return Err(format!("{sample:?} at {t}: density {} times area {area} is {ratio}", seen.density));
        }
    }
    match left_out <= MAX_LEFT_OUT {
        true => Ok(()),
        false => Err(format!("neighbours of {left_out} rays go elsewhere")),
    }
}

/// `density` of a ray agrees with `connect` for its points.
pub fn rays_know_their_density(camera: &dyn Camera, time: f32) -> Result<(), String> {
    for (sample, ray, t) in some(camera, 20, time) {
        let seen = connect(camera, at(&ray, t), &sample).ok_or("a point is not seen")?;
        let said = camera.density(&ray, t);
        if (said - seen.density).abs() > 1e-4 * said {
            return Err(format!("{sample:?} at {t}: the ray says {said}, its point {}", seen.density));
        }
    }
    Ok(())
}

/// On a tilted square in front of the camera, random points connected with the camera count as much in each cell of the
/// film as random rays that hit the square.
pub fn planes_are_sampled_as_hit(camera: &dyn Camera, time: f32) -> Result<(), String> {
    let middle = camera.ray(&CameraSample { film: Vec2::splat(0.45), lens: Vec2::ZERO, time });
    let (forward, distance) = (Vec3::from(middle.direction), 3.0);
    let side = forward.any_orthonormal_vector();
    let (u, v) = (side * 2.5, (forward.cross(side) + forward * 0.4) * 1.8);
    let corner = at(&middle, distance) - (u + v) * 0.5;
    let (across, area) = (u.cross(v).normalize(), u.cross(v).length());
    let cell = |film: Vec2| {
        let index = |x: f32| (x * CELLS as f32) as usize;
        index(film.y) * CELLS + index(film.x)
    };
    let (mut traced, mut seen) = ([Tally::default(); ALL + 1], [Tally::default(); ALL + 1]);
    for i in 0..SAMPLES {
        let sample = sample(30, i, time);
        let ray = camera.ray(&sample);
        let (o, d) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
        let t = (corner - o).dot(across) / d.dot(across);
        let place = o + d * t - corner;
        let share = |x: Vec3, y: Vec3| x.cross(y).dot(across) / area;
        let inside = |x: f32| (0.0..1.0).contains(&x);
        let hit = !ray.is_nowhere() && t > 0.0 && inside(share(place, v)) && inside(share(u, place));
        traced.iter_mut().enumerate().for_each(|(c, tally)| {
            tally.add(f64::from(u8::from(hit && (c == ALL || c == cell(sample.film)))))
        });
        let (place, lens) = (uniforms(40, i).1, warp::sample_disc(uniforms(41, i).1));
        let connection = camera.connect(corner + u * place.x + v * place.y, lens, time);
        let connection = connection.filter(CameraConnection::is_on_film);
        let found = connection.map(|c| (cell(c.film), f64::from(c.density * c.wi.dot(across).abs() * area)));
        seen.iter_mut()
            .enumerate()
            .for_each(|(c, tally)| tally.add(found.filter(|f| c == ALL || f.0 == c).map_or(0.0, |f| f.1)));
    }
    for (c, (traced, seen)) in traced.iter().zip(&seen).enumerate() {
        let p = traced.p_value(seen);
        let sparse = c != ALL && (traced.is_sparse() || seen.is_sparse());
        if !sparse && p < SIGNIFICANCE / (ALL + 1) as f64 {
            let (a, b) = (traced.mean(), seen.mean());
            return Err(format!("cell {c}: {a:.5} of the rays, {b:.5} of the points, p = {p:.2e}"));
        }
    }
    Ok(())
}

/// `connect` returns `None` for points that no ray sees, such as those behind a lens that does not look back. Beside the film it goes on as it is on the film, since
/// pixel filters reach beyond the edge.
pub fn only_what_is_ahead_is_seen(camera: &dyn Camera, time: f32) -> Result<(), String> {
    for (i, (inside, ray, t)) in some(camera, 50, time).enumerate() {
        let behind = at(&ray, -t);
        if let Some(seen) = camera.connect(behind, inside.lens, time) {
            let towards = camera.ray(&CameraSample { film: seen.film, ..inside });
            let away = (behind - Vec3::from(towards.origin)).normalize();
            if Vec3::from(towards.direction).distance(away) > 1e-3 {
                return Err(format!("{behind} behind is seen at {}, which looks elsewhere", seen.film));
            }
        }
        // Where the film closes on itself, the same is seen beyond the nearer edge; that of one of two eyes is half as wide.
        let closes = |x: f32| camera.repeats(Vec2::new(x, inside.film.y)) != [None; 3];
        let is_pair = camera.lens_of(inside.film, Vec2::ZERO) != Vec2::ZERO;
        let far = if !closes(0.1) && !closes(0.4) {
            1.0
        } else if is_pair {
            0.25
        } else {
            0.5
        };
        let shift = [Vec2::X, -Vec2::X, Vec2::Y, -Vec2::Y][i % 4] * far;
        let ray = camera.ray(&CameraSample { film: inside.film + shift, ..inside });
        if ray.is_nowhere() {
            continue;
        }
        let beside = at(&ray, t);
        let place = inside.film + shift;
        let Some(seen) = connect(camera, beside, &CameraSample { film: place, ..inside }) else {
            return Err(format!("{beside}, at {place} beside the film, is not found"));
        };
        let is_near_edge = (inside.film - inside.film.round()).abs().min_element() < 1e-3;
        let said = camera.density(&ray, t);
        let again = camera.repeats(seen.film);
        let is_place = again.into_iter().flatten().chain([seen.film]).any(|film| film.distance(place) < 1e-3);
        let is_off = [place.x, place.y].iter().any(|x| !(0.0..1.0).contains(x));
        let is_there = is_place && (said - seen.density).abs() < 1e-3 * said;
        if !is_near_edge && (is_off && seen.is_on_film() && again == [None; 3] || !is_there) {
            return Err(format!(
                "{beside}, at {place} beside the film, whose ray says {said}, is found as {seen:?}"
            ));
        }
    }
    let lens = sample(60, 0, time).lens;
    for strange in [Vec3::NAN, Vec3::INFINITY] {
        if let Some(seen) = camera.connect(strange, lens, time) {
            return Err(format!("{strange} is seen: {seen:?}"));
        }
    }
    let origin = Vec3::from(camera.ray(&sample(60, 0, time)).origin);
    match camera.connect(origin, lens, time) {
        Some(seen) if !(seen.wi.is_finite() && seen.p.is_finite() && seen.density.is_finite()) => {
            Err(format!("its own place {origin} is seen: {seen:?}"))
        }
        _ => Ok(()),
    }
}
