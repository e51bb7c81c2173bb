"""Self-intersections of a stored shape, by exact arithmetic (CGAL, through libigl): no code of billow has a part in it.

Elements that share an edge or a node intersect only beyond it.
"""

import igl.copyleft.cgal as cgal
import numpy as np


def pairs(positions, triangles):
    """Number of pairs of elements that intersect."""
    vertices = np.ascontiguousarray(positions, dtype=np.float64)
    faces = np.ascontiguousarray(triangles, dtype=np.int64)
    return len(cgal.remesh_self_intersections(vertices, faces, detect_only=True)[2])


def is_seen(positions, triangles):
    """Whether an intersection would be found: the lowest node is moved through the film, to above the highest."""
    moved = np.array(positions, dtype=np.float64)
    height = moved[:, 2].max() - moved[:, 2].min()
    moved[np.argmin(moved[:, 2]), 2] = moved[:, 2].max() + height
    return pairs(moved, triangles) > 0
