"""STEP files for the referee: records, curves and surfaces, as they are written. Needs numpy and nothing else."""

import math
import re

import numpy as np

TAU = 2.0 * math.pi


class Unable(Exception):
    """What the referee does not do."""


class Enumeration(str):
    pass


class Reference(int):
    pass


TOKEN = re.compile(
    r"\s*(?:(#\d+)|('(?:[^']|'')*')|(\.[A-Za-z0-9_]+\.)|([A-Za-z_][A-Za-z0-9_]*)|([-+0-9.][-+0-9.eE]*)|(.))", re.S
)


class File:
    """Records by name: lists of (keyword, parameters), one of a simple record and several of a complex one."""

    def __init__(self, path):
        with open(path, "rb") as stream:
            text = stream.read().decode("latin-1")
        text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
        self.bodies = dict(self.records(text[text.index("DATA;") + 5 :]))
        self.parsed = {}
        degrees = any("CONVERSION_BASED_UNIT" in body and "DEGREE" in body.upper() for body in self.bodies.values())
        self.radians = math.pi / 180.0 if degrees else 1.0

    @staticmethod
    def records(text):
        for piece in re.findall(r"(?:[^;']|'(?:[^']|'')*')+", text):
            found = re.match(r"\s*#(\d+)\s*=\s*(.*)", piece, re.S)
            if found:
                yield int(found[1]), found[2]

    def parts(self, name):
        if name not in self.parsed:
            if name not in self.bodies:
                raise Unable(f"#{name} is not there")
            tokens = [next(t for t in match if t) for match in TOKEN.findall(self.bodies[name]) if any(match)]
            self.parsed[name] = parts_of(tokens)
        return self.parsed[name]

    def get(self, name, *keywords):
        """Parameters of the part of a record that has one of the keywords."""
        for keyword, parameters in self.parts(name):
            if keyword in keywords:
                return parameters
        raise Unable(f"#{name} is no {keywords[0]}")

    def keyword(self, name):
        return self.parts(name)[0][0]

    def has(self, name, keyword):
        return any(part[0] == keyword for part in self.parts(name))

    def point(self, name):
        return np.array([float(x) for x in self.get(name, "CARTESIAN_POINT")[1]])

    def direction(self, name):
        given = np.array([float(x) for x in self.get(name, "DIRECTION")[1]])
        return given / np.linalg.norm(given)

    def frame(self, name):
        parameters = self.get(name, "AXIS2_PLACEMENT_3D", "AXIS1_PLACEMENT")
        origin = self.point(parameters[1])
        z = self.direction(parameters[2]) if isinstance(parameters[2], Reference) else np.array([0.0, 0.0, 1.0])
        given = parameters[3] if len(parameters) > 3 else None
        x = self.direction(given) if isinstance(given, Reference) else np.eye(3)[0 if abs(z[0]) < 1.0 else 2]
        x = x - z * (x @ z)
        if np.linalg.norm(x) < 1e-9:
            x = np.eye(3)[np.argmin(np.abs(z))]
            x = x - z * (x @ z)
        x = x / np.linalg.norm(x)
        return np.array([origin, x, np.cross(z, x), z])


def parts_of(tokens):
    at = 0

    def value():
        nonlocal at
        token = tokens[at]
        at += 1
        if token == "(":
            found = []
            while tokens[at] != ")":
                found.append(value())
                if tokens[at] == ",":
                    at += 1
            at += 1
            return found
        if token[0] == "#":
            return Reference(token[1:])
        if token[0] == ".":
            return Enumeration(token.strip(".")) if token[1:2].isalpha() else float(token)
        if token[0] == "'":
            return token[1:-1]
        if token[0].isalpha():
            return value()[0]
        return token if token in "$*" else float(token)

    found = []
    if tokens[0] == "(":
        at = 1
        while tokens[at] != ")":
            keyword = tokens[at].upper()
            at += 1
            found.append((keyword, value()))
    else:
        keyword, at = tokens[0].upper(), 1
        found.append((keyword, value()))
    return found


def knots_of(multiplicities, values):
    return np.repeat(np.array(values, float), [int(m) for m in multiplicities])


def quasi_uniform(degree, count):
    """Knots 0, 1, 2 and so on, with full multiplicity at both ends (ISO 10303-42, `quasi_uniform_knots`)."""
    return np.concatenate([np.zeros(degree), np.arange(count - degree + 1.0), np.full(degree, count - degree)])


def basis(knots, degree, at):
    """Span, functions and their derivatives at many parameters, by the recurrence of Cox and de Boor."""
    count = len(knots) - degree - 1
    span = np.clip(np.searchsorted(knots, at, side="right") - 1, degree, count - 1)
    values = np.zeros((len(at), degree + 1))
    values[:, 0] = 1.0
    lower = values.copy()
    for p in range(1, degree + 1):
        lower = values.copy()
        values = np.zeros_like(values)
        for j in range(p):
            left, right = knots[span + j + 1 - p], knots[span + j + 1]
            share = lower[:, j] / np.where(right > left, right - left, 1.0)
            values[:, j] += (right - at) * share
            values[:, j + 1] += (at - left) * share
    slopes = np.zeros_like(values)
    for j in range(degree):
        left, right = knots[span + j + 1 - degree], knots[span + j + 1]
        share = degree * lower[:, j] / np.where(right > left, right - left, 1.0)
        slopes[:, j] -= share
        slopes[:, j + 1] += share
    return span, values, slopes


class Spline:
    """A curve: homogeneous control points over knots."""

    def __init__(self, degree, knots, points):
        self.degree, self.knots, self.points = degree, knots, points
        self.domain = (knots[degree], knots[-degree - 1])
        self.pieces = [k for k in np.unique(knots) if self.domain[0] <= k <= self.domain[1]]

    def point(self, at):
        span, values, _ = basis(self.knots, self.degree, at)
        sums = sum(values[:, j, None] * self.points[span - self.degree + j] for j in range(self.degree + 1))
        return sums[:, :3] / sums[:, 3:]

    def parameter(self, point):
        ends = [np.linalg.norm(self.point(np.array([end]))[0] - point) for end in self.domain]
        size = np.ptp(self.points[:, :3] / self.points[:, 3:], axis=0).max()
        if min(ends) <= 1e-5 * size:
            return self.domain[int(ends[1] < ends[0])]
        low, high = self.domain
        for _ in range(12):
            at = np.linspace(low, high, 2001)
            best = int(np.argmin(np.linalg.norm(self.point(at) - point, axis=1)))
            low, high = at[max(best - 1, 0)], at[min(best + 1, 2000)]
        return 0.5 * (low + high)


def weighted(points, weights):
    weights = np.asarray(weights, float)
    return np.concatenate([points * weights[..., None], weights[..., None]], axis=-1)


class Line:
    def __init__(self, origin, way):
        self.origin, self.way, self.period = origin, way, None

    def point(self, at):
        return self.origin + np.outer(at, self.way)

    def parameter(self, point):
        return (point - self.origin) @ self.way / (self.way @ self.way)

    def breaks(self, low, high):
        return [low, high]


class Conic:
    def __init__(self, frame, a, b):
        self.frame, self.a, self.b, self.period = frame, a, b, TAU

    def point(self, at):
        origin, x, y, _ = self.frame
        return origin + np.outer(self.a * np.cos(at), x) + np.outer(self.b * np.sin(at), y)

    def parameter(self, point):
        away = point - self.frame[0]
        return math.atan2(away @ self.frame[2] / self.b, away @ self.frame[1] / self.a)

    def breaks(self, low, high):
        return list(np.linspace(low, high, 5))


class SplineCurve:
    def __init__(self, spline):
        self.spline = spline
        low, high = spline.domain
        ends = spline.point(np.array([low, high]))
        size = np.ptp(spline.points[:, :3] / spline.points[:, 3:], axis=0).max()
        self.period = high - low if np.linalg.norm(ends[1] - ends[0]) <= 1e-7 * size else None

    def point(self, at):
        low, high = self.spline.domain
        if self.period:
            at = np.where((at < low) | (at > high), low + (at - low) % self.period, at)
        return self.spline.point(np.clip(at, low, high))

    def parameter(self, point):
        return self.spline.parameter(point)

    def breaks(self, low, high):
        turns = [-self.period, 0.0, self.period] if self.period else [0.0]
        inner = sorted(k + turn for k in self.spline.pieces for turn in turns if low < k + turn < high)
        return [low, *inner, high]


def curve(file, name):
    keyword = file.keyword(name)
    if keyword in ("SURFACE_CURVE", "SEAM_CURVE", "INTERSECTION_CURVE"):
        return curve(file, file.parts(name)[0][1][1])
    if keyword == "LINE":
        _, origin, vector = file.get(name, "LINE")
        _, way, length = file.get(vector, "VECTOR")
        return Line(file.point(origin), file.direction(way) * length)
    if keyword == "CIRCLE":
        _, place, radius = file.get(name, "CIRCLE")
        return Conic(file.frame(place), radius, radius)
    if keyword == "ELLIPSE":
        _, place, a, b = file.get(name, "ELLIPSE")
        return Conic(file.frame(place), a, b)
    if file.has(name, "B_SPLINE_CURVE_WITH_KNOTS"):
        given = file.get(name, "B_SPLINE_CURVE_WITH_KNOTS")
        simple = len(file.parts(name)) == 1
        degree, points = (given[1:3] if simple else file.get(name, "B_SPLINE_CURVE")[:2])
        multiplicities, values = given[-3:-1]
        points = np.array([file.point(p) for p in points])
        rational = file.has(name, "RATIONAL_B_SPLINE_CURVE")
        weights = file.get(name, "RATIONAL_B_SPLINE_CURVE")[0] if rational else np.ones(len(points))
        return SplineCurve(Spline(int(degree), knots_of(multiplicities, values), weighted(points, weights)))
    if keyword == "QUASI_UNIFORM_CURVE":
        _, degree, points = file.parts(name)[0][1][:3]
        points = np.array([file.point(p) for p in points])
        knots = quasi_uniform(int(degree), len(points))
        return SplineCurve(Spline(int(degree), knots, weighted(points, np.ones(len(points)))))
    raise Unable(f"curve {keyword}")


class Surface:
    """Points and tangents at many parameters, and back. `ends` are where the second parameter meets a pole."""

    periods = (None, None)
    ends = (None, None)

    def breaks(self, way, low, high):
        """Places between which a column over one parameter is smooth."""
        return np.linspace(low, high, 2)


class Plane(Surface):
    kind = "plane"

    def __init__(self, frame):
        self.frame = frame

    def at(self, u, v):
        point = self.frame[0] + u[..., None] * self.frame[1] + v[..., None] * self.frame[2]
        return point, np.broadcast_to(self.frame[1], point.shape), np.broadcast_to(self.frame[2], point.shape)

    def parameters(self, points):
        away = points - self.frame[0]
        return away @ self.frame[1], away @ self.frame[2]


class Round(Surface):
    """Cylinder, cone, sphere and torus: a distance from the axis and a height, both by v."""

    def __init__(self, frame):
        self.frame = frame
        self.periods = (TAU, None)

    def at(self, u, v):
        (rho, slope), (height, climb) = self.profile(v)
        cos, sin = np.cos(u), np.sin(u)
        out = cos[..., None] * self.frame[1] + sin[..., None] * self.frame[2]
        along = cos[..., None] * self.frame[2] - sin[..., None] * self.frame[1]
        z = self.frame[3]
        return (
            self.frame[0] + rho[..., None] * out + height[..., None] * z,
            rho[..., None] * along,
            slope[..., None] * out + climb[..., None] * z,
        )

    def parameters(self, points):
        away = points - self.frame[0]
        x, y, z = away @ self.frame[1], away @ self.frame[2], away @ self.frame[3]
        return np.arctan2(y, x), self.height(np.hypot(x, y), z)

    def breaks(self, way, low, high):
        return np.linspace(low, high, 2 + int(abs(high - low) / 0.5)) if self.turns[way] else np.linspace(low, high, 2)

    turns = (True, False)


class Cylinder(Round):
    kind = "cylinder"

    def __init__(self, frame, radius):
        super().__init__(frame)
        self.radius = radius

    def profile(self, v):
        one = np.ones_like(v)
        return (self.radius * one, 0.0 * one), (v, one)

    def height(self, rho, z):
        return z


class Cone(Round):
    kind = "cone"

    def __init__(self, frame, radius, angle):
        super().__init__(frame)
        self.radius, self.slope = radius, math.tan(angle)
        apex = -radius / self.slope
        self.ends = (apex, None) if self.slope > 0.0 else (None, apex)

    def profile(self, v):
        one = np.ones_like(v)
        return (self.radius + v * self.slope, self.slope * one), (v, one)

    def height(self, rho, z):
        return ((rho - self.radius) * self.slope + z) / (1.0 + self.slope**2)


class Sphere(Round):
    kind = "sphere"
    turns = (True, True)
    ends = (-math.pi / 2, math.pi / 2)

    def __init__(self, frame, radius):
        super().__init__(frame)
        self.radius = radius

    def profile(self, v):
        cos, sin = self.radius * np.cos(v), self.radius * np.sin(v)
        return (cos, -sin), (sin, cos)

    def height(self, rho, z):
        return np.arctan2(z, rho)


class Torus(Round):
    kind = "torus"
    turns = (True, True)

    def __init__(self, frame, major, minor):
        super().__init__(frame)
        self.major, self.minor = major, minor
        self.periods = (TAU, TAU)

    def profile(self, v):
        cos, sin = self.minor * np.cos(v), self.minor * np.sin(v)
        return (self.major + cos, -sin), (sin, cos)

    def height(self, rho, z):
        return np.arctan2(z, rho - self.major)


class Searched(Surface):
    """A surface whose parameters are found by Newton's method from the nearest of many samples."""

    def prepare(self, us, vs):
        self.grid = np.stack(np.meshgrid(us, vs, indexing="ij"), axis=-1).reshape(-1, 2)
        self.samples = self.at(self.grid[:, 0], self.grid[:, 1])[0]
        self.box = np.array([[us[0], vs[0]], [us[-1], vs[-1]]])

    def parameters(self, points):
        best = np.empty(len(points), int)
        for start in range(0, len(points), 256):
            away = points[start : start + 256, None, :] - self.samples[None, :, :]
            best[start : start + 256] = np.argmin(np.einsum("ijk,ijk->ij", away, away), axis=1)
        uv = self.grid[best].copy()
        for _ in range(60):
            point, du, dv = self.at(*self.inside(uv).T)
            away = points - point
            a, b, c = (du * du).sum(1), (du * dv).sum(1), (dv * dv).sum(1)
            p, q = (away * du).sum(1), (away * dv).sum(1)
            det = np.where(a * c - b * b > 1e-14 * a * c, a * c - b * b, np.inf)
            step = np.stack([c * p - b * q, a * q - b * p], axis=1) / det[:, None]
            limit = 0.05 * (self.box[1] - self.box[0])
            uv = self.inside(uv + np.clip(step, -limit, limit))
            if np.max(np.abs(step) / (self.box[1] - self.box[0])) < 1e-14:
                break
        return uv[:, 0], uv[:, 1]

    def inside(self, uv):
        uv = uv.copy()
        for way, period in enumerate(self.periods):
            low, high = self.box[:, way]
            uv[:, way] = low + (uv[:, way] - low) % period if period else np.clip(uv[:, way], low, high)
        return uv


class SplineSurface(Searched):
    kind = "b_spline"

    def __init__(self, degrees, knots, net):
        self.degrees, self.knots, self.net = degrees, knots, net
        domains = [(k[p], k[-p - 1]) for k, p in zip(knots, degrees)]
        self.pieces = [np.unique(np.clip(k, *d)) for k, d in zip(knots, domains)]
        euclidean = net[..., :3] / net[..., 3:]
        size = np.ptp(euclidean.reshape(-1, 3), axis=0).max()
        ways = [np.linspace(*d, 33) for d in domains]
        periods = []
        for way in (0, 1):
            low, high = [np.full(33, end) for end in domains[way]]
            borders = [self.at(*((end, ways[1]) if way == 0 else (ways[0], end)))[0] for end in (low, high)]
            closed = np.abs(borders[1] - borders[0]).max() <= 1e-7 * size
            periods.append(domains[way][1] - domains[way][0] if closed else None)
        self.periods = tuple(periods)
        counts = [max(3, min(12, 600 // len(p))) for p in self.pieces]
        spread = lambda p, n: np.unique(np.concatenate([np.linspace(a, b, n) for a, b in zip(p, p[1:])]))
        self.prepare(*(spread(p, n) for p, n in zip(self.pieces, counts)))
        self.ends = tuple(self.pole(end) for end in domains[1])

    def pole(self, v):
        points = self.at(np.linspace(*self.box[:, 0], 9), np.full(9, v))[0]
        return v if np.ptp(points, axis=0).max() <= 1e-7 * np.ptp(self.samples, axis=0).max() else None

    def at(self, u, v):
        shape = np.shape(u)
        u, v = np.ravel(u), np.ravel(v)
        (p, q), (ku, kv) = self.degrees, self.knots
        (su, bu, du), (sv, bv, dv) = basis(ku, p, u), basis(kv, q, v)
        sums = np.zeros((3, len(u), 4))
        for i in range(p + 1):
            for j in range(q + 1):
                point = self.net[su - p + i, sv - q + j]
                for k, (a, b) in enumerate([(bu, bv), (du, bv), (bu, dv)]):
                    sums[k] += (a[:, i] * b[:, j])[:, None] * point
        weight = sums[0, :, 3:]
        point = sums[0, :, :3] / weight
        along = [(sums[k, :, :3] - point * sums[k, :, 3:]) / weight for k in (1, 2)]
        return tuple(x.reshape(*shape, 3) for x in (point, *along))

    def breaks(self, way, low, high):
        period = self.periods[way]
        turns = range(-2, 3) if period else [0]
        inner = {k + t * (period or 0.0) for k in self.pieces[way] for t in turns}
        inner = sorted((k for k in inner if min(low, high) < k < max(low, high)), reverse=bool(high < low))
        return np.array([low, *inner, high])


class Extrusion(Searched):
    kind = "linear_extrusion"

    def __init__(self, swept, way, reach):
        self.swept, self.way = swept, way
        self.periods = (swept.period, None)
        low, high = swept.spline.domain if isinstance(swept, SplineCurve) else (0.0, TAU)
        self.step = 1e-6 * (high - low)
        self.prepare(np.linspace(low, high, 400), np.linspace(-reach, reach, 41))

    def at(self, u, v):
        shape = np.shape(u)
        u, v = np.ravel(u), np.ravel(v)
        low, high = (u - self.step, u + self.step)
        point = self.swept.point(u) + v[:, None] * self.way
        du = (self.swept.point(high) - self.swept.point(low)) / (2.0 * self.step)
        return tuple(x.reshape(*shape, 3) for x in (point, du, np.broadcast_to(self.way, point.shape)))

    def breaks(self, way, low, high):
        return np.linspace(low, high, 2)


def surface(file, name, reach):
    keyword = file.keyword(name)
    given = file.parts(name)[0][1]
    if keyword == "PLANE":
        return Plane(file.frame(given[1]))
    if keyword == "CYLINDRICAL_SURFACE":
        return Cylinder(file.frame(given[1]), given[2])
    if keyword == "CONICAL_SURFACE":
        return Cone(file.frame(given[1]), given[2], given[3] * file.radians)
    if keyword == "SPHERICAL_SURFACE":
        return Sphere(file.frame(given[1]), given[2])
    if keyword == "TOROIDAL_SURFACE":
        return Torus(file.frame(given[1]), given[2], given[3])
    if keyword == "SURFACE_OF_LINEAR_EXTRUSION":
        _, way, length = file.get(given[2], "VECTOR")
        way = file.direction(way) * length
        return Extrusion(curve(file, given[1]), way, reach / np.linalg.norm(way))
    if file.has(name, "B_SPLINE_SURFACE_WITH_KNOTS"):
        knots = file.get(name, "B_SPLINE_SURFACE_WITH_KNOTS")
        simple = len(file.parts(name)) == 1
        p, q, rows = (knots[1:4] if simple else file.get(name, "B_SPLINE_SURFACE")[:3])
        mu, mv, ku, kv = knots[-5:-1]
        net = np.array([[file.point(point) for point in row] for row in rows])
        rational = file.has(name, "RATIONAL_B_SPLINE_SURFACE")
        weights = file.get(name, "RATIONAL_B_SPLINE_SURFACE")[0] if rational else np.ones(net.shape[:2])
        return SplineSurface((int(p), int(q)), (knots_of(mu, ku), knots_of(mv, kv)), weighted(net, weights))
    if keyword == "QUASI_UNIFORM_SURFACE":
        p, q, rows = given[1:4]
        net = np.array([[file.point(point) for point in row] for row in rows])
        knots = quasi_uniform(int(p), net.shape[0]), quasi_uniform(int(q), net.shape[1])
        return SplineSurface((int(p), int(q)), knots, weighted(net, np.ones(net.shape[:2])))
    raise Unable(f"surface {keyword}")
