"""Captures of scenes/corner/corner.glb by mitransient; see README.md. Usage: python make.py ../../../scenes/corner/corner.glb"""
import json, struct, sys
import numpy as np
import mitsuba as mi

mi.set_variant("llvm_ad_mono")
import mitransient  # registers its plugins

with open(sys.argv[1], "rb") as file:
    glb = file.read()
length = struct.unpack("<I", glb[12:16])[0]
document, buffer = json.loads(glb[20:20 + length]), glb[28 + length:]


def accessor(index):
    a = document["accessors"][index]
    view = document["bufferViews"][a["bufferView"]]
    offset = view.get("byteOffset", 0) + a.get("byteOffset", 0)
    dtype = {5126: "<f4", 5125: "<u4", 5123: "<u2"}[a["componentType"]]
    width = {"VEC3": 3, "VEC2": 2, "SCALAR": 1}[a["type"]]
    return np.frombuffer(buffer, dtype, a["count"] * width, offset).reshape(a["count"], width)


scene = {"type": "scene", "light": {"type": "point", "position": [1.2, 2.8, 1.0], "intensity": 10.0},
         "integrator": {"type": "transient_path", "max_depth": 3}}
for mesh in document["meshes"]:
    primitive = mesh["primitives"][0]
    points, faces = accessor(primitive["attributes"]["POSITION"]), accessor(primitive["indices"]).ravel()
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict({"type": "diffuse", "reflectance": 0.6})
    shape = mi.Mesh(mesh["name"], len(points), len(faces) // 3, props=properties)
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = points.ravel()
    parameters["faces"] = faces.astype(np.uint32)
    parameters.update()
    scene[mesh["name"]] = shape


def capture(near, unwarp, start, bins):
    """(32, 40, bins, 1), f4: a crop of a film of 48 x 40 whose vertical field of view is 40 degrees."""
    film = {"type": "transient_hdr_film", "width": 48, "height": 40, "crop_width": 40, "crop_height": 32,
            "crop_offset_x": 5, "crop_offset_y": 3, "temporal_bins": bins, "start_opl": start,
            "bin_width_opl": 0.1, "rfilter": {"type": "box"}}
    pose = mi.ScalarTransform4f().look_at(origin=[3.2, 3.0, 4.6], target=[-0.4, 1.0, -0.6], up=[0, 1, 0])
    sensor = {"type": "perspective", "fov": 40, "fov_axis": "y", "near_clip": near, "to_world": pose,
              "film": film, "sampler": {"type": "independent"}}
    integrator = {**scene["integrator"], "camera_unwarp": unwarp}
    loaded = mi.load_dict({**scene, "sensor": sensor, "integrator": integrator})
    total = 0
    for seed in range(8):
        _, transient = mi.render(loaded, spp=512, seed=seed)
        total = total + np.array(transient, np.float64) / 8
    # The lamp's pulse: a Gaussian of 0.2 m.
    offsets = 0.1 * np.arange(-10, 11)
    pulse = np.exp(-0.5 * (offsets / 0.2) ** 2)
    pulse /= pulse.sum()
    # The array has the whole film's size, and the crop begins at its corner.
    total = total[:32, :40]
    return np.apply_along_axis(lambda x: np.convolve(x, pulse, "same"), 2, total).astype(np.float32)


world = capture(0.01, True, 1.0, 80)
np.savez_compressed("unwarped.npz", data=world.astype(np.float16))
for name, plane, start in [("near_clip.npz", 2.0, 4.0), ("near_clip_default.npz", 0.01, 6.0), ("near_clip_3.npz", 3.0, 3.0)]:
    near = capture(plane, False, start, 90)
    print(name, near.shape, near.sum(), near.sum((0, 1, 3))[[0, -1]])
    np.savez_compressed(name, data=near.astype(np.float16))
