"""Where is re-tessellation the better choice? Time against error for 10^3 to 10^7 triangles, 0 to 0.99 c, 1 to 1000 objects.

    python3 benches/studies/crossover.py PROGRAM [--sweeps triangles,beta,objects] [--budget SECONDS] [--threads N] [--out FOLDER]

runs `PROGRAM study` on one scene for each value of each sweep, and writes crossover.csv (a line for each method that was
measured) and crossover.svg: for each sweep the time of a picture by the ray tracer, and by the fastest rasterizer all of whose
points are within 0.1 and 0.01 pixels. Needs Python 3 and nothing else.
"""

import argparse
import csv
import json
import math
import os
import subprocess
import tempfile

METHODS = "trace; raster:none; raster:adaptive=1; raster:adaptive=0.1; raster:adaptive=0.01"
SIZE = "320x240"
ERRORS = [0.1, 0.01]

HEAD = """[display]
back_faces = "two_sided"
exposure = "99 %"

[camera]
eye = [0.0, 1.2, 4.5]
look_at = [0.0, 0.5, 0.0]
hfov = "40 deg"
clock_zero = "20 m"
{velocity}
[[object]]
name = "floor"
shape = {{ plane = {{ size = [12.0, 12.0] }} }}
colour = [0.4, 0.4, 0.4]
"""


def head(beta):
    motion = f'velocity = {{ beta = {beta}, direction = [0.0, -0.7, -4.5] }}\n' if beta else ""
    return HEAD.format(velocity=motion)


def ball(name, radius, subdivisions, place, beta=0.0):
    text = f'\n[[object]]\nname = "{name}"\nshape = {{ sphere = {{ radius = {radius}, subdivisions = {subdivisions} }} }}\n'
    x, y, z = place
    if not beta:
        return text + f"transform = {{ translate = [{x}, {y}, {z}] }}\n"
    # It passes through its place when its light has to leave for the camera.
    time = 20.0 - math.dist((0.0, 1.2, 4.5), place)
    return text + f'velocity = {{ beta = [{beta}, 0.0, 0.0] }}\norigin = {{ position = [{x}, {y}, {z}], time = "{time} m" }}\n'


def triangles(subdivisions):
    if subdivisions <= 8:
        return head(0.9) + ball("ball", 0.9, subdivisions, (0.0, 0.9, 0.0))
    # A ball has 20 * 4^8 at most: eight of them.
    places = [(x, y, z) for x in (-0.45, 0.45) for y in (0.45, 1.35) for z in (-0.45, 0.45)]
    return head(0.9) + "".join(ball(f"ball {k}", 0.45, 8, place) for k, place in enumerate(places))


def speed(beta):
    return head(beta) + ball("ball", 0.9, 5, (0.0, 0.9, 0.0))


def objects(count):
    """So many balls, 81,920 triangles in all as nearly as may be, each with a velocity of its own."""
    level = max(0, min(6, round(math.log(81920 / 20 / count, 4))))
    rows = math.ceil(count ** (1 / 3))
    step = 2.4 / rows
    text = head(0.0)
    for k in range(count):
        i, j, l = k % rows, k // rows % rows, k // rows // rows
        place = tuple(round(step * (n + 0.5) - offset, 6) for n, offset in zip((i, j, l), (1.2, 0.0, 1.2)))
        text += ball(f"ball {k + 1}", round(0.4 * step, 6), level, place, round(0.9 + 0.09 * k / max(1, count), 6))
    return text


SWEEPS = {
    "triangles": [((160 << 16) if n == 9 else 20 << (2 * n), triangles, n) for n in (3, 4, 5, 6, 7, 8, 9)],
    "beta": [(beta, speed, beta) for beta in (0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99)],
    "objects": [(count, objects, count) for count in (1, 3, 10, 30, 100, 300, 1000)],
}


def study(program, text, threads, budget, folder):
    scene, result = os.path.join(folder, "scene.toml"), os.path.join(folder, "study.json")
    if os.path.exists(result):
        os.remove(result)
    with open(scene, "w") as file:
        file.write(text)
    command = [program, "study", scene, "--size", SIZE, "--threads", str(threads), "--samples", "1", "--runs", "9",
               "--budget", str(budget), "--reference-spp", "1", "--methods", METHODS, "-o", result]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    with open(result) as file:
        return json.load(file)


def rows(sweep, value, found):
    for entry in found["entries"]:
        timing = entry["timing"]
        if timing is None:
            continue
        error = entry["geometry"]["pixels"]["max"]
        yield {
            "sweep": sweep, "value": value, "triangles": found["triangles"], "threads": found["threads"],
            "method": entry["method"], "ms": round(1e3 * timing["median"], 3),
            "ms_q1": round(1e3 * timing["quartiles"][0], 3), "ms_q3": round(1e3 * timing["quartiles"][1], 3),
            "ms_first_tile": round(1e3 * timing["setup"], 3), "ms_once": round(1e3 * entry["once_seconds"], 3),
            "max_px": "" if error is None else f"{error:.3g}", "wrong_objects": entry["geometry"]["wrong_object"],
        }


def curves(table, sweep):
    """By name, the pairs of value and milliseconds."""
    lines = {"ray tracer": []}
    values = sorted({row["value"] for row in table if row["sweep"] == sweep})
    for value in values:
        of = [row for row in table if row["sweep"] == sweep and row["value"] == value]
        lines["ray tracer"] += [(value, row["ms"]) for row in of if row["method"] == "trace"]
        for error in ERRORS:
            fit = [row["ms"] for row in of if row["method"] != "trace" and row["max_px"] and float(row["max_px"]) <= error]
            if fit:
                lines.setdefault(f"rasterizer, at most {error} px", []).append((value, min(fit)))
    return lines


def chart(table, sweeps):
    colours = {"ray tracer": "#005aaa", f"rasterizer, at most {ERRORS[0]} px": "#008c64", f"rasterizer, at most {ERRORS[1]} px": "#d55e00"}
    width, height = 250, 200
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width * len(sweeps) + 20} {height + 90}" '
             'font-family="serif" font-size="10">', '<rect width="100%" height="100%" fill="white"/>']
    for at, sweep in enumerate(sweeps):
        lines = curves(table, sweep)
        points = [point for line in lines.values() for point in line]
        if not points:
            continue
        # A speed is drawn over its rapidity, everything else over its logarithm.
        along = (lambda v: math.atanh(v)) if sweep == "beta" else (lambda v: math.log10(v))
        xs, ys = [along(p[0]) for p in points], [math.log10(p[1]) for p in points]
        low, high = math.floor(min(ys)), math.ceil(max(ys))
        left, top = width * at + 45, 25
        wide, tall = width - 60, height - 25
        x = lambda v: left + wide * (along(v) - min(xs)) / ((max(xs) - min(xs)) or 1)
        y = lambda v: top + tall * (high - math.log10(v)) / ((high - low) or 1)
        parts.append(f'<rect x="{left}" y="{top}" width="{wide}" height="{tall}" fill="none" stroke="black"/>')
        parts.append(f'<text x="{left + wide / 2}" y="{top - 8}" text-anchor="middle">ms of one picture over {"β" if sweep == "beta" else sweep}</text>')
        for decade in range(low, high + 1):
            parts.append(f'<line x1="{left}" x2="{left + wide}" y1="{y(10.0 ** decade)}" y2="{y(10.0 ** decade)}" stroke="#ddd"/>')
            parts.append(f'<text x="{left - 4}" y="{y(10.0 ** decade) + 3}" text-anchor="end">{10.0 ** decade:g}</text>')
        written = -math.inf
        for value in sorted({p[0] for p in points}):
            if x(value) - written < 12:
                continue
            written = x(value)
            label = f"{value:g}" if value < 10000 else f"{value:.0e}".replace("e+0", "e")
            parts.append(f'<text x="{x(value)}" y="{top + tall + 13}" text-anchor="middle" font-size="7">{label}</text>')
        for k, (name, line) in enumerate(lines.items()):
            path = " ".join(f"{x(v):.1f},{y(ms):.1f}" for v, ms in line)
            parts.append(f'<polyline points="{path}" fill="none" stroke="{colours[name]}" stroke-width="1.5"/>')
            parts += [f'<circle cx="{x(v):.1f}" cy="{y(ms):.1f}" r="2.5" fill="{colours[name]}"/>' for v, ms in line]
    for k, (name, colour) in enumerate(colours.items()):
        parts.append(f'<circle cx="50" cy="{height + 35 + 16 * k}" r="3" fill="{colour}"/>')
        parts.append(f'<text x="60" y="{height + 38 + 16 * k}">{name}</text>')
    return "\n".join(parts + ["</svg>"]) + "\n"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--sweeps", default="triangles,beta,objects")
    parser.add_argument("--budget", type=float, default=20.0)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--out", default=".")
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    sweeps = options.sweeps.split(",")
    table = []
    with tempfile.TemporaryDirectory() as folder:
        for sweep in sweeps:
            for value, scene, argument in SWEEPS[sweep]:
                found = study(options.program, scene(argument), options.threads, options.budget, folder)
                table += rows(sweep, value, found)
                print(sweep, value, *(f'{row["method"]} {row["ms"]} ms' for row in table if row["value"] == value and row["sweep"] == sweep), sep="  ", flush=True)
    with open(os.path.join(options.out, "crossover.csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, table[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    with open(os.path.join(options.out, "crossover.svg"), "w") as file:
        file.write(chart(table, sweeps))


main()
