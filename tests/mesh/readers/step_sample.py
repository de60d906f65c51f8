"""STEP files (AP214): a solid with plane faces, written from its corners and polygons, and solids of revolution."""

import re
from collections.abc import Sequence

import numpy as np

_HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""


class _Writer:
    def __init__(self) -> None:
        self.entities: list[str] = []

    def add(self, text: str) -> str:
        self.entities.append(text)
        return f"#{len(self.entities)}"

    def vector(self, kind: str, xyz: Sequence[float]) -> str:
        return self.add(f"{kind}('',({','.join(repr(float(x)) for x in xyz)}))")

    def axes(self, origin: Sequence[float], z: Sequence[float], x: Sequence[float]) -> str:
        at = self.vector("CARTESIAN_POINT", origin)
        return self.add(f"AXIS2_PLACEMENT_3D('',{at},{self.vector('DIRECTION', z)},{self.vector('DIRECTION', x)})")


def step_solid(points: np.ndarray, polygons: Sequence[Sequence[int]], name: str, inches: bool = False) -> str:
    """The solid with corners `points` and outward `polygons`, in millimetres or in inches."""
    w = _Writer()
    context = _context(w, inches)
    shape = _product(w, name)
    corners = [w.add(f"VERTEX_POINT('',{w.vector('CARTESIAN_POINT', p)})") for p in points]
    edges: dict[tuple[int, int], str] = {}

    def oriented_edge(a: int, b: int) -> str:
        forward = (b, a) not in edges
        if forward:
            along = points[b] - points[a]
            length = float(np.linalg.norm(along))
            vector = w.add(f"VECTOR('',{w.vector('DIRECTION', along / length)},{length!r})")
            line = w.add(f"LINE('',{w.vector('CARTESIAN_POINT', points[a])},{vector})")
            edges[a, b] = w.add(f"EDGE_CURVE('',{corners[a]},{corners[b]},{line},.T.)")
        edge = edges[(a, b) if forward else (b, a)]
        return w.add(f"ORIENTED_EDGE('',*,*,{edge},.{'T' if forward else 'F'}.)")

    faces = []
    for polygon in polygons:
        ring = [oriented_edge(a, b) for a, b in zip(polygon, [*polygon[1:], polygon[0]], strict=True)]
        loop = w.add(f"EDGE_LOOP('',({','.join(ring)}))")
        bound = w.add(f"FACE_OUTER_BOUND('',{loop},.T.)")
        a, b, c = points[list(polygon[:3])]
        normal = np.cross(b - a, c - a)
        plane = w.axes(a, normal / np.linalg.norm(normal), (b - a) / np.linalg.norm(b - a))
        surface = w.add(f"PLANE('',{plane})")
        faces.append(w.add(f"ADVANCED_FACE('',({bound}),{surface},.T.)"))
    return _file(w, name, faces, shape, context)


def step_sphere(radius: float) -> str:
    """A ball about the origin, in millimetres."""
    w = _Writer()
    context = _context(w, inches=False)
    shape = _product(w, "Ball")
    pole = w.add(f"VERTEX_POINT('',{w.vector('CARTESIAN_POINT', (0, 0, -radius))})")
    loop = w.add(f"VERTEX_LOOP('',{pole})")
    bound = w.add(f"FACE_BOUND('',{loop},.T.)")
    surface = w.add(f"SPHERICAL_SURFACE('',{w.axes((0, 0, 0), (0, 0, 1), (1, 0, 0))},{float(radius)!r})")
    return _file(w, "Ball", [w.add(f"ADVANCED_FACE('',({bound}),{surface},.T.)")], shape, context)


def step_torus(major: float, minor: float) -> str:
    """A ring about the z axis, in millimetres."""
    w = _Writer()
    context = _context(w, inches=False)
    shape = _product(w, "Ring")
    vertex = w.add(f"VERTEX_POINT('',{w.vector('CARTESIAN_POINT', (major + minor, 0, 0))})")
    circles = [
        w.add(f"CIRCLE('',{w.axes((0, 0, 0), (0, 0, 1), (1, 0, 0))},{major + minor!r})"),
        w.add(f"CIRCLE('',{w.axes((major, 0, 0), (0, -1, 0), (1, 0, 0))},{minor!r})"),
    ]
    edges = [w.add(f"EDGE_CURVE('',{vertex},{vertex},{circle},.T.)") for circle in circles]
    surface = w.add(f"TOROIDAL_SURFACE('',{w.axes((0, 0, 0), (0, 0, 1), (1, 0, 0))},{major!r},{minor!r})")
    face = _face(w, [(edges[0], "T"), (edges[1], "T"), (edges[0], "F"), (edges[1], "F")], surface)
    return _file(w, "Ring", [face], shape, context)


def step_cone(low: float, high: float, height: float) -> str:
    """A frustum about the z axis with these radii, the larger one above, or a cylinder, in millimetres."""
    w = _Writer()
    context = _context(w, inches=False)
    shape = _product(w, "Frustum")
    places = ((low, 0.0), (high, height))
    vertices = [w.add(f"VERTEX_POINT('',{w.vector('CARTESIAN_POINT', (r, 0, z))})") for r, z in places]
    circles = [w.add(f"CIRCLE('',{w.axes((0, 0, z), (0, 0, 1), (1, 0, 0))},{r!r})") for r, z in places]
    rims = [
        w.add(f"EDGE_CURVE('',{vertex},{vertex},{circle},.T.)")
        for vertex, circle in zip(vertices, circles, strict=True)
    ]
    along = np.array([high - low, 0, height])
    length = float(np.linalg.norm(along))
    vector = w.add(f"VECTOR('',{w.vector('DIRECTION', along / length)},{length!r})")
    line = w.add(f"LINE('',{w.vector('CARTESIAN_POINT', (low, 0, 0))},{vector})")
    seam = w.add(f"EDGE_CURVE('',{vertices[0]},{vertices[1]},{line},.T.)")
    axes = w.axes((0, 0, 0), (0, 0, 1), (1, 0, 0))
    angle = float(np.arctan2(high - low, height))
    side = "CYLINDRICAL" if low == high else "CONICAL"
    surface = w.add(f"{side}_SURFACE('',{axes},{low!r}{'' if low == high else f',{angle!r}'})")
    faces = [
        _face(w, [(rims[0], "T"), (seam, "T"), (rims[1], "F"), (seam, "F")], surface),
        _face(w, [(rims[1], "T")], w.add(f"PLANE('',{w.axes((0, 0, height), (0, 0, 1), (1, 0, 0))})")),
        _face(w, [(rims[0], "F")], w.add(f"PLANE('',{w.axes((0, 0, 0), (0, 0, -1), (1, 0, 0))})")),
    ]
    return _file(w, "Frustum", faces, shape, context)


def step_of_several(*files: str) -> str:
    """One file with the solids of several."""
    head, data, last = files[0].partition("DATA;\n")[0], "", 0
    for file in files:
        entities = file.partition("DATA;\n")[2].partition("ENDSEC;")[0]
        data += re.sub(r"#(\d+)", lambda number, before=last: f"#{int(number[1]) + before}", entities)
        last += max(map(int, re.findall(r"^#(\d+)", entities, re.MULTILINE)))
    return f"{head}DATA;\n{data}ENDSEC;\nEND-ISO-10303-21;\n"


def step_placed(text: str, scale: float, axis: int) -> str:
    """The solid of a file, put elsewhere by an operator: scaled, its x along y, its z along z or against it."""
    last = max(map(int, re.findall(r"^#(\d+) =", text, re.MULTILINE)))
    own = re.search(r"#(\d+) = ADVANCED_BREP_SHAPE_REPRESENTATION\('',\(#(\d+),#\d+\),#(\d+)\)", text)
    link = re.search(r"#\d+ = SHAPE_DEFINITION_REPRESENTATION\((#\d+),#\d+\);\n", text)
    assert own is not None
    assert link is not None
    entities = (
        "DIRECTION('',(0.,1.,0.))",
        "DIRECTION('',(-1.,0.,0.))",
        f"DIRECTION('',(0.,0.,{axis}.))",
        "CARTESIAN_POINT('',(1.,2.,3.))",
        f"CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#{last + 1},#{last + 2},#{last + 4},{scale!r},#{last + 3})",
        f"REPRESENTATION_MAP(#{own[2]},#{own[1]})",
        f"MAPPED_ITEM('',#{last + 6},#{last + 5})",
        f"SHAPE_REPRESENTATION('',(#{last + 7}),#{own[3]})",
        f"SHAPE_DEFINITION_REPRESENTATION({link[1]},#{last + 8})",
    )
    lines = "".join(f"#{last + k} = {entity};\n" for k, entity in enumerate(entities, 1))
    return text.replace(link[0], "").replace("ENDSEC;\nEND-ISO", f"{lines}ENDSEC;\nEND-ISO")


def _face(w: _Writer, edges: Sequence[tuple[str, str]], surface: str) -> str:
    ring = [w.add(f"ORIENTED_EDGE('',*,*,{edge},.{sense}.)") for edge, sense in edges]
    loop = w.add(f"EDGE_LOOP('',({','.join(ring)}))")
    bound = w.add(f"FACE_OUTER_BOUND('',{loop},.T.)")
    return w.add(f"ADVANCED_FACE('',({bound}),{surface},.T.)")


def _file(w: _Writer, name: str, faces: Sequence[str], shape: str, context: str) -> str:
    shell = w.add(f"CLOSED_SHELL('',({','.join(faces)}))")
    brep = w.add(f"MANIFOLD_SOLID_BREP('{name}',{shell})")
    origin = w.axes((0, 0, 0), (0, 0, 1), (1, 0, 0))
    body = w.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({origin},{brep}),{context})")
    w.add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{body})")
    entities = "".join(f"#{i} = {text};\n" for i, text in enumerate(w.entities, 1))
    return f"{_HEAD}{entities}ENDSEC;\nEND-ISO-10303-21;\n"


def _product(w: _Writer, name: str) -> str:
    application = w.add("APPLICATION_CONTEXT('automotive design')")
    product_context = w.add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
    product = w.add(f"PRODUCT('{name}','{name}','',({product_context}))")
    formation = w.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    context = w.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = w.add(f"PRODUCT_DEFINITION('','',{formation},{context})")
    return w.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")


def _context(w: _Writer, inches: bool) -> str:
    length = w.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    if inches:
        size = w.add(f"LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),{length})")
        dimensions = w.add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)")
        length = w.add(f"(CONVERSION_BASED_UNIT('INCH',{size})LENGTH_UNIT()NAMED_UNIT({dimensions}))")
    angle = w.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    solid = w.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    return w.add(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid}))"
        "REPRESENTATION_CONTEXT('',''))"
    )
