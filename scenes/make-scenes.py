#!/usr/bin/env python3
"""Writes the models of grotto's own scenes as glTF 2.0, with Python's library alone.

The .gltf files beside this script are what it wrote: Python is not needed to
build or run grotto. Everything here and what it writes is CC0 1.0 (public domain).

    make-scenes.py [FOLDER]          writes the models (default: beside the script)
    make-scenes.py --check           compares with what is there

Axes: glTF, metres, +Y up. Triangles are flat shaded, counter-clockwise from the
front. Roughness 1 without metal is pure Lambert to grotto (docs/models.md).
"""
import base64
import json
import math
import os
import random
import struct
import sys


def sub(a, b):
    return [a[i] - b[i] for i in range(3)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(dot(a, a))
    return [x / length for x in a]


class Model:
    """Triangles by material; to_gltf gives one primitive for each material."""

    def __init__(self, description):
        self.description = description
        self.materials = []
        self.triangles = {}

    def material(self, name, color, roughness=1.0, metallic=0.0, emission=None):
        entry = {
            "name": name,
            "pbrMetallicRoughness": {
                "baseColorFactor": list(color) + [1.0],
                "metallicFactor": metallic,
                "roughnessFactor": roughness,
            },
        }
        if emission:
            strength = max(emission)
            entry["emissiveFactor"] = [round(e / strength, 6) for e in emission]
            entry["extensions"] = {
                "KHR_materials_emissive_strength": {"emissiveStrength": strength}}
        self.materials.append(entry)
        self.triangles[name] = []
        return name

    def triangle(self, material, a, b, c):
        self.triangles[material].append([[round(x, 4) for x in p] for p in (a, b, c)])

    def polygon(self, material, *corners):
        """A convex polygon, counter-clockwise from the front."""
        for i in range(1, len(corners) - 1):
            self.triangle(material, corners[0], corners[i], corners[i + 1])

    def facing(self, material, towards, *corners):
        """A polygon whose front is turned to the point `towards`."""
        normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]))
        if dot(normal, sub(towards, corners[0])) < 0:
            corners = corners[::-1]
        self.polygon(material, *corners)

    def box(self, material, low, high, turn=0.0, sides="xXyYzZ"):
        """A box seen from outside, turned about its own vertical axis (radians)."""
        middle = [(low[i] + high[i]) / 2 for i in range(3)]
        c, s = math.cos(turn), math.sin(turn)

        def corner(x, y, z):
            p = [(low, high)[x][0] - middle[0], (low, high)[y][1], (low, high)[z][2] - middle[2]]
            return [middle[0] + c * p[0] + s * p[2], p[1], middle[2] - s * p[0] + c * p[2]]

        faces = {
            "x": [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)],
            "X": [(1, 0, 1), (1, 0, 0), (1, 1, 0), (1, 1, 1)],
            "y": [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)],
            "Y": [(0, 1, 1), (1, 1, 1), (1, 1, 0), (0, 1, 0)],
            "z": [(1, 0, 0), (0, 0, 0), (0, 1, 0), (1, 1, 0)],
            "Z": [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        }
        for side in sides:
            self.polygon(material, *[corner(*f) for f in faces[side]])

    def count(self):
        return sum(len(t) for t in self.triangles.values())

    def to_gltf(self):
        data = bytearray()
        views, accessors, primitives, used = [], [], [], []

        def accessor(values, bounds):
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": 12 * len(values),
                          "target": 34962})
            entry = {"bufferView": len(views) - 1, "componentType": 5126, "count": len(values),
                     "type": "VEC3"}
            if bounds:
                entry["min"] = [min(v[i] for v in values) for i in range(3)]
                entry["max"] = [max(v[i] for v in values) for i in range(3)]
            for v in values:
                data.extend(struct.pack("<3f", *v))
            accessors.append(entry)
            return len(accessors) - 1

        for material in self.materials:
            triangles = self.triangles[material["name"]]
            if not triangles:
                continue
            used.append(material)
            points = [p for t in triangles for p in t]
            normals = [unit(cross(sub(t[1], t[0]), sub(t[2], t[0]))) for t in triangles]
            primitives.append({
                "attributes": {"POSITION": accessor(points, True),
                               "NORMAL": accessor([n for n in normals for _ in range(3)], False)},
                "material": len(used) - 1,
            })
        gltf = {
            "asset": {"version": "2.0", "generator": "grotto make-scenes.py",
                      "copyright": "CC0 1.0; " + self.description},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "name": "scene"}],
            "meshes": [{"primitives": primitives}],
            "materials": used,
            "accessors": accessors,
            "bufferViews": views,
            "buffers": [{"byteLength": len(data),
                         "uri": "data:application/octet-stream;base64," +
                                base64.b64encode(bytes(data)).decode("ascii")}],
        }
        if any("extensions" in m for m in used):
            gltf["extensionsUsed"] = ["KHR_materials_emissive_strength"]
        return json.dumps(gltf, indent=1) + "\n"


# The Cornell box as published by the Cornell Program of Computer Graphics
# (https://www.graphics.cornell.edu/online/box/data.html), millimetres times 0.01, so
# that the box is 5.5 m wide and a person fits. Reflectances and lamp are the RGB
# values in common use for it.
CORNELL_BLOCKS = {
    "short": ([(1.30, 0.65), (0.82, 2.25), (2.40, 2.72), (2.90, 1.14)], 1.65),
    "tall": ([(4.23, 2.47), (2.65, 2.96), (3.14, 4.56), (4.72, 4.06)], 3.30),
}


def cornell(lamp):
    m = Model("geometry and reflectances as published by Cornell University")
    white = m.material("white", (0.725, 0.71, 0.68))
    red = m.material("red", (0.63, 0.065, 0.05))
    green = m.material("green", (0.14, 0.45, 0.091))
    tall = m.material("tall", (0.725, 0.71, 0.68))  # white, with a name of its own
    inside = [2.78, 2.7, 2.8]
    top, back = 5.488, 5.592

    m.facing(white, inside, [5.528, 0, 0], [0, 0, 0], [0, 0, back], [5.496, 0, back])
    m.facing(white, inside, [5.496, 0, back], [0, 0, back], [0, top, back], [5.56, top, back])
    m.facing(green, inside, [0, 0, back], [0, 0, 0], [0, top, 0], [0, top, back])
    m.facing(red, inside, [5.528, 0, 0], [5.496, 0, back], [5.56, top, back], [5.56, top, 0])

    def ceiling(material, x0, x1, z0, z1):
        m.facing(material, inside, [x1, top, z0], [x1, top, z1], [x0, top, z1], [x0, top, z0])

    if lamp:
        light = m.material("lamp", (0, 0, 0), emission=(17.0, 12.0, 4.0))
        ceiling(white, 0, 5.56, 0, 2.27)
        ceiling(white, 0, 5.56, 3.32, back)
        ceiling(white, 3.43, 5.56, 2.27, 3.32)
        ceiling(white, 0, 2.13, 2.27, 3.32)
        ceiling(light, 2.13, 3.43, 2.27, 3.32)
    else:
        ceiling(white, 0, 5.56, 0, back)
    for name, (foot, height) in CORNELL_BLOCKS.items():
        paint = tall if name == "tall" else white
        middle = [sum(p[0] for p in foot) / 4, height / 2, sum(p[1] for p in foot) / 4]
        away = lambda p: [2 * p[i] - middle[i] for i in range(3)]
        roof = [[x, height, z] for x, z in foot]
        m.facing(paint, [middle[0], 9, middle[2]], *roof)
        for i in range(4):
            a, b = roof[i], roof[(i + 1) % 4]
            half = [(a[0] + b[0]) / 2, height / 2, (a[2] + b[2]) / 2]
            m.facing(paint, away(half), [a[0], 0, a[2]], a, b, [b[0], 0, b[2]])
    return m


def box(doorway):
    """A room of 8 x 4 x 3 m; a wall 20 cm thick with a doorway, or 2 cm without, parts it at x = 0."""
    m = Model("two halves of a room and a %s" % ("doorway" if doorway else "closed wall"))
    white = m.material("white", (0.75, 0.73, 0.7))
    floor = m.material("floor", (0.5, 0.42, 0.34))
    red = m.material("red", (0.62, 0.12, 0.08))
    blue = m.material("blue", (0.12, 0.25, 0.6))
    wood = m.material("wood", (0.55, 0.36, 0.18))
    x, y, z = 4.0, 3.0, 2.0
    half, door, lintel = (0.1, 0.5, 2.1) if doorway else (0.01, 0, 0)
    inside = [0, 1.5, 0]

    if doorway:
        m.facing(floor, inside, [-x, 0, z], [x, 0, z], [x, 0, -z], [-x, 0, -z])
    else:
        for a, b in ((-x, -half), (half, x)):
            m.facing(floor, inside, [a, 0, z], [b, 0, z], [b, 0, -z], [a, 0, -z])
    for a, b in ((-x, -half), (half, x)):
        m.facing(white, inside, [a, y, z], [b, y, z], [b, y, -z], [a, y, -z])
        for side in (-z, z):
            m.facing(white, inside, [a, 0, side], [b, 0, side], [b, y, side], [a, y, side])
    m.facing(red, inside, [-x, 0, -z], [-x, 0, z], [-x, y, z], [-x, y, -z])
    m.facing(blue, inside, [x, 0, -z], [x, 0, z], [x, y, z], [x, y, -z])
    for side in (-half, half):
        front = [side * 200, 1, 0]
        if not doorway:
            m.facing(white, front, [side, 0, -z], [side, 0, z], [side, y, z], [side, y, -z])
            continue
        for a, b in ((-z, -door), (door, z)):
            m.facing(white, front, [side, 0, a], [side, 0, b], [side, y, b], [side, y, a])
        m.facing(white, front, [side, lintel, -door], [side, lintel, door], [side, y, door],
                 [side, y, -door])
    for side in (-door, door) if doorway else ():
        m.facing(white, [0, 1, 0], [-half, 0, side], [half, 0, side], [half, lintel, side],
                 [-half, lintel, side])
    if doorway:
        m.facing(white, [0, 0, 0], [-half, lintel, -door], [half, lintel, -door],
                 [half, lintel, door], [-half, lintel, door])
    m.box(wood, [-3.2, 0, -1.5], [-2.4, 0.75, -0.7], 0.4, "xXYzZ")
    m.box(white, [2.9, 0, 0.8], [3.5, 1.3, 1.4], -0.5, "xXYzZ")
    m.box(wood, [1.3, 0, -1.7], [2.1, 0.45, -1.2], 0.1, "xXYzZ")
    return m


class Shell:
    """The rock around the grotto, kept to find floor and ceiling over a point."""

    def __init__(self):
        self.triangles = []

    def add(self, *corners):
        self.triangles.append(corners)

    def heights(self, x, z):
        """All heights at which a vertical line meets the rock, from below."""
        found = []
        for a, b, c in self.triangles:
            d = (b[0] - a[0]) * (c[2] - a[2]) - (c[0] - a[0]) * (b[2] - a[2])
            if abs(d) < 1e-9:
                continue
            u = ((x - a[0]) * (c[2] - a[2]) - (c[0] - a[0]) * (z - a[2])) / d
            v = ((b[0] - a[0]) * (z - a[2]) - (x - a[0]) * (b[2] - a[2])) / d
            if u >= 0 and v >= 0 and u + v <= 1:
                found.append(a[1] + u * (b[1] - a[1]) + v * (c[1] - a[1]))
        return sorted(found)


def grotto():
    m = Model("a grotto of about 300 polygons")
    rock = m.material("sandstone", (0.60, 0.47, 0.34))
    dark = m.material("slate", (0.36, 0.36, 0.40))
    moss = m.material("moss", (0.20, 0.42, 0.12))
    rust = m.material("ochre", (0.66, 0.25, 0.11))
    chalk = m.material("chalk", (0.80, 0.77, 0.70))
    water = m.material("water", (0.04, 0.13, 0.17), roughness=0.25)
    crystal = m.material("crystal", (0.10, 0.30, 0.35), emission=(0.6, 2.2, 3.0))
    chance = random.Random(5)
    jitter = lambda size: chance.uniform(-size, size)
    shell = Shell()
    sides = 12

    # Ways out of the round: a deep one to the front (-Z), smaller ones behind and aside.
    def radius(a):
        lobes = ((-math.pi / 2, 2.6, 3.0), (math.radians(35), 1.2, 4.0), (math.radians(160), 1.5, 4.0))
        r = 3.9
        for middle, size, sharp in lobes:
            r += size * math.exp(sharp * (math.cos(a - middle) - 1))
        return r

    def ring(part, height, rough, flat=None):
        points = []
        for i in range(sides):
            a = 2 * math.pi * i / sides + math.pi / sides
            r = flat
            if not flat:
                a += jitter(0.12)
                r = radius(a) * part * (1 + jitter(0.11))
            points.append([r * math.cos(a), height + (jitter(rough) if rough else 0),
                           r * math.sin(a)])
        return points

    # The CAVE stands on the flat middle: 3 x 3 m reach out to 2.12 m.
    rings = [ring(1, 0.0, 0, flat=2.25), ring(0.74, 0.16, 0.14), ring(0.97, 0.95, 0.3),
             ring(1.0, 2.0, 0.35), ring(0.80, 3.15, 0.35), ring(0.40, 3.8, 0.35)]
    bottom, top = [0.0, 0.0, 0.0], [0.1, 4.05, -0.1]
    inside = [0, 1.6, 0]

    def rocky(material, *corners):
        shell.add(*corners)
        m.facing(material, inside, *corners)

    def wall_material(row, i):
        if row == 0:
            return rock
        if row >= 4:
            return dark
        if i in (0, 11):
            return moss
        if i in (5, 6):
            return rust
        return chalk if i in (8, 9) and row > 1 else rock

    for i in range(sides):
        k = (i + 1) % sides
        rocky(rock, bottom, rings[0][i], rings[0][k])
        for row in range(len(rings) - 1):
            a, b, c, d = rings[row][i], rings[row][k], rings[row + 1][k], rings[row + 1][i]
            if (i + row) % 2:
                rocky(wall_material(row, i), a, b, c)
                rocky(wall_material(row, i), a, c, d)
            else:
                rocky(wall_material(row, i), a, b, d)
                rocky(wall_material(row, i), b, c, d)
        rocky(dark, rings[-1][i], rings[-1][k], top)

    # A cone between a round at height `base` and a tip; stands or hangs.
    def spike(material, x, z, base, tip, width, corners=5):
        turn = chance.uniform(0, math.pi)
        lean = [jitter(0.08), jitter(0.08)]
        foot = []
        for i in range(corners):
            a = turn + 2 * math.pi * i / corners
            r = width * (1 + jitter(0.15))
            foot.append([x + r * math.cos(a), base, z + r * math.sin(a)])
        peak = [x + lean[0], tip, z + lean[1]]
        for i in range(corners):
            a, b = foot[i], foot[(i + 1) % corners]
            away = [a[0] + b[0] - x, (base + tip) / 2, a[2] + b[2] - z]
            m.facing(material, away, a, b, peak)

    def stalactite(x, z, length, width):
        roof = shell.heights(x, z)[-1]
        spike(chalk, x, z, roof + 0.15, roof - length, width)

    def stalagmite(x, z, length, width):
        ground = shell.heights(x, z)[0]
        spike(chalk, x, z, ground - 0.05, ground + length, width)

    for x, z, length, width in ((1.9, -2.6, 1.5, 0.24), (-1.5, -2.9, 1.1, 0.2),
                                (0.3, -4.2, 1.6, 0.26), (-2.6, 0.9, 1.2, 0.22),
                                (2.5, 1.2, 0.9, 0.2), (0.5, 2.6, 1.0, 0.2),
                                (-0.8, -3.3, 0.7, 0.15), (1.2, -3.7, 0.8, 0.16)):
        stalactite(x, z, length, width)
    for x, z, length, width in ((2.6, -2.3, 1.0, 0.3), (-2.3, -2.6, 0.7, 0.24),
                                (-3.1, 1.5, 1.2, 0.3), (2.9, 1.9, 0.6, 0.25),
                                (-0.6, 3.0, 0.9, 0.28), (2.1, -3.1, 0.6, 0.22)):
        stalagmite(x, z, length, width)

    # A column, floor to roof, narrow in the middle.
    x, z, corners = -1.7, -4.0, 6
    heights = shell.heights(x, z)
    rows = []
    for height, width in ((heights[0] - 0.05, 0.55), (1.7, 0.26), (heights[-1] + 0.15, 0.6)):
        rows.append([[x + width * math.cos(2 * math.pi * i / corners), height,
                      z + width * math.sin(2 * math.pi * i / corners)] for i in range(corners)])
    for low, high in zip(rows, rows[1:]):
        for i in range(corners):
            a, b, c, d = low[i], low[(i + 1) % corners], high[(i + 1) % corners], high[i]
            away = [a[0] + b[0] - x, a[1], a[2] + b[2] - z]
            m.facing(rock, away, a, b, c, d)

    # The pool: water within a rim of stone, in front of the visitor.
    x, z, corners = 0.7, -3.4, 10
    ground = max(shell.heights(x + dx, z + dz)[0] for dx in (-0.9, 0, 0.9) for dz in (-0.6, 0, 0.6))
    inner, crest, outer = [], [], []
    for i in range(corners):
        a = 2 * math.pi * i / corners
        stretch = 1 + jitter(0.12)
        for points, r, height in ((inner, 0.95, ground + 0.04), (crest, 1.12, ground + 0.16 + jitter(0.05)),
                                  (outer, 1.38, ground - 0.25)):
            points.append([x + 1.15 * stretch * r * math.cos(a), height,
                           z + 0.75 * stretch * r * math.sin(a)])
    middle = [x, ground + 0.04, z]
    for i in range(corners):
        k = (i + 1) % corners
        m.facing(water, [x, 5, z], middle, inner[i], inner[k])
        m.facing(dark, [x, 5, z], inner[i], inner[k], crest[k], crest[i])
        m.facing(dark, [3 * crest[i][0] - 2 * x, 2, 3 * crest[i][2] - 2 * z],
                 crest[i], crest[k], outer[k], outer[i])

    # Crystals that glow: pyramids of four faces, few enough that each face is a lamp of
    # its own to the renderer, which shares 16 among all glowing surfaces.
    for x, z, length, width in ((-2.75, -2.0, 0.75, 0.16), (-2.45, -1.6, 0.45, 0.12),
                                (-2.95, -1.5, 0.35, 0.1)):
        spike(crystal, x, z, shell.heights(x, z)[0] - 0.05, shell.heights(x, z)[0] + length,
              width, corners=4)
    return m


MODELS = {
    "cornell.gltf": lambda: cornell(lamp=True),
    "cornell-spot.gltf": lambda: cornell(lamp=False),
    "box.gltf": lambda: box(doorway=True),
    "box-closed.gltf": lambda: box(doorway=False),
    "grotto.gltf": grotto,
}


def main(arguments):
    here = os.path.dirname(os.path.abspath(__file__))
    check = arguments == ["--check"]
    folder = here if check or not arguments else arguments[0]
    differ = 0
    for name, make in MODELS.items():
        model = make()
        path = os.path.join(folder, name)
        text = model.to_gltf()
        if check:
            with open(path, encoding="ascii") as file:
                same = file.read() == text
            differ += not same
            print("%s: %s" % (name, "the same" if same else "DIFFERS"))
        else:
            with open(path, "w", encoding="ascii") as file:
                file.write(text)
            print("%s: %d triangles" % (name, model.count()))
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
