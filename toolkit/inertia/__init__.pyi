"""Everything that is public, by what one does with it; `docs/python.md` says a line about each.

What is not named here may change from one version to the next without a word.
"""

# A file becomes a part, and a part is checked and mended.
from inertia.mass.repair import Repaired as Repaired
from inertia.mass.repair import repair as repair
from inertia.mass.repair import weld as weld
from inertia.mesh.check import check as check
from inertia.mesh.checks.findings import Finding as Finding
from inertia.mesh.checks.findings import Report as Report
from inertia.mesh.part import Part as Part
from inertia.mesh.read import read as read
from inertia.mesh.repairs.simplify import halvings as halvings
