"""OpenUSD: rigid bodies with what `PhysicsMassAPI` states of them, the meshes and primitives below them.

Read by usd-core. A link is a prim with `PhysicsRigidBodyAPI`, or where there is none one with `PhysicsMassAPI`; its
axes are the prim's without their scale, in metres by the stage's `metersPerUnit`. Source: OpenUSD API documentation,
UsdPhysics: what is zero, or not finite for the centre of mass, counts as not given.
"""

from __future__ import annotations

import importlib.util
import math
import re
from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from inertia.arrays import Float
from inertia.errors import ReadError, visible
from inertia.exchange.robots.forest import forest
from inertia.exchange.robots.links import (
    Figures,
    Filling,
    Geometry,
    Inertial,
    Joint,
    Link,
    Motion,
    Partial,
    Placement,
    Primitive,
    Robot,
    Role,
)
from inertia.exchange.robots.usd_transforms import Transforms, shortened
from inertia.exchange.rotations import rotation_of_quaternion
from inertia.mass.moments import dot
from inertia.mesh.part import Part
from inertia.mesh.readers.contents import shown
from inertia.mesh.tree import Matrix, diagonal, inverse, times
from inertia.mesh.tree import Motion as Transform
from inertia.mesh.turns import root
from inertia.output import note_input
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia.standard_input import file_of

_SOLIDS = ("Mesh", "Cube", "Sphere", "Cylinder", "Cylinder_1", "Capsule", "Capsule_1", "Cone")
_UNREAD = ("PointInstancer", "TetMesh", "NurbsPatch", "BasisCurves")
_ONTO = {"X": [[0, 0, 1], [1, 0, 0], [0, 1, 0]], "Y": [[0, 1, 0], [0, 0, 1], [1, 0, 0]], "Z": np.eye(3)}
"""The turn that takes z to an axis."""
_ELSEWHERE = 1e-5  # m, and of a rotation: more than float32 rounds
_WATER = 1000.0  # kg/m³, of what collides, where nothing else is said
_DIGITS = 9  # that tell one float32 from the next
_LONGEST = 300  # characters of what OpenUSD says
_PASSING = re.compile(r",?@anon:0x[0-9a-f]+:[^@]*@| \(instantiating stage on stage .*")
"""Of what OpenUSD says, what has an address in memory."""
_SKEW = 1e-6  # of their lengths: axes at right angles to this are so up to what float32 stored of their matrix
_SQUARE = 3e-15  # likewise, up to what float64 rounds, which an assembly takes for a rotation


class _Stage:
    """A stage: its prims, those of instances too, where they lie, and its units."""

    def __init__(self, path: Path) -> None:
        from pxr import Ar, Tf, Usd, UsdGeom, UsdPhysics, UsdUtils

        self._diagnostics = UsdUtils.CoalescingDiagnosticDelegate()  # without it they go to standard error
        try:
            stage = Usd.Stage.Open(_file(path))
            for layer in stage.GetUsedLayers():
                if layer.realPath and layer != stage.GetRootLayer():  # of a package, the file
                    note_input(Path(Ar.SplitPackageRelativePathOuter(layer.realPath)[0]))
            stage.Reload()  # what has changed before it was noted
        except Tf.ErrorException as error:
            says = _said(str(error).partition(" : '")[2].partition("'\n")[0])
            raise ReadError(f"OpenUSD cannot open it: {says}") from None
        for words in sorted(_lost(stage)):
            remedy = "put a stage there, or deactivate the prim that refers to it"
            raise ReadError(f"OpenUSD says: {words}: {remedy}", code="no_file")
        self.physics, self.geometry, self.time = UsdPhysics, UsdGeom, Usd.TimeCode.EarliestTime()
        self.fault: type[Exception] = Tf.ErrorException
        self.metres = float(UsdGeom.GetStageMetersPerUnit(stage))
        self.kilograms = float(UsdPhysics.GetStageKilogramsPerUnit(stage))
        if not (self.metres > 0 and self.kilograms > 0):
            raise ReadError(
                f"its units are {self.metres:g} m and {self.kilograms:g} kg: they must be positive", code="unknown_unit"
            )
        self.name = stage.GetDefaultPrim().GetName() if stage.GetDefaultPrim() else path.stem
        self._stage = stage  # prims die with it
        self.prims = list(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()))
        self._cache = UsdGeom.XformCache(self.time)
        self.transforms = Transforms(UsdGeom, self._cache)
        self.bodies = [prim for prim in self.prims if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
        self.bodies = self.bodies or [prim for prim in self.prims if prim.HasAPI(UsdPhysics.MassAPI)]
        names = [prim.GetName() for prim in self.bodies]
        self.labels: dict[str, str] = {
            str(prim.GetPath()): name if names.count(name) == 1 else str(prim.GetPath())
            for prim, name in zip(self.bodies, names, strict=True)
        }

    def warnings(self) -> Iterator[str]:
        """Yield what OpenUSD warned of, a sentence each."""
        said = (_said(warning.commentary) for warning in self._diagnostics.TakeUncoalescedDiagnostics())
        for words in sorted(said):  # they come from several threads
            yield f"OpenUSD warns: {words}"

    def prim(self, path: str) -> Any:
        """Return a prim by its path; None where there is none."""
        prim = self._stage.GetPrimAtPath(path) if path else None
        return prim if prim else None

    def is_enabled(self, prim: Any) -> bool:
        """Whether a prim moves as a rigid body, where it is one."""
        body = self.physics.RigidBodyAPI(prim)
        return not prim.HasAPI(self.physics.RigidBodyAPI) or body.GetRigidBodyEnabledAttr().Get() is not False

    def density_of_material(self, prim: Any) -> float:
        """Return the density of the physics material that is bound to a prim, in units of the stage; 0 without one."""
        from pxr import UsdShade

        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")
        if not material or not material.GetPrim().HasAPI(self.physics.MaterialAPI):
            return 0.0
        return float(self.physics.MaterialAPI(material.GetPrim()).GetDensityAttr().Get(self.time))

    def body_of(self, path: str) -> str | None:
        """Return the path of the body that a prim belongs to: itself, or the nearest above it."""
        while path not in self.labels and path:
            path = path.rpartition("/")[0]
        return path or None

    def place(self, prim: Any) -> tuple[Float, Float]:
        """Return A, (3, 3), and b, (3,): a point p of a prim lies at A p + b in the stage, in its units."""
        try:
            matrix = np.array(self._cache.GetLocalToWorldTransform(prim))
        except self.fault:
            raise ReadError(f"the transformation of {prim.GetPath()} cannot be used") from None
        if not np.isfinite(matrix).all():
            raise ReadError(f"the transformation of {prim.GetPath()} is not finite")
        return matrix[:3, :3].T, matrix[3, :3]


def _said(words: str) -> str:
    """Return what OpenUSD says, on one line that is the same in every run."""
    return _PASSING.sub("", " ".join(words.split()))[:_LONGEST]


def _lost(stage: Any) -> Iterator[str]:
    """Yield what OpenUSD says of each sublayer, reference and payload of a stage that it cannot open.

    What is not active has none.
    """
    from pxr import Pcp

    for error in stage.GetCompositionErrors():
        prim = stage.GetPrimAtPath(error.rootSite.path)
        if isinstance(error, Pcp.ErrorInvalidAssetPath | Pcp.ErrorInvalidSublayerPath) and (
            not prim or prim.IsActive()
        ):
            yield _said(str(error)).rstrip(".")


def _file(path: Path) -> str:
    """Return the name of a stage's file; OpenUSD goes by how it ends, which standard input has not."""
    if str(path) != STANDARD_INPUT:
        return str(path)
    spool = file_of(STANDARD_INPUT)
    with spool.open("rb") as file:
        named = spool.with_name("input.usdz" if file.read(2) == b"PK" else "input.usd")
    named.write_bytes(spool.read_bytes())
    return str(named)


def read_usd(path: Path) -> Robot:
    """Read the rigid bodies of a stage; raise `ReadError` where it is none."""
    if importlib.util.find_spec("pxr") is None:
        raise ReadError("OpenUSD needs the package usd-core: pip install 'inertia[usd]'", code="needs_package")
    stage = _Stage(path)
    if not stage.bodies:
        raise ReadError("no prim of it has PhysicsRigidBodyAPI or PhysicsMassAPI: apply one to each body", code="empty")
    notes: dict[str, None] = {}
    hung = _hung(stage, notes)
    links = []
    for prim in stage.bodies:
        name = stage.labels[str(prim.GetPath())]
        try:
            if not stage.is_enabled(prim):
                notes[f"{shown(prim.GetName())} is not enabled as a rigid body: it is counted as one"] = None
            geometries = tuple(_geometries(stage, prim, notes))
            collides = any(geometry.weighs for geometry in geometries)
            inertial, mass, stated = _inertial(stage, prim, name, collides, notes)
            if apart := _stated_apart(stage, prim, inertial is not None):
                notes[f"what {', '.join(apart)} below {shown(prim.GetName())} states of itself is not counted"] = None
        except ReadError:
            raise
        except (
            TypeError,
            ValueError,
            OverflowError,
            KeyError,
            stage.fault,
        ):  # what is against the schema is handed out
            raise ReadError(f"an attribute in {prim.GetPath()} has another type than its schema") from None
        joint = hung.get(visible(name)) or Joint(name, None, _frame(stage, prim))
        is_fixed = joint.kind == "fixed" and joint.parent is not None
        parent, placement = (joint.parent, joint.placement) if is_fixed else (None, Placement())
        links.append(Link(name, inertial, geometries, parent, placement, joint=joint, mass=mass, stated=stated))
    return Robot(path, "usd", stage.name, tuple(links), (*notes, *dict.fromkeys(stage.warnings())))


def _rotation(matrix: Float) -> Float:
    """Return the rotation nearest to a matrix; its columns at unit length where they are at right angles."""
    if _is_askew(matrix, _SQUARE) or np.linalg.det(matrix) <= 0:
        left, _, right = np.linalg.svd(matrix)
        return np.asarray(left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right)
    return np.asarray(matrix / np.linalg.norm(matrix, axis=0))


def _is_askew(matrix: Float, limit: float = _SKEW) -> bool:
    lengths = np.linalg.norm(matrix, axis=0)
    if not lengths.all():
        return True
    unit = matrix / lengths
    return bool(np.abs(unit.T @ unit - np.eye(3)).max() > limit)


def _frame(stage: _Stage, prim: Any) -> Placement:
    """Return where the axes of a prim lie in the stage, without their scale, in metres."""
    matrix, origin = stage.place(prim)
    return Placement(_rotation(matrix), origin * stage.metres)


def _hung(stage: _Stage, notes: dict[str, None]) -> dict[str, Joint]:
    """Return what each link hangs on, by its name, where the joint is at 0.

    Of a loop the joint is left out that no articulation is to have, or that moves.
    """
    joints = sorted(_joints(stage, notes), key=lambda each: (each[0], each[2].kind != "fixed"))
    roots = [
        stage.labels[str(prim.GetPath())] for prim in stage.bodies if prim.HasAPI(stage.physics.ArticulationRootAPI)
    ]
    hung, loops = forest(((child, joint) for _, child, joint in joints), stage.labels.values(), roots)
    notes |= {f"joint {shown(joint.name)} closes a loop: it is left out of the tree": None for joint in loops}
    return hung


def _joints(stage: _Stage, notes: dict[str, None]) -> Iterator[tuple[bool, str | None, Joint]]:
    """Yield each joint, at 0, from its body 0 to its body 1; the latter, and whether no articulation is to have it."""
    prims = {str(prim.GetPath()): prim for prim in stage.bodies}
    names: set[str] = set()
    for prim in stage.prims:
        if not prim.IsA(stage.physics.Joint):
            continue
        joint = stage.physics.Joint(prim)
        if joint.GetJointEnabledAttr().Get() is False:
            continue
        targets = [str((*relation.GetTargets(), "")[0]) for relation in (joint.GetBody0Rel(), joint.GetBody1Rel())]
        bodies = [stage.body_of(target) for target in targets]
        if bodies[0] == bodies[1]:
            continue
        parent, child = (body and stage.labels[body] for body in bodies)
        places = [
            (joint.GetLocalPos0Attr(), joint.GetLocalRot0Attr()),
            (joint.GetLocalPos1Attr(), joint.GetLocalRot1Attr()),
        ]
        there, here = (_end(stage, prims, targets[k], bodies[k], *places[k]) for k in range(2))
        kind, axis = _motion(stage, prim)
        outer, inner = (Placement() if body is None else _frame(stage, prims[body]) for body in bodies)
        authored, placement = outer.inverse.then(inner), there.then(here.inverse)
        apart = max(
            float(np.abs(authored.rotation - placement.rotation).max()),
            float(np.abs(authored.origin - placement.origin).max()),
        )
        if kind not in ("turns", "slides"):
            placement = authored
        elif apart > _ELSEWHERE:
            words = "its link stands where its position puts it, at 0 without one"
            notes[f"joint {shown(prim.GetName())} is not at 0 in the stage: {words}"] = None
        label = str(prim.GetPath()) if prim.GetName() in names else prim.GetName()
        names.add(label)
        excluded = bool(joint.GetExcludeFromArticulationAttr().Get())
        yield excluded, child, Joint(label, parent, placement, kind, here.rotation @ axis, here.origin)


def _end(
    stage: _Stage, prims: dict[str, Any], target: str, body: str | None, position: Any, rotation: Any
) -> Placement:
    """Return where the frame of a joint lies on one of its ends: in the axes of the link, or of the world."""
    at, turn = np.array(position.Get() or (0, 0, 0), float), rotation.Get()
    own = np.eye(3) if turn is None else rotation_of_quaternion([turn.GetReal(), *turn.GetImaginary()])
    prim = stage.prim(target)
    if prim is None:
        return Placement(own, at * stage.metres)
    matrix, origin = stage.place(prim)
    there = Placement(_rotation(matrix) @ own, (matrix @ at + origin) * stage.metres)
    if body is None:
        return there
    return _frame(stage, prims[body]).inverse.then(there)


def _motion(stage: _Stage, prim: Any) -> tuple[Motion, Float]:
    """Return how a joint moves, and its axis in its own frame."""
    if prim.IsA(stage.physics.FixedJoint):
        return "fixed", np.eye(3)[2]
    for kind, typed in (("turns", stage.physics.RevoluteJoint), ("slides", stage.physics.PrismaticJoint)):
        if prim.IsA(typed):
            motion: Motion = "turns" if kind == "turns" else "slides"
            return motion, np.eye(3)["XYZ".index(str(typed(prim).GetAxisAttr().Get()))]
    return "other", np.eye(3)[2]


class _Values(NamedTuple):
    """What a prim states by `PhysicsMassAPI`, in units of the stage and its own axes; None and 0 where it does not."""

    mass: float = 0.0
    center: Float | None = None
    moments: Float | None = None
    axes: Float | None = None

    @property
    def states_more(self) -> bool:
        """Whether more than a mass is stated."""
        return any(each is not None for each in self[1:])


def _values(stage: _Stage, prim: Any) -> _Values:
    if not prim.HasAPI(stage.physics.MassAPI):
        return _Values()
    api = stage.physics.MassAPI(prim)
    mass = float(api.GetMassAttr().Get(stage.time))
    center, moments = (
        np.array(each.Get(stage.time), float) for each in (api.GetCenterOfMassAttr(), api.GetDiagonalInertiaAttr())
    )
    axes = api.GetPrincipalAxesAttr().Get(stage.time)
    quaternion = [axes.GetReal(), *axes.GetImaginary()]
    if not np.isfinite([mass, *moments, *quaternion]).all():
        raise ReadError(f"what {prim.GetPath()} states is not finite")
    return _Values(
        mass,
        center if np.isfinite(center).all() else None,
        moments if moments.any() else None,
        rotation_of_quaternion(quaternion) if any(quaternion) else None,
    )


def _inertial(
    stage: _Stage, prim: Any, name: str, collides: bool, notes: dict[str, None]
) -> tuple[Inertial | None, float | None, Partial | None]:
    """Return what is stated of a link; where that is not all, its mass, kg, and the rest, beside what collides of it.

    Of what nothing collides the centre of mass is the origin, as OpenUSD has it.
    """
    values = _values(stage, prim)
    mass = values.mass * stage.kilograms
    matrix, _ = stage.place(prim)
    stated = _partial(stage, values, _rotation(matrix).T @ matrix * stage.metres, np.zeros(3), np.eye(3))
    center = np.zeros(3) if stated.center is None and not collides else stated.center
    if values.mass and stated.moments is not None and center is not None:
        turn = np.eye(3) if stated.axes is None else stated.axes
        unit = float(np.abs(stated.moments).max()) * 2.0**-23  # of float32
        figures = Figures(math.floor(-math.log10(unit)), _DIGITS)
        return Inertial(mass, Placement(turn, center), np.diag(stated.moments), (None, figures)), None, None
    given = {
        "mass": values.mass > 0,
        "centre of mass": values.center is not None,
        "tensor": values.moments is not None,
        "principal axes": values.axes is not None,
    }
    has = [each for each, there in given.items() if there]
    lacks = [each for each in list(given)[: 4 if given["tensor"] and collides else 3] if not given[each]]
    if has and collides:
        about = ", about the centre stated" if given["centre of mass"] and not given["tensor"] else ""
        words = f"{', '.join(has)} alone: what collides of it has its {', '.join(lacks)}{about}"
        notes[f"link {shown(name)} states {words}"] = None
    elif has:
        notes[f"link {shown(name)} states no {' and no '.join(lacks)}, and nothing collides of it"] = None
    elif prim.HasAPI(stage.physics.MassAPI) and stage.physics.MassAPI(prim).GetDensityAttr().Get(stage.time) > 0:
        notes[f"link {shown(name)} states a density alone: there is nothing to compare"] = None
    return None, mass if mass > 0 else None, stated if collides and values.states_more else None


def _partial(stage: _Stage, values: _Values, linear: Float, at: Float, frame: Float) -> Partial:
    """Return what is stated of a prim whose points p lie at `linear` p + `at`, m, in its link, its axes as `frame`."""
    return Partial(
        None if values.center is None else linear @ values.center + at,
        None if values.moments is None else values.moments * (stage.kilograms * stage.metres**2),
        None if values.axes is None else frame @ values.axes,
        frame,
    )


def _weight(stage: _Stage, prim: Any, body: str) -> tuple[float, float | None]:
    """Return the density, kg/m³, and the mass, kg, of what collides where the mass of its body is not stated.

    By the rules of UsdPhysics: of densities that of the nearest prim up to the body, then that of the physics material,
    then that of water.
    """
    api, density, mass = stage.physics.MassAPI, 0.0, 0.0
    if prim.HasAPI(api) and str(prim.GetPath()) != body:
        mass = float(api(prim).GetMassAttr().Get(stage.time))
    above = prim
    while not density > 0:
        if above.HasAPI(api):
            density = float(api(above).GetDensityAttr().Get(stage.time))
        if str(above.GetPath()) == body:
            break
        above = above.GetParent()
    if not density > 0:
        density = stage.density_of_material(prim)
    cubed = stage.kilograms / stage.metres**3
    return density * cubed if density > 0 else _WATER, mass * stage.kilograms if mass > 0 else None


def _geometries(stage: _Stage, body: Any, notes: dict[str, None]) -> Iterator[Geometry]:
    path = str(body.GetPath())
    unscaled, origin = _axes(stage, body)
    for prim in stage.prims:
        kind, where = prim.GetTypeName(), str(prim.GetPath())
        if kind not in _SOLIDS + _UNREAD or stage.body_of(where) != path:
            continue
        if kind in _UNREAD:
            notes[f"{shown(prim.GetName())} below {shown(body.GetName())} is left out: a {kind} is not read"] = None
            continue
        role: Role = "collision" if prim.HasAPI(stage.physics.CollisionAPI) else "visual"
        image, tokens = stage.geometry.Imageable(prim), stage.geometry.Tokens
        hidden = image.ComputePurpose() in (tokens.guide, tokens.proxy) or image.ComputeVisibility() == tokens.invisible
        if role == "visual" and hidden:
            continue  # a mark for the eye of who edits, what stands in for the body, or what is not shown
        stage.place(prim)  # raises where it is not finite
        lies = stage.transforms.place(prim)
        away = [a - b for a, b in zip(lies.at, origin, strict=True)]
        at = tuple(dot(row, away) for row in unscaled)
        transform = shortened(Transform(at, times(unscaled, lies.linear)))
        density, mass = (None, None) if role == "visual" else _weight(stage, prim, path)
        linear, values = np.array(transform.linear, float), _values(stage, prim)
        stated = None
        if role == "collision" and values.states_more and where != path:
            stated = _partial(stage, values, linear, np.array(transform.at, float), _rotation(linear))
        name = where.removeprefix(f"{path}/") if where != path else prim.GetName()
        if kind == "Mesh":
            if stage.geometry.Mesh(prim).GetSubdivisionSchemeAttr().Get() != stage.geometry.Tokens.none:
                notes["meshes are taken as their points have them: no subdivision is applied"] = None
            shape = _mesh(stage, prim)
            hull = prim.HasAPI(stage.physics.MeshCollisionAPI) and (
                stage.physics.MeshCollisionAPI(prim).GetApproximationAttr().Get() == stage.physics.Tokens.convexHull
            )
            filling: Filling = "hull" if hull else "solid"
            yield Geometry(
                name, role, shape, transform=transform, density=density, mass=mass, filling=filling, stated=stated
            )
        else:
            turn, solid = _primitive(stage, kind, prim, transform.linear)
            place = Placement(turn, np.array(transform.at, float))
            yield Geometry(name, role, solid, place, density=density, mass=mass, stated=stated)


def _axes(stage: _Stage, body: Any) -> tuple[Matrix, tuple[Fraction, ...]]:
    """Return what takes directions in the stage to those along the axes of a link, in m, and where its origin lies.

    The axes are those of its prim at unit length; where these are not at right angles, or left-handed, the nearest.
    """
    matrix, _ = stage.place(body)
    lies, metres = stage.transforms.place(body), Fraction(repr(stage.metres))
    if _is_askew(matrix, _SQUARE) or np.linalg.det(matrix) <= 0:
        turn: Matrix = tuple(tuple(Fraction(k) for k in row) for row in _rotation(matrix).T.tolist())
    else:
        turn = times(diagonal(map(_length, zip(*lies.linear, strict=True))), inverse(lies.linear))
    return tuple(tuple(metres * k for k in row) for row in turn), lies.at


def _length(column: Sequence[Fraction]) -> Fraction:
    return root(dot(column, column))


def _stated_apart(stage: _Stage, body: Any, is_complete: bool) -> list[str]:
    """Return the prims below a body, no bodies, whose own mass properties do not count.

    OpenUSD has what collides count, where what is stated of the body is not complete.
    """
    return [
        shown(prim.GetName())
        for prim in stage.prims
        if prim.HasAPI(stage.physics.MassAPI) and str(prim.GetPath()) not in stage.labels
        if stage.body_of(str(prim.GetPath())) == str(body.GetPath())
        if is_complete or not prim.HasAPI(stage.physics.CollisionAPI)
    ]


def _mesh(stage: _Stage, prim: Any) -> Part | str:
    """Return a mesh in its own axes, its polygons as fans of triangles."""
    mesh = stage.geometry.Mesh(prim)
    points = np.array(mesh.GetPointsAttr().Get(stage.time) or np.empty((0, 3)), float).reshape(-1, 3)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(stage.time) or [], np.int64)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get(stage.time) or [], np.int64)
    if not len(counts) or counts.min() < 3 or counts.sum() != len(corners):
        return "its faces do not add up to its list of corners"
    if corners.min() < 0 or corners.max() >= len(points):
        return f"a face names a point beyond the {len(points)} there are"
    if not np.isfinite(points).all():
        return "a point of it is not finite"
    first = np.repeat(np.cumsum(counts) - counts, counts - 2)
    step = np.arange(len(first)) - np.repeat(np.cumsum(counts - 2) - (counts - 2), counts - 2)
    faces = np.column_stack([corners[first], corners[first + step + 1], corners[first + step + 2]])
    if mesh.GetOrientationAttr().Get() == stage.geometry.Tokens.leftHanded:
        faces = faces[:, ::-1]
    return Part.from_arrays(points, faces, unit="m")


def _primitive(stage: _Stage, kind: str, prim: Any, linear: Matrix) -> tuple[Float, Primitive | str]:
    """Return how a primitive is turned, and what it is; its transformation may scale it along its own axes."""
    matrix = np.array(linear, float)
    if _is_askew(matrix):
        return np.eye(3), f"a {kind} that is sheared cannot be weighed"
    x, y, z = (float(_length(column)) for column in zip(*linear, strict=True))
    typed = getattr(stage.geometry, kind)(prim)
    onto = np.array(_ONTO[typed.GetAxisAttr().Get() if hasattr(typed, "GetAxisAttr") else "Z"], float)
    axes = matrix @ onto
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1  # the shape is its own mirror image across its axis; along it a cone is not
    rotation = _rotation(axes)
    if kind == "Cube":
        size = float(typed.GetSizeAttr().Get(stage.time))
        return rotation, Primitive("box", (size * x, size * y, size * z))
    ends = (typed.GetRadiusTopAttr, typed.GetRadiusBottomAttr) if kind.endswith("_1") else (typed.GetRadiusAttr,)
    radius, *other = (float(end().Get(stage.time)) for end in ends)
    if other and other[0] != radius:
        return rotation, f"a {kind} of two radii cannot be weighed"
    if kind == "Sphere":
        if x == y == z:
            return rotation, Primitive("sphere", (radius * x,))
        return rotation, Primitive("ellipsoid", (radius * x, radius * y, radius * z))
    across, beside, along = (np.abs(onto.T) @ [x, y, z]).tolist()
    if abs(across - beside) > _SKEW * across or (kind.startswith("Capsule") and abs(across - along) > _SKEW * across):
        return rotation, f"a {kind} of different scale along its axes cannot be weighed"
    height = float(typed.GetHeightAttr().Get(stage.time))
    sizes = radius * across, height * along
    names: dict[str, Literal["cylinder", "capsule", "cone"]] = {"Cylinder": "cylinder", "Capsule": "capsule"}
    return rotation, Primitive(names.get(kind.removesuffix("_1"), "cone"), sizes)
