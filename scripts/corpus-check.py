#!/usr/bin/env python3
"""Compares a table of scripts/corpus.sh with readers that share nothing with the program.

    scripts/corpus-check.py DIR OUTCOMES.tsv

Reads each OBJ, STL, OFF, PLY and 3MF file of the table that the program has read, with nothing but
Python's standard library, and compares the number of triangles (a polygon of n corners has n - 2)
and the box around the corners of all polygons, within 1e-5 of its size. Prints the files that
differ, and why these readers gave up where they did. The status is 1 when a file differs.
"""

import math
import re
import struct
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree


class NotRead(Exception):
    """This reader doesn't know how; nothing is said about the file."""


def text_of(data):
    return data.decode("utf-8-sig", "replace").replace("\r\n", "\n").replace("\r", "\n")


def read_obj(path):
    points, polygons = [], []
    text = re.sub(r"\\\n", " ", text_of(path.read_bytes()))
    for line in text.split("\n"):
        words = line.split("#")[0].split()
        if not words:
            continue
        if words[0] == "v":
            points.append(tuple(map(float, words[1:4])))
        elif words[0] == "f" and len(words) > 3:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            polygons.append([c - 1 if c > 0 else len(points) + c for c in corners])
        elif words[0] in ("curv", "surf", "call"):
            raise NotRead(words[0])
    return points, polygons


def read_stl(path):
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else None
    if count is not None and len(data) >= 84 + 50 * count and count > 0:
        points = []
        for facet in range(count):
            values = struct.unpack_from("<9f", data, 84 + 50 * facet + 12)
            points += [values[0:3], values[3:6], values[6:9]]
    elif data.lstrip()[:5] == b"solid":
        numbers = re.findall(r"vertex\s+(\S+)\s+(\S+)\s+(\S+)", text_of(data))
        points = [tuple(map(float, n)) for n in numbers]
    else:
        raise NotRead("neither kind of STL")
    return points, [[i, i + 1, i + 2] for i in range(0, len(points) - 2, 3)]


def read_off(path):
    data = path.read_bytes()
    lines = [line.split("#")[0].split() for line in text_of(data).split("\n")]
    words = [word for line in lines for word in line]
    head = words.pop(0)
    if not re.fullmatch(r"(ST|C|N)*OFF", head) or words[0] == "BINARY":
        raise NotRead(head)
    extra = {"C": 4, "N": 3}
    if "ST" in head or "C" in head:
        raise NotRead(head)
    per_point = 3 + sum(extra[c] for c in head[:-3])
    n_points, n_polygons = int(words[0]), int(words[1])
    at = 3
    points = []
    for _ in range(n_points):
        points.append(tuple(map(float, words[at:at + 3])))
        at += per_point
    # What stands behind the corners of a face (its colour) ends with the line.
    rows = [line for line in lines if line]
    rows = rows[len(rows) - n_polygons:]
    polygons = [list(map(int, row[1:1 + int(row[0])])) for row in rows]
    return points, [p for p in polygons if len(p) > 2]


PLY_TYPES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h",
             "ushort": "H", "uint16": "H", "int": "i", "int32": "i", "uint": "I", "uint32": "I",
             "float": "f", "float32": "f", "double": "d", "float64": "d"}


def read_ply(path):
    data = path.read_bytes()
    end = re.search(rb"end_header[ \t]*(\r\n|\n|\r)", data)
    head = data[:end.start()].decode("latin1").replace("\r", "\n").split("\n")
    body = data[end.end():]
    kind, elements = None, []
    for line in head:
        words = line.split()
        if words[:1] == ["format"]:
            kind = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    if kind == "ascii":
        tokens = iter(body.split())

        def scalar(kind_of):
            token = next(tokens)
            return float(token) if PLY_TYPES[kind_of] in "fd" else int(float(token))
    else:
        order, at = ("<" if "little" in kind else ">"), [0]

        def scalar(kind_of):
            code = order + PLY_TYPES[kind_of]
            value = struct.unpack_from(code, body, at[0])[0]
            at[0] += struct.calcsize(code)
            return value
    points, polygons = [], []
    for name, count, properties in elements:
        for _ in range(count):
            row = {}
            for prop in properties:
                if prop[0] == "list":
                    row[prop[3]] = [scalar(prop[2]) for _ in range(scalar(prop[1]))]
                else:
                    row[prop[1]] = scalar(prop[0])
            if name == "vertex":
                points.append((row["x"], row["y"], row["z"]))
            elif name == "face":
                corners = row.get("vertex_indices", row.get("vertex_index"))
                if len(corners) > 2:
                    polygons.append(corners)
            elif name == "tristrips":
                raise NotRead("strips")
    return points, polygons


def read_3mf(path):
    with zipfile.ZipFile(path) as archive:
        names = [n for n in archive.namelist() if n.lower().endswith(".model")]
        if len(names) != 1:
            raise NotRead(f"{len(names)} model parts")
        root = ElementTree.fromstring(archive.read(names[0]))
    space = root.tag.split("}")[0] + "}"
    objects = {o.get("id"): o for o in root.iter(space + "object")}

    def matrix(text):
        return tuple(map(float, text.split())) if text else (1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)

    def move(m, p):
        return tuple(p[0] * m[k] + p[1] * m[3 + k] + p[2] * m[6 + k] + m[9 + k] for k in range(3))

    points, polygons = [], []

    def add(number, chain):
        mesh = objects[number].find(space + "mesh")
        if mesh is not None:
            first = len(points)
            for v in mesh.iter(space + "vertex"):
                p = (float(v.get("x")), float(v.get("y")), float(v.get("z")))
                for m in chain:
                    p = move(m, p)
                points.append(p)
            for t in mesh.iter(space + "triangle"):
                polygons.append([first + int(t.get(k)) for k in ("v1", "v2", "v3")])
        for c in objects[number].iter(space + "component"):
            add(c.get("objectid"), [matrix(c.get("transform"))] + chain)

    for item in root.iter(space + "item"):
        add(item.get("objectid"), [matrix(item.get("transform"))])
    return points, polygons


READERS = {".obj": read_obj, ".stl": read_stl, ".off": read_off, ".ply": read_ply, ".3mf": read_3mf}


def differences(path, row):
    points, polygons = READERS[path.suffix.lower()](path)
    triangles = sum(len(p) - 2 for p in polygons)
    used = [points[c] for p in polygons for c in p]
    if not used:
        return None if row["triangles"] == "-" else "no polygons"
    if str(triangles) != row["triangles"]:
        return f"{triangles} triangles, the program has {row['triangles']}"
    box = [[f(p[k] for p in used) for k in range(3)] for f in (min, max)]
    size = math.dist(*box) + 1e-6 * max(abs(c) for corner in box for c in corner)
    for own, text in zip(box, (row["low"], row["high"])):
        theirs = list(map(float, text.split(",")))
        if max(abs(a - b) for a, b in zip(own, theirs)) > 1e-5 * size:
            return f"a corner at {own}, the program has {theirs}"
    return None


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: scripts/corpus-check.py DIR OUTCOMES.tsv")
    folder = Path(sys.argv[1])
    compared, gave_up, differ = 0, 0, 0
    for line in Path(sys.argv[2]).read_text(errors="replace").splitlines():
        cells = line.split("\t")
        row = dict(zip(("file", "info", "render", "draw", "visible", "triangles", "low", "high"),
                       cells))
        path = folder / row["file"]
        if row["info"] != "ok" or path.suffix.lower() not in READERS:
            continue
        try:
            what = differences(path, row)
        except Exception as error:  # a reader of ten lines is easily at a loss
            gave_up += 1
            print(f"not compared: {row['file']}: {type(error).__name__}: {error}")
            continue
        compared += 1
        if what:
            differ += 1
            print(f"differs: {row['file']}: {what}")
    print(f"{compared} files compared, {differ} differ, {gave_up} not compared")
    sys.exit(1 if differ else 0)


if __name__ == "__main__":
    main()
