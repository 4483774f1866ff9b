"""Writes the meshes and clock faces of the scenes in this folder: python3 make.py (needs numpy; same bytes every time)."""

import json
import math
import struct
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


class Model:
    """Quads and triangles by material, written as GLB."""

    def __init__(self):
        self.parts = {}  # material: (points, indices)
        self.known = {}  # material: point → its index

    def face(self, material, *points):
        """A convex polygon, counter-clockwise as seen from outside."""
        vertices, indices = self.parts.setdefault(material, ([], []))
        first = len(vertices)
        vertices.extend(points)
        for k in range(1, len(points) - 1):
            indices.extend([first, first + k, first + k + 1])

    def shared(self, material, points):
        """The same, of points that are shared with its neighbours."""
        vertices, indices = self.parts.setdefault(material, ([], []))
        known = self.known.setdefault(material, {})
        numbers = []
        for point in points:
            number = known.setdefault(tuple(round(x, 6) for x in point), len(vertices))
            if number == len(vertices):
                vertices.append(point)
            numbers.append(number)
        for k in range(1, len(numbers) - 1):
            indices.extend([numbers[0], numbers[k], numbers[k + 1]])

    def box(self, material, low, high, skip=""):
        """An axis-aligned box; skip names faces to leave out, as in "-y"."""
        (a, b, c), (d, e, f) = low, high
        faces = {
            "+x": [(d, b, f), (d, b, c), (d, e, c), (d, e, f)],
            "-x": [(a, b, c), (a, b, f), (a, e, f), (a, e, c)],
            "+y": [(a, e, f), (d, e, f), (d, e, c), (a, e, c)],
            "-y": [(a, b, c), (d, b, c), (d, b, f), (a, b, f)],
            "+z": [(a, b, f), (d, b, f), (d, e, f), (a, e, f)],
            "-z": [(d, b, c), (a, b, c), (a, e, c), (d, e, c)],
        }
        for name, points in faces.items():
            if name not in skip:
                self.face(material, *points)

    def tube(self, material, centre, profile, sides):
        """A surface of revolution about y: profile is (radius, y) from the bottom up."""
        x, z = centre
        rings = [
            [(x + r * math.sin(t), y, z + r * math.cos(t)) for t in np.arange(sides) * math.tau / sides]
            for r, y in profile
        ]
        vertices, indices = self.parts.setdefault(material, ([], []))
        first = len(vertices)
        vertices.extend(point for ring in rings for point in ring)
        for k in range(len(rings) - 1):
            for j in range(sides):
                a, b = first + k * sides + j, first + k * sides + (j + 1) % sides
                c, d = a + sides, b + sides
                if profile[k][0] > 0:
                    indices.extend([a, b, d])
                if profile[k + 1][0] > 0:
                    indices.extend([a, d, c])

    def write(self, name, materials):
        """materials: name → (linear RGB, metallic, roughness)."""
        blob, views, accessors, primitives, listed = b"", [], [], [], []

        def add(array, target):
            nonlocal blob
            blob += b"\0" * (-len(blob) % 4)
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": array.nbytes, "target": target})
            blob += array.tobytes()
            return len(views) - 1

        for material, (points, indices) in self.parts.items():
            points = np.array(points, dtype="<f4")
            wide = "<u2" if len(points) < 65535 else "<u4"
            indices = np.array(indices, dtype=wide)
            accessors.append({
                "bufferView": add(points, 34962), "componentType": 5126, "count": len(points), "type": "VEC3",
                "min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist(),
            })
            code = 5123 if wide == "<u2" else 5125
            accessors.append({"bufferView": add(indices, 34963), "componentType": code, "count": len(indices), "type": "SCALAR"})
            rgb, metallic, roughness = materials[material]
            listed.append({"name": material, "pbrMetallicRoughness": {
                "baseColorFactor": [*rgb, 1], "metallicFactor": metallic, "roughnessFactor": roughness}})
            n = len(accessors)
            primitives.append({"attributes": {"POSITION": n - 2}, "indices": n - 1, "material": len(listed) - 1})
        blob += b"\0" * (-len(blob) % 4)
        document = {
            "asset": {"version": "2.0", "generator": "make.py"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"name": name, "mesh": 0}], "meshes": [{"primitives": primitives}], "materials": listed,
            "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(blob)}],
        }
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        head = struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(blob))
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
        (HERE / f"{name}.glb").write_bytes(head + chunks)


# ---- a street -------------------------------------------------------------------------------------------------

WALLS = {
    "brick": [0.50, 0.17, 0.10], "ochre": [0.72, 0.46, 0.17], "cream": [0.78, 0.68, 0.47], "sage": [0.31, 0.42, 0.27],
    "rose": [0.66, 0.32, 0.26], "blue": [0.20, 0.33, 0.50], "white": [0.80, 0.78, 0.74],
}


def house(model, side, z, width, storeys, wall, shop):
    """A gabled house, its front on the street at x = ±4.6, its gable to the street; side is −1 or 1."""
    front, back, height = 4.6 * side, 11.5 * side, 3.0 * storeys + 0.6
    low, high = sorted([front, back])
    model.box(wall, (low, 0, z), (high, height, z + width), skip="-y+y")
    ridge, middle, over = height + 0.62 * width, z + width / 2, 0.35
    # Gable triangles at front and back, and two planes of the roof, which reach over the walls.
    for x, out in [(front, side), (back, -side)]:
        tri = [(x, height, z), (x, height, z + width), (x, ridge, middle)]
        model.face(wall, *(tri if out < 0 else tri[::-1]))
    x0, x1 = low - over, high + over
    drop = over * 1.24
    for edge, sign in [(z - over, -1), (z + width + over, 1)]:
        quad = [(x0, height - drop, edge), (x1, height - drop, edge), (x1, ridge + 0.05, middle), (x0, ridge + 0.05, middle)]
        model.face("tiles", *(quad if sign > 0 else quad[::-1]))
        under = [(p[0], p[1] - 0.14, p[2]) for p in quad]
        model.face("trim", *(under[::-1] if sign > 0 else under))
        # The board along the slope, which closes the roof towards the street.
        x = x0 if side > 0 else x1
        a, b = (x, height - drop, edge), (x, ridge + 0.05, middle)
        board = [a, (a[0], a[1] - 0.14, a[2]), (b[0], b[1] - 0.14, b[2]), b]
        model.face("trim", *(board if (sign * side) < 0 else board[::-1]))
    cx, cz = front + 2.2 * side, middle + 0.22 * width
    model.box("brick", (cx - 0.35, ridge - 0.3 * width, cz - 0.35), (cx + 0.35, ridge + 0.5, cz + 0.35), skip="-y")

    def pane(material, out, y0, y1, z0, z1):
        x = front - out * side
        quad = [(x, y0, z0), (x, y0, z1), (x, y1, z1), (x, y1, z0)]
        model.face(material, *(quad[::-1] if side > 0 else quad)[::-1])

    count = max(2, round(width / 1.9))
    for storey in range(storeys):
        for k in range(count):
            at, y = z + (k + 0.5) * width / count, 3.0 * storey + 1.0
            if storey == 0 and k == count // 2:
                pane("trim", 0.02, 0.0, 2.5, at - 0.65, at + 0.65)
                pane("door", 0.04, 0.1, 2.35, at - 0.5, at + 0.5)
                continue
            pane("trim", 0.02, y - 0.1, y + 1.6, at - 0.6, at + 0.6)
            pane("glass", 0.03, y, y + 1.5, at - 0.5, at - 0.04)
            pane("glass", 0.03, y, y + 1.5, at + 0.04, at + 0.5)
    pane("trim", 0.02, height + 0.25, height + 1.45, middle - 0.5, middle + 0.5)
    pane("glass", 0.03, height + 0.35, height + 1.35, middle - 0.4, middle + 0.4)
    if shop:
        x0, x1 = front - 1.3 * side, front
        awning = [(x0, 2.5, z + 0.5), (x0, 2.5, z + width - 0.5), (x1, 3.1, z + width - 0.5), (x1, 3.1, z + 0.5)]
        model.face("awning", *(awning if side > 0 else awning[::-1]))


def tree(model, x, z, size, rings=13, sides=20):
    model.tube("trunk", (x, z), [(0.13, 0), (0.1, 1.9 * size), (0, 2.0 * size)], 6)
    ball = [(max(1.15 * math.sin(t), 0) * size, (2.75 - 1.25 * math.cos(t)) * size) for t in np.linspace(0, math.pi, rings)]
    ball[0], ball[-1] = (0, ball[0][1]), (0, ball[-1][1])
    model.tube("leaves", (x, z), ball, sides)


def street():
    model, random = Model(), np.random.default_rng(9)
    names = list(WALLS)
    for side in (-1, 1):
        z, last = 14.0, ""
        while z > -96:
            width = float(random.choice([5.0, 5.8, 6.6, 7.4]))
            wall = str(random.choice([n for n in names if n != last]))
            house(model, side, z - width, width, int(random.integers(1, 4)), wall, random.random() < 0.3)
            z, last = z - width - float(random.choice([0.9, 0.9, 2.4])), wall
        model.box("kerb", (*[min(3.0 * side, 13 * side), 0], -110), (max(3.0 * side, 13 * side), 0.14, 26), skip="-y")
    for k, z in enumerate(np.arange(9.0, -98.0, -9.0)):
        side = -1 if k % 2 else 1
        tree(model, 3.6 * side, float(z), 1.0 + 0.12 * (k % 3))
        x = -3.5 * side
        model.tube("iron", (x, float(z)), [(0.07, 0.14), (0.05, 3.4), (0, 3.4)], 8)
        model.box("lamp", (x - 0.16, 3.4, z - 0.16), (x + 0.16, 3.85, z + 0.16))
    model.box("asphalt", (-3.0, -0.1, -110), (3.0, 0, 26), skip="-y")
    for z in np.arange(22.0, -108.0, -4.0):
        model.face("paint", (-0.07, 0.01, z), (0.07, 0.01, z), (0.07, 0.01, z - 2), (-0.07, 0.01, z - 2))
    model.face("grass", (-400, -0.06, 400), (400, -0.06, 400), (400, -0.06, -700), (-400, -0.06, -700))
    model.write("street", {name: (rgb, 0, 1) for name, rgb in WALLS.items()} | {
        "tiles": ([0.33, 0.11, 0.07], 0, 1), "trim": ([0.82, 0.80, 0.76], 0, 1), "glass": ([0.05, 0.07, 0.09], 0, 0.12),
        "door": ([0.10, 0.16, 0.12], 0, 1), "awning": ([0.62, 0.10, 0.08], 0, 1), "trunk": ([0.16, 0.10, 0.06], 0, 1),
        "leaves": ([0.16, 0.33, 0.07], 0, 1), "kerb": ([0.44, 0.42, 0.39], 0, 1), "iron": ([0.05, 0.05, 0.06], 0, 1),
        "lamp": ([0.86, 0.82, 0.70], 0, 1), "asphalt": ([0.10, 0.10, 0.11], 0, 1), "paint": ([0.8, 0.8, 0.78], 0, 1),
        "grass": ([0.16, 0.22, 0.09], 0, 1),
    })


# ---- dice and balls -------------------------------------------------------------------------------------------

PIPS = {1: [(0, 0)], 2: [(-1, -1), (1, 1)], 3: [(-1, -1), (0, 0), (1, 1)], 4: [(-1, -1), (-1, 1), (1, -1), (1, 1)],
        5: [(-1, -1), (-1, 1), (0, 0), (1, -1), (1, 1)], 6: [(-1, -1), (-1, 0), (-1, 1), (1, -1), (1, 0), (1, 1)]}


def die():
    """A die of edge 1 m about the origin, its edges rounded; 1 on +z, 2 on +x, 3 on +y, opposite faces add up to 7."""
    model, cut, steps = Model(), 0.09, 5
    # A cube's six faces as grids, whose points are drawn to a rounded box: flat within ±(½ − cut).
    line = [-0.5 + cut + cut * math.tan(-t) for t in np.linspace(math.pi / 4, 0, steps, endpoint=False)]
    line += [-0.5 + cut, 0.5 - cut] + [-v for v in line[::-1]]
    frames = [((1, 0, 0), (0, 1, 0)), ((0, 0, -1), (0, 1, 0)), ((1, 0, 0), (0, 0, -1)),
              ((1, 0, 0), (0, 0, 1)), ((0, 0, 1), (0, 1, 0)), ((-1, 0, 0), (0, 1, 0))]
    for number, (u, v) in enumerate(frames, 1):
        u, v = np.array(u, float), np.array(v, float)
        n = np.cross(u, v)

        def rounded(a, b):
            p = a * u + b * v + 0.5 * n
            core = np.clip(p, -0.5 + cut, 0.5 - cut)
            return tuple(core + cut * (p - core) / np.linalg.norm(p - core))

        points = [[rounded(a, b) for a in line] for b in line]
        for i in range(len(line) - 1):
            for j in range(len(line) - 1):
                model.face("body", points[i][j], points[i][j + 1], points[i + 1][j + 1], points[i + 1][j])
        for a, b in PIPS[number]:
            ring = [(0.24 * a + 0.085 * math.cos(t), 0.24 * b + 0.085 * math.sin(t)) for t in np.arange(24) * math.tau / 24]
            model.face("pip", *(tuple(x * u + y * v + 0.501 * n) for x, y in ring))
    model.write("die", {"body": ([0.82, 0.78, 0.70], 0, 0.45), "pip": ([0.05, 0.04, 0.05], 0, 0.6)})


def ball():
    """A ball of radius ½ m about the origin: 12 gores, light and dark between two caps."""
    model, sides, rows = Model(), 96, 48
    for i in range(rows):
        for j in range(sides):
            t, p = np.array([i, i + 1]) * math.pi / rows, np.array([j, j + 1]) * math.tau / sides
            at = lambda a, b: (0.5 * math.sin(t[a]) * math.sin(p[b]), 0.5 * math.cos(t[a]), 0.5 * math.sin(t[a]) * math.cos(p[b]))
            square = (j * 12 // sides + i * 6 // rows) % 2
            corners = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)]
            if i in (0, rows - 1):
                # At a pole two corners are one.
                del corners[3 if i == 0 else 2]
            model.shared("light" if square else "dark", corners)
    model.write("ball", {"light": ([0.80, 0.76, 0.68], 0, 0.35), "dark": ([0.52, 0.07, 0.05], 0, 0.35)})


# ---- a colonnade ----------------------------------------------------------------------------------------------

def columns():
    """Two rows of columns at x = ±3 m, one every 4 m from z = 40 m to −200 m, under a vault of ribs, over a chequered floor."""
    model = Model()
    profile = [(0.62, 0.0), (0.44, 0.35), (0.36, 4.4), (0.6, 4.75), (0.6, 5.0)]
    for k, z in enumerate(np.arange(40.0, -202.0, -4.0)):
        for side in (-1, 1):
            model.tube("stone" if k % 5 else "marble", (3.0 * side, float(z)), profile, 12)
        arch = [(3.35 * math.cos(t), 5.0 + 2.0 * math.sin(t)) for t in np.linspace(0, math.pi, 9)]
        inner = [(2.7 * math.cos(t), 5.0 + 1.45 * math.sin(t)) for t in np.linspace(0, math.pi, 9)]
        for i in range(8):
            (a, b), (c, d), (e, f), (g, h) = arch[i], arch[i + 1], inner[i + 1], inner[i]
            for zz, order in [(z + 0.3, 1), (z - 0.3, -1)]:
                model.face("rib", *[(a, b, zz), (c, d, zz), (e, f, zz), (g, h, zz)][::order])
            model.face("rib", (g, h, z + 0.3), (e, f, z + 0.3), (e, f, z - 0.3), (g, h, z - 0.3))
    model.face("ground", (-300, -0.02, 300), (300, -0.02, 300), (300, -0.02, -900), (-300, -0.02, -900))
    for k, z in enumerate(np.arange(40.0, -200.0, -2.0)):
        for j in range(4):
            x = -4 + 2 * j
            model.face("light" if (j + k) % 2 else "dark", (x, 0, z), (x + 2, 0, z), (x + 2, 0, z - 2), (x, 0, z - 2))
    model.write("columns", {
        "stone": ([0.62, 0.52, 0.38], 0, 1), "marble": ([0.35, 0.12, 0.09], 0, 1), "rib": ([0.55, 0.45, 0.33], 0, 1),
        "ground": ([0.28, 0.26, 0.20], 0, 1), "light": ([0.70, 0.64, 0.54], 0, 1), "dark": ([0.16, 0.15, 0.16], 0, 1),
    })


# ---- barn and ladder ------------------------------------------------------------------------------------------

def barn():
    """A barn from x = −5 to 5 m, open at both gates and towards +z, 4 m deep; its frame and back wall in planks."""
    model = Model()
    for k in range(40):
        x = -5 + 0.25 * k
        model.box("plank" if k % 2 else "board", (x, 0, -2.1), (x + 0.25, 3.6, -2.0), skip="-y")
    for x in (-5.0, -2.5, 0.0, 2.5, 5.0):
        for z in (-1.9, 2.0):
            model.box("beam", (x - 0.12, 0, z - 0.12), (x + 0.12, 3.6, z + 0.12), skip="-y")
    for z in (-1.9, 2.0):
        model.box("beam", (-5.2, 3.5, z - 0.14), (5.2, 3.78, z + 0.14))
    for x in (-5.0, 5.0):
        model.box("beam", (x - 0.14, 3.5, -2.0), (x + 0.14, 3.78, 2.0))
    for z, sign in [(2.4, 1), (-2.4, -1)]:
        for k in range(42):
            x = -5.25 + 0.25 * k
            quad = [(x, 3.7, z), (x + 0.25, 3.7, z), (x + 0.25, 5.5, 0), (x, 5.5, 0)]
            model.face("roof" if k % 2 else "slate", *(quad if sign > 0 else quad[::-1]))
    model.face("floor", (-5, 0.02, 2.1), (5, 0.02, 2.1), (5, 0.02, -2.1), (-5, 0.02, -2.1))
    model.write("barn", {
        "plank": ([0.45, 0.10, 0.06], 0, 1), "board": ([0.36, 0.08, 0.05], 0, 1), "beam": ([0.72, 0.68, 0.60], 0, 1),
        "roof": ([0.22, 0.23, 0.26], 0, 1), "slate": ([0.16, 0.17, 0.20], 0, 1), "floor": ([0.50, 0.40, 0.22], 0, 1),
    })


def ladder():
    """A ladder of 20 m from x = −10 to 10 m, lying on its side: rails at y = ±0.4 m, a rung every metre."""
    model = Model()
    for y in (-0.4, 0.4):
        model.box("rail", (-10, y - 0.07, -0.05), (10, y + 0.07, 0.05))
    for x in np.arange(-9.5, 10.0, 1.0):
        model.box("rung", (x - 0.05, -0.4, -0.04), (x + 0.05, 0.4, 0.04))
    model.write("ladder", {"rail": ([0.85, 0.62, 0.12], 0, 1), "rung": ([0.70, 0.48, 0.10], 0, 1)})


# ---- trains ---------------------------------------------------------------------------------------------------

def train():
    """Five coaches of 12 m along z, from z = −30 to 30 m, 2.6 m wide, wheels down at y = 0, a nose at each end."""
    model = Model()
    for k in range(5):
        z0, z1 = -30.0 + 12 * k, -18.0 + 12 * k
        a, b = z0 + (2.2 if k == 0 else 0.25), z1 - (2.2 if k == 4 else 0.25)
        model.box("body", (-1.3, 0.7, a), (1.3, 1.75, b))
        model.box("band", (-1.32, 1.30, a), (1.32, 1.42, b))
        model.box("window", (-1.27, 1.75, a), (1.27, 2.65, b))
        for z in np.linspace(a, b, 8):
            w = 0.16
            model.box("roof", (-1.31, 1.75, max(a, z - w)), (1.31, 2.65, min(b, z + w)))
        model.box("roof", (-1.3, 2.65, a), (1.3, 3.0, b))
        for z in (a + 1.6, b - 1.6):
            model.box("iron", (-1.1, 0.05, z - 0.9), (1.1, 0.7, z + 0.9))
        if k < 4:
            model.box("iron", (-0.9, 0.9, z1 - 0.25), (0.9, 2.6, z1 + 0.25))
    for s in (-1, 1):
        # The nose: the coach's cross-section drawn in towards its tip.
        ring = lambda z, x, low, high: [(-x, low, z), (x, low, z), (x, high, z), (-x, high, z)]
        rings = [ring(27.8, 1.3, 0.7, 3.0), ring(29.0, 1.2, 0.65, 2.5), ring(29.8, 0.95, 0.65, 1.7), ring(30.0, 0.7, 0.7, 1.3)]
        for n, (p, q) in enumerate(zip(rings, rings[1:])):
            for i in range(4):
                j = (i + 1) % 4
                quad = [p[i], p[j], q[j], q[i]]
                flip = [(x * s, y, z * s) for x, y, z in quad]
                model.face("window" if (n, i) == (0, 2) else "roof" if n == 0 and i != 0 else "body", *flip)
        model.face("body", *[(x * s, y, z * s) for x, y, z in rings[-1]])
        for x in (-0.75, 0.75):
            lamp = [(x + 0.17 * math.cos(t), 1.15 + 0.17 * math.sin(t)) for t in np.arange(16) * math.tau / 16]
            # On the nose's slope, a little before it.
            model.face("lamp", *[(px * s, py, 29.96 * s) for px, py in lamp])
    return model


def trains():
    looks = {"window": ([0.04, 0.05, 0.07], 0, 0.15), "iron": ([0.06, 0.06, 0.06], 0, 1), "lamp": ([0.95, 0.93, 0.85], 0, 1)}
    train().write("train-red", looks | {
        "body": ([0.55, 0.05, 0.04], 0, 0.4), "band": ([0.85, 0.80, 0.62], 0, 1), "roof": ([0.70, 0.68, 0.62], 0, 0.5)})
    train().write("train-green", looks | {
        "body": ([0.05, 0.26, 0.12], 0, 0.4), "band": ([0.85, 0.70, 0.20], 0, 1), "roof": ([0.72, 0.70, 0.66], 0, 0.5)})


def railway():
    model = Model()
    for x in (-2.2, 2.2):
        for r in (-0.72, 0.72):
            model.box("rail", (x + r - 0.04, 0, -260), (x + r + 0.04, 0.14, 60), skip="-y")
        for z in np.arange(58.0, -260.0, -1.0):
            model.face("sleeper", (x - 1.2, 0, z + 0.13), (x + 1.2, 0, z + 0.13), (x + 1.2, 0, z - 0.13), (x - 1.2, 0, z - 0.13))
    model.face("ballast", (-4.6, -0.06, 60), (4.6, -0.06, 60), (4.6, -0.06, -260), (-4.6, -0.06, -260))
    model.face("meadow", (-500, -0.1, 300), (500, -0.1, 300), (500, -0.1, -900), (-500, -0.1, -900))
    for k, z in enumerate(np.arange(40.0, -250.0, -15.0)):
        for x in (-5.0, 5.0):
            model.tube("mast", (x, float(z)), [(0.11, -0.1), (0.08, 6.2), (0, 6.2)], 8)
            model.box("mast", (min(x, x * 0.36), 5.7, z - 0.05), (max(x, x * 0.36), 5.8, z + 0.05))
    for x in (-2.2, 2.2):
        model.box("wire", (x - 0.025, 5.3, -260), (x + 0.025, 5.35, 60))
    random = np.random.default_rng(4)
    for _ in range(70):
        x = float(random.uniform(9, 60)) * (1 if random.random() < 0.5 else -1)
        tree(model, x, float(random.uniform(-240, 30)), float(random.uniform(1.2, 2.2)), 7, 9)
    model.write("railway", {
        "rail": ([0.45, 0.42, 0.40], 0, 1), "sleeper": ([0.20, 0.14, 0.09], 0, 1), "ballast": ([0.30, 0.28, 0.26], 0, 1),
        "meadow": ([0.17, 0.27, 0.08], 0, 1), "mast": ([0.30, 0.33, 0.34], 0, 1), "wire": ([0.05, 0.05, 0.05], 0, 1),
        "trunk": ([0.16, 0.10, 0.06], 0, 1), "leaves": ([0.10, 0.23, 0.05], 0, 1),
    })


# ---- clocks ---------------------------------------------------------------------------------------------------

def clock():
    """A clock face over 12 m of proper time, a picture each half metre: the hand turns once, and the lit
    sector that it sweeps has a colour of its own in each quarter."""
    size, bins = 64, 24
    row, column = np.mgrid[0:size, 0:size]
    x, y = (column + 0.5) / size * 2 - 1, 1 - (row + 0.5) / size * 2
    r, turn = np.hypot(x, y), (np.arctan2(x, y) / math.tau) % 1
    quarters = np.array([[0.95, 0.75, 0.10], [0.90, 0.25, 0.08], [0.10, 0.35, 0.85], [0.10, 0.60, 0.20]])
    faces = np.zeros((size, size, bins, 3), dtype="<f2")
    for k in range(bins):
        face = np.where((r < 0.92)[..., None], np.array([0.85, 0.84, 0.80]), np.array([0.10, 0.10, 0.12]))
        swept = (r < 0.80) & (turn <= (k + 0.5) / bins)
        face = np.where(swept[..., None], quarters[(turn * 4).astype(int) % 4], face)
        ticks = (r > 0.80) & (r < 0.90) & (np.abs((turn * 12 + 0.5) % 1 - 0.5) < 0.09)
        face[ticks] = 0.03
        angle = math.tau * (k + 0.5) / bins
        along, across = x * math.sin(angle) + y * math.cos(angle), np.abs(x * math.cos(angle) - y * math.sin(angle))
        face[(along > -0.12) & (along < 0.80) & (across < 0.05)] = 0.03
        face[(np.abs(x) > 0.96) | (np.abs(y) > 0.96)] = 0.10
        faces[:, :, k] = face
    np.savez_compressed(HERE / "clock.npz", faces=faces)
    # A signal lamp: red, but green within 1 m of its own time 0. Steady before and after; 40 bins of 0.5 m from −10 m.
    times = -10 + 0.5 * (np.arange(40) + 0.5)
    signal = np.where(np.abs(times)[:, None] < 1, np.array([0.05, 1.0, 0.15]), np.array([0.9, 0.04, 0.02]))
    np.savez_compressed(HERE / "signal.npz", light=np.broadcast_to(signal, (2, 2, 40, 3)).astype("<f2"))


for make in (street, die, ball, columns, barn, ladder, trains, railway, clock):
    make()
