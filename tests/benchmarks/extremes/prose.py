"""The sentences of docs/extremes.md, around the tables."""

TEXT = """# Accuracy at the extremes

One solid, a dented ball of 512 triangles without any symmetry, is moved off, scaled, stretched to needles and plates,
hollowed out to a thin wall, sliced into slivers and stored in float32. What `inertia` answers by each of its three
methods is compared with rational arithmetic, beside what trimesh, libigl, Drake, MuJoCo and VTK answer.

```
python -m tests.benchmarks.extremes
```

(after `pip install -e .[benchmark]` and, for Drake's column, `pip install drake`, which brings the proprietary Mosek; a
minute) makes the measurements and writes this page and [extremes.json](extremes.json), which has every figure. With
`--large` it measures ten million triangles instead (minutes), with `--costs` the times; without, their last figures
stay.

Versions: {versions}.

## What to conclude

* Errors beyond their bound: {exceeded}, in {compared:,} comparisons over {meshes:,} random meshes
  ([below](#the-bounds-hold)) and in every case on this page.
* Distance and scale cost nothing: the volume and the tensor of a part a million million diameters from the file's
  origin are right to the last digit *of the part as it is stored*. What the coordinates lost when they were written is
  a property of the file: it is the condition of the problem, not an error of the integration, and no program can bring
  it back. The column “lost in the file” states it.
* Needles and plates that lie askew and thin walls do cost digits in float64, to everybody, because the volume is a
  small difference of large products. The bound says so, and `--accuracy 1e-12` goes on to double-double or to
  integers.
* A result that float64 cannot hold is a sentence and exit code 4, never an infinity or a zero.
* These other programs state no bound. (Geometry kernels do state accuracies: Parasolid, ACIS, OpenCASCADE and Rhino
  give an estimate of the error with their mass properties. An estimate is no proof.) The same call that is right to
  1e-16 at the origin is off by many orders of magnitude far away, and mostly no exception or warning tells the two
  apart.

## At a glance

The largest error in each family of cases, of the tensor or, for slender parts, of the smallest principal moment, as
part of the true value. `inertia` is asked without an accuracy and answers “error ≤ bound” (its largest of each). VTK
gives volumes only and is judged by them. “None in 3 of 5” counts exceptions, refusals, infinities and NaN.

{glance}

## How to read the tables

All figures are of the answers as returned, in float64, against rational arithmetic on the coordinates *as stored*.
Volume, tensor (Frobenius norm) and smallest principal moment are relative to the true value; the centre of mass is the
distance over the largest extent of the part. `inertia` answers “error ≤ bound”. Rounding a result to float64 alone
costs up to 1.1e-16 and is in both; for the centre of mass that is 1.1e-16 of its distance from the file's origin.

* *lost in the file*: how far the stored part is from the part that was meant, because its coordinates were rounded.
* *`1e-12` runs*: which method `--accuracy 1e-12` answers with: the cheapest whose bounds, of all quantities, are below
  1e-12; that of the centre of mass for the pair of numbers that is returned then. A needle whose smallest moment would
  drown goes on to the method that keeps nine digits of it.
* *refuses*: a sentence and exit code 4, the first of them quoted below the table.
* *throws*: an exception; *not finite*: an infinity or NaN in the answer; –: not computed, or not installed.

The programs are asked in the way that favours them: trimesh without merging vertices (its default merges those nearer
than 1e-8, and with them the whole of a small part), MuJoCo with `inertia="exact"`, all with unit density. MuJoCo keeps
coordinates in float32, so that its errors are mostly those of that storage.

## The cases

{families}

### Nearly equal moments

A slanted body of revolution whose two smaller moments differ by a gap, relative to the largest. With a gap that is
below the error of the tensor there are no two axes but a plane; which it is, the bounds decide. Given are the class at
`--class-tolerance 0`, and the angle between the first axis and the true one, in radians, ≤ its bound. The others give
an axis with all digits, whatever of it is noise.

{axes}

### No answer

The volume or the tensor of these is above or below what float64 holds, or there is no volume at all.

{refusals}

### On the command line

Parts in millimetres, which `python -m tests.benchmarks.extremes --parts FOLDER` writes. Volume and tensor are relative;
where the true volume is rational, its error stands before its bound. The centre of mass is the pair of numbers where an
accuracy is asked for.

{commands}

{large}

## The bounds hold

{meshes:,} random meshes of 4 to 384 triangles (unions of tetrahedra, rough balls, thin shells, slivers; a part of them
flattened to 1e-9, turned, moved off by up to 1e10 diameters, scaled by 1e-50 to 1e50, or stored in float32; always the
same ones), in millimetres and of steel. “Exceeded” counts errors above their bound, “no error” answers that are the
true number itself. The other columns are bound over error, where there is one. Typical (the medians for volume, mass,
centre and tensor): {typical}.

{sweep}

The bounds of the dearer methods are within a few times the error: what is left is the rounding of the result. In
float64, sums over up to {many:,} triangles, as all of these are, are formed a second time in double-double, and the
bound is what those in float64 are off by. Where a body has small moments beside large ones, the bound of the smallest
is as large as the error of the others can make it.

“Before rounding” compares the sums before the result is rounded to float64. The principal moments of the dearer
methods are computed from rationals, so their bound is the rounding itself. Refused, because for these coordinates and
that method the volume cannot be told from zero: {refused}.

Larger meshes are summed with the digits that float64 loses, with a quarter of the double-double work. Bound over error,
the medians of {bodies} wavy tori, each turned and scaled at random, against exact integers:

{growth}

## What accuracy costs

CPU time on one core, from arrays of vertices and faces to moments and bounds, for a wavy torus of {triangles:,}
triangles: medians of runs in which the methods took turns. The first row is a kernel that forms the same ten sums and
nothing that only a bound, the area or the extents need. The float64 row is that with more digits, the double-double
row includes the sums in float64, whose magnitudes its bound needs. Exact integers cost more where the coordinates have
more bits: “float32” are coordinates as a binary STL file holds them. {machine}.

{costs}
"""

NOTES = {
    "Far from the origin": """The solid, one diameter in size, is moved off. All that happens to ours is that the
coordinates have fewer digits, and that the centre of mass, a large number, is rounded: its column shows that rounding.
Who asks for `--accuracy` gets what the rounding took beside it (`center_of_mass_low`). The others sum tetrahedra that
reach to the origin, or shift a tensor taken about it.""",
    "Very small and very large": """No digits are lost: coordinates beyond 2^±100 are multiplied by a power of two
first. At 1e-63 m the tensor itself is below the normal range of float64, so fewer digits of it exist.""",
    "Needles": """Stretched by the aspect and, if slanted, turned by a rational rotation. Along the axes, every product
is small with the part; slanted, the volume is what remains of products that are larger by the square of the aspect.
The smallest moment is the one about the length. At 1 : 1e6 a tensor's float64 elements hold four digits of it, from
1e8 on none: it takes moments that are diagonalised before they are rounded, and sums with more digits.""",
    "Plates": """The same with one thin direction: only the normal cancels, so less is lost.""",
    "Thin walls": """A cavity of the body's own shape. The volume is what outer and inner surface leave of each other:
at 1e-12 and 1e-15 nearly nothing. Where floating point does not tell which shell lies in which, integers do.""",
    "Slivers": """Every triangle is split in three about a point next to one of its edges. The edge form of the
determinant takes no harm.""",
    "Stored in float32": """As binary STL stores it: the file has lost more than any method does. The integration reads
the records as they are.""",
}

LARGE = """### Ten million triangles

A wavy torus whose coordinates are float32 numbers. The sums are added up as a tree, so neither error nor bound grows
with the number of triangles. MuJoCo and Drake were not asked."""
