#!/usr/bin/env python3
"""Writes the sample models of samples/ (all of our own making; licence as the project's).

    scripts/make_samples.py [FOLDER]        (default: samples/ of the repository)

Only the standard library; the same bytes on every run. All models are +Y up with counter-clockwise
front faces, and closed unless said otherwise.
"""

import json
import math
import pathlib
import struct
import sys
import zlib

TAU = 2 * math.pi


def number(value):
    """Shortest text of a coordinate at a millionth, without a negative zero."""
    return f"{round(value, 6) + 0.0:g}"


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def add(a, b, factor=1.0):
    return tuple(x + factor * y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return tuple(x / length for x in a)


class Mesh:
    """Polygons over joined vertices, in named objects with a material each."""

    def __init__(self):
        self.vertices = []
        self.objects = []
        self._index = {}

    def begin(self, name, material=None):
        self.objects.append((name, material, []))

    def vertex(self, point):
        key = tuple(number(c) for c in point)
        if key not in self._index:
            self._index[key] = len(self.vertices)
            self.vertices.append(key)
        return self._index[key]

    def face(self, *points):
        self.objects[-1][2].append([self.vertex(p) for p in points])

    def grid(self, point, columns, rows, wrap_columns=False, wrap_rows=False):
        """Quads over point(i, j); their front is (d/di) x (d/dj)."""
        for j in range(rows if wrap_rows else rows - 1):
            for i in range(columns if wrap_columns else columns - 1):
                k, m = (i + 1) % columns, (j + 1) % rows
                self.face(point(i, j), point(k, j), point(k, m), point(i, m))

    def box(self, lo, hi):
        x0, y0, z0 = lo
        x1, y1, z1 = hi
        self.prism([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], lambda u, v, w: (u, v, w), z0, z1)

    def prism(self, outline, place, lo, hi):
        """An outline, counter-clockwise seen from +w, extruded from w = lo to hi. `place` maps
        (u, v, w) to the world and must keep handedness."""
        self.face(*[place(u, v, hi) for u, v in outline])
        self.face(*[place(u, v, lo) for u, v in reversed(outline)])
        for (u0, v0), (u1, v1) in zip(outline, outline[1:] + outline[:1]):
            self.face(place(u0, v0, lo), place(u1, v1, lo), place(u1, v1, hi), place(u0, v0, hi))

    def obj(self, title, library=None):
        lines = [f"# {title}"]
        if library:
            lines.append(f"mtllib {library}")
        lines += ["v " + " ".join(v) for v in self.vertices]
        for name, material, faces in self.objects:
            lines.append(f"o {name}")
            if material:
                lines.append(f"usemtl {material}")
            lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
        return "\n".join(lines) + "\n"


def materials(title, table):
    """An MTL file; colours are sRGB-like triples, as the format's habit is."""
    lines = [f"# {title}"]
    for name, color in table.items():
        lines += [f"newmtl {name}", "Kd " + " ".join(number(c) for c in color), "d 1"]
    return "\n".join(lines) + "\n"


def ply(title, properties, rows, faces):
    head = ["ply", "format ascii 1.0", f"comment {title}", f"element vertex {len(rows)}"]
    head += [f"property {kind} {name}" for kind, name in properties]
    head += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    body = [" ".join(row) for row in rows]
    body += [" ".join(str(i) for i in [len(face), *face]) for face in faces]
    return "\n".join(head + body) + "\n"


def knot():
    """A tube around a trefoil knot: quads, no boundary."""

    def centre(t):
        return (math.sin(t) + 2 * math.sin(2 * t), math.cos(t) - 2 * math.cos(2 * t),
                -math.sin(3 * t))

    def point(i, j, columns=20, rows=160, radius=0.42):
        t, step = TAU * j / rows, 1e-4
        along = unit(add(centre(t + step), centre(t - step), -1))
        # The knot winds round the z axis and never runs towards it, so that is a steady guide.
        side = unit(cross(along, (0, 0, 1)))
        other = cross(side, along)
        angle = TAU * i / columns
        offset = add(tuple(math.cos(angle) * s for s in side), other, math.sin(angle))
        return add(centre(t), offset, radius)

    mesh = Mesh()
    mesh.begin("knot")
    mesh.grid(lambda i, j: point(-i, j), 20, 160, wrap_columns=True, wrap_rows=True)
    return {"knot.obj": mesh.obj("A tube around a trefoil knot.")}


def arc(centre, radius, begin, end, steps):
    """Points of a circle from angle begin to end (degrees), both included."""
    return [(centre[0] + radius * math.cos(math.radians(begin + (end - begin) * k / steps)),
             centre[1] + radius * math.sin(math.radians(begin + (end - begin) * k / steps)))
            for k in range(steps + 1)]


def bracket():
    """An angle bracket with a fillet and three drilled holes. A face with holes is two concave
    polygons that meet on the line through the holes' centres."""
    width, depth, height, thick, fillet = 60.0, 50.0, 46.0, 8.0, 8.0
    steps = 16
    mesh = Mesh()
    mesh.begin("bracket")

    # Each plate is drawn in its own plane (x, v), v running away from the bend; `lift` puts
    # (x, v, w) into the world, where w = 0 is the outer face and w = thick the inner one.
    def base(x, v, w):
        return (x, w, v)

    def upright(x, v, w):
        return (x, v, w)

    plates = [
        (base, depth, 30.0, [(15.0, 6.0), (45.0, 6.0)]),
        (upright, height, 28.0, [(30.0, 11.0)]),
    ]
    for lift, end, line, holes in plates:
        for w, begin in ((0.0, 0.0), (thick, thick + fillet)):
            near = [(0.0, line), (0.0, begin), (width, begin), (width, line)]
            for x, radius in reversed(holes):
                near += arc((x, line), radius, 0, -180, steps)
            far = [(width, line), (width, end), (0.0, end), (0.0, line)]
            for x, radius in holes:
                far += arc((x, line), radius, 180, 0, steps)
            for outline in (near, far):
                # Counter-clockwise in (x, v): for `upright` that faces +w, for `base` -w.
                if (lift is upright) == (w == 0.0):
                    outline = outline[::-1]
                mesh.face(*[lift(x, v, w) for x, v in outline])
        for x, radius in holes:
            ring = arc((x, line), radius, 0, 360, 2 * steps)
            for (x0, v0), (x1, v1) in zip(ring, ring[1:]):
                wall = [lift(x0, v0, 0), lift(x0, v0, thick), lift(x1, v1, thick), lift(x1, v1, 0)]
                mesh.face(*(wall if lift is upright else wall[::-1]))

    # The profile in (z, y), with the points where the lines of the holes meet it.
    bend = arc((thick + fillet, thick + fillet), fillet, 270, 180, 12)
    profile = [(0, 0), (30.0, 0), (depth, 0), (depth, thick), (30.0, thick), *bend,
               (thick, 28.0), (thick, height), (0, height), (0, 28.0)]
    mesh.face(*[(0.0, y, z) for z, y in profile])
    mesh.face(*[(width, y, z) for z, y in reversed(profile)])
    narrow = [((depth, 0), (depth, thick)), ((thick, height), (0, height)), *zip(bend, bend[1:])]
    for (z0, y0), (z1, y1) in narrow:
        mesh.face((0.0, y0, z0), (width, y0, z0), (width, y1, z1), (0.0, y1, z1))
    return {"bracket.obj": mesh.obj("An angle bracket with drilled holes; millimetres.")}


def house():
    """A house of named objects with materials."""
    mesh = Mesh()
    mesh.begin("ground", "grass")
    mesh.box((-8, -0.3, -7), (8, 0, 7))
    mesh.begin("path", "stone")
    mesh.box((-1, 0, 3), (1, 0.06, 7))
    mesh.begin("walls", "plaster")
    gable = [(-4, 0), (4, 0), (4, 3.2), (0, 6.2), (-4, 3.2)]
    mesh.prism(gable, lambda u, v, w: (u, v, w), -3, 3)
    mesh.begin("roof", "tiles")
    # Two slabs that follow the gable's slope, 0.3 thick, as one angle.
    angle = [(0, 6.25), (-4.8, 2.65), (-4.8, 3.05), (0, 6.65), (4.8, 3.05), (4.8, 2.65)]
    mesh.prism(angle[::-1], lambda u, v, w: (u, v, w), -3.5, 3.5)
    mesh.begin("chimney", "brick")
    mesh.box((1.6, 3.8, -1.8), (2.5, 7.2, -0.9))
    mesh.begin("door", "wood")
    mesh.box((-0.7, 0, 3), (0.7, 2.2, 3.12))
    for name, place in {
        "window_front_left": lambda u, v, w: (u - 2.4, v + 1.2, 3 + w),
        "window_front_right": lambda u, v, w: (u + 2.4, v + 1.2, 3 + w),
        "window_gable": lambda u, v, w: (0.8 * u, v + 3.4, 3 + w),
        "window_side_front": lambda u, v, w: (4 + w, v + 1.2, 1.4 - u),
        "window_side_back": lambda u, v, w: (4 + w, v + 1.2, -1.4 - u),
    }.items():
        mesh.begin(name, "frame")
        mesh.prism([(-0.75, 0), (0.75, 0), (0.75, 1.3), (-0.75, 1.3)], place, 0, 0.08)
        mesh.begin(name + "_panes", "glass")
        for u0, u1 in ((-0.65, -0.05), (0.05, 0.65)):
            for v0, v1 in ((0.1, 0.6), (0.7, 1.2)):
                mesh.prism([(u0, v0), (u1, v0), (u1, v1), (u0, v1)], place, 0.08, 0.1)
    for name, x, z, size in (("tree_left", -6.2, 4.2, 1.0), ("tree_right", 6.3, 3.6, 0.8),
                             ("tree_back", 6.2, -4.6, 1.2)):
        mesh.begin(name + "_trunk", "wood")
        hexagon = [(0.3 * size * math.cos(TAU * k / 6), 0.3 * size * math.sin(TAU * k / 6))
                   for k in range(6)]

        def place(u, v, w, x=x, z=z):
            return (x + u, w, z - v)

        mesh.prism(hexagon, place, 0, 1.1 * size)
        mesh.begin(name, "leaves")
        for low, high, radius in ((0.9, 2.9, 1.5), (2.0, 3.8, 1.2), (3.0, 4.6, 0.85)):
            ring = [(x + radius * size * math.cos(TAU * k / 12), low * size,
                     z - radius * size * math.sin(TAU * k / 12)) for k in range(12)]
            mesh.face(*reversed(ring))
            for a, b in zip(ring, ring[1:] + ring[:1]):
                mesh.face(a, b, (x, high * size, z))
    colors = {
        "grass": (0.36, 0.55, 0.26), "stone": (0.62, 0.6, 0.57), "plaster": (0.93, 0.89, 0.8),
        "tiles": (0.7, 0.27, 0.19), "brick": (0.58, 0.3, 0.24), "wood": (0.42, 0.28, 0.17),
        "frame": (0.97, 0.97, 0.95), "glass": (0.25, 0.42, 0.58), "leaves": (0.18, 0.4, 0.22),
    }
    return {"house.obj": mesh.obj("A house with named objects.", "house.mtl"),
            "house.mtl": materials("Colours of house.obj.", colors)}


def pawn():
    """A chess pawn: a surface of revolution with vertex normals."""
    # Half profile (radius, height) from the axis below to the axis above, as smooth runs.
    runs = [
        [(0.0, 0.0), (1.0, 0.0)],
        [(1.0, 0.0), (1.02, 0.12), (1.0, 0.24)],
        [(1.0, 0.24), (0.93, 0.3), (0.86, 0.3)],
        [(0.86, 0.3), (0.8, 0.46), (0.62, 0.62), (0.46, 0.86), (0.36, 1.2), (0.31, 1.55),
         (0.32, 1.72)],
        [(0.32, 1.72), (0.52, 1.76), (0.56, 1.83), (0.52, 1.9), (0.3, 1.93)],
        arc((0.0, 2.3), 0.48, -50, 90, 12),
    ]
    runs[-1][-1] = (0.0, runs[-1][-1][1])
    runs[4][-1] = runs[5][0]
    segments = 48
    rows, faces = [], []
    for run in runs:
        ring_of = []
        for k, (radius, height) in enumerate(run):
            before, after = run[max(k - 1, 0)], run[min(k + 1, len(run) - 1)]
            du, dv = after[0] - before[0], after[1] - before[1]
            length = math.hypot(du, dv)
            ring = []
            for s in range(segments):
                turn = TAU * s / segments
                direction = (math.cos(turn), -math.sin(turn))
                values = (radius * direction[0], height, radius * direction[1],
                          dv / length * direction[0], -du / length, dv / length * direction[1])
                ring.append(len(rows))
                rows.append([number(value) for value in values])
                if radius == 0.0:
                    # One vertex on the axis; the normal there is the axis itself.
                    rows[-1][3:] = ["0", "-1" if height == 0 else "1", "0"]
                    ring = ring * segments
                    break
            ring_of.append(ring)
        for low, high in zip(ring_of, ring_of[1:]):
            for s in range(segments):
                t = (s + 1) % segments
                corners = [low[s], low[t], high[t], high[s]]
                faces.append([c for k, c in enumerate(corners) if c not in corners[:k]])
    properties = [("float", name) for name in ("x", "y", "z", "nx", "ny", "nz")]
    return {"pawn.ply": ply("A chess pawn, turned on a lathe.", properties, rows, faces)}


def chess():
    """A board of 6 x 6 squares, and a scene file that puts pawns and the knot on it."""
    mesh = Mesh()
    count, side = 6, 2.4
    half = count * side / 2
    mesh.begin("frame", "walnut")
    mesh.box((-half - 0.5, -0.9, -half - 0.5), (half + 0.5, -0.2, half + 0.5))
    for shade, name in enumerate(("ivory", "ebony")):
        mesh.begin("squares_" + name, name)
        for i in range(count):
            for j in range(shade ^ (i & 1), count, 2):
                x, z = i * side - half, j * side - half
                mesh.box((x, -0.2, z), (x + side, 0, z + side))
    colors = {"walnut": (0.3, 0.17, 0.1), "ivory": (0.9, 0.84, 0.7), "ebony": (0.2, 0.17, 0.16)}

    def pawn_at(name, column, row, color):
        place = [round((k + 0.5) * side - half, 3) for k in (column, row)]
        return {"path": "pawn.ply", "name": name,
                "transform": [{"translate": [place[0], 0, place[1]]}],
                "material": {"base_color": color, "specular": 0.5, "shininess": 60}}

    white, black = "#ece3cf", "#4a3f3a"
    models = [{"path": "board.obj"}]
    models += [pawn_at(f"white {k + 1}", k, 4 - (k == 2), white) for k in (0, 1, 2, 4, 5)]
    models += [pawn_at(f"black {k + 1}", k, 1 + (k == 3), black) for k in (0, 1, 3, 4, 5)]
    models.append({
        "path": "knot.obj", "name": "knot",
        "transform": [{"scale": 0.5}, {"rotate": {"axis": [0, 1, 0], "degrees": 25}},
                      {"translate": [1.2, 1.42, 1.2]}],
        "material": {"base_color": "#c8552b", "specular": 0.6, "shininess": 80},
    })
    scene = {
        "models": models,
        "lights": [
            {"type": "directional", "direction": [-0.6, -1, -0.4], "intensity": 0.75},
            {"type": "point", "position": [-12, 9, 10], "color": "#ffd9a8", "intensity": 0.4},
            {"type": "headlight", "intensity": 0.15},
        ],
        "camera": {"eye": [10.5, 11.5, 19], "target": [0.2, -0.6, 0.7], "fov": 40},
    }
    return {"board.obj": mesh.obj("A board of squares.", "board.mtl"),
            "board.mtl": materials("Colours of board.obj.", colors),
            "scene.json": json.dumps(scene, indent=2) + "\n"}


def crossing():
    """Three bars that overlap in a cycle, so that no order of painting is right, pierced by a
    plate that is not closed."""
    mesh = Mesh()
    for k, name in enumerate(("red", "green", "blue")):
        angle = TAU * k / 3
        along, side = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))

        def place(u, v, w):
            # v moves the bar off the centre; it rises along u, so each lies over the next.
            x, y = u * along[0] + (v - 0.75) * side[0], u * along[1] + (v - 0.75) * side[1]
            return (x, y, w + 0.3 * u)

        mesh.begin(f"bar_{name}", name)
        mesh.prism([(-2.6, -0.3), (2.6, -0.3), (2.6, 0.3), (-2.6, 0.3)], place, -0.1, 0.1)
    mesh.begin("plate", "yellow")
    mesh.face((-1.9, -0.5, -1.0), (1.5, -1.6, -1.0), (1.9, 0.6, 1.0), (-1.5, 1.7, 1.0))
    colors = {"red": (0.8, 0.22, 0.18), "green": (0.25, 0.6, 0.3), "blue": (0.2, 0.36, 0.75),
              "yellow": (0.92, 0.76, 0.25)}
    return {"crossing.obj": mesh.obj("A cyclic overlap and a plate through it.", "crossing.mtl"),
            "crossing.mtl": materials("Colours of crossing.obj.", colors)}


def tee():
    """A pipe with a thinner one through it, each closed: their surfaces cross."""
    mesh = Mesh()

    def ring(radius, steps):
        return [(radius * math.cos(TAU * k / steps), radius * math.sin(TAU * k / steps))
                for k in range(steps)]

    mesh.begin("pipe", "steel")
    mesh.prism(ring(1.0, 64), lambda u, v, w: (v, w, u), -2.0, 2.0)
    mesh.begin("branch", "brass")
    mesh.prism(ring(0.6, 48), lambda u, v, w: (w, u, v), -2.2, 2.2)
    colors = {"steel": (0.56, 0.62, 0.7), "brass": (0.83, 0.66, 0.3)}
    return {"tee.obj": mesh.obj("Two pipes that cross.", "tee.mtl"),
            "tee.mtl": materials("Colours of tee.obj.", colors)}


def decal():
    """A wall with a poster and a sign that lie exactly in its plane. The lower id wins a tie, so
    the decals come before the wall. Not closed."""
    mesh = Mesh()

    def sheet(u0, v0, u1, v1):
        # A plane that no axis is parallel to, so that its corners are rounded in the file.
        def place(u, v):
            return (u * 0.8 + v * 0.2, v * 0.9 + u * 0.1, u * -0.6 + v * 0.3)

        mesh.face(place(u0, v0), place(u1, v0), place(u1, v1), place(u0, v1))

    mesh.begin("disc", "white")
    mesh.face(*[(u * 0.8 + v * 0.2, v * 0.9 + u * 0.1, u * -0.6 + v * 0.3)
                for u, v in arc((1.1, 1.6), 0.55, 0, 345, 23)])
    mesh.begin("poster", "red")
    sheet(0.3, 0.8, 1.9, 2.4)
    mesh.begin("stripe", "dark")
    sheet(-3, 0.15, 3, 0.4)
    mesh.begin("sign", "blue")
    sheet(-2.4, 1.0, -0.6, 1.9)
    mesh.begin("wall", "plaster")
    for column in range(6):
        for row in range(3):
            sheet(column - 3, row, column - 2, row + 1)
    colors = {"white": (0.97, 0.97, 0.95), "red": (0.78, 0.2, 0.16), "dark": (0.2, 0.22, 0.25),
              "blue": (0.16, 0.36, 0.66), "plaster": (0.88, 0.84, 0.74)}
    return {"decal.obj": mesh.obj("Decals in the plane of a wall.", "decal.mtl"),
            "decal.mtl": materials("Colours of decal.obj.", colors)}


def noise(x, y):
    """Smooth value noise in 0..1 on the integer lattice, from an integer hash."""

    def lattice(i, j):
        h = (i * 374761393 + j * 668265263) & 0xFFFFFFFF
        h = ((h ^ (h >> 13)) * 1274126177) & 0xFFFFFFFF
        return ((h ^ (h >> 16)) & 0xFFFF) / 0xFFFF

    i, j = math.floor(x), math.floor(y)
    u, v = x - i, y - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    low = lattice(i, j) * (1 - u) + lattice(i + 1, j) * u
    high = lattice(i, j + 1) * (1 - u) + lattice(i + 1, j + 1) * u
    return low * (1 - v) + high * v


def terrain():
    """A height field with vertex colours. Not closed."""
    size, span = 72, 12.0

    def height(i, j):
        x, y = 4.0 * i / size + 9, 4.0 * j / size + 4
        value = sum(noise(x * 2**k, y * 2**k) / 2.4**k for k in range(4)) / 1.65
        rim = math.hypot(2 * i / (size - 1) - 1, 2 * j / (size - 1) - 1)
        return max(0.0, value - 0.18 - 0.42 * rim**2) * 6.5

    def color(h):
        stops = [(0.0, (52, 101, 150)), (0.02, (196, 184, 138)), (0.5, (98, 138, 70)),
                 (1.7, (112, 98, 80)), (2.3, (150, 144, 136)), (2.6, (244, 246, 248))]
        for (h0, c0), (h1, c1) in zip(stops, stops[1:]):
            if h <= h1:
                t = (h - h0) / (h1 - h0)
                return [round(a + (b - a) * t) for a, b in zip(c0, c1)]
        return stops[-1][1]

    rows, faces = [], []
    for j in range(size):
        for i in range(size):
            h = height(i, j)
            x, z = span * (i / (size - 1) - 0.5), span * (j / (size - 1) - 0.5)
            place = [f"{round(c, 3) + 0.0:g}" for c in (x, h, z)]
            rows.append(place + [str(c) for c in color(h)])
    for j in range(size - 1):
        for i in range(size - 1):
            a = j * size + i
            faces.append([a, a + size, a + size + 1, a + 1])
    properties = [("float", n) for n in "xyz"] + [("uchar", n) for n in ("red", "green", "blue")]
    return {"terrain.ply": ply("A height field.", properties, rows, faces)}


def mountains():
    """A height map, 16-bit grey: ridges where octaves of noise change their sign, higher the nearer
    to the middle, so that there is a summit to look from."""
    side, octaves = 400, 8

    def height(x, y):
        total, share, step, weight = 0.0, 1.0, 4.0 / side, 1.0
        for octave in range(octaves):
            ridge = 1 - abs(2 * noise(x * step + 17 * octave, y * step + 31 * octave) - 1)
            ridge *= ridge * weight
            weight = min(1.0, 1.6 * ridge)
            total += share * ridge
            share *= 0.48
            step *= 2.03
        away = math.hypot(x - side / 2, y - side / 2) / side
        return total * (1.15 - 1.1 * away)

    heights = [[height(x, y) for x in range(side)] for y in range(side)]
    low, high = min(map(min, heights)), max(map(max, heights))
    rows = b"".join(b"\0" + struct.pack(f">{side}H", *(
        round(3000 * (h - low) / (high - low)) for h in row)) for row in heights)

    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data
                + struct.pack(">I", zlib.crc32(kind + data)))

    # Zlib's bytes may differ from one version to the next, those of stored blocks do not; but they
    # would be twice as many, and pictures are read by what they show.
    return {"mountains.png": b"\x89PNG\r\n\x1a\n"
            + chunk(b"IHDR", struct.pack(">2I5B", side, side, 16, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")}


def staircase():
    """A spiral staircase: two meshes, placed many times by the nodes of a binary glTF file."""
    treads, turn, rise = 22, math.radians(18), 0.2

    def mesh_arrays(outline, lo, hi):
        mesh = Mesh()
        mesh.begin("part")
        mesh.prism(outline, lambda u, v, w: (u, w, -v), lo, hi)
        points = [tuple(float(c) for c in v) for v in mesh.vertices]
        indices = [i for face in mesh.objects[0][2]
                   for k in range(1, len(face) - 1) for i in (face[0], face[k], face[k + 1])]
        return points, indices

    half = math.radians(10.5)
    wedge = [(0.0, -0.12), (2.2 * math.cos(half), -2.2 * math.sin(half)),
             (2.2 * math.cos(half), 2.2 * math.sin(half)), (0.0, 0.12)]
    post = arc((0, 0), 0.16, 0, 345, 23)
    top = treads * rise + 0.5
    rail = [(x + 2.1, y) for x, y in arc((0, 0), 0.03, 0, 315, 7)]
    parts = {"tread": mesh_arrays(wedge, 0, 0.07), "post": mesh_arrays(post, 0, top),
             "rail": mesh_arrays(rail, 0.07, 0.95)}

    data, views, accessors, meshes = b"", [], [], []

    def accessor(packed, target, kind, component, count, extra):
        nonlocal data
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed),
                      "target": target})
        accessors.append({"bufferView": len(views) - 1, "componentType": component,
                          "count": count, "type": kind, **extra})
        data += packed + b"\0" * (-len(packed) % 4)
        return len(accessors) - 1

    for material, (name, (points, indices)) in enumerate(parts.items()):
        bounds = {"min": [min(p[k] for p in points) for k in range(3)],
                  "max": [max(p[k] for p in points) for k in range(3)]}
        packed = b"".join(struct.pack("<3f", *p) for p in points)
        position = accessor(packed, 34962, "VEC3", 5126, len(points), bounds)
        packed = b"".join(struct.pack("<H", i) for i in indices)
        index = accessor(packed, 34963, "SCALAR", 5123, len(indices), {})
        meshes.append({"name": name, "primitives": [
            {"attributes": {"POSITION": position}, "indices": index, "material": material}]})

    nodes = [{"name": "post", "mesh": 1}]
    for k in range(treads):
        # A quarter of a full turn of a quaternion about +Y is half of the angle.
        spin = [0, round(math.sin(k * turn / 2), 7), 0, round(math.cos(k * turn / 2), 7)]
        nodes.append({"name": f"tread_{k}", "mesh": 0, "translation": [0, round(k * rise, 3), 0],
                      "rotation": spin, "children": [treads + 1 + k]})
    nodes += [{"name": f"rail_{k}", "mesh": 2} for k in range(treads)]

    def paint(name, *color):
        return {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*color, 1],
                                                       "metallicFactor": 0}}

    document = {
        "asset": {"version": "2.0", "generator": "make_samples.py"}, "scene": 0,
        "scenes": [{"nodes": list(range(treads + 1))}], "nodes": nodes, "meshes": meshes,
        "materials": [paint("oak", 0.55, 0.33, 0.16), paint("steel", 0.25, 0.28, 0.32),
                      paint("brass", 0.7, 0.52, 0.2)],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = (struct.pack("<I4s", len(text), b"JSON") + text
              + struct.pack("<I4s", len(data), b"BIN\0") + data)
    return {"staircase.glb": struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks}


def main():
    default = pathlib.Path(__file__).resolve().parent.parent / "samples"
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else default
    folder.mkdir(parents=True, exist_ok=True)
    for make in (knot, bracket, house, pawn, chess, crossing, tee, decal, terrain, mountains,
                 staircase):
        for name, content in make().items():
            (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


if __name__ == "__main__":
    main()
