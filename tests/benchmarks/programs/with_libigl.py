"""Volume and moments with libigl; the vertices are welded and the boundary must be empty."""

import sys

import igl

soup, corners = igl.read_triangle_mesh(sys.argv[1])
vertices, _, _, faces = igl.remove_duplicate_vertices(soup, corners, 0.0)
if len(igl.boundary_facets(faces)[0]):
    raise SystemExit("open")
volume, first, second = igl.moments(vertices, faces)
print(volume)
