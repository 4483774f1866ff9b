"""Writes the meshes of the scenes in this folder: python3 models.py (needs numpy; same bytes every time).

The rabbit and the dragon are unions of ellipsoids and round cones, blended where they meet, as surface nets: one vertex in each cell of a grid that
the surface passes through, drawn onto the surface by Newton's method. They are free of any licence, as is all of this repository's own.
"""

import json
import math
import struct
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


def blended(a, b, width):
    """The union of two distances, rounded over `width` where both are near (a polynomial smooth minimum)."""
    h = np.maximum(width - np.abs(a - b), 0.0) / width
    return np.minimum(a, b) - h * h * h * width / 6.0


def turned(p, about, angles):
    """Points in the frame of something turned by angles (degrees, about x, then y, then z) around a place."""
    q = p - np.array(about)
    for axis, angle in enumerate(angles):
        c, s = math.cos(math.radians(-angle)), math.sin(math.radians(-angle))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        q[..., i], q[..., j] = c * q[..., i] - s * q[..., j], s * q[..., i] + c * q[..., j]
    return q


def ellipsoid(p, centre, radii, angles=(0, 0, 0)):
    q = turned(p, centre, angles)
    far, near = np.linalg.norm(q / radii, axis=-1), np.linalg.norm(q / np.square(radii), axis=-1)
    return far * (far - 1.0) / np.maximum(near, 1e-9)


def cone(p, a, b, ra, rb):
    """A round cone from a to b."""
    a, b = np.array(a), np.array(b)
    way = b - a
    t = np.clip((p - a) @ way / (way @ way), 0.0, 1.0)
    return np.linalg.norm(p - a - t[..., None] * way, axis=-1) - (ra + (rb - ra) * t)


def union(p, parts):
    """Parts are (distance function, blend width)."""
    total = None
    for part, width in parts:
        d = part(p)
        total = d if total is None else blended(total, d, width)
    return total


def rabbit(p):
    e = lambda *a: (lambda q: ellipsoid(q, *a))
    parts = [
        (e((0, 0.42, -0.12), (0.34, 0.38, 0.48)), 0.1),
        (e((0, 0.48, 0.2), (0.25, 0.31, 0.26)), 0.12),
        (e((0, 0.86, 0.4), (0.2, 0.2, 0.25), (15, 0, 0)), 0.1),
        (e((0, 0.8, 0.58), (0.12, 0.1, 0.13)), 0.08),
        (e((0, 0.36, -0.62), (0.12, 0.12, 0.11)), 0.03),
    ]
    for side in (-1, 1):
        parts += [
            (e((0.25 * side, 0.3, -0.26), (0.17, 0.27, 0.29)), 0.06),
            (e((0.25 * side, 0.07, 0.02), (0.09, 0.07, 0.24)), 0.05),
            (e((0.13 * side, 0.24, 0.36), (0.08, 0.24, 0.1), (-8, 0, 0)), 0.06),
            (e((0.13 * side, 0.06, 0.46), (0.08, 0.06, 0.13)), 0.05),
            (e((0.12 * side, 1.22, 0.22), (0.075, 0.3, 0.045), (-22, 0, -9 * side)), 0.05),
            (e((0.15 * side, 0.79, 0.46), (0.09, 0.08, 0.1)), 0.06),
        ]
    return union(p, parts)


SPINE = [
    (-1.25, 0.1, -0.25, 0.02), (-1.12, 0.1, 0.12, 0.045), (-0.85, 0.13, 0.34, 0.075), (-0.52, 0.22, 0.28, 0.12), (-0.22, 0.36, 0.05, 0.175),
    (0.1, 0.46, -0.1, 0.2), (0.38, 0.58, -0.1, 0.17), (0.54, 0.8, 0.0, 0.12), (0.6, 1.03, 0.08, 0.095), (0.74, 1.2, 0.1, 0.1),
]


def along(t):
    """Place and radius on the spine, t from 0 to 1: Catmull and Rom's curve."""
    s = np.array(SPINE)
    x = t * (len(s) - 1)
    k = min(int(x), len(s) - 2)
    f = x - k
    a, b, c, d = (s[min(max(k + i, 0), len(s) - 1)] for i in (-1, 0, 1, 2))
    return 0.5 * (2 * b + (c - a) * f + (2 * a - 5 * b + 4 * c - d) * f * f + (3 * b - 3 * c + d - a) * f**3)


def dragon(p):
    c = lambda *a: (lambda q: cone(q, *a))
    e = lambda *a: (lambda q: ellipsoid(q, *a))
    parts = []
    steps = [along(t) for t in np.linspace(0, 1, 41)]
    for a, b in zip(steps, steps[1:]):
        parts.append((c(a[:3], b[:3], a[3], b[3]), 0.02))
    # Spikes on the back, the largest in the middle.
    for t in np.linspace(0.08, 0.95, 20):
        x, y, z, r = along(t)
        height = r + 0.05 + 0.5 * r
        parts.append((c((x, y + 0.6 * r, z), (x - 0.05, y + height, z), 0.045 * (0.4 + 3 * r), 0.008), 0.02))
    # Head: skull, snout, jaw, horns, brows.
    parts += [
        (e((0.8, 1.22, 0.11), (0.14, 0.11, 0.11), (0, 0, -10)), 0.06),
        (e((0.97, 1.18, 0.11), (0.15, 0.06, 0.075), (0, 0, -8)), 0.05),
        (e((0.93, 1.1, 0.11), (0.14, 0.035, 0.06), (0, 0, -22)), 0.03),
    ]
    for side in (-1, 1):
        z = 0.11 + 0.07 * side
        parts += [
            (c((0.76, 1.3, z), (0.5, 1.45, z + 0.05 * side), 0.035, 0.01), 0.03),
            (e((0.87, 1.27, z), (0.05, 0.03, 0.03)), 0.02),
            (e((1.09, 1.22, 0.11 + 0.035 * side), (0.025, 0.02, 0.02)), 0.02),
        ]
    # Legs, from the body to the feet, with toes.
    for hip, knee, foot in [
        ((-0.3, 0.36, 0.22), (-0.34, 0.24, 0.44), (-0.22, 0.05, 0.42)),
        ((-0.2, 0.34, -0.1), (-0.3, 0.25, -0.28), (-0.16, 0.05, -0.32)),
        ((0.36, 0.5, 0.05), (0.3, 0.28, 0.2), (0.44, 0.05, 0.2)),
        ((0.36, 0.5, -0.24), (0.3, 0.28, -0.38), (0.44, 0.05, -0.38)),
    ]:
        parts += [(c(hip, knee, 0.11, 0.075), 0.06), (c(knee, foot, 0.075, 0.05), 0.03)]
        x, y, z = foot
        for turn in (-25, 0, 25):
            to = (x + 0.15 * math.cos(math.radians(turn)), 0.035, z + 0.15 * math.sin(math.radians(turn)))
            parts.append((c(foot, to, 0.045, 0.02), 0.03))
    # Wings, half folded.
    for side in (-1, 1):
        z = -0.1 + 0.1 * side
        parts += [
            (c((0.2, 0.58, z), (-0.02, 1.05, z + 0.3 * side), 0.05, 0.03), 0.04),
            (c((-0.02, 1.05, z + 0.3 * side), (-0.55, 0.98, z + 0.5 * side), 0.03, 0.015), 0.03),
            (e((-0.12, 0.82, z + 0.24 * side), (0.36, 0.24, 0.05), (-35 * side, 8 * side, 18)), 0.04),
        ]
    return union(p, parts)


def net(distance, low, high, cell):
    """Vertices and quads (counter-clockwise from outside) of the surface where `distance` is 0."""
    counts = np.ceil((np.array(high) - low) / cell).astype(int) + 1
    axes = [l + cell * np.arange(n) for l, n in zip(low, counts)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    d = np.concatenate([distance(slab) for slab in np.array_split(grid, 16)])
    inside = d < 0
    total, crossings = np.zeros((*(counts - 1), 3)), np.zeros(counts - 1)
    for axis in range(3):
        for i in (0, 1):
            for j in (0, 1):
                pick = [slice(None, -1)] * 3
                pick[(axis + 1) % 3] = slice(i, counts[(axis + 1) % 3] - 1 + i)
                pick[(axis + 2) % 3] = slice(j, counts[(axis + 2) % 3] - 1 + j)
                far = list(pick)
                far[axis] = slice(1, None)
                a, b = d[tuple(pick)], d[tuple(far)]
                crosses = (a < 0) != (b < 0)
                t = np.where(crosses, a / np.where(crosses, a - b, 1.0), 0.0)
                place = grid[tuple(pick)] + t[..., None] * cell * np.eye(3)[axis]
                total += crosses[..., None] * place
                crossings += crosses
    there = crossings > 0
    numbers = np.full(there.shape, -1)
    numbers[there] = np.arange(there.sum())
    points = total[there] / crossings[there][:, None]
    quads = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        near, far = [slice(None)] * 3, [slice(None)] * 3
        near[axis], far[axis] = slice(None, -1), slice(1, None)
        a, b = inside[tuple(near)], inside[tuple(far)]
        for index in np.argwhere(a != b):
            if index[u] == 0 or index[v] == 0 or index[u] == counts[u] - 1 or index[v] == counts[v] - 1:
                continue
            corners = []
            for du, dv in [(-1, -1), (0, -1), (0, 0), (-1, 0)]:
                at = index.copy()
                at[u] += du
                at[v] += dv
                corners.append(numbers[tuple(at)])
            quads.append(corners if a[tuple(index)] else corners[::-1])
    # Onto the surface: steps along the gradient.
    for _ in range(4):
        e = 1e-4
        gradient = np.stack([(distance(points + e * unit) - distance(points - e * unit)) / (2 * e) for unit in np.eye(3)], axis=-1)
        value = distance(points)
        step = value / np.maximum((gradient * gradient).sum(-1), 0.05)
        points = points - np.clip(step, -0.5 * cell, 0.5 * cell)[:, None] * gradient
    triangles = []
    for a, b, c, d in quads:
        # Along the shorter diagonal.
        if np.linalg.norm(points[a] - points[c]) <= np.linalg.norm(points[b] - points[d]):
            triangles += [(a, b, c), (a, c, d)]
        else:
            triangles += [(a, b, d), (b, c, d)]
    points[:, 1] = np.maximum(points[:, 1], 0.0)
    return points, np.array(triangles)


def columns():
    """Two rows of columns, each a base, a shaft that swells, and a capital; their bottoms and tops are not there."""
    points, triangles, sides = [], [], 20
    profile = [(0.3, 0.0), (0.3, 0.12), (0.24, 0.18), (0.24, 0.22), (0.2, 0.26), (0.19, 1.2), (0.165, 2.5), (0.21, 2.56), (0.28, 2.7), (0.28, 2.8)]
    for x in (-1.5, 1.5):
        for z in (0.6, -0.8, -2.2):
            first = len(points)
            for radius, y in profile:
                for k in range(sides):
                    angle = math.tau * k / sides
                    points.append((x + radius * math.sin(angle), y, z + radius * math.cos(angle)))
            for ring in range(len(profile) - 1):
                for k in range(sides):
                    a, b = first + ring * sides + k, first + ring * sides + (k + 1) % sides
                    c, d = a + sides, b + sides
                    triangles += [(a, b, d), (a, d, c)]
    return np.array(points), np.array(triangles)


def lathe(radius, height, turns, steps):
    """A closed surface about y: radius and height of (angle around, 0 at the bottom to 1 at the top)."""
    points, triangles = [(0.0, float(height(0.0, 0.0)), 0.0)], []
    for i in range(1, steps):
        for k in range(turns):
            angle, way = math.tau * k / turns, i / steps
            r = radius(angle, way)
            points.append((r * math.sin(angle), height(angle, way), r * math.cos(angle)))
    points.append((0.0, float(height(0.0, 1.0)), 0.0))
    top = len(points) - 1
    for k in range(turns):
        n = (k + 1) % turns
        triangles.append((0, 1 + n, 1 + k))
        triangles.append((top, top - turns + k, top - turns + n))
        for i in range(steps - 2):
            a, b = 1 + i * turns + k, 1 + i * turns + n
            triangles += [(a, b, b + turns), (a, b + turns, a + turns)]
    return np.array(points), np.array(triangles)


def tomato():
    """Half a metre wide and more, with five shallow lobes and a hollow at the stem."""
    lobe = lambda angle, way: 1 + 0.05 * math.cos(5 * angle) * math.sin(math.pi * way) ** 2
    radius = lambda angle, way: 0.5 * lobe(angle, way) * math.sin(math.pi * way)
    height = lambda angle, way: 0.4 - 0.4 * math.cos(math.pi * way) - 0.16 * math.exp(-(((1 - way) / 0.14) ** 2))
    return lathe(radius, height, 60, 36)


def stem():
    """The calyx, a star of five leaves, and a stalk."""
    def radius(angle, way):
        leaf = 0.06 + 0.2 * max(math.cos(2.5 * ((angle + math.pi / 5) % (math.tau / 5) - math.pi / 5)), 0.0) ** 3
        return leaf * min(1.0, way / 0.15) if way < 0.5 else leaf + (0.025 - leaf) * min((way - 0.5) / 0.15, 1.0)
    def height(angle, way):
        r = radius(angle, way)
        leaf = 0.64 + 1.0 * r - 2.2 * r * r
        return leaf if way < 0.5 else leaf + 0.02 + 0.16 * max((way - 0.65) / 0.35, 0.0)
    return lathe(radius, height, 60, 20)


def write(name, mesh, colour):
    points, triangles = mesh
    points = points.astype("<f4")
    # Corners that fell together leave triangles without area.
    a, b, c = (points[triangles[:, k]].astype(float) for k in range(3))
    triangles = triangles[np.linalg.norm(np.cross(b - a, c - a), axis=-1) > 1e-12]
    kind = ("<u2", 5123) if len(points) < 65536 else ("<u4", 5125)
    blob = points.tobytes() + triangles.astype(kind[0]).tobytes()
    blob += b"\0" * (-len(blob) % 4)
    low, high = points.min(0).tolist(), points.max(0).tolist()
    tree = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": name}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0}}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3", "min": low, "max": high},
            {"bufferView": 1, "componentType": kind[1], "count": triangles.size, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": points.nbytes}, {"buffer": 0, "byteOffset": points.nbytes, "byteLength": triangles.size * int(kind[0][2])}],
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(blob))
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    (HERE / f"{name}.glb").write_bytes(head + chunks)
    print(f"{name}.glb: {len(points)} vertices, {len(triangles)} triangles, {28 + len(text) + len(blob)} bytes")


if __name__ == "__main__":
    write("rabbit", net(rabbit, [-0.5, -0.05, -0.85], [0.5, 1.65, 0.85], 0.025), [0.72, 0.6, 0.47])
    write("dragon", net(dragon, [-1.4, -0.05, -0.95], [1.25, 1.6, 0.95], 0.021), [0.32, 0.55, 0.33])
    write("tomato", tomato(), [0.75, 0.07, 0.04])
    write("stem", stem(), [0.12, 0.35, 0.06])
    write("columns", columns(), [0.75, 0.73, 0.68])
