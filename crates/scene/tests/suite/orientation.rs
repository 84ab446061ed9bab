//! Models are oriented by up axis and front before they are framed.

use bilux_math::{Aabb, DMat4, DVec3, Transform, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::presets::{Studio, complete};
use bilux_scene::{Axis, Mesh, Object, Orientation, OrientationSource, SceneBuilder, Spec, UpHint, Value};
use std::sync::Arc;

fn scene(mesh: Mesh, up: UpHint) -> SceneBuilder {
    let mut scene = SceneBuilder { up, materials: vec![Spec::new("", "phong")], ..SceneBuilder::default() };
    scene.objects.push(Object::new("it", Arc::new(mesh), 0));
    scene
}

fn joined(boxes: &[[[f32; 3]; 2]]) -> Mesh {
    let mut all = Mesh::default();
    for [min, max] in boxes {
        let part = shapes::cuboid(Aabb { min: (*min).into(), max: (*max).into() });
        let first = all.positions.len() as u32;
        all.positions.extend(part.positions);
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    all
}

/// A bust on a round base, taller than wide, symmetric only in left and right. Up is y, the front is z.
fn bust() -> Mesh {
    joined(&[
        [[-1.0, 0.0, -1.0], [1.0, 0.3, 1.0]],
        [[-0.4, 0.3, -0.5], [0.4, 2.2, 0.3]],
        [[-0.5, 2.2, -0.6], [0.5, 3.2, 0.6]],
        [[-0.1, 2.5, 0.6], [0.1, 2.8, 0.9]],
    ])
}

fn turned(mesh: &Mesh, up: Axis, front: Axis) -> Mesh {
    let from = Orientation { up, front, source: OrientationSource::Asked }.upright().transpose();
    let mut mesh = mesh.clone();
    mesh.positions.iter_mut().for_each(|p| *p = (from * p.as_dvec3()).as_vec3());
    mesh
}

#[test]
fn names_of_axes() {
    for axis in Axis::ALL {
        assert_eq!(Axis::from_name(axis.name()), Some(axis));
        assert_eq!(axis.direction(), -axis.opposite().direction());
    }
    assert_eq!(Axis::from_name(" +Z"), Some(Axis::Z));
    assert_eq!((Axis::from_name("auto"), Axis::from_name("w")), (None, None));
}

#[test]
fn up_and_front_are_turned_to_y_and_z() {
    for up in Axis::ALL {
        for front in Axis::ALL.into_iter().filter(|front| front.index() != up.index()) {
            let turn = Orientation { up, front, source: OrientationSource::Asked }.upright();
            assert_eq!((turn * up.direction(), turn * front.direction()), (DVec3::Y, DVec3::Z));
            assert_eq!(turn.determinant(), 1.0);
        }
    }
}

#[test]
fn a_stable_shape_overrides_the_usual_axis_and_a_ball_does_not() {
    for up in [Axis::X, Axis::Y, Axis::Z] {
        let front = if up == Axis::Z { Axis::NegY } else { Axis::Z };
        for usual in [Axis::Y, Axis::Z] {
            let scene = scene(turned(&bust(), up, front), UpHint::Usually(usual));
            let found = Orientation::of(&scene, None, None).unwrap();
            assert_eq!(found.up, up, "where {usual:?} is usual");
            assert_eq!(
                found.source,
                if up == usual { OrientationSource::Usual } else { OrientationSource::Shape }
            );
        }
    }
    let ball = || shapes::icosphere(Vec3::ZERO, 1.0, 3);
    for usual in [Axis::Y, Axis::Z] {
        let found = Orientation::of(&scene(ball(), UpHint::Usually(usual)), None, None).unwrap();
        assert_eq!((found.up, found.source), (usual, OrientationSource::Usual));
    }
    // A plate lies flat, and an orientation fixed by the format is not questioned.
    let plate = || joined(&[[[-1.0, -0.7, 0.0], [1.0, 0.7, 0.05]]]);
    let up_of = |hint| Orientation::of(&scene(plate(), hint), None, None).unwrap().up;
    assert_eq!(up_of(UpHint::Usually(Axis::Y)).index(), 2);
    assert_eq!(up_of(UpHint::Is(Axis::Y)), Axis::Y);
}

#[test]
fn a_model_that_faces_backwards_is_turned_round() {
    // Four legs, a long body, and a head that is high and far from the middle.
    let animal = |head: f32| {
        let mut parts = vec![[[-0.4, 1.0, -2.0], [0.4, 1.7, 2.0]]];
        for (x, z) in [(-0.3, -1.8), (0.3, -1.8), (-0.3, 1.8), (0.3, 1.8)] {
            parts.push([[x - 0.1, 0.0, z - 0.1], [x + 0.1, 1.0, z + 0.1]]);
        }
        parts.push([[-0.3, 1.5, head - 0.4], [0.3, 2.8, head + 0.4]]);
        joined(&parts)
    };
    let front = |head: f32| {
        let scene = scene(animal(head), UpHint::Usually(Axis::Y));
        let found = Orientation::of(&scene, None, None).unwrap();
        assert_eq!(found.up, Axis::Y);
        found.front
    };
    assert_eq!((front(1.9), front(-1.9)), (Axis::Z, Axis::NegZ));
}

/// The front that is found for a shape whose conventional front, +z, is right.
fn front_of_upright(parts: &[[[f32; 3]; 2]]) -> Axis {
    let scene = scene(joined(parts), UpHint::Usually(Axis::Y));
    let found = Orientation::of(&scene, Some(Axis::Y), None).unwrap();
    found.front
}

#[test]
fn a_model_that_hardly_leans_back_is_not_turned_round() {
    // A bust whose head lies slightly behind its chest.
    let bust = [
        [[-1.0, 0.0, -0.9], [1.0, 1.2, 1.1]],
        [[-0.4, 1.2, -0.5], [0.4, 1.6, 0.3]],
        [[-0.7, 1.6, -1.1], [0.7, 3.2, 0.6]],
    ];
    assert_eq!(front_of_upright(&bust), Axis::Z);
    // A coarse fish, whose tail has more triangles than its head.
    let mut fish = vec![[[-0.4, 0.0, -2.0], [0.4, 1.6, 0.0]], [[-0.3, 0.4, 0.0], [0.3, 1.2, 2.0]]];
    fish.extend((0..30).map(|i| {
        let y = 0.05 * i as f32;
        [[-0.35, y, -2.1], [0.35, y + 0.05, -2.0]]
    }));
    assert_eq!(front_of_upright(&fish), Axis::Z);
    // A scorpion: broader than high, with its tail above its back.
    let mut scorpion = vec![[[-0.5, 0.3, -1.5], [0.5, 0.7, 1.5]], [[-0.15, 0.7, -1.7], [0.15, 2.2, -1.2]]];
    for x in [-2.0, 0.5] {
        scorpion.push([[x, 0.0, 0.9], [x + 1.5, 0.3, 1.9]]);
    }
    assert_eq!(front_of_upright(&scorpion), Axis::Z);
}

#[test]
fn a_figure_on_the_ground_plane_is_not_laid_on_its_face() {
    // A woman with her arms apart and with straight feet: all of her back is in one plane.
    let figure = |ground: f32| {
        let parts = [
            [[-0.35, 0.0, -0.15], [-0.25, 0.06, 0.09]],
            [[0.25, 0.0, -0.15], [0.35, 0.06, 0.09]],
            [[-0.4, 0.06, -0.2], [-0.25, 1.0, 0.0]],
            [[0.25, 0.06, -0.2], [0.4, 1.0, 0.0]],
            [[-0.3, 1.0, -0.2], [0.3, 1.7, 0.2]],
            [[-0.8, 1.45, -0.2], [0.8, 1.6, -0.1]],
            [[-0.12, 1.7, -0.2], [0.12, 2.0, 0.1]],
        ];
        let raised = parts.map(|part| part.map(|[x, y, z]| [x, y + ground, z]));
        let scene = scene(joined(&raised), UpHint::Usually(Axis::Y));
        Orientation::of(&scene, None, None).unwrap().up
    };
    assert_eq!(figure(0.0), Axis::Y);
    // Without that, its shape decides.
    assert_eq!(figure(-1.0), Axis::Z);
}

#[test]
fn an_animal_stands_on_its_legs_where_the_usual_axis_would_topple_it() {
    // A bull: legs under a part of its length, a heavy head, and a tail.
    let mut parts = vec![[[-0.4, 1.0, -1.6], [0.4, 1.7, 1.6]]];
    for (x, z) in [(-0.3, -0.6), (0.3, -0.6), (-0.3, 2.3), (0.3, 2.3)] {
        parts.push([[x - 0.1, 0.0, z - 0.1], [x + 0.1, 1.0, z + 0.1]]);
    }
    parts.push([[-0.4, 1.6, 1.6], [0.4, 2.6, 3.1]]);
    parts.push([[-0.05, 1.6, -3.1], [0.05, 1.7, -1.6]]);
    let scene = scene(joined(&parts), UpHint::Usually(Axis::Z));
    let found = Orientation::of(&scene, None, None).unwrap();
    assert_eq!((found.up, found.source), (Axis::Y, OrientationSource::Shape));
}

/// A room that lacks its wall at +z or at -z, its triangles facing inwards; and a box that lacks one, its triangles facing outwards.
#[test]
fn a_room_is_seen_through_its_missing_wall() {
    let room = |open: f32, inwards: bool| {
        let mut mesh = joined(&[[[-1.0, 0.0, -1.0], [1.0, 1.5, 1.0]]]);
        let at = |i: u32, mesh: &Mesh| mesh.positions[i as usize].z == open;
        let is_wall = |t: &[u32; 3]| !t.iter().all(|&i| at(i, &mesh));
        mesh.triangles = mesh.triangles.iter().copied().filter(is_wall).collect();
        mesh.normals.clear();
        if inwards {
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let scene = scene(mesh, UpHint::Usually(Axis::Y));
        Orientation::of(&scene, Some(Axis::Y), None).unwrap().front
    };
    assert_eq!((room(1.0, true), room(-1.0, true)), (Axis::Z, Axis::NegZ));
    assert_eq!((room(1.0, false), room(-1.0, false)), (Axis::NegZ, Axis::Z), "a box, from outside");
}

#[test]
fn requested_axes_are_applied_and_scenes_with_cameras_stay() {
    let height = |scene: &SceneBuilder| scene.bounds(0.0).extent();
    let asked = |up, front| Studio { up, front, ..Studio::default() };
    let long = || scene(joined(&[[[0.0, 0.0, 0.0], [1.0, 2.0, 5.0]]]), UpHint::default());
    let mut up_x = long();
    let floor = |scene: &SceneBuilder| scene.objects.len();
    let found = complete(&mut up_x, &asked(Some(Axis::X), None)).unwrap();
    assert_eq!((found.up, found.source, floor(&up_x)), (Axis::X, OrientationSource::Asked, 2));
    up_x.objects.truncate(1);
    assert_eq!(height(&up_x).y, 1.0);
    let mut front_x = long();
    complete(&mut front_x, &asked(None, Some(Axis::X)));
    front_x.objects.truncate(1);
    assert_eq!(height(&front_x), Vec3::new(5.0, 2.0, 1.0));
    // It has its own camera, and the user asked for nothing.
    let mut own = long();
    complete(&mut own, &Studio::default());
    let (before, mut again) = (own.bounds(0.0), SceneBuilder { up: UpHint::Usually(Axis::Z), ..own });
    assert_eq!(complete(&mut again, &Studio::default()), None);
    assert_eq!(again.bounds(0.0), before);
}

/// Of up and front, either may be asked for alone: the other is then as without it, or, where that is on the same axis, another.
#[test]
fn one_of_two_axes_is_enough() {
    for hint in [UpHint::Is(Axis::Y), UpHint::Is(Axis::Z), UpHint::Usually(Axis::Y), UpHint::Usually(Axis::Z)]
    {
        let scene = scene(bust(), hint);
        let free = Orientation::of(&scene, None, None).unwrap();
        for asked in Axis::ALL {
            let up = Orientation::of(&scene, Some(asked), None).unwrap();
            assert_eq!((up.up, up.source), (asked, OrientationSource::Asked), "{hint:?}");
            assert_ne!(up.up.index(), up.front.index(), "{hint:?}, up {asked:?}");
            let front = Orientation::of(&scene, None, Some(asked)).unwrap();
            assert_eq!((front.front, front.source), (asked, OrientationSource::Asked), "{hint:?}");
            assert_ne!(front.up.index(), front.front.index(), "{hint:?}, front {asked:?}");
            if free.up.index() != asked.index() {
                assert_eq!(front.up, free.up, "{hint:?}: the front says nothing about what is up");
            }
            if let (UpHint::Is(_), true) = (hint, free.up == asked) {
                assert_eq!(up.front, free.front, "{hint:?}: what is known is asked for");
            }
        }
    }
}

#[test]
fn a_model_far_from_the_origin_is_framed_as_tightly_as_one_at_it() {
    let placed = |shift: DVec3| {
        let mut mesh = bust();
        // Coordinates that f32 represents exactly after the shift too.
        mesh.positions.iter_mut().for_each(|p| *p = (*p * 16.0).round());
        mesh.positions.iter_mut().for_each(|p| *p = (p.as_dvec3() + shift).as_vec3());
        let mut scene = scene(mesh, UpHint::Is(Axis::Z));
        complete(&mut scene, &Studio::default());
        let camera = scene.cameras[0].spec.clone();
        let position = camera.parameters.find("position").unwrap().0.clone();
        let Value::List(position) = position else { panic!() };
        let numbers = position.iter().map(|c| match c {
            Value::Number(x) => *x,
            Value::Integer(i) => *i as f64,
            _ => panic!(),
        });
        let eye = DVec3::from_slice(&numbers.collect::<Vec<_>>());
        let bounds = scene.objects[0].motion.at(0.0).bounds(&scene.objects[0].mesh.bounds());
        (eye - bounds.centre().as_dvec3(), bounds.extent())
    };
    let (near, size) = placed(DVec3::ZERO);
    for shift in [DVec3::new(1e6, 0.0, 0.0), DVec3::new(-1e6, 3e6, 1e6)] {
        let (far, far_size) = placed(shift);
        assert_eq!(far_size, size);
        assert!((far - near).length() < 1e-3 * near.length(), "{near} {far}");
    }
}

#[test]
fn units_become_metres_and_objects_keep_their_positions() {
    let mut millimetres = scene(bust(), UpHint::Is(Axis::Y));
    let place = Transform::from_matrix(DMat4::from_scale(DVec3::splat(2.0))).unwrap();
    millimetres.objects[0] = millimetres.objects[0].clone().placed(place);
    millimetres.unit = 0.001;
    complete(&mut millimetres, &Studio::default());
    let height = millimetres.objects[0].motion.at(0.0).bounds(&bust().bounds()).extent().y;
    assert!((height - 0.0064).abs() < 1e-6, "{height}");
}

/// Of light that passes so many units of a medium, as much is left in any unit: it goes by the product of the length
/// with the coefficient [Beer-Lambert law], or by the quotient of the length by the depth.
#[test]
fn insides_are_scaled_with_their_objects() {
    let mut millimetres = scene(bust(), UpHint::Is(Axis::Y));
    millimetres.unit = 0.001;
    millimetres.materials = vec![
        Spec::new("", "principled").with("transmission_depth", 4).with("specular_ior", 1.25),
        Spec::new("", "interface").with("absorption", Value::triple([3.0, 0.0, 0.5])),
    ];
    complete(&mut millimetres, &Studio::default());
    let [wax, smoke] = &millimetres.materials[..2] else { panic!() };
    assert_eq!((wax.number("transmission_depth"), wax.number("specular_ior")), (Some(0.004), Some(1.25)));
    assert_eq!(smoke.vector("absorption"), Some(Vec3::new(3000.0, 0.0, 500.0)));
}
