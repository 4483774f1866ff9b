"""How fast is path tracing, and baking in time, at equal noise? nullray beside Mitsuba 3 and mitransient.

    python3 benches/studies/peers.py PROGRAM [--threads N] [--samples N] [--seeds N] [--only cornell,hall,transient] [--json FILE]

Both programs render one scene with several seeds. The noise of a picture is the mean over pixels of the variance between seeds, relative to
the square of the mean picture (in time: of the cube, bin by bin); the time is that of the processor, all threads together, which other load
on the machine changes less than the wall's. Neither counts loading, building trees, or translation to machine code (a first picture is thrown
away). As noise falls as 1/samples for both, or faster, a program is faster at equal noise by

    (time · noise of the peer)/(time · noise of nullray).

Lines also say how far the mean pictures of both are apart, in units of what the noise of both lets expect: about 1 where they show the same.
Peers are from the Python package index (mitsuba 3.9.1, mitransient 1.3.1 were measured) and need LLVM (DRJIT_LIBLLVM_PATH); they are skipped
by name where they are absent. PROGRAM is nullray, a release build.
"""

import argparse
import json
import math
import os
import re
import resource
import subprocess
import tempfile
import time

import numpy as np

WHITE, RED, GREEN = [0.73, 0.73, 0.71], [0.6, 0.06, 0.05], [0.13, 0.45, 0.1]
BOUNCES = 4
PULSE = 1e-4  # sigma of the flash, metres: far below a bin
BINS = (100, 0.08, 2.0)  # count, width, start

# Boxes: size, centre, turn about y in degrees, colour.
CORNELL = [
    ([2, 0.02, 2], [0, -0.01, 0], 0, WHITE),
    ([2, 0.02, 2], [0, 2.01, 0], 0, WHITE),
    ([2, 2, 0.02], [0, 1, -1.01], 0, WHITE),
    ([0.02, 2, 2], [-1.01, 1, 0], 0, RED),
    ([0.02, 2, 2], [1.01, 1, 0], 0, GREEN),
    ([0.6, 1.2, 0.6], [-0.35, 0.6, -0.35], 17, WHITE),
    ([0.6, 0.6, 0.6], [0.36, 0.3, 0.3], -17, WHITE),
]
# A hall of two rows of columns, open towards the camera.
HALL = [
    ([6, 0.02, 12], [0, -0.01, -4], 0, WHITE),
    ([6, 0.02, 12], [0, 3.01, -4], 0, WHITE),
    ([0.02, 3, 12], [-3.01, 1.5, -4], 0, RED),
    ([0.02, 3, 12], [3.01, 1.5, -4], 0, GREEN),
    ([6, 3, 0.02], [0, 1.5, -10.01], 0, WHITE),
] + [([0.4, 3, 0.4], [x, 1.5, -2 * k], 15 * k, WHITE) for k in range(5) for x in (-1.4, 1.4)]

SCENES = {
    "cornell": dict(boxes=CORNELL, eye=[0, 1, 3.9], at=[0, 1, 0], fov=40, panel=([0.5, 0.4], [0, 1.99, 0]), radiance=[18, 13, 6]),
    "hall": dict(boxes=HALL, eye=[0.3, 1.4, 4.5], at=[0, 1.3, -4], fov=50, panel=([1.5, 6], [0, 2.99, -4]), radiance=[8, 8, 7]),
}


def nullray_scene(scene, size, lamp=False):
    text = f'[render]\nbounces = {BOUNCES}\n[display]\nback_faces = "culled"\n[camera]\neye = {scene["eye"]}\nlook_at = {scene["at"]}\n'
    text += f'hfov = "{scene["fov"]} deg"\nsize = [{size}, {size}]\n'
    for k, (extent, centre, turn, colour) in enumerate(scene["boxes"]):
        text += f'[[object]]\nname = "box {k}"\nshape = {{ box = {{ size = {extent} }} }}\ncolour = {colour}\n'
        text += f'transform = {{ translate = {centre}, rotate = {{ axis = [0, 1, 0], angle = "{turn} deg" }} }}\n'
    (w, d), place = scene["panel"]
    if lamp:
        x, y, z = place
        return text + f'[[light]]\nposition = [{x}, {y - 0.2}, {z}]\nintensity = 10\nemission = {{ gaussian = {{ sigma = "{PULSE} m" }} }}\n'
    text += f'[[object]]\nname = "panel"\nshape = {{ plane = {{ size = [{w}, {d}] }} }}\ncolour = [0, 0, 0]\n'
    text += f'transform = {{ translate = {place}, rotate = {{ axis = [1, 0, 0], angle = "180 deg" }} }}\n'
    return text + f'[[light]]\nname = "panel"\ntype = "area"\nobject = "panel"\nradiance = {scene["radiance"]}\n'


def nullray_run(program, arguments, threads):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    run = subprocess.run([program, *arguments, "--threads", str(threads)], capture_output=True, text=True)
    if run.returncode:
        raise SystemExit(run.stderr)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def nullray_pictures(program, scene, size, samples, seeds, threads, folder):
    path, out = os.path.join(folder, "scene.toml"), os.path.join(folder, "out.npz")
    with open(path, "w") as file:
        file.write(nullray_scene(scene, size))
    pictures, seconds = [], []
    for seed in range(seeds):
        one = lambda n: nullray_run(program, ["render", path, "-q", "--spp", str(n), "--set", f"render.seed={seed}", "-o", out], threads)
        # What one sample takes less is loading, building and writing.
        rest = one(1)
        seconds.append(one(samples) - rest)
        pictures.append(np.load(out)["radiance"])
    return np.array(pictures), np.median(seconds) * samples / (samples - 1)


def nullray_cubes(program, scene, size, samples, seeds, threads, folder):
    path, out = os.path.join(folder, "scene.toml"), os.path.join(folder, "cube.npy")
    with open(path, "w") as file:
        file.write(nullray_scene(scene, size, lamp=True))
    count, width, start = BINS
    cubes, seconds = [], []
    for seed in range(seeds):
        def one(n):
            return nullray_run(
                program,
                ["bake", path, "-q", "--camera", "--spp", str(n), "--set", f"render.seed={seed}", "-o", out,
                 "--bins", str(count), "--bin-width", f"{width} m", "--start", f"{start} m"], threads)
        rest = one(1)
        seconds.append(one(samples) - rest)
        cubes.append(np.load(out))
    return np.array(cubes), np.median(seconds) * samples / (samples - 1)


def mitsuba_scene(mi, scene, size, samples, transient=False):
    from mitsuba import ScalarTransform4f as T
    count, width, start = BINS
    (w, d), place = scene["panel"]
    camera = {
        "type": "perspective", "fov": scene["fov"], "fov_axis": "x",
        # Times of Mitsuba's rays count from the near plane on.
        "near_clip": 1e-4, "far_clip": 100.0,
        "to_world": T().look_at(origin=scene["eye"], target=scene["at"], up=[0, 1, 0]),
        "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"},
        "sampler": {"type": "multijitter" if not transient else "independent", "sample_count": samples},
    }
    integrator = {"type": "path", "max_depth": BOUNCES + 2, "rr_depth": 1000}
    if transient:
        camera["film"] = {"type": "transient_hdr_film", "width": size, "height": size, "temporal_bins": count, "bin_width_opl": width,
                          "start_opl": start, "rfilter": {"type": "box"}}
        integrator = {"type": "transient_path", "max_depth": BOUNCES + 2, "rr_depth": 1000, "camera_unwarp": False, "temporal_filter": "box"}
    tree = {"type": "scene", "integrator": integrator, "sensor": camera}
    for k, (extent, centre, turn, colour) in enumerate(scene["boxes"]):
        tree[f"box{k}"] = {
            "type": "cube",
            "to_world": T().translate(centre).rotate([0, 1, 0], turn).scale([e / 2 for e in extent]),
            "bsdf": {"type": "twosided", "material": {"type": "diffuse", "reflectance": {"type": "rgb", "value": colour}}},
        }
    if transient:
        x, y, z = place
        # The energy of a Gaussian of peak 10.
        energy = 10 * math.sqrt(2 * math.pi) * PULSE
        tree["lamp"] = {"type": "point", "position": [x, y - 0.2, z], "intensity": {"type": "rgb", "value": [energy] * 3}}
    else:
        tree["panel"] = {
            "type": "rectangle",
            "to_world": T().translate(place).rotate([1, 0, 0], 90).scale([w / 2, d / 2, 1]),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0, 0, 0]}},
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": scene["radiance"]}},
        }
    return mi.load_dict(tree)


def mitsuba_pictures(scene, size, samples, seeds, threads, transient=False):
    import drjit as dr
    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    if transient:
        import mitransient  # noqa: F401  (registers its plugins)
    dr.set_thread_count(threads)
    loaded = mitsuba_scene(mi, scene, size, samples, transient)
    pictures, seconds, walls = [], [], []
    for seed in range(-1, seeds):
        before, began = resource.getrusage(resource.RUSAGE_SELF).ru_utime, time.time()
        image = mi.render(loaded, spp=samples, seed=seed + 1)
        image = np.array(image[1] if transient else image)
        if seed >= 0:
            seconds.append(resource.getrusage(resource.RUSAGE_SELF).ru_utime - before)
            walls.append(time.time() - began)
            pictures.append(image[..., :3])
    return np.array(pictures), np.median(seconds)


def noise(pictures):
    mean = pictures.mean(axis=0)
    return pictures.var(axis=0, ddof=1).mean() / (mean**2).mean()


def report(name, ours, peers, peer):
    (a, ta), (b, tb) = ours, peers
    na, nb = noise(a), noise(b)
    apart = ((a.mean(axis=0) - b.mean(axis=0)) ** 2).mean()
    expected = a.var(axis=0, ddof=1).mean() / len(a) + b.var(axis=0, ddof=1).mean() / len(b)
    line = dict(scene=name, peer=peer, nullray_seconds=ta, peer_seconds=tb, nullray_noise=math.sqrt(na), peer_noise=math.sqrt(nb),
                faster=tb * nb / (ta * na), apart=math.sqrt(apart / expected))
    print(f"{name}: nullray {ta:.2f} s, noise {100 * math.sqrt(na):.2f} %; {peer} {tb:.2f} s, noise {100 * math.sqrt(nb):.2f} %: "
          f"nullray is {line['faster']:.2f} times as fast at equal noise; means apart {line['apart']:.2f} of the noise", flush=True)
    return line


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--size", type=int, default=240)
    parser.add_argument("--only", default="cornell,hall,transient")
    parser.add_argument("--json")
    chosen = parser.parse_args()
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        for name in chosen.only.split(","):
            transient = name == "transient"
            scene, size = SCENES["cornell" if transient else name], chosen.size // 2 if transient else chosen.size
            arguments = (scene, size, chosen.samples, chosen.seeds, chosen.threads)
            peer = "mitransient" if transient else "Mitsuba"
            try:
                peers = mitsuba_pictures(*arguments, transient=transient)
            except ImportError as missing:
                print(f"{name}: skipped: {peer} is not here ({missing})")
                continue
            run = nullray_cubes if transient else nullray_pictures
            ours = run(chosen.program, *arguments, folder)
            lines.append(report(name, ours, peers, peer))
    if chosen.json:
        with open(chosen.json, "w") as file:
            json.dump(lines, file, indent=1)


if __name__ == "__main__":
    main()
