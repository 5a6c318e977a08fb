"""Areas and volumes of STEP faces by polygons: a referee between two programs that measure by quadrature.

    python3 referee.py [--points N] FILE [#FACE ...]

Needs numpy and nothing else: the file is read here, topology and geometry as they are written. Each edge gives N points
for each of its pieces (N = 400 where nothing is said), each is projected onto the surface of the face (in closed
form, or by Newton's method), and the polygon of the parameter plane that joins them is measured by columns of Gauss
points. The error falls with the square of N; a second round with N/2 points gives the value at the limit, and how far
it is. Lengths are in the unit of the file.

Prints one JSON line for each face: its record, the kind of its surface, its area and the volume of the cone over it
from the origin (`flux`), both with the distance of the last round from the limit, and the greatest distance of an edge
from the surface. Without faces, all of the file. A face that cannot be refereed says why.
"""

import json
import re
import sys

import numpy as np

from step_geometry import File, Searched, Unable, curve, surface

# Gauss points of a column over one piece of a parameter.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(10)


def edge_points(file, name, count):
    """Points along an edge from its start to its end."""
    _, start, end, geometry, sense = file.get(name, "EDGE_CURVE")
    ends = [file.point(file.get(vertex, "VERTEX_POINT")[1]) for vertex in (start, end)]
    forward = sense == "T"
    if not forward:
        ends.reverse()
    along = curve(file, geometry)
    low, high = (along.parameter(point) for point in ends)
    if along.period:
        way = (high - low) % along.period
        whole = start == end or min(way, along.period - way) <= 1e-9 * along.period
        high = low + (along.period if whole else way)
    breaks = along.breaks(low, high)
    at = np.concatenate([np.linspace(a, b, count, endpoint=False) for a, b in zip(breaks, breaks[1:])] + [[high]])
    points = along.point(at)
    return points if forward else points[::-1]


def loop_points(file, bound, count):
    """Points of a bound in its own sense; where two edges meet, the end of the one and the start of the other."""
    _, loop, orientation = file.get(bound, "FACE_BOUND", "FACE_OUTER_BOUND")
    if file.keyword(loop) == "VERTEX_LOOP":
        return None
    pieces = []
    for use in file.get(loop, "EDGE_LOOP")[1]:
        _, _, _, edge, forward = file.get(use, "ORIENTED_EDGE")
        points = edge_points(file, edge, count)
        pieces.append(points if forward == "T" else points[::-1])
    if orientation != "T":
        pieces = [piece[::-1] for piece in reversed(pieces)]
    return np.concatenate(pieces)


def unwrapped(values, period):
    """A run of parameters without jumps, closed: its first value again at the end, whole turns off."""
    values = np.append(values, values[0])
    return np.unwrap(values, period=period) if period else values


def singular(of, uv):
    """Where u says nothing."""
    _, du, _ = of.at(uv[:, 0], uv[:, 1])
    speed = np.linalg.norm(du, axis=1)
    return speed <= 1e-7 * speed.max()


def polygon(of, points):
    uv = np.stack(of.parameters(points), axis=1)
    away = np.linalg.norm(of.at(uv[:, 0], uv[:, 1])[0] - points, axis=1).max()
    # At a pole the parameter is that of the way in, and then that of the way out.
    poles = np.flatnonzero(singular(of, uv)) if of.periods[0] and any(e is not None for e in of.ends) else []
    rows = []
    for k in range(len(uv)):
        if k in poles:
            rows.extend([[uv[k - 1, 0], uv[k, 1]], [uv[(k + 1) % len(uv), 0], uv[k, 1]]])
        else:
            rows.append(uv[k])
    uv = np.array(rows)
    return np.stack([unwrapped(uv[:, k], of.periods[k]) for k in (0, 1)], axis=1), away


def columns(of, start, fixed, ends, way):
    """Integrals of area and flux over one parameter from `start` to each of the ends, at fixed values of the other."""
    pieces = []
    for k, end in enumerate(ends):
        breaks = of.breaks(way, start, end)
        pieces.extend((k, a, b) for a, b in zip(breaks, breaks[1:]) if a != b)
    sums = np.zeros((2, len(ends)))
    for first in range(0, len(pieces), 4096):
        which, low, high = (np.array(x) for x in zip(*pieces[first : first + 4096]))
        half = 0.5 * (high - low)[:, None]
        at = low[:, None] + half * (1.0 + NODES)
        other = np.broadcast_to(fixed[which][:, None], at.shape)
        u, v = (other, at) if way == 1 else (at, other)
        if isinstance(of, Searched):
            u, v = (x.reshape(at.shape) for x in of.inside(np.stack([u.ravel(), v.ravel()], axis=1)).T)
        point, du, dv = of.at(u, v)
        normal = np.cross(du, dv)
        for row, value in enumerate((np.linalg.norm(normal, axis=-1), np.einsum("ijk,ijk->ij", point, normal))):
            sums[row] += np.bincount(which, (value * half * WEIGHTS).sum(axis=1), len(ends))
    return sums


def measured(file, face, count):
    _, bounds, geometry, sense = file.get(face, "ADVANCED_FACE", "FACE_SURFACE")
    loops = [loop_points(file, bound, count) for bound in bounds]
    loops = [points for points in loops if points is not None]
    if not loops:
        raise Unable("no bound but a vertex")
    everything = np.concatenate(loops)
    of = surface(file, geometry, 2.0 * np.ptp(everything, axis=0).max() + np.abs(everything).max())
    found = [polygon(of, points) for points in loops]
    around = lambda p, k: round((p[-1, k] - p[0, k]) / of.periods[k]) if of.periods[k] else 0
    turns = np.array([[around(p, k) for k in (0, 1)] for p, _ in found])
    forward = 1.0 if sense == "T" else -1.0
    if turns[:, 0].any() and turns[:, 1].any():
        raise Unable("bounds run round both ways")
    # Columns along v, from a pole on the face's side where one bound alone runs round; along u where bounds do in v.
    way = 0 if turns[:, 1].any() else 1
    total = turns[:, 1 - way].sum() * forward
    start = min(p[:, way].min() for p, _ in found)
    if total != 0.0:
        start = of.ends[int(total > 0.0)] if way == 1 else None
        if start is None:
            raise Unable("bounds leave a side open")
    sums = np.zeros(2)
    for p, _ in found:
        step = np.diff(p[:, 1 - way])
        moving = step != 0.0
        middle = 0.5 * (p[:-1] + p[1:])[moving]
        parts = columns(of, start, middle[:, 1 - way], middle[:, way], way)
        sums += (parts * step[moving]).sum(axis=1) * (-1.0 if way == 1 else 1.0)
    return of.kind, np.array([sums[0] * forward, sums[1]]), max(away for _, away in found)


def referee(file, face, count):
    kind, half, _ = measured(file, face, count // 2)
    _, full, gap = measured(file, face, count)
    limit = full + (full - half) / 3.0
    error = np.abs(limit - full)
    return {
        "face": f"#{face}",
        "kind": kind,
        "area": limit[0],
        "area_error": error[0],
        "flux": limit[1] / 3.0,
        "flux_error": error[1] / 3.0,
        "gap": gap,
    }


def main():
    arguments = sys.argv[1:]
    count = 400
    if arguments[0] == "--points":
        count, arguments = int(arguments[1]), arguments[2:]
    file = File(arguments[0])
    faces = [int(name.lstrip("#")) for name in arguments[1:]]
    faces = faces or [name for name, body in file.bodies.items() if re.match(r"(ADVANCED_FACE|FACE_SURFACE)\b", body)]
    for face in faces:
        try:
            found = referee(file, face, count)
        except Unable as reason:
            found = {"face": f"#{face}", "unable": str(reason)}
        print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
