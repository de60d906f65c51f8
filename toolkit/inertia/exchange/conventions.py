"""How other programs write mass properties down: signs, order, point, axes, units, rotation; one row a target.

Writers and readers take signs and order from here (`Convention.elements`, `Convention.tensor`), and nowhere else is
it said what another program means by *ixy*. `inertia.mass.tensor` states the signs of this package.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.mass.tensor import array_of
from inertia.records import dataclass

Products = Literal["elements", "integrals", "none"]

AXES = {"x": 0, "1": 0, "y": 1, "2": 1, "z": 2, "3": 2}
"""The number of the axis that each half of a subscript such as *xy* or *21* stands for."""


@dataclass(frozen=True)
class Convention:
    """What one target means by its numbers.

    Attributes
    ----------
    program : the program, and the statement or element
    fields : the names of what is written, as the target spells them
    products : "elements" of the tensor, −∫xy dm; positive "integrals", ∫xy dm; "none": principal moments alone
    order : subscripts of the six elements in the target's order; () for principal moments
    about : the point the moments are taken about, and the axes they are resolved along
    units : of what is written
    handedness : "right" or "left"
    rotation : how a rotation is written, and between which frames
    digits : how many digits the target holds
    cannot : what it cannot express; "" where nothing is lost
    source : manual or source, and section
    read_back : the program that read back what is written here; "" where that was done by the manual alone
    """

    program: str
    fields: str
    products: Products
    order: tuple[str, ...]
    about: str
    units: str
    handedness: Literal["right", "left"]
    rotation: str
    digits: str
    cannot: str
    source: str
    read_back: str = ""

    def elements(self, inertia: ArrayLike) -> list[float]:
        """Return the six numbers of a tensor (3, 3) in the target's order and with its signs.

        >>> [float(k) for k in CONVENTIONS["nastran"].elements([[1, -4, -5], [-4, 2, -6], [-5, -6, 3]])]
        [1.0, 4.0, 2.0, 5.0, 6.0, 3.0]
        """
        tensor = array_of(inertia, (3, 3), "inertia")
        return [float(self._sign(pair) * tensor[AXES[pair[0]], AXES[pair[1]]]) + 0.0 for pair in self.order]

    def tensor(self, elements: Sequence[float]) -> Float:
        """Return the tensor (3, 3) that six numbers in the target's order and with its signs stand for.

        >>> CONVENTIONS["nastran"].tensor([1, 4, 2, 5, 6, 3]).tolist()
        [[1.0, -4.0, -5.0], [-4.0, 2.0, -6.0], [-5.0, -6.0, 3.0]]
        """
        tensor = np.empty((3, 3))
        for pair, value in zip(self.order, elements, strict=True):
            i, j = AXES[pair[0]], AXES[pair[1]]
            tensor[i, j] = tensor[j, i] = self._sign(pair) * value
        return tensor

    @property
    def off_diagonal(self) -> str:
        """What stands off the diagonal, as a formula."""
        if self.products == "none":
            return "none: principal moments and a rotation"
        pair = next(pair for pair in self.order if pair[0] != pair[1])
        integrand = " ".join(f"x{axis}" if axis.isdigit() else axis for axis in pair)
        return f"I{pair} = {'−' if self.products == 'elements' else '+'}∫{integrand} dm"

    def _sign(self, pair: str) -> int:
        return -1 if self.products == "integrals" and pair[0] != pair[1] else 1


_ROW_BY_ROW = ("xx", "xy", "xz", "yy", "yz", "zz")
_DIAGONAL_FIRST = ("xx", "yy", "zz", "xy", "xz", "yz")
_COM = "centre of mass; axes of the part"
_SI = "kg, m, kg m²"
_CONSISTENT = "none in the file, any consistent set; SI is written"
_ALL = "17: reads back as the same float64"

CONVENTIONS = {
    "urdf": Convention(
        program="URDF, `<inertial>` of a link",
        fields="`<origin xyz rpy>`, `<mass value>`, `<inertia ixx ixy ixz iyy iyz izz>`",
        products="elements",
        order=_ROW_BY_ROW,
        about="centre of mass, the origin of `<origin>`; the axes that its rpy turns the link's to",
        units=_SI,
        handedness="right",
        rotation="rpy: roll about x, then pitch about y, then yaw about z, all fixed axes; written as 0 0 0",
        digits=_ALL,
        cannot="a scale or a unit of its own; several readers drop rpy, hence it is written as zero; "
        "for MuJoCo, which has moments from the six elements to a few parts in 10¹⁵, I1 + I2 = I3 as of a sheet",
        source="ROS wiki, urdf/XML/link, inertia: the negative convention of products; what the readers beside do",
        read_back="pin 4.1.0, drake 1.51.1, yourdfpy 0.0.60, MuJoCo 4.0.0",
    ),
    "sdf": Convention(
        program="SDFormat (Gazebo, Drake), `<inertial>` of a link",
        fields="`<pose>`, `<mass>`, `<inertia>` with `<ixx> <ixy> <ixz> <iyy> <iyz> <izz>`",
        products="elements",
        order=_ROW_BY_ROW,
        about="centre of mass, the origin of `<pose>`; the axes that the pose turns the link's to",
        units=_SI,
        handedness="right",
        rotation="roll pitch yaw as in URDF, or quat_xyzw by `rotation_format`; written as 0 0 0",
        digits=_ALL,
        cannot="",
        source="SDFormat 1.9, link, inertial; gz-math `Inertial`: the frame lies at the centre of mass",
        read_back="drake 1.51.1",
    ),
    "mjcf": Convention(
        program="MuJoCo MJCF, `<inertial>` of a body",
        fields="`pos`, `quat`, `mass`, `diaginertia`; or `fullinertia` = xx yy zz xy xz yz without `quat`",
        products="elements",
        order=_DIAGONAL_FIRST,
        about="centre of mass; principal axes by `quat`, or with `fullinertia` the axes of the body",
        units="none in the file; SI is written, as the default gravity asks for",
        handedness="right",
        rotation="quaternion w x y z from inertial to body axes",
        digits=_ALL,
        cannot="mass or moments below 1e-15 of a body that moves, or moments that break I1 + I2 ≥ I3 in the last digit",
        source="MuJoCo documentation, XML reference, body/inertial",
        read_back="MuJoCo 4.0.0",
    ),
    "usd": Convention(
        program="OpenUSD, `PhysicsMassAPI` (Omniverse, Isaac Sim)",
        fields="`physics:mass`, `:centerOfMass`, `:diagonalInertia`, `:principalAxes`",
        products="none",
        order=(),
        about="centre of mass; principal axes",
        units="those of the stage: `metersPerUnit` and `kilogramsPerUnit`, both written as 1",
        handedness="right",
        rotation="quaternion, real part first, from principal to prim axes: I = R D Rᵀ",
        digits="7: float32, by the schema",
        cannot="float64; zero: a mass or inertia of 0 counts as not given, and is computed from colliders",
        source="OpenUSD API documentation, UsdPhysics, UsdPhysicsMassAPI; rigid body physics proposal, units",
        read_back="usd-core 26.11",
    ),
    "modelica": Convention(
        program="Modelica, `MultiBody.Parts.Body`",
        fields="`m`, `r_CM`, `I_11 I_22 I_33 I_21 I_31 I_32`",
        products="elements",
        order=("11", "22", "33", "21", "31", "32"),
        about="centre of mass; axes parallel to frame_a",
        units=_SI,
        handedness="right",
        rotation="none: axes are those of frame_a",
        digits=_ALL,
        cannot="",
        source="Modelica Standard Library 4.0, Mechanics.MultiBody.Parts.Body: elements of the tensor, its equations",
    ),
    "simscape": Convention(
        program="Simscape Multibody, block Inertia (type Custom)",
        fields="`Mass`, `CenterOfMass`, `MomentsOfInertia` = [Ixx Iyy Izz], `ProductsOfInertia` = [Iyz Izx Ixy]",
        products="elements",
        order=("xx", "yy", "zz", "yz", "zx", "xy"),
        about="centre of mass; axes parallel to the reference frame R",
        units="a field each in the dialog; kg, m, kg*m^2 is written",
        handedness="right",
        rotation="none: axes are those of R",
        digits=_ALL,
        cannot="",
        source="Simscape Multibody User's Guide, Specifying Custom Inertias: negated convention, I_yz = −∫yz ρ dv",
    ),
    "nastran": Convention(
        program="Nastran, CONM2",
        fields="M, X1 X2 X3, I11 I21 I22 I31 I32 I33",
        products="integrals",
        order=("11", "21", "22", "31", "32", "33"),
        about="centre of mass; axes of coordinate system CID, written as 0, the basic one",
        units=_CONSISTENT,
        handedness="right",
        rotation="none: axes are those of CID",
        digits="10 to 13: large fields of 16 columns",
        cannot="a name: it stands in a comment; moments that are zero",
        source="MSC Nastran Quick Reference Guide, CONM2, remark on the inertia matrix: the solver supplies the minus; "
        "Autodesk Nastran Reference, CONM2, remark 6",
        read_back="pyNastran 1.4.1",
    ),
    "adams": Convention(
        program="Adams Solver, PART",
        fields="MASS, CM, IM, IP = xx, yy, zz, xy, xz, yz",
        products="integrals",
        order=_DIAGONAL_FIRST,
        about="origin and axes of the marker IM, by default CM; it is written at the centre of mass, unturned",
        units="by UNITS; kilogram, metre, newton, second are written",
        handedness="right",
        rotation="of the marker: REULER, body-fixed z x z; not written",
        digits=_ALL,
        cannot="a name: it stands in a comment",
        source="Adams Solver (C++), PART statement: 'defines Ixy, Ixz and Iyz as positive integrals'",
    ),
    "abaqus": Convention(
        program="Abaqus, *MASS and *ROTARY INERTIA",
        fields="I11, I22, I33, I12, I13, I23 of a ROTARYI element, mass of a MASS element, at one node",
        products="elements",
        order=("11", "22", "33", "12", "13", "23"),
        about="the node, which is the centre of mass; global or part axes, or those of ORIENTATION",
        units=_CONSISTENT,
        handedness="right",
        rotation="none: axes are global ones",
        digits="14 to 17: a number holds 20 characters at most",
        cannot="a centre of mass beside the node",
        source="Abaqus Analysis User's Guide, Rotary Inertia, 30.2.1: I12 = −∫ρ x1 x2 dV; Input Syntax Rules, 1.2.1",
    ),
    "drake": Convention(
        program="Drake, `SpatialInertia.MakeFromCentralInertia` (Python)",
        fields="mass, p_PScm_E, RotationalInertia(Ixx, Iyy, Izz, Ixy, Ixz, Iyz)",
        products="elements",
        order=_DIAGONAL_FIRST,
        about="centre of mass; the frame E, axes of the part (the `SpatialInertia` made of it is about the origin P)",
        units=_SI,
        handedness="right",
        rotation="none: axes are those of E",
        digits=_ALL,
        cannot="",
        source="Drake, multibody/tree/rotational_inertia.h: products are −∫xy dm",
        read_back="drake 1.51.1",
    ),
    "csv": Convention(
        program="a table, one row a body",
        fields="name, mass, com_x, com_y, com_z, ixx, iyy, izz, ixy, ixz, iyz and the bounds",
        products="elements",
        order=_DIAGONAL_FIRST,
        about=_COM,
        units=_SI,
        handedness="right",
        rotation="none: axes are those of the part",
        digits=_ALL,
        cannot="comments: the column convention says what the numbers are",
        source="this package",
        read_back="Python's csv",
    ),
    "pinocchio": Convention(
        program="Pinocchio, `Inertia(mass, lever, inertia)`",
        fields="mass, lever (3,), inertia (3, 3)",
        products="elements",
        order=_DIAGONAL_FIRST,
        about=_COM,
        units=_SI,
        handedness="right",
        rotation="none: axes are those of the joint",
        digits=_ALL,
        cannot="",
        source="Pinocchio, spatial/inertia.hpp; URDF is read with `buildModelFromUrdf`",
        read_back="pin 4.1.0",
    ),
    "chrono": Convention(
        program="Project Chrono, `ChBody`",
        fields="SetMass, SetInertiaXX(Ixx, Iyy, Izz), SetInertiaXY(Ixy, Ixz, Iyz)",
        products="elements",
        order=_DIAGONAL_FIRST,
        about="centre of mass, where the body's frame lies; of `ChBodyAuxRef` by SetFrameCOMToRef",
        units=_SI,
        handedness="right",
        rotation="of the frame at the centre of mass: quaternion, real part first",
        digits=_ALL,
        cannot="",
        source="Chrono, chrono/physics/ChBody.h, SetInertiaXY: [−∫xy dm, −∫xz dm, −∫yz dm]",
    ),
    "jsbsim": Convention(
        program="JSBSim, `<mass_balance>`",
        fields="ixx iyy izz ixy ixz iyz, emptywt, location CG",
        products="elements",
        order=_DIAGONAL_FIRST,
        about="centre of mass; structural axes: x aft, y right, z up",
        units="`unit` of each field; slug ft², pounds and inches without it",
        handedness="right",
        rotation="none: axes are the structural ones",
        digits=_ALL,
        cannot="",
        source='JSBSim, FGMassBalance.cpp: elements unless negated_crossproduct_inertia="false", ∫xy dm then',
    ),
    "ansys": Convention(
        program="Ansys Mechanical APDL, MASS21",
        fields="MASSX MASSY MASSZ IXX IYY IZZ; or with KEYOPT(1) = 2 the upper triangle of the 6 × 6 mass matrix",
        products="none",
        order=(),
        about="the node, or the offset OFFX OFFY OFFZ; axes of the element's coordinate system",
        units=_CONSISTENT,
        handedness="right",
        rotation="of the element's coordinate system (LOCAL, ESYS), which has to lie along the principal axes",
        digits=_ALL,
        cannot="products of inertia, unless KEYOPT(1) = 2: elements of the tensor there, as in any mass matrix",
        source="Ansys Element Reference, MASS21; Theory Reference, 13.21",
    ),
    "bullet": Convention(
        program="Bullet, `btRigidBody::setMassProps` (PyBullet `changeDynamics`)",
        fields="mass, local inertia (a diagonal)",
        products="none",
        order=(),
        about="centre of mass, which is the body's frame; principal axes, which are the body's axes",
        units="none; SI by the default gravity",
        handedness="right",
        rotation="of the body's frame itself: shapes are moved into it (`calculatePrincipalAxisTransform`)",
        digits="7, or 17 where it was built in double precision",
        cannot="products, or a centre of mass beside the body's origin; a URDF's tensor is replaced by that of the "
        "collision shape unless URDF_USE_INERTIA_FROM_FILE is set",
        source="Bullet, btCompoundShape.h, calculatePrincipalAxisTransform; PyBullet Quickstart Guide, loadURDF",
    ),
    "unity": Convention(
        program="Unity, `Rigidbody`",
        fields="mass, centerOfMass, inertiaTensor (a diagonal), inertiaTensorRotation",
        products="none",
        order=(),
        about="centre of mass; principal axes",
        units="kg, m by the default gravity",
        handedness="left",
        rotation="quaternion x y z w from principal to body axes, in left-handed axes with y up",
        digits="7: float32",
        cannot="a moment of zero: it counts as infinite",
        source="Unity Scripting API, Rigidbody.inertiaTensor, Rigidbody.inertiaTensorRotation",
    ),
    "unreal": Convention(
        program="Unreal Engine, `FBodyInstance`",
        fields="MassInKgOverride, COMNudge, InertiaTensorScale",
        products="none",
        order=(),
        about="centre of mass as an offset from the computed one",
        units="kg, cm",
        handedness="left",
        rotation="none",
        digits="7: float32",
        cannot="a tensor: mass and centre of mass only; the tensor is that of the shapes, times a factor an axis",
        source="Unreal Engine API, Body Instance: Mass in Kg, Center Of Mass Offset, Inertia Tensor Scale",
    ),
}
"""Every target by its name; those that `inertia.export` writes come first."""
