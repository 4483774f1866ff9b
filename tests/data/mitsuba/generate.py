"""Light by Mitsuba 3 (pip install mitsuba numpy): direct light on a floor, a box and balls, of a panel and an even sky together, and of a
point lamp, parallel light and a picture of a sky, one at a time on metal and together on glossy dielectrics; and light that bounces in a
room with a mirror and glass."""
import math
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
T = mi.ScalarTransform4f


def rgb(value):
    return {"type": "rgb", "value": value}


def diffuse(colour):
    return {"type": "diffuse", "reflectance": rgb(colour)}


def ball(centre, radius, alpha):
    return {
        "type": "sphere", "center": centre, "radius": radius,
        "bsdf": {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": alpha},
    }


class MetallicRoughness(mi.BSDF):
    """The metallic-roughness model as glTF 2.0 publishes it (Appendix B, "BRDF implementation"), which none of Mitsuba's is. Directions are
    sampled by the cosine alone: Mitsuba weighs them against those towards the lights."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.colour = np.array([float(c) for c in props["colour"]])
        self.metallic, self.alpha = props["metallic"], props["roughness"] ** 2
        flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
        self.m_components = [flags]
        self.m_flags = flags

    def brdf(self, v, l):
        v, l = np.array(v), np.array(l)
        h = (v + l) / np.linalg.norm(v + l)
        square = self.alpha ** 2
        fresnel = (1 - abs(v @ h)) ** 5
        root = lambda x: math.sqrt(square + (1 - square) * x * x)
        d = square / (math.pi * (h[2] ** 2 * (square - 1) + 1) ** 2)
        visible = 0.5 / (l[2] * root(v[2]) + v[2] * root(l[2]))
        black, f0 = self.colour * (1 - self.metallic), 0.04 * (1 - self.metallic) + self.colour * self.metallic
        f = f0 + (1 - f0) * fresnel
        return (1 - f) * black / math.pi + f * d * visible

    def sample(self, ctx, si, sample1, sample2, active):
        bs = mi.BSDFSample3f()
        bs.wo = mi.warp.square_to_cosine_hemisphere(sample2)
        bs.pdf = mi.warp.square_to_cosine_hemisphere_pdf(bs.wo)
        bs.eta, bs.sampled_type, bs.sampled_component = 1.0, +mi.BSDFFlags.GlossyReflection, 0
        value = self.eval(ctx, si, bs.wo, active)
        return bs, value / bs.pdf if bs.pdf > 0 else mi.Color3f(0)

    def eval(self, ctx, si, wo, active):
        if si.wi[2] <= 0 or wo[2] <= 0:
            return mi.Color3f(0)
        return mi.Color3f(*(float(c) for c in self.brdf(si.wi, wo) * wo[2]))

    def pdf(self, ctx, si, wo, active):
        return mi.warp.square_to_cosine_hemisphere_pdf(wo) if si.wi[2] > 0 and wo[2] > 0 else 0.0

    def eval_pdf(self, ctx, si, wo, active):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def traverse(self, callback):
        pass

    def to_string(self):
        return "MetallicRoughness[]"


mi.register_bsdf("metallic_roughness", MetallicRoughness)


def dielectric(centre, radius, colour, metallic, roughness):
    model = {"type": "metallic_roughness", "colour": mi.ScalarColor3f(colour), "metallic": metallic, "roughness": roughness}
    return {"type": "sphere", "center": centre, "radius": radius, "bsdf": model}


def sky(rows):
    """L = 0.5 + 0.3 y + 0.15 x − 0.1 z along (x, y, z), by (1, 0.8, 0.6): row 0 is +Y, the middle −Z, and right of that +X."""
    i, j = np.meshgrid(np.arange(rows), np.arange(2 * rows), indexing="ij")
    latitude, longitude = math.pi * (0.5 - (i + 0.5) / rows), math.pi * ((j + 0.5) / rows - 1)
    x, y, z = np.cos(latitude) * np.sin(longitude), np.sin(latitude), -np.cos(latitude) * np.cos(longitude)
    return ((0.5 + 0.3 * y + 0.15 * x - 0.1 * z)[..., None] * np.array([1, 0.8, 0.6])).astype(np.float32)


def render(name, width, height, parts, samples=4096):
    """The floor and the box with these lights and balls, as `name`.npy of shape (height, width, 3)."""
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "direct"},
        "sensor": {
            "type": "perspective", "fov": 50, "fov_axis": "x",
            "to_world": T().look_at(origin=[0.5, 2.2, 5], target=[0, 0.6, 0], up=[0, 1, 0]),
            "sampler": {"type": "independent", "sample_count": samples},
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
        },
        "floor": {
            "type": "rectangle", "to_world": T().rotate([1, 0, 0], -90).scale([6, 6, 1]), "bsdf": diffuse([0.6, 0.5, 0.4]),
        },
        "box": {
            "type": "cube", "to_world": T().translate([1.1, 0.5, -0.2]).scale([0.5, 0.5, 0.5]), "bsdf": diffuse([0.3, 0.7, 0.4]),
        },
        **parts,
    })
    image = np.array(mi.render(scene, seed=1), dtype=np.float32)
    assert image.shape == (height, width, 3)
    np.save(f"{name}.npy", image)
    print(name, image.mean(axis=(0, 1)), image.max())


render("direct", 40, 30, {
    "sky": {"type": "constant", "radiance": rgb([0.3, 0.4, 0.6])},
    "panel": {
        "type": "rectangle",
        "to_world": T().translate([0, 3, 0.5]).rotate([1, 0, 0], 90).scale([0.6, 0.4, 1]),
        "bsdf": diffuse(0.0),
        "light": {"type": "area", "radiance": rgb([9, 7, 5])},
    },
    "ball": ball([-0.9, 0.8, 0.2], 0.8, 0.25),
})
lamps = {
    "point": {"type": "point", "position": [1.5, 3, 2], "intensity": rgb([20, 18, 15])},
    "directional": {"type": "directional", "direction": [-0.4, -1, -0.3], "irradiance": rgb([2, 1.8, 1.5])},
    # Mitsuba has −Z at the left edge of its pictures.
    "environment": {"type": "envmap", "bitmap": mi.Bitmap(sky(64)), "to_world": T().rotate([0, 1, 0], 180)},
}
for name, lamp in lamps.items():
    balls = {"smooth": ball([-0.9, 0.8, 0.2], 0.8, 0.09), "rough": ball([0.3, 0.4, 1.3], 0.4, 0.36)}
    render(name, 28, 21, {"light": lamp, **balls})
# One thread calls Python without its lock changing hands: a sixteenth of the samples takes minutes.
balls = {
    "smooth": dielectric([-0.9, 0.8, 0.2], 0.8, [0.7, 0.2, 0.1], 0.0, 0.3),
    "rough": dielectric([0.3, 0.4, 1.3], 0.4, [0.2, 0.5, 0.8], 0.4, 0.6),
}
render("dielectric", 28, 21, {"point": lamps["point"], "environment": lamps["environment"], **balls}, 1024)


def room(name, width, height):
    """A room that is open in front, with a mirror, a ball of glass and a box, in light that bounces up to four times."""
    wall = lambda place, turn, colour: {
        "type": "rectangle", "to_world": T().translate(place).rotate(*turn).scale([1, 1, 1]), "bsdf": diffuse(colour),
    }
    scene = mi.load_dict({
        "type": "scene",
        # From lamp to camera: six ways between surfaces, by four of them, and the first hit.
        "integrator": {"type": "path", "max_depth": 6, "rr_depth": 100},
        "sensor": {
            "type": "perspective", "fov": 36, "fov_axis": "x",
            "to_world": T().look_at(origin=[0, 1, 4.4], target=[0, 0.95, 0], up=[0, 1, 0]),
            "sampler": {"type": "independent", "sample_count": 16384},
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
        },
        "floor": wall([0, 0, 0], ([1, 0, 0], -90), [0.7, 0.7, 0.7]),
        "ceiling": wall([0, 2, 0], ([1, 0, 0], 90), [0.7, 0.7, 0.7]),
        "back": wall([0, 1, -1], ([0, 1, 0], 0), [0.5, 0.6, 0.8]),
        "left": wall([-1, 1, 0], ([0, 1, 0], 90), [0.75, 0.2, 0.15]),
        "right": wall([1, 1, 0], ([0, 1, 0], -90), [0.2, 0.6, 0.2]),
        "panel": {
            "type": "rectangle",
            "to_world": T().translate([0.1, 1.9, 0]).rotate([1, 0, 0], 90).scale([0.4, 0.3, 1]),
            "bsdf": diffuse(0.0),
            "light": {"type": "area", "radiance": rgb([12, 10, 8])},
        },
        "box": {
            "type": "cube", "to_world": T().translate([0.45, 0.3, 0.3]).scale([0.25, 0.3, 0.25]), "bsdf": diffuse([0.7, 0.6, 0.3]),
        },
        "mirror": {"type": "sphere", "center": [-0.45, 0.45, -0.4], "radius": 0.45, "bsdf": {"type": "conductor", "material": "none"}},
        "glass": {"type": "sphere", "center": [-0.3, 0.3, 0.5], "radius": 0.3, "bsdf": {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}},
    })
    image = np.array(mi.render(scene, seed=1), dtype=np.float32)
    np.save(f"{name}.npy", image)
    print(name, image.mean(axis=(0, 1)), image.max())


room("bounces", 28, 21)
