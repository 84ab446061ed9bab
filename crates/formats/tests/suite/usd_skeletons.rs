//! `UsdSkel`: joints, blend shapes, and what is bound to them.

use crate::{read_text, warnings};
use bilux_formats::{ReadOptions, read};
use bilux_math::Vec3;
use bilux_scene::SceneBuilder;

/// An arm along x of two joints, the second 2 from the first; the second turns about z by 90 degrees within 10 time codes, and the
/// first rises. Vertices 0 and 1 are at the first joint, 2 is at the second, 3 is 1 beyond.
const ARM: &str = r#"(startTimeCode = 0 endTimeCode = 10 timeCodesPerSecond = 10)
def SkelRoot "rig" (prepend apiSchemas = ["SkelBindingAPI"]) {
    rel skel:skeleton = </rig/skeleton>
    def Skeleton "skeleton" {
        uniform token[] joints = ["arm", "arm/hand"]
        uniform matrix4d[] bindTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1)), ((1,0,0,0),(0,1,0,0),(0,0,1,0),(2,0,0,1))]
        uniform matrix4d[] restTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,5,1)), ((1,0,0,0),(0,1,0,0),(0,0,1,0),(2,0,0,1))]
        rel skel:animationSource = </rig/skeleton/wave>
        double3 xformOp:translate = (0, 0, 100)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        def SkelAnimation "wave" {
            uniform token[] joints = ["arm/hand"]
            float3[] translations = [(2, 0, 0)]
            quatf[] rotations.timeSamples = { 0: [(1, 0, 0, 0)], 10: [(0.70710678, 0, 0, 0.70710678)] }
            half3[] scales = [(1, 1, 1)]
            uniform token[] blendShapes = ["swell"]
            float[] blendShapeWeights.timeSamples = { 0: [0], 10: [1] }
        }
        def SkelAnimation "other" {
            uniform token[] joints = ["arm/hand", "arm"]
            float3[] translations = [(2, 0, 0), (0, 7, 0)]
            quatf[] rotations = [(1, 0, 0, 0), (1, 0, 0, 0)]
            half3[] scales = [(1, 1, 1), (1, 1, 1)]
        }
    }
    def Mesh "skin" {
        int[] faceVertexCounts = [3, 3]
        int[] faceVertexIndices = [0, 1, 2, 1, 3, 2]
        point3f[] points = [(0, 1, 0), (0, -1, 0), (2, 1, 0), (3, 0, 0)]
        uniform token subdivisionScheme = "none"
        normal3f[] normals = [(0, 1, 0), (0, 1, 0), (0, 1, 0), (1, 0, 0)] (interpolation = "vertex")
        MORE
    }
}
"#;

const BOUND: &str = r#"uniform token[] skel:joints = ["arm/hand", "arm"]
        int[] primvars:skel:jointIndices = [1, 0, 1, 0, 0, 1, 0, 0] (elementSize = 2 interpolation = "vertex")
        float[] primvars:skel:jointWeights = [1, 0, 1, 0, 0.5, 0.5, 1, 0] (elementSize = 2 interpolation = "vertex")"#;

fn arm(more: &str, time: f32, animation: Option<&str>) -> SceneBuilder {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("arm.usda");
    std::fs::write(&file, format!("#usda 1.0\n{}", ARM.replace("MORE", more))).unwrap();
    let options = ReadOptions { time, animation: animation.map(str::to_owned), ..ReadOptions::default() };
    read(&file, &options).unwrap()
}

/// The points of the only object in the world, and the normal of the last.
fn points(scene: &SceneBuilder) -> (Vec<Vec3>, Vec3) {
    let object = &scene.objects[0];
    let place = object.motion.at(0.0);
    let points = object.mesh.positions.iter().map(|p| place.point(*p)).collect();
    let normal = object.mesh.normals.last().map_or(Vec3::ZERO, |n| place.normal(*n));
    (points, normal)
}

fn close(a: Vec3, b: [f32; 3]) -> bool {
    a.distance(Vec3::from(b)) < 1e-4
}

#[test]
fn points_follow_their_joints() {
    // The first joint is not animated and rests, 5 above where it was bound; all is in the space of the skeleton, 100 above.
    let (still, _) = points(&arm(BOUND, 0.0, None));
    assert!(close(still[0], [0.0, 1.0, 105.0]) && close(still[3], [3.0, 0.0, 105.0]), "{still:?}");
    // Turned by 90 degrees about z at (2, 0, 5).
    let (turned, normal) = points(&arm(BOUND, 1.0, None));
    assert!(close(turned[3], [2.0, 1.0, 105.0]) && close(normal, [0.0, 1.0, 0.0]), "{turned:?} {normal}");
    // Half of (2, 1) and half of (1, 0).
    assert!(close(turned[2], [1.5, 0.5, 105.0]), "{turned:?}");
    // Halfway a quaternion has turned by 45 degrees, and is of length 1.
    let (halfway, _) = points(&arm(BOUND, 0.5, None));
    let side = std::f32::consts::FRAC_1_SQRT_2;
    assert!(close(halfway[3], [2.0 + side, side, 105.0]), "{halfway:?}");
    assert!(!warnings(&arm(BOUND, 1.0, None)).contains("skin"));
}

#[test]
fn another_animation_is_chosen_by_its_name() {
    let scene = arm(BOUND, 1.0, Some("other"));
    let (moved, _) = points(&scene);
    assert!(close(moved[3], [3.0, 7.0, 100.0]), "{moved:?}");
    let names: Vec<_> = scene.inventory.animations.iter().map(|a| (a.name.as_str(), a.plays)).collect();
    assert_eq!(names, [("wave", false), ("other", true)]);
}

#[test]
fn prims_that_one_joint_moves_are_elsewhere_and_keep_their_mesh() {
    let rigid = r#"int[] primvars:skel:jointIndices = [1] (elementSize = 1 interpolation = "constant")
        float[] primvars:skel:jointWeights = [1] (elementSize = 1 interpolation = "constant")
        matrix4d primvars:skel:geomBindTransform = ((1,0,0,0),(0,1,0,0),(0,0,1,0),(1,0,0,1))"#;
    let scene = arm(rigid, 1.0, None);
    assert!(close(scene.objects[0].mesh.positions[3], [3.0, 0.0, 0.0]));
    // (3, 0, 0) was bound at (4, 0, 0), 2 from the joint.
    assert!(close(points(&scene).0[3], [2.0, 2.0, 105.0]));
}

/// A shape of the skin's last point, with one in between and with more of its own.
fn swell(more: &str) -> String {
    format!(
        r#"uniform token[] skel:blendShapes = ["swell"]
        rel skel:blendShapeTargets = </rig/skin/swell>
        def BlendShape "swell" {{
            uniform vector3f[] offsets = [(4, 0, 0)]
            uniform vector3f[] normalOffsets = [(-1, 0, 1)]
            uniform vector3f[] inbetweens:half = [(0, 8, 0)] (weight = 0.5)
            {more}
            uniform int[] pointIndices = [3]
        }}"#
    )
}

#[test]
fn blend_shapes_run_through_those_in_between() {
    let shape = swell("");
    let at = |time: f32| points(&arm(&shape, time, None));
    // Without joints the mesh is where its prim is.
    assert!(close(at(0.0).0[3], [3.0, 0.0, 0.0]));
    assert!(close(at(0.25).0[3], [3.0, 4.0, 0.0]));
    assert!(close(at(0.5).0[3], [3.0, 8.0, 0.0]));
    assert!(close(at(0.75).0[3], [5.0, 4.0, 0.0]));
    let (whole, normal) = at(1.0);
    assert!(close(whole[3], [7.0, 0.0, 0.0]) && close(normal, [0.0, 0.0, 1.0]), "{whole:?} {normal}");
    assert!(close(whole[0], [0.0, 1.0, 0.0]));
}

/// A shape in between has offsets of normals of its own, which count where its offsets of points do.
#[test]
fn normals_turn_as_the_shapes_in_between_say() {
    let shape = swell("uniform vector3f[] inbetweens:half:normalOffsets = [(-1, 1, 0)]");
    let normal = |time: f32| points(&arm(&shape, time, None)).1.normalize();
    // From x by way of y to z.
    let side = std::f32::consts::FRAC_1_SQRT_2;
    let ways = [[1.0, 0.0, 0.0], [side, side, 0.0], [0.0, 1.0, 0.0], [0.0, side, side], [0.0, 0.0, 1.0]];
    for (quarter, wanted) in ways.into_iter().enumerate() {
        let found = normal(0.25 * quarter as f32);
        assert!(close(found, wanted), "{quarter}: {found}");
    }
}

#[test]
fn bindings_that_make_no_sense_keep_the_shape_and_are_named() {
    let fewer = BOUND.replace("[1, 0, 1, 0, 0.5, 0.5, 1, 0]", "[1, 0]");
    let message = |more: &str| warnings(&arm(more, 1.0, None));
    assert!(message(&fewer).contains("not as many weights as joints"), "{}", message(&fewer));
    let wild = BOUND.replace("[1, 0, 1, 0, 0, 1, 0, 0]", "[1, 0, 1, 0, -7, 1, 2000000000, 0]");
    assert_eq!(points(&arm(&wild, 1.0, None)).0.len(), 4);
    let lost =
        ARM.replace("bindTransforms = [", "bindTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1)), ");
    let scene = read_text("usda", format!("#usda 1.0\n{}", lost.replace("MORE", BOUND))).unwrap();
    assert!(warnings(&scene).contains("where each joint was bound"), "{}", warnings(&scene));
}
