//! Spheres and other primitives: a tree finds what a loop finds, and the formulas hold.

use crate::support::{Numbers, SIEVE, bits};
use bilux_accel::primitives::{
    Capsule, Cone, Crossing, Curve, Disc, PrimitiveTree, Primitives, Quadric, Shape, Sphere,
};
use bilux_accel::{Accelerator, Culling, Hit, Primitive, Query, Ray};
use rayon::prelude::*;

fn random_shape(numbers: &mut Numbers, scale: f32) -> Shape {
    let vector = |numbers: &mut Numbers, size: f32| numbers.vector().map(|x| x * size * scale);
    let near = |numbers: &mut Numbers, at: [f32; 3], size: f32| {
        let step = vector(numbers, size);
        [at[0] + step[0], at[1] + step[1], at[2] + step[2]]
    };
    let centre = vector(numbers, 4.0);
    let radius = numbers.unit() * scale;
    match numbers.below(6) {
        0 => Shape::Sphere(Sphere { centre, radius }),
        1 => Shape::Disc(Disc { centre, normal: numbers.vector(), radius }),
        2 => {
            let ends = [centre, near(numbers, centre, 1.0)];
            let second = if numbers.below(2) == 0 { radius } else { numbers.unit() * scale };
            Shape::Cone(Cone { ends, radii: [radius, second] })
        }
        5 => Shape::Capsule(Capsule { ends: [centre, near(numbers, centre, 1.0)], radius: radius * 0.3 }),
        3 => {
            let corner = |sign: f32| centre.map(|x| x + sign * scale);
            let within = [corner(-1.0), corner(1.0)];
            let square = std::array::from_fn(|_| numbers.unit() * 2.0 - 1.0);
            Shape::Quadric(Quadric {
                square,
                linear: numbers.vector(),
                constant: numbers.unit() - 0.5,
                within,
            })
        }
        _ => {
            let points = std::array::from_fn(|_| near(numbers, centre, 1.0));
            Shape::Curve(Curve::new(points, [radius * 0.1, radius * 0.02]))
        }
    }
}

/// A loop over all shapes, using the trait alone.
fn closest_by_loop(shapes: &Vec<Shape>, ray: &Ray, query: &Query) -> Option<Hit> {
    let mut nearest: Option<Hit> = None;
    for primitive in 0..Primitives::len(shapes) as u32 {
        shapes.crossings(primitive, ray, &mut |Crossing { t, u, v, back }| {
            let hit = Hit { t, u, v, primitive, instance: 0 };
            let counts = t >= ray.t_min && t <= ray.t_max && !(back && query.culling == Culling::Back);
            let kept = counts && query.filter.is_none_or(|filter| filter(&hit));
            if kept && nearest.is_none_or(|best| t < best.t) {
                nearest = Some(hit);
            }
        });
    }
    nearest
}

#[test]
fn a_tree_finds_what_a_loop_finds() {
    let hits: usize = [1e-6f32, 1.0, 1e6]
        .into_par_iter()
        .enumerate()
        .map(|(seed, scale)| {
            let mut numbers = Numbers::new(seed as u64);
            let shapes: Vec<Shape> = (0..300).map(|_| random_shape(&mut numbers, scale)).collect();
            let tree = PrimitiveTree::new(shapes.clone());
            let plain = Query::default();
            let queries =
                [plain, Query { culling: Culling::Back, ..plain }, Query { filter: Some(SIEVE), ..plain }];
            let mut hits = 0;
            for _ in 0..3000 {
                let far = if numbers.below(4) == 0 { 100.0 } else { 5.0 };
                let origin = numbers.vector().map(|x| x * far * scale);
                let target = numbers.vector().map(|x| x * 4.0 * scale);
                let mut ray = Ray::new(origin, std::array::from_fn(|k| target[k] - origin[k]));
                for step in 0..3 {
                    for query in &queries {
                        let truth = closest_by_loop(&shapes, &ray, query);
                        assert_eq!(bits(tree.closest_hit(&ray, query)), bits(truth), "{ray:?}");
                        assert_eq!(tree.any_hit(&ray, query), truth.is_some(), "{ray:?}");
                        assert_eq!(
                            tree.all_hits(&ray, query).first().map(|hit| hit.t),
                            truth.map(|hit| hit.t)
                        );
                    }
                    let Some(hit) = tree.closest_hit(&ray, &plain) else { break };
                    hits += 1;
                    // A second ray from there, in another direction.
                    let exclude = hit.primitive();
                    ray = Ray { exclude, ..Ray::new(ray.at(hit.t), numbers.vector().map(|x| x * scale)) };
                    if step == 1 {
                        ray.t_max = numbers.unit();
                    }
                }
            }
            hits
        })
        .sum();
    assert!(hits > 5000, "{hits}");
}

#[test]
fn no_ray_escapes_a_sphere_and_none_hits_it_again_at_its_origin() {
    for (seed, scale) in [1e-6f32, 1e-3, 1.0, 1e3, 1e6].into_iter().enumerate() {
        for shift in [0.0, 1.0, 1000.0] {
            let mut numbers = Numbers::new(seed as u64);
            let centre = [shift * scale, -shift * scale, 0.5 * shift * scale];
            let tree = PrimitiveTree::new(vec![Shape::Sphere(Sphere { centre, radius: scale })]);
            for _ in 0..5000 {
                let origin = numbers.vector().map(|x| x * 0.57 * scale);
                let origin = std::array::from_fn(|k| origin[k] + centre[k]);
                let ray = Ray::new(origin, numbers.vector());
                let hit =
                    tree.closest_hit(&ray, &Query::default()).expect("from inside there is no way past");
                assert!(
                    tree.closest_hit(&ray, &Query { culling: Culling::Back, ..Query::default() }).is_none()
                );
                // From the surface, whatever its rounding: an outward ray hits nothing, an inward ray the far side.
                let p = ray.at(hit.t);
                let out: [f32; 3] = std::array::from_fn(|k| p[k] - centre[k]);
                let leave = |direction| Ray {
                    exclude: Primitive { instance: 0, index: 0 },
                    ..Ray::new(p, direction)
                };
                assert!(!tree.any_hit(&leave(out), &Query::default()));
                let across =
                    tree.closest_hit(&leave(out.map(|x| -x)), &Query::default()).expect("the far side");
                assert!((across.t - 2.0).abs() < 1e-2, "{across:?}");
            }
        }
    }
}

#[test]
fn hits_lie_where_the_formulas_say() {
    let ray = Ray::new([0.0, 0.5, 10.0], [0.0, 0.0, -2.0]);
    let all = |shape: Shape| -> Vec<(f32, f32)> {
        let hits = PrimitiveTree::new(vec![shape]).all_hits(&ray, &Query::default());
        hits.iter().map(|hit| (hit.t, hit.u)).collect()
    };
    let disc = Disc { centre: [0.0, 0.0, 2.0], normal: [0.0, 0.0, 3.0], radius: 1.0 };
    assert_eq!(all(Shape::Disc(disc)), [(4.0, 0.5)]);
    assert_eq!(all(Shape::Disc(Disc { radius: 0.25, ..disc })), []);
    let cylinder = Cone { ends: [[0.0, -1.0, 0.0], [0.0, 3.0, 0.0]], radii: [2.0, 2.0] };
    assert_eq!(all(Shape::Cone(cylinder)), [(4.0, 0.375), (6.0, 0.375)]);
    let cone = Cone { ends: [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]], radii: [2.0, 0.0] };
    assert_eq!(all(Shape::Cone(cone)), [(4.5, 0.5), (5.5, 0.5)]);
    // A round end, the side, and a capsule that is a sphere.
    let capsule = Capsule { ends: [[0.0, -1.0, 0.0], [0.0, 3.0, 0.0]], radius: 2.0 };
    assert_eq!(all(Shape::Capsule(capsule)), [(4.0, 0.375), (6.0, 0.375)]);
    let below = Capsule { ends: [[0.0, -2.5, 0.0], [0.0, -2.5, 0.0]], radius: 5.0 };
    assert_eq!(all(Shape::Capsule(below)), [(3.0, 0.0), (7.0, 0.0)]);
    let end = Capsule { ends: [[0.0, -9.0, 0.0], [0.0, -2.5, 0.0]], radius: 5.0 };
    assert_eq!(all(Shape::Capsule(end)), [(3.0, 1.0), (7.0, 1.0)]);
    let along = Capsule { ends: [[0.0, 0.5, 0.0], [0.0, 0.5, 4.0]], radius: 1.0 };
    assert_eq!(all(Shape::Capsule(along)), [(2.5, 1.0), (5.5, 0.0)]);
    // The other half of the double cone would lie beyond the apex.
    assert_eq!(all(Shape::Cone(Cone { ends: [[0.0, -1.5, 0.0], [0.0, 0.0, 0.0]], radii: [3.0, 0.0] })), []);
    // A paraboloid z = x² + y².
    let bowl = Quadric {
        square: [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        linear: [0.0, 0.0, -0.5],
        constant: 0.0,
        within: [[-1.0; 3], [1.0; 3]],
    };
    assert_eq!(all(Shape::Quadric(bowl)), [(4.875, 0.0)]);
    let straight = [[-1.0, 0.5, 1.0], [-0.5, 0.5, 1.0], [0.5, 0.5, 1.0], [1.0, 0.5, 1.0]];
    assert_eq!(all(Shape::Curve(Curve::new(straight, [0.1, 0.1]))), [(4.5, 0.5)]);
}

/// The fraction of rays through a square, all along z, that hit something; the square is `[-1, 1]²`.
fn coverage(shapes: Vec<Shape>) -> f64 {
    let (tree, side) = (PrimitiveTree::new(shapes), 700);
    let place = |i: usize| (i as f32 + 0.5) / side as f32 * 2.0 - 1.0;
    let row = |y: usize| {
        let ray = |x: usize| Ray::new([place(x), place(y), 5.0], [0.0, 0.0, -1.0]);
        (0..side).filter(|&x| tree.any_hit(&ray(x), &Query::default())).count()
    };
    (0..side).into_par_iter().map(row).sum::<usize>() as f64 / (side * side) as f64
}

#[test]
fn coverage_matches_projected_areas() {
    let close = |measured: f64, expected: f64| {
        assert!((measured / expected - 1.0).abs() < 0.01, "{measured} {expected}")
    };
    let circle = std::f64::consts::PI / 4.0;
    close(coverage(vec![Shape::Sphere(Sphere { centre: [0.0; 3], radius: 0.8 })]), circle * 0.64);
    // A disc seen at 60 degrees covers half of its area.
    let normal = [0.75f32.sqrt(), 0.0, 0.5];
    close(coverage(vec![Shape::Disc(Disc { centre: [0.0; 3], normal, radius: 0.8 })]), circle * 0.32);
    // A cone lying on its side: a triangle.
    let cone = Cone { ends: [[-0.8, 0.0, 0.0], [0.8, 0.0, 0.0]], radii: [0.5, 0.0] };
    close(coverage(vec![Shape::Cone(cone)]), 1.6 * 0.5 / 4.0);
    // Half a circle of radius 0.7 as two Bézier curves, with its length times its width; in one piece or nine.
    let k = 0.7 * 0.552_284_8;
    let arcs = [
        [[0.7, 0.0, 0.0], [0.7, k, 0.0], [k, 0.7, 0.0], [0.0, 0.7, 0.0]],
        [[0.0, 0.7, 0.0], [-k, 0.7, 0.0], [-0.7, k, 0.0], [-0.7, 0.0, 0.0]],
    ];
    let curves = arcs.map(|points| Curve::new(points, [0.1, 0.1]));
    let expected = std::f64::consts::PI * 0.7 * 0.1 / 4.0;
    close(coverage(curves.map(Shape::Curve).to_vec()), expected);
    close(
        coverage(curves.into_iter().flat_map(|curve| curve.pieces(9)).map(Shape::Curve).collect()),
        expected,
    );
}

#[test]
fn a_quadric_can_be_a_sphere() {
    let (r, mut numbers) = (1.5f32, Numbers::new(5));
    let sphere = PrimitiveTree::new(vec![Shape::Sphere(Sphere { centre: [0.0; 3], radius: r })]);
    let quadric = PrimitiveTree::new(vec![Shape::Quadric(Quadric {
        square: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
        linear: [0.0; 3],
        constant: -r * r,
        within: [[-2.0; 3], [2.0; 3]],
    })]);
    for _ in 0..10_000 {
        let ray = Ray::new(numbers.vector().map(|x| x * 4.0), numbers.vector());
        let [a, b] = [&sphere, &quadric].map(|tree| tree.all_hits(&ray, &Query::default()));
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(&b).all(|(a, b)| (a.t - b.t).abs() <= 1e-5 * a.t.abs().max(1.0)));
    }
}

#[test]
fn invalid_shapes_are_never_hit() {
    let odd = [f32::NAN, f32::INFINITY, 0.0, -1.0, f32::MAX, f32::MIN_POSITIVE];
    for x in odd {
        let points = [[x, 0.0, 0.0], [0.0, x, 0.0], [1.0, 1.0, x], [x; 3]];
        let shapes = vec![
            Shape::Sphere(Sphere { centre: [0.0; 3], radius: x.min(0.0) }),
            Shape::Sphere(Sphere { centre: [x.abs() * f32::INFINITY; 3], radius: 1.0 }),
            Shape::Disc(Disc { centre: [0.0; 3], normal: [0.0; 3], radius: x }),
            Shape::Disc(Disc { centre: [0.0; 3], normal: [0.0, 0.0, 1.0], radius: x.min(0.0) }),
            Shape::Cone(Cone { ends: [[x; 3]; 2], radii: [1.0, x] }),
            Shape::Curve(Curve::new(points, [x.min(0.0), 0.0])),
            Shape::Quadric(Quadric {
                square: [0.0; 6],
                linear: [0.0; 3],
                constant: x,
                within: [[-1.0; 3], [1.0; 3]],
            }),
        ];
        let tree = PrimitiveTree::new(shapes);
        let ray = Ray::new([0.1, 0.2, 9.0], [0.0, 0.0, -1.0]);
        assert_eq!(tree.closest_hit(&ray, &Query::default()), None, "{x}");
        for direction in [[0.0; 3], [f32::NAN; 3]] {
            assert!(!tree.any_hit(&Ray::new([0.0; 3], direction), &Query::default()));
        }
    }
    assert_eq!(
        PrimitiveTree::new(Vec::<Shape>::new()).closest_hit(&Ray::new([0.0; 3], [1.0; 3]), &Query::default()),
        None
    );
}

#[test]
fn a_capsule_is_hit_on_its_surface_and_not_again_at_the_origin() {
    let mut numbers = Numbers::new(7);
    let (mut hits, mut across) = (0, 0);
    for _ in 0..20_000 {
        let ends = [numbers.vector(), numbers.vector()];
        let capsule = Capsule { ends, radius: 0.02 + 0.3 * numbers.unit() };
        let tree = PrimitiveTree::new(vec![Shape::Capsule(capsule)]);
        let origin = numbers.vector().map(|x| x * 5.0);
        let target = numbers.vector();
        let ray = Ray::new(origin, std::array::from_fn(|k| target[k] - origin[k]));
        let distance = |p: [f32; 3]| {
            let wide = |v: [f32; 3]| v.map(f64::from);
            let (a, b, p) = (wide(ends[0]), wide(ends[1]), wide(p));
            let s = capsule.nearest(p);
            (0..3)
                .map(|k| {
                    let d = p[k] - (a[k] + (b[k] - a[k]) * s);
                    d * d
                })
                .sum::<f64>()
                .sqrt()
        };
        let Some(hit) = tree.closest_hit(&ray, &Query::default()) else { continue };
        hits += 1;
        let p = ray.at(hit.t);
        assert!((distance(p) - f64::from(capsule.radius)).abs() < 1e-5, "{capsule:?} {ray:?}");
        // A ray through it: it hits the far side, or nothing if it only grazes the surface.
        let on = Ray { exclude: hit.primitive(), t_min: 0.0, ..Ray::new(p, ray.direction) };
        if let Some(far) = tree.closest_hit(&on, &Query::default()) {
            across += 1;
            assert!((distance(on.at(far.t)) - f64::from(capsule.radius)).abs() < 1e-5);
            let middle = std::array::from_fn(|k| (p[k] + on.at(far.t)[k]) * 0.5);
            assert!(distance(middle) < f64::from(capsule.radius) + 1e-5);
        }
    }
    assert!(hits > 2000 && across > hits * 9 / 10, "{hits} {across}");
}
