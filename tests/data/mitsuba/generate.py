"""Direct light of a panel and an even sky on a floor, a box and a metal ball, by Mitsuba 3 (pip install mitsuba numpy)."""
import math
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
T = mi.ScalarTransform4f
width, height = 40, 30
scene = mi.load_dict({
    "type": "scene",
    "integrator": {"type": "direct"},
    "sensor": {
        "type": "perspective", "fov": 50, "fov_axis": "x",
        "to_world": T().look_at(origin=[0.5, 2.2, 5], target=[0, 0.6, 0], up=[0, 1, 0]),
        "sampler": {"type": "independent", "sample_count": 4096},
        "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
    },
    "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [0.3, 0.4, 0.6]}},
    "panel": {
        "type": "rectangle",
        "to_world": T().translate([0, 3, 0.5]).rotate([1, 0, 0], 90).scale([0.6, 0.4, 1]),
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}},
        "light": {"type": "area", "radiance": {"type": "rgb", "value": [9, 7, 5]}},
    },
    "floor": {
        "type": "rectangle",
        "to_world": T().rotate([1, 0, 0], -90).scale([6, 6, 1]),
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.6, 0.5, 0.4]}},
    },
    "box": {
        "type": "cube",
        "to_world": T().translate([1.1, 0.5, -0.2]).scale([0.5, 0.5, 0.5]),
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.3, 0.7, 0.4]}},
    },
    "ball": {
        "type": "sphere", "center": [-0.9, 0.8, 0.2], "radius": 0.8,
        "bsdf": {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": 0.25},
    },
})
image = np.array(mi.render(scene, seed=1), dtype=np.float32)
assert image.shape == (height, width, 3)
np.save("direct.npy", image)
print(image.mean(axis=(0, 1)))
