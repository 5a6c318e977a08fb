#!/usr/bin/env python3
"""Checks a proof sheet against the two files, as docs/proof-sheet.md lays it down. Needs Python 3 alone.

verify_proof.py PROOF.json BEFORE.step AFTER.step
Ends with 0 when every claim holds, with 1 when one does not.
"""
import gzip
import hashlib
import json
import math
import re
import struct
import sys

sys.setrecursionlimit(20000)
TOKEN = re.compile(
    rb"\s+|/\*.*?\*/|(?P<string>'(?:[^']|'')*')|(?P<binary>\"[0-9A-Fa-f]*\")|(?P<ref>#\d+)"
    rb"|(?P<enum>\.[A-Za-z_][A-Za-z0-9_]*\.)|(?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[Ee][+-]?\d+)?)"
    rb"|(?P<word>!?[A-Za-z_][A-Za-z0-9_-]*)|(?P<sign>[()$*,;=])",
    re.S,
)


def tokens(data):
    at = 0
    while at < len(data):
        match = TOKEN.match(data, at)
        if not match:
            raise ValueError(f"byte {at} is no token: {data[at:at + 20]!r}")
        at = match.end()
        if match.lastgroup:
            yield match.lastgroup, match.group()


class Records:
    """Records of a file: name -> list of (keyword, parameters)."""

    def __init__(self, path):
        self.bytes = open(path, "rb").read()
        if self.bytes[:2] == b"\x1f\x8b":
            self.bytes = gzip.decompress(self.bytes)
        self.records, self.digests = {}, {}
        for section in re.findall(rb"DATA\s*(?:\([^;]*\))?\s*;(.*?)ENDSEC\s*;", self.bytes, re.S):
            self.read(list(tokens(section)))

    def read(self, all_tokens):
        at = 0
        while at < len(all_tokens):
            name = all_tokens[at][1]
            assert all_tokens[at][0] == "ref" and all_tokens[at + 1][1] == b"=", name
            at += 2
            partial = []
            outer = all_tokens[at][1] == b"("
            at += outer
            while all_tokens[at][0] == "word":
                keyword = all_tokens[at][1].upper()
                parameters, at = self.members(all_tokens, at + 1)
                partial.append((keyword, parameters))
            at += outer
            assert all_tokens[at][1] == b";", name
            at += 1
            self.records.setdefault(int(name[1:]), partial)

    def members(self, all_tokens, at):
        assert all_tokens[at][1] == b"("
        found, at = [], at + 1
        while all_tokens[at][1] != b")":
            kind, text = all_tokens[at]
            if text == b",":
                at += 1
            elif text == b"(":
                inner, at = self.members(all_tokens, at)
                found.append(("list", b"", inner))
            elif kind == "word":
                inner, at = self.members(all_tokens, at + 1)
                found.append(("typed", text.upper(), inner))
            else:
                found.append((kind, text, None))
                at += 1
        return found, at + 1

    def curve_in_space(self, name):
        partial = self.records[name]
        for keyword, parameters in partial:
            if keyword in (b"SURFACE_CURVE", b"SEAM_CURVE", b"INTERSECTION_CURVE"):
                return reference(parameters[0 if len(partial) > 1 else 1])
        return None

    def digest(self, name):
        if name not in self.digests:
            self.digests[name] = None
            curve = self.curve_in_space(name)
            text = b"" if curve else b"".join(k + self.text(p) for k, p in self.records[name])
            self.digests[name] = self.digest(curve) if curve else hashlib.sha256(text).hexdigest()
        if self.digests[name] is None:
            raise ValueError(f"#{name} refers to itself")
        return self.digests[name]

    def text(self, parameters):
        return b"(" + b",".join(self.value(p) for p in parameters) + b")"

    def value(self, parameter):
        kind, text, inner = parameter
        if kind == "ref":
            return b"#" + self.digest(reference(parameter)).encode()
        if kind == "number":
            return b"%016x" % bits(text)
        if kind in ("list", "typed"):
            return text + self.text(inner)
        return text.upper() if kind == "enum" else text

    # Places and directions.

    def numbers(self, name):
        return [float(p[1]) for p in self.records[name][0][1][1][2]]

    def direction(self, parameter):
        if parameter[1] == b"$":
            return None
        ratios = self.numbers(reference(parameter))
        return unit(ratios) if len(ratios) == 3 else None

    def placed(self, name):
        """(points, directions, lengths), or None for a record to be looked at by parameters."""
        if len(self.records[name]) != 1:
            return None
        keyword, p = self.records[name][0]
        if keyword == b"CARTESIAN_POINT":
            x = self.numbers(name)
            return ([x], [], []) if len(x) == 3 else None
        if keyword == b"DIRECTION":
            x = self.numbers(name)
            return ([], [unit(x)], []) if len(x) == 3 else None
        if keyword == b"VECTOR":
            d = self.direction(p[1])
            return ([], [d], [float(p[2][1])]) if d else None
        if keyword == b"AXIS1_PLACEMENT":
            return ([self.numbers(reference(p[1]))], [self.direction(p[2]) or [0.0, 0.0, 1.0]], [])
        if keyword == b"AXIS2_PLACEMENT_3D":
            z = self.direction(p[2]) or [0.0, 0.0, 1.0]
            along_x = z[1] == 0.0 and z[2] == 0.0
            x = self.direction(p[3]) or ([0.0, 1.0, 0.0] if along_x else [1.0, 0.0, 0.0])
            c = sum(a * b for a, b in zip(x, z))
            x = unit([a - c * b for a, b in zip(x, z)])
            return ([self.numbers(reference(p[1]))], [z, x], [])
        return None


def reference(parameter):
    assert parameter[0] == "ref", parameter
    return int(parameter[1][1:])


def bits(text):
    value = float(text)
    return 0 if value == 0.0 else struct.unpack(">Q", struct.pack(">d", value))[0]


def unit(vector):
    length = math.sqrt(sum(c * c for c in vector))
    return [c / length for c in vector]


class Copy:
    """Records of two files, followed at once."""

    def __init__(self, before, after):
        self.before, self.after, self.seen = before, after, set()
        self.points, self.directions, self.lengths = [], [], []

    def add(self, a, b):
        on_a, on_b = self.before.curve_in_space(a), self.after.curve_in_space(b)
        if on_a or on_b:
            return self.add(on_a or a, on_b or b)
        if (a, b) in self.seen:
            return None
        self.seen.add((a, b))
        old, new = self.before.placed(a), self.after.placed(b)
        if (old is None) != (new is None):
            raise ValueError(f"#{a} and #{b} are of different kinds")
        if old:
            if [len(x) for x in old] != [len(x) for x in new]:
                raise ValueError(f"#{a} and #{b} are of different kinds")
            self.points += zip(old[0], new[0])
            self.directions += zip(old[1], new[1])
            self.lengths += zip(old[2], new[2])
            return None
        old, new = self.before.records[a], self.after.records[b]
        if [k for k, _ in old] != [k for k, _ in new]:
            raise ValueError(f"#{a} and #{b} are of different kinds")
        for (keyword, p), (_, q) in zip(old, new):
            self.lists(p, q, b"B_SPLINE" in keyword, f"#{a} and #{b}")
        return None

    def lists(self, p, q, advice, names):
        if len(p) != len(q):
            raise ValueError(f"{names}: lists of different lengths")
        for x, y in zip(p, q):
            if x[0] != y[0]:
                raise ValueError(f"{names}: values of different kinds")
            if x[0] == "ref":
                self.add(reference(x), reference(y))
            elif x[0] in ("list", "typed"):
                if x[1] != y[1]:
                    raise ValueError(f"{names}: values of different types")
                self.lists(x[2], y[2], advice, names)
            elif x[0] == "number":
                if bits(x[1]) != bits(y[1]):
                    raise ValueError(f"{names}: {x[1]!r} became {y[1]!r}")
            elif x[0] == "enum":
                if x[1].upper() != y[1].upper() and not advice:
                    raise ValueError(f"{names}: {x[1]!r} became {y[1]!r}")
            elif x[0] != "string" and x[1] != y[1]:
                raise ValueError(f"{names}: {x[1]!r} became {y[1]!r}")

    def faults(self, m, t):
        low = [min(p[k] for p, _ in self.points) for k in range(3)]
        high = [max(p[k] for p, _ in self.points) for k in range(3)]
        extent = math.dist(low, high) or 1.0
        greatest = max(abs(c) for pair in self.points for p in pair for c in p)
        accepted = extent * 1e-12 + 8 * 2.0**-52 * greatest
        turn = lambda v: [sum(m[i][k] * v[k] for k in range(3)) for i in range(3)]
        for p, q in self.points:
            if max(abs(a + b - c) for a, b, c in zip(turn(p), t, q)) > accepted:
                yield f"the point {p} did not move to {q}"
        step = max(1, -(-len(self.points) // 1500))
        chosen = self.points[::step]
        for k, (p, q) in enumerate(chosen):
            for r, s in chosen[:k]:
                if abs(math.dist(p, r) - math.dist(q, s)) > accepted:
                    yield f"the distance of {p} and {r} changed"
        for d, e in self.directions:
            if max(abs(a - b) for a, b in zip(turn(d), e)) > 1e-12:
                yield f"the direction {d} did not turn to {e}"
        for a, b in self.lengths:
            if abs(b - a) > 1e-12 * abs(a):
                yield f"a length changed from {a} to {b}"
        gram = [[sum(m[k][i] * m[k][j] for k in range(3)) - (i == j) for j in range(3)] for i in range(3)]
        if max(abs(c) for row in gram for c in row) > 1e-12:
            yield "the matrix is not orthogonal"
        cross = [m[1][1] * m[2][2] - m[1][2] * m[2][1], m[1][2] * m[2][0] - m[1][0] * m[2][2],
                 m[1][0] * m[2][1] - m[1][1] * m[2][0]]
        if sum(a * b for a, b in zip(m[0], cross)) <= 0:
            yield "the motion mirrors"


def verify(sheet, before, after):
    if sheet["version"] != 1:
        yield f"version {sheet['version']} is not known"
        return
    for claim, records in ((sheet["before"], before), (sheet["after"], after)):
        if hashlib.sha256(records.bytes).hexdigest() != claim["sha256"]:
            yield f"{claim['name']} is another file"
    if not any(group["entities"] for group in sheet["groups"]):
        yield "the sheet claims nothing"
    for group in sheet["groups"]:
        m, t = group["motion"]["matrix"], group["motion"]["translation"]
        identity = m == [[1, 0, 0], [0, 1, 0], [0, 0, 1]] and t == [0, 0, 0]
        copy = Copy(before, after)
        for entity in group["entities"]:
            name = int(entity["record"][1:])
            try:
                for when, records in (("before", before), ("after", after)):
                    if records.digest(name) != entity[when]:
                        yield f"{entity['record']}: another digest {when}"
                if identity and entity["before"] != entity["after"]:
                    yield f"{entity['record']}: is claimed to stay, and changed"
                copy.add(name, name)
            except (ValueError, KeyError, AssertionError) as error:
                yield f"{entity['record']}: {error}"
        if copy.points:
            yield from copy.faults(m, t)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    sheet = json.load(open(sys.argv[1], encoding="utf-8"))
    faults = list(verify(sheet, Records(sys.argv[2]), Records(sys.argv[3])))
    for fault in faults[:20]:
        print("fault:", fault)
    print("not proved" if faults else "proved", sum(len(g["entities"]) for g in sheet["groups"]), "entities")
    sys.exit(1 if faults else 0)


main()
