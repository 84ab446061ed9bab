"""What Open CASCADE says of STEP files: the names of files come in, a line for each goes out.

A line has the seconds, the number of faces, the area, the volume (not a number for sheets) and the bounds, all in millimetres, the
area by colour in linear light, and the file.
Needs the package cadquery-ocp.
"""
import sys
import time

from OCP.Bnd import Bnd_Box
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.Quantity import Quantity_ColorRGBA
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE, TopAbs_SHAPE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.XCAFDoc import XCAFDoc_ColorGen, XCAFDoc_ColorSurf, XCAFDoc_DocumentTool
from OCP.collections import Sequence_TDF_Label


def area_of(shape):
    props = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, props)
    return props.Mass()


def faces_of(shape, kind=TopAbs_FACE, outside=TopAbs_SHAPE):
    explorer = TopExp_Explorer(shape, kind, outside)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def sequence(call):
    labels = Sequence_TDF_Label()
    call(labels)
    return [labels.Value(i + 1) for i in range(labels.Length())]


def colour_of(tool, thing):
    colour = Quantity_ColorRGBA()
    ask = tool.GetColor_s if isinstance(thing, TDF_Label) else tool.GetColor
    for kind in (XCAFDoc_ColorSurf, XCAFDoc_ColorGen):
        if ask(thing, kind, colour):
            rgb = colour.GetRGB()
            return (round(rgb.Red(), 3), round(rgb.Green(), 3), round(rgb.Blue(), 3))
    return None


def by_colour(shapes, colours, label, inherited, areas):
    """Adds the area of each colour: that of a face, or else of what it is in."""
    referred = TDF_Label()
    own = colour_of(colours, label) or inherited
    if shapes.GetReferredShape_s(label, referred):
        return by_colour(shapes, colours, referred, own, areas)
    if shapes.IsAssembly_s(label):
        for part in sequence(lambda labels: shapes.GetComponents_s(label, labels)):
            by_colour(shapes, colours, part, own, areas)
        return
    shape = shapes.GetShape_s(label)
    own = colour_of(colours, label) or inherited
    for kind, outside in ((TopAbs_SOLID, TopAbs_SHAPE), (TopAbs_SHELL, TopAbs_SOLID), (TopAbs_FACE, TopAbs_SHELL)):
        for part in faces_of(shape, kind, outside):
            whole = colour_of(colours, part)
            for face in faces_of(part):
                colour = colour_of(colours, face) or whole or own
                areas[colour] = areas.get(colour, 0) + area_of(face)


for name in sys.stdin.read().split("\n"):
    start = time.time()
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    reader = STEPCAFControl_Reader()
    reader.SetColorMode(True)
    if reader.ReadFile(name) != IFSelect_RetDone or not reader.Transfer(document):
        print("E", name, sep="\t", flush=True)
        continue
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    area = volume = 0
    count = 0
    box = Bnd_Box()
    areas = {}
    for label in sequence(shapes.GetFreeShapes):
        shape = shapes.GetShape_s(label)
        area += area_of(shape)
        props = GProp_GProps()
        BRepGProp.VolumeProperties_s(shape, props)
        # Sheets have none.
        volume += props.Mass() if any(faces_of(shape, TopAbs_SOLID)) else float("nan")
        count += sum(1 for _ in faces_of(shape))
        # Lines beside the faces do not count.
        for face in faces_of(shape):
            BRepBndLib.AddOptimal_s(face, box, False, False)
        by_colour(shapes, colours, label, None, areas)
    corners = [] if box.IsVoid() else [box.CornerMin(), box.CornerMax()]
    bounds = [x for p in corners for x in (p.X(), p.Y(), p.Z())] or [0] * 6
    said = ";".join(f"{','.join(map(str, c)) if c else '-'}={a}" for c, a in areas.items())
    print("F", f"{time.time() - start:.2f}", count, area, volume, *bounds, said, name, sep="\t", flush=True)
