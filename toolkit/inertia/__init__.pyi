# ruff: noqa: I001  # the order is that of what one does
"""What is public, by what one does with it; `docs/python.md` has a line on each.

This list is the only one: `__init__.py` looks up here where a name lives and imports it when it is first used. What is
not named here is private, and may change from one version to the next.
"""

__version__: str

# What can go wrong.
from inertia.errors import GeometryError as GeometryError
from inertia.errors import InertiaError as InertiaError
from inertia.errors import ReadError as ReadError
from inertia.errors import Remedy as Remedy
from inertia.errors import UsageError as UsageError
from inertia.errors import WriteError as WriteError

# A file becomes a part; a part is checked and repaired.
from inertia.mesh.read import read as read
from inertia.mesh.part import Part as Part
from inertia.mesh.check import check as check
from inertia.mesh.checks.findings import Finding as Finding
from inertia.mesh.checks.findings import Report as Report
from inertia.mass.repair import repair as repair
from inertia.mass.repair import weld as weld
from inertia.mass.repair import Repaired as Repaired
from inertia.mesh.unite import unite as unite
from inertia.mesh.unite import Union as Union
from inertia.mesh.repairs.simplify import halvings as halvings

# A part is integrated to its mass properties.
from inertia.mass.analyse import mass_properties as mass_properties
from inertia.mass.analyse import analyse as analyse
from inertia.mass.many import many as many
from inertia.mass.many import Many as Many
from inertia.mass.analysis import Analysis as Analysis
from inertia.mass.properties import MassProperties as MassProperties
from inertia.mass.properties import ErrorBound as ErrorBound
from inertia.mass.gradient import gradient as gradient
from inertia.mass.gradient import Gradient as Gradient
from inertia.estimate import Estimate as Estimate
from inertia.mass.tessellation import richardson as richardson
from inertia.work_precision.trade import trade as trade
from inertia.work_precision.trade import Trade as Trade

# Parts hang together in an assembly, and their masses in a budget.
from inertia.assembly.document import Assembly as Assembly
from inertia.assembly.budget import Budget as Budget

# Many files become a table.
from inertia.batching.batch import batch as batch

# Mass properties go out to other programs' files.
from inertia.exchange.export import export as export

# What a robot's file states is compared with its meshes.
from inertia.auditing.audit import audit as audit
from inertia.auditing.audit import Audit as Audit

# Which publications the methods of an answer are from.
from inertia.report.citation import cite as cite

# Bodies without a mesh, and the algebra of tensors.
from inertia.mass.elements import point_masses as point_masses
from inertia.mass.elements import wire as wire
from inertia.mass.elements import lamina as lamina
from inertia.mass.tensor import steiner as steiner
from inertia.mass.tensor import reexpress as reexpress
from inertia.mass.principal import principal as principal
from inertia.mass.principal import Principal as Principal

# A rotor is balanced, from its model or from readings of a machine.
from inertia.balancing.balance import balance as balance
from inertia.balancing.balance import Balance as Balance
from inertia.balancing.rotor import Rotor as Rotor
from inertia.balancing.axis.journals import axis_candidates as axis_candidates
from inertia.balancing.measured.measure import measure as measure
from inertia.balancing.measured.measure import Measurement as Measurement
from inertia.balancing.measured.job import Job as Job
from inertia.balancing.measured.readings import readings as readings
from inertia.balancing.measured.trial_weights import trial_weight as trial_weight
from inertia.balancing.measured.trial_weights import trial_response as trial_response
from inertia.balancing.measured.trial_weights import unbalance_for_weight as unbalance_for_weight
from inertia.balancing.measured.trial_weights import unbalance_for_change as unbalance_for_change
from inertia.balancing.measured.influence import influence_coefficients as influence_coefficients
from inertia.balancing.measured.influence import influence_correction as influence_correction
from inertia.balancing.measured.index_balancing import index_balancing as index_balancing
from inertia.balancing.measured.amplitudes import amplitude_balance as amplitude_balance

# A scene is followed by the smallest model that it needs, and recorded.
from inertia.dynamics.scene.document import Scene as Scene
from inertia.dynamics.scene.sections import Start as Start
from inertia.dynamics.scene.sections import Constraint as Constraint
from inertia.dynamics.scene.sections import Settings as Settings
from inertia.dynamics.scene.body import SceneBody as SceneBody
from inertia.dynamics.loads.gravity import Gravity as Gravity
from inertia.dynamics.loads.gravity import GravityGradient as GravityGradient
from inertia.dynamics.loads.orbit import Orbit as Orbit
from inertia.dynamics.loads.torque import Torque as Torque
from inertia.dynamics.loads.losses import Damping as Damping
from inertia.dynamics.loads.losses import Dissipation as Dissipation
from inertia.dynamics.plan import plan as plan
from inertia.dynamics.simulate import simulate as simulate
from inertia.dynamics.spread.ensemble import ensemble as ensemble
from inertia.dynamics.spread.ensemble import Ensemble as Ensemble
from inertia.dynamics.run import Run as Run
from inertia.dynamics.sensitivity import sensitivity as sensitivity
from inertia.dynamics.sensitivity import Sensitivity as Sensitivity
from inertia.recording.record import record as record
from inertia.recording.record import show as show
from inertia.recording.web import export_html as export_html
from inertia.recording.pictures import export_picture as export_picture

# The models by themselves, as functions of arrays.
from inertia.dynamics.models.free.motion import free_motion as free_motion
from inertia.dynamics.models.free.motion import free_ensemble as free_ensemble
from inertia.dynamics.integrators.ensemble import step_ensemble as step_ensemble
from inertia.dynamics.models.free.flips import flip_period as flip_period
from inertia.dynamics.models.free.flips import flip_times as flip_times
from inertia.dynamics.models.free.flips import polhode_period as polhode_period
from inertia.dynamics.models.free.flips import tumbles as tumbles
from inertia.dynamics.models.heavy.top import HeavyTop as HeavyTop
from inertia.dynamics.models.heavy.top import solve_heavy_top as solve_heavy_top
from inertia.dynamics.models.rolling.equations import RollingBody as RollingBody
from inertia.dynamics.models.rolling.motion import solve_rolling as solve_rolling
from inertia.dynamics.models.rolling.steady import steady_rolling as steady_rolling
from inertia.dynamics.models.rolling.steady import steady_circle as steady_circle
from inertia.dynamics.models.rolling.steady import straight_rolling as straight_rolling
from inertia.dynamics.models.rolling.steady import straight_rolling_threshold as straight_rolling_threshold
from inertia.dynamics.models.rolling.steady import edge_spin_threshold as edge_spin_threshold
from inertia.dynamics.models.deforming.joints import Joint as Joint
from inertia.dynamics.models.deforming.joints import JointedPart as JointedPart
from inertia.dynamics.models.deforming.jointed_body import JointedBody as JointedBody
from inertia.dynamics.models.deforming.motion import solve_deforming as solve_deforming
from inertia.dynamics.integrators.rotation import RotationProblem as RotationProblem
from inertia.dynamics.models.stepped.solve import solve_stepped as solve_stepped
from inertia.dynamics.models.stepped.solve import state_between as state_between
from inertia.dynamics.integrators.events import find_events as find_events

# The geometry of free rotation.
from inertia.dynamics.kinematics.stability import wobble_frequencies as wobble_frequencies
from inertia.dynamics.kinematics.stability import growth_rate as growth_rate
from inertia.dynamics.kinematics.stability import stable_axes as stable_axes
from inertia.dynamics.kinematics.euler_equations import inverse_dynamics as inverse_dynamics
from inertia.dynamics.kinematics.stability import energy_bounds as energy_bounds
from inertia.dynamics.kinematics.stability import separatrix_distance as separatrix_distance
from inertia.dynamics.kinematics.geometry import cones as cones
from inertia.dynamics.kinematics.geometry import momentum_angle as momentum_angle
from inertia.dynamics.kinematics.geometry import poinsot as poinsot
from inertia.dynamics.kinematics.geometry import binet as binet
from inertia.dynamics.kinematics.polhode import polhode as polhode
from inertia.dynamics.kinematics.polhode import separatrix as separatrix
from inertia.dynamics.kinematics.polhode import herpolhode as herpolhode

# Coordinates of rotation: modules, whose functions have short names, as `inertia.quaternion.to_space`.
from inertia.dynamics.kinematics import quaternion as quaternion
from inertia.dynamics.kinematics import euler_angles as euler_angles
from inertia.dynamics.kinematics import canonical as canonical
from inertia.dynamics.kinematics import andoyer as andoyer
