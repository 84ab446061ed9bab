//! Places of meshes, and attributes of their corners.

use super::*;
use bilux_math::Vec2;

#[test]
fn a_quad_is_two_triangles_with_its_attributes() {
    let scene = read_all(&placed(vec![]));
    let (object, mesh) = (&scene.objects[0], &scene.objects[0].mesh);
    assert_eq!((object.name.as_str(), mesh.triangles.as_slice()), ("node", &[[0, 1, 2], [0, 2, 3]][..]));
    assert_eq!(mesh.positions[2], Vec3::new(1.0, 2.0, 0.0));
    assert_eq!((mesh.normals[0], mesh.uvs[2]), (Vec3::Z, Vec2::ONE));
    assert_eq!(crate::warnings(&scene), "");
}

/// A metre is 39.37 inches, and what is up in the file is up in the scene.
#[test]
fn units_and_axes_are_those_of_the_settings() {
    let mut settings = z_up();
    settings.push(p("UnitScaleFactor", &[2.54]));
    let nodes = file(
        settings,
        vec![quad(1), model(2, "", vec![p("Lcl Translation", &[39.370_08, 0.0, 78.740_16])])],
        vec![link(1, 2, ""), link(2, 0, "")],
    );
    let scene = read_all(&nodes);
    near(at(&scene.objects[0], [0.0; 3]), [1.0, 2.0, 0.0]);
    near(at(&scene.objects[0], [0.0, 39.370_08, 0.0]), [1.0, 2.0, -1.0]);
    // Centimetres if nothing is stated.
    let nodes = file(vec![], vec![quad(1), model(2, "", vec![])], vec![link(1, 2, ""), link(2, 0, "")]);
    near(at(&read_all(&nodes).objects[0], [100.0, 0.0, 0.0]), [1.0, 0.0, 0.0]);
}

/// By hand: about a pivot at x = 1, a quarter turn about z takes (2, 0, 0) to (1, 1, 0); a scale of 2 about x = 1 takes
/// (2, 0, 0) to (3, 0, 0).
#[test]
fn rotations_and_scales_are_about_their_pivots() {
    let place = |list: Vec<N>, point: [f32; 3]| at(&read_all(&placed(list)).objects[0], point);
    let quarter = || p("Lcl Rotation", &[0.0, 0.0, 90.0]);
    near(place(vec![quarter(), p("RotationPivot", &[1.0, 0.0, 0.0])], [2.0, 0.0, 0.0]), [1.0, 1.0, 0.0]);
    let scaled = p("Lcl Scaling", &[2.0; 3]);
    near(place(vec![scaled.clone(), p("ScalingPivot", &[1.0, 0.0, 0.0])], [2.0, 0.0, 0.0]), [3.0, 0.0, 0.0]);
    near(place(vec![scaled.clone(), p("ScalingOffset", &[0.0, 0.0, 5.0])], [1.0, 0.0, 0.0]), [2.0, 0.0, 5.0]);
    near(place(vec![quarter(), p("RotationOffset", &[0.0, 7.0, 0.0])], [1.0, 0.0, 0.0]), [0.0, 8.0, 0.0]);
    // Before and after: x to y, then y to z.
    let active = p("RotationActive", &[1.0]);
    let before = vec![active.clone(), quarter(), p("PreRotation", &[90.0, 0.0, 0.0])];
    near(place(before, [1.0, 0.0, 0.0]), [0.0, 0.0, 1.0]);
    // The rotation after is inverted: x to -z by -90 degrees about y... its inverse takes x to z's negative.
    let after = vec![active.clone(), quarter(), p("PostRotation", &[0.0, 0.0, 90.0])];
    near(place(after, [1.0, 0.0, 0.0]), [1.0, 0.0, 0.0]);
    // About x then z, or about z then x: the order is that of the name's letters.
    let both = p("Lcl Rotation", &[90.0, 0.0, 90.0]);
    near(place(vec![both.clone(), p("RotationOrder", &[0.0])], [1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]);
    near(place(vec![both, p("RotationOrder", &[5.0])], [1.0, 0.0, 0.0]), [0.0, 0.0, 1.0]);
    near(place(vec![p("GeometricTranslation", &[0.0, 3.0, 0.0]), scaled], [1.0, 0.0, 0.0]), [2.0, 6.0, 0.0]);
}

/// A parent that is scaled by 2 along x and turned by 90 degrees; the child is turned by another 90 and scaled by 3 along x.
#[test]
fn children_inherit_scales_as_their_type_says() {
    let child = |inherits: f64| {
        let turned = || p("Lcl Rotation", &[0.0, 0.0, 90.0]);
        let objects = vec![
            quad(1),
            model(2, "parent", vec![turned(), p("Lcl Scaling", &[2.0, 1.0, 1.0])]),
            model(
                3,
                "child",
                vec![turned(), p("Lcl Scaling", &[3.0, 1.0, 1.0]), p("InheritType", &[inherits])],
            ),
        ];
        let links = vec![link(1, 3, ""), link(3, 2, ""), link(2, 0, "")];
        let scene = read_all(&file(vec![p("UnitScaleFactor", &[100.0])], objects, links));
        at(&scene.objects[0], [1.0, 1.0, 0.0])
    };
    // Turned (1, 1) scaled to (3, 1) is (-1, 3), scaled by 2 along x (-2, 3), turned (-3, -2).
    near(child(1.0), [-3.0, -2.0, 0.0]);
    // The scales first: (3 * 2, 1), and then half a turn.
    near(child(0.0), [-6.0, -1.0, 0.0]);
    near(child(2.0), [-3.0, -1.0, 0.0]);
}

#[test]
fn two_nodes_share_a_mesh_and_hidden_ones_are_not_there() {
    let objects = vec![
        quad(1),
        model(2, "a", vec![]),
        model(3, "b", vec![]),
        model(4, "c", vec![p("Visibility", &[0.0])]),
    ];
    let links = [2, 3, 4].into_iter().flat_map(|node| [link(1, node, ""), link(node, 0, "")]).collect();
    let scene = read_all(&file(vec![], objects, links));
    let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["a", "b"]);
    assert!(std::sync::Arc::ptr_eq(&scene.objects[0].mesh, &scene.objects[1].mesh));
}

#[test]
fn a_text_of_version_6_1_is_the_same_quad() {
    let text = "; FBX 6.1.0 project file\nFBXHeaderExtension: {\n FBXVersion: 6100\n}\nObjects: {\n Model: \"Model::node\", \"Mesh\" {\n  \
        Properties60: {\n   Property: \"Lcl Translation\", \"Lcl Translation\", \"A+\",100.0,0,0\n  }\n  Vertices: 0,0,0,1,0,0\n  ,1,2,0,0,2,0\n  \
        PolygonVertexIndex: 0,1,2,-4\n  LayerElementUV: 0 {\n   MappingInformationType: \"ByPolygonVertex\"\n   \
        ReferenceInformationType: \"IndexToDirect\"\n   UV: 0,0,1,0,1,1,0,1\n   UVIndex: 0,1,2,3\n  }\n }\n}\n\
        Connections: {\n Connect: \"OO\", \"Model::node\", \"Model::Scene\"\n}\n";
    let scene = scene_of(text.as_bytes()).unwrap();
    let mesh = &scene.objects[0].mesh;
    assert_eq!(
        (mesh.triangles.len(), mesh.positions[2], mesh.uvs[2]),
        (2, Vec3::new(1.0, 2.0, 0.0), Vec2::ONE)
    );
    near(at(&scene.objects[0], [0.0; 3]), [1.0, 0.0, 0.0]);
}

#[test]
fn arrays_may_be_of_any_type() {
    let mut nodes = placed(vec![]);
    let mesh = &mut nodes[2].children[0];
    mesh.children[0].values = vec![V::Floats(vec![0., 0., 0., 1., 0., 0., 1., 2., 0., 0., 2., 0.])];
    mesh.children[1].values = vec![V::Longs(vec![0, 1, 2, -4])];
    assert_eq!(read_all(&nodes).objects[0].mesh, read_all(&placed(vec![])).objects[0].mesh);
}

/// The corner of a cube whose edges are two long ends at a half: (9 v + 4 Σ neighbours + Σ diagonals) / 24. With all edges sharp, the
/// cube stays as it is.
#[test]
fn subdivision_surfaces_are_smooth_but_for_creases() {
    let cube = |smoothness: i32, crease: f64| {
        let corners =
            (0..8).flat_map(|i| [1, 2, 4].map(|bit| if i & bit == 0 { -1.0 } else { 1.0 })).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let indices = faces.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, !*d]).collect();
        let creases = n("EdgeCrease", vec![V::Doubles(vec![crease; 24])], vec![]);
        let mesh = object(
            "Geometry",
            1,
            "cube",
            "Mesh",
            vec![
                n("Smoothness", vec![V::Int(smoothness)], vec![]),
                n("Vertices", vec![V::Doubles(corners)], vec![]),
                n("PolygonVertexIndex", vec![V::Ints(indices)], vec![]),
                n("Edges", vec![V::Ints((0..24).collect())], vec![]),
                n("LayerElementEdgeCrease", vec![V::Int(0)], vec![creases]),
            ],
        );
        let list = vec![p("UnitScaleFactor", &[100.0])];
        // What is far away makes the cube small in the picture, so that it gets few polygons.
        let far = model(4, "far", vec![p("Lcl Translation", &[20.0, 0.0, 0.0])]);
        let nodes = vec![mesh, model(2, "node", vec![]), quad(3), far];
        let links = [(1, 2), (2, 0), (3, 4), (4, 0)].map(|(from, to)| link(from, to, ""));
        let scene = read_all(&file(list, nodes, links.to_vec()));
        let positions = &scene.objects[0].mesh.positions;
        let furthest = positions.iter().copied().max_by(|a, b| a.element_sum().total_cmp(&b.element_sum()));
        (furthest.unwrap(), scene.objects[0].mesh.triangles.len())
    };
    assert_eq!(cube(0, 0.0), (Vec3::ONE, 12));
    let (corner, triangles) = cube(2, 0.0);
    near(corner, [0.5; 3]);
    assert!(triangles > 1000);
    near(cube(1, 1.0).0, [1.0; 3]);
}

#[test]
fn corners_of_borders_are_round_where_the_rule_says_so() {
    let widest = |rule: i32| {
        let mut mesh = quad(1);
        mesh.children.push(n("Smoothness", vec![V::Int(2)], vec![]));
        mesh.children.push(n("BoundaryRule", vec![V::Int(rule)], vec![]));
        let list = vec![p("UnitScaleFactor", &[100.0])];
        let nodes = file(list, vec![mesh, model(2, "node", vec![])], vec![link(1, 2, ""), link(2, 0, "")]);
        let positions = read_all(&nodes).objects[0].mesh.positions.clone();
        positions.iter().map(|p| p.element_sum()).fold(0.0, f32::max)
    };
    assert_eq!([0, 1].map(widest), [3.0; 2]);
    assert!(widest(2) < 2.7);
}
