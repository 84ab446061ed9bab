//! NURBS surfaces.

use super::*;

fn surface(orders: [i32; 2], counts: [i32; 2], knots: [&[f64]; 2], points: &[[f64; 4]]) -> Vec<N> {
    let geometry = object(
        "Geometry",
        1,
        "surface",
        "NurbsSurface",
        vec![
            n("NurbsSurfaceOrder", orders.map(V::Int).to_vec(), vec![]),
            n("Dimensions", counts.map(V::Int).to_vec(), vec![]),
            n("Points", vec![V::Doubles(points.concat())], vec![]),
            n("KnotVectorU", vec![V::Doubles(knots[0].to_vec())], vec![]),
            n("KnotVectorV", vec![V::Doubles(knots[1].to_vec())], vec![]),
        ],
    );
    let settings = vec![p("UnitScaleFactor", &[100.0])];
    file(settings, vec![geometry, model(2, "node", vec![])], vec![link(1, 2, ""), link(2, 0, "")])
}

/// A quarter of a circle is a conic with a weight of √½ at its corner. [Farin 2002, section 12.2]
#[test]
fn a_rational_surface_of_degree_two_is_a_cylinder() {
    let half = 0.5f64.sqrt();
    let arc = |z: f64| [[1.0, 0.0, z, 1.0], [1.0, 1.0, z, half], [0.0, 1.0, z, 1.0]];
    let points = [arc(0.0), arc(3.0)].concat();
    let nodes = surface([3, 2], [3, 2], [&[0., 0., 0., 2., 2., 2.], &[0., 0., 1., 1.]], &points);
    let mesh = read_all(&nodes).objects[0].mesh.clone();
    assert_eq!(mesh.triangles.len(), 2 * 16 * 16);
    for (i, p) in mesh.positions.iter().enumerate() {
        assert!((p.truncate().length() - 1.0).abs() < 1e-6, "{p}");
        let normal = p.truncate().extend(0.0);
        assert!(
            mesh.normals[i].dot(normal) > 0.99,
            "u runs around and v upwards, so that outside is the front"
        );
        assert!((p.z - 3.0 * mesh.uvs[i].y).abs() < 1e-5);
    }
}

/// Cubic and periodic around, over four points, and closed at both ends of a line by poles.
#[test]
fn a_periodic_surface_with_poles_is_closed() {
    let corners = [[1.0, 0.0], [0.0, -1.0], [-1.0, 0.0], [0.0, 1.0]];
    let column = |[x, z]: [f64; 2]| [[0.0, -1.0, 0.0, 1.0], [x, 0.0, z, 1.0], [0.0, 1.0, 0.0, 1.0]];
    let points = corners.map(column).concat();
    let around: Vec<f64> = (-3..8).map(f64::from).collect();
    let nodes = surface([2, 4], [3, 4], [&[0., 0., 1., 2., 2.], &around], &points);
    let mesh = read_all(&nodes).objects[0].mesh.clone();
    assert_eq!(mesh.triangles.len(), 2 * 32 * 64 - 2 * 64);
    // A uniform cubic spline begins at (1, 4, 1) / 6 of its first points.
    let widest = mesh.positions.iter().map(|p| p.x.max(p.z)).fold(0.0, f32::max);
    assert!((widest - 4.0 / 6.0).abs() < 1e-5, "{widest}");
    let mut directed: Vec<[[u32; 3]; 2]> = Vec::new();
    for [a, b, c] in &mesh.triangles {
        let at = |i: &u32| (mesh.positions[*i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
        directed.extend([[at(a), at(b)], [at(b), at(c)], [at(c), at(a)]]);
    }
    directed.sort_unstable();
    assert!(directed.iter().all(|[a, b]| directed.binary_search(&[*b, *a]).is_ok()), "an edge is open");
}

#[test]
fn surfaces_that_are_none_are_left_out() {
    let square = [[0., 0., 0., 1.], [1., 0., 0., 1.], [0., 1., 0., 1.], [1., 1., 0., 1.]];
    let line: &[f64] = &[0., 0., 1., 1.];
    let weightless = square.map(|[x, y, z, _]| [x, y, z, 0.0]);
    for (orders, counts, knots, points, wanted) in [
        ([2, 2], [2, 2], [line, line], &square[..3], "its knots or points do not fit"),
        ([2, 2], [2, 2], [&[1., 0., 1., 1.], line], &square[..], "its knots or points do not fit"),
        ([2, 2], [2, 2], [&[0., 0., 0., 0.], line], &square[..], "its knots or points do not fit"),
        ([9, 2], [2, 2], [line, line], &square[..], "its knots or points do not fit"),
        ([2, 2], [-2, -2], [line, line], &square[..], "its knots or points do not fit"),
        ([2, 2], [2, 2], [line, line], &weightless[..], "beyond all bounds"),
    ] {
        let scene = read_all(&surface(orders, counts, knots, points));
        assert!(scene.objects.is_empty());
        assert!(crate::warnings(&scene).contains(wanted), "{}", crate::warnings(&scene));
    }
}
