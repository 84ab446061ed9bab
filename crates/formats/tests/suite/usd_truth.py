"""Where OpenUSD puts the meshes of files, as lines for `usd_truth.rs`: `F seconds file`, then for each name of prims `O`, whether
they are subdivided, the number of triangles, and the least and greatest coordinates. Files come from the standard input."""

import sys

from pxr import Gf, Usd, UsdGeom, UsdSkel


def prepared(path):
    stage = Usd.Stage.Open(path)
    stage.SetEditTarget(stage.GetSessionLayer())
    # Meshes of instances can only be deformed if they are not shared.
    if any(p.GetTypeName() == "SkelRoot" for p in proxies(stage)):
        for _ in range(8):
            shared = [p for p in stage.Traverse() if p.IsInstance()]
            for prim in shared:
                prim.SetInstanceable(False)
            if not shared:
                break
    return stage


def proxies(stage):
    return Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate))


def sampled(stage, time, otherwise):
    """A time nearby with samples: skinning is baked at no others. The other one where nothing is skinned."""
    for prim in proxies(stage):
        for name in ("rotations", "blendShapeWeights") if prim.GetTypeName() == "SkelAnimation" else ():
            samples = prim.GetAttribute(name).GetBracketingTimeSamples(time)
            if samples:
                return samples[0]
    return otherwise


def bake(stage, time):
    for root in [p for p in stage.Traverse() if p.IsA(UsdSkel.Root)]:
        UsdSkel.BakeSkinning(UsdSkel.Root(root), Gf.Interval(time, time))


def mesh(prim, world, time, found):
    shape = UsdGeom.Mesh(prim)
    points = shape.GetPointsAttr().Get(time) or []
    counts = shape.GetFaceVertexCountsAttr().Get(time) or []
    indices = shape.GetFaceVertexIndicesAttr().Get(time) or []
    holes = set(shape.GetHoleIndicesAttr().Get(time) or [])
    entry = found.setdefault(prim.GetName(), [False, 0, [float("inf")] * 3, [float("-inf")] * 3])
    entry[0] |= shape.GetSubdivisionSchemeAttr().Get(time) != "none"
    used, at = set(), 0
    for face, count in enumerate(counts):
        corners = indices[at : at + count]
        at += count
        if face in holes or count < 3 or len(corners) < count or any(not 0 <= i < len(points) for i in corners):
            continue
        entry[1] += count - 2
        used.update(corners)
    for i in used:
        p = world.Transform(Gf.Vec3d(points[i]))
        entry[2] = [min(a, b) for a, b in zip(entry[2], p)]
        entry[3] = [max(a, b) for a, b in zip(entry[3], p)]


def walk(prim, above, purpose, time, found, open_instancers=()):
    world, purpose = above, purpose
    if prim.IsA(UsdGeom.Imageable):
        shape = UsdGeom.Imageable(prim)
        if shape.GetVisibilityAttr().Get(time) == "invisible":
            return
        own = shape.GetPurposeAttr().Get()
        purpose = own if purpose == "default" and own else purpose
    if prim.IsA(UsdGeom.Xformable):
        local = UsdGeom.Xformable(prim)
        matrix = local.GetLocalTransformation(time)
        world = matrix if local.GetResetXformStack() else matrix * above
    is_shown = purpose in ("default", "render")
    if prim.IsA(UsdGeom.PointInstancer):
        if is_shown and prim.GetPath() not in open_instancers:
            instancer = UsdGeom.PointInstancer(prim)
            paths = instancer.GetPrototypesRel().GetForwardedTargets()
            prototypes = [prim.GetStage().GetPrimAtPath(path) for path in paths]
            chosen = instancer.GetProtoIndicesAttr().Get(time) or []
            mask = instancer.ComputeMaskAtTime(time)
            if len(chosen) == 0:
                return
            places = instancer.ComputeInstanceTransformsAtTime(
                time, time, UsdGeom.PointInstancer.ExcludeProtoXform, UsdGeom.PointInstancer.IgnoreMask
            )
            for i, place in enumerate(places):
                if (not mask or mask[i]) and prototypes[chosen[i]]:
                    inner = open_instancers + (prim.GetPath(),)
                    walk(prototypes[chosen[i]], place * world, "default", time, found, inner)
        return
    if prim.GetTypeName() == "Mesh" and is_shown:
        mesh(prim, world, time, found)
    for child in prim.GetFilteredChildren(Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
        walk(child, world, purpose, time, found, open_instancers)


def main():
    for path in sys.stdin.read().splitlines():
        try:
            stage = prepared(path)
        except Exception as error:
            print("E", path, str(error).splitlines()[0][:120], sep="\t")
            continue
        layer = stage.GetRootLayer()
        start = layer.startTimeCode if layer.HasStartTimeCode() else 0.0
        times = [sampled(stage, start, start)]
        if layer.HasEndTimeCode() and layer.endTimeCode > start:
            later = start + 0.37 * (layer.endTimeCode - start)
            times.append(sampled(stage, later, float(round(later))))
        for time in times:
            found = {}
            stage.GetSessionLayer().Clear()
            stage = prepared(path)
            bake(stage, time)
            walk(stage.GetPseudoRoot(), Gf.Matrix4d(1.0), "default", time, found)
            print("F", (time - start) / (stage.GetTimeCodesPerSecond() or 24.0), path, sep="\t")
            for name, (subdivided, triangles, low, high) in found.items():
                print("O", name, int(subdivided), triangles, *low, *high, sep="\t")
        sys.stdout.flush()


main()
