"""Writes the seeds that are not of the program's own making (fuzz/README.md), into the folder that it stands in."""

import os
import struct
import zipfile
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))


def save(name, data):
    with open(os.path.join(HERE, name), "wb") as file:
        file.write(data if isinstance(data, bytes) else data.encode())


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, bits, colour, rows, extra=b"", interlace=0):
    head = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, interlace)
    body = chunk(b"IHDR", head) + extra + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def rows(height, size, byte=b"\x5a"):
    return (b"\x00" + byte * size) * height


# Pictures of every kind of sample; one that is 64 million pixels of one bit.
PALETTE = chunk(b"PLTE", bytes(range(12))) + chunk(b"tRNS", b"\x00\x80")
TEXT = chunk(b"tEXt", b"Title\0some words") + chunk(b"zTXt", b"Comment\0\0" + zlib.compress(b"packed"))
KINDS = {
    "grey1": png(9, 4, 1, 0, rows(4, 2)),
    "grey16": png(3, 4, 16, 0, rows(4, 6), TEXT),
    "rgb8": png(3, 4, 8, 2, rows(4, 9)),
    "rgb16": png(3, 4, 16, 2, rows(4, 18)),
    "palette2": png(5, 4, 2, 3, rows(4, 2), PALETTE),
    "greyalpha8": png(3, 4, 8, 4, rows(4, 6)),
    "rgba16": png(3, 4, 16, 6, rows(4, 24)),
}
for name, data in KINDS.items():
    save(f"picture_png/{name}.png", data)
    save(f"texture/{name}.png", data)
save("picture_png/wide.png", png(8000, 8000, 1, 0, rows(8000, 1000, b"\0")))
save("texture/wide.png", png(16384, 4096, 1, 0, rows(4096, 2048, b"\0")))


def npy(shape, descr, data=b""):
    text = f"{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}"
    text += " " * (63 - (10 + len(text)) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode() + data


# Archives whose directories claim 32 GiB, stored or compressed, in 64-bit fields.
def lying(name, member, claimed):
    data = zlib.compress(member, 9)[2:-4]
    crc = zlib.crc32(member)
    extra = struct.pack("<HHQQ", 1, 16, claimed, claimed // 1000)
    sizes = struct.pack("<II", 0xFFFFFFFF, 0xFFFFFFFF)
    local = b"PK\x03\x04" + struct.pack("<HHHHHI", 45, 0, 8, 0, 33, crc) + sizes
    local += struct.pack("<HH", len(name), len(extra)) + name + extra
    entry = b"PK\x01\x02" + struct.pack("<HHHHHHI", 45, 45, 0, 8, 0, 33, crc) + sizes
    entry += struct.pack("<HHHHHII", len(name), len(extra), 0, 0, 0, 0, 0) + name + extra
    end = struct.pack("<HHHHIIH", 0, 0, 1, 1, len(entry), len(local) + len(data), 0)
    return local + data + entry + b"PK\x05\x06" + end


huge = npy("(65536, 65536)", "<f8")
save("picture_npz/claims-32-gib.npz", lying(b"value.npy", huge, 32 << 30))
save("cube_npz/claims-32-gib.npz", lying(b"cube.npy", npy("(4096, 1024, 1024, 1)", "<f8"), 32 << 30))
save("cube_npy/claims-32-gib.npy", npy("(4096, 1024, 1024, 1)", "<f8", b"\0" * 64))
for descr, size in [("<f2", 2), (">f4", 4), ("<f8", 8)]:
    save(f"cube_npy/small{descr[1:]}.npy", npy("(2, 3, 2)", descr, b"\0" * 12 * size))
with zipfile.ZipFile(os.path.join(HERE, "picture_npz/several.npz"), "w", zipfile.ZIP_DEFLATED) as archive:
    for name, shape, descr, size in [("radiance", "(2, 3, 3)", "<f2", 36), ("a", "(2, 3)", "|u1", 6)]:
        archive.writestr(zipfile.ZipInfo(name + ".npy"), npy(shape, descr, b"\0" * size))

# The data window of a small EXR file, made 16384 by 8192.
frame = open(os.path.join(HERE, "picture_exr/frame.exr"), "rb").read()
window = b"dataWindow\0box2i\0" + struct.pack("<I", 16)
at = frame.index(window) + len(window)
save("picture_exr/claims-much.exr", frame[: at + 8] + struct.pack("<ii", 16383, 8191) + frame[at + 16 :])

# Transient images of each version, and one whose sizes have a product beyond 64 bits.
SAMPLES = struct.pack("<24f", *range(24))
BLOCK = struct.pack("<II15f", 3, 2, *range(15))
save("cube_ti/version4.ti", b"TI04" + struct.pack("<IIIffI", 10, 6, 4, 0.5, 0.25, len(BLOCK)) + SAMPLES + BLOCK + b"{}")
save("cube_ti/version1.ti", b"TI01" + struct.pack("<IIIff", 4, 3, 2, 0, 1) + SAMPLES)
save("cube_ti/version0.ti", b"TI00" + struct.pack("<IIIff", 2, 4, 3, 0, 1) + SAMPLES)
save("cube_ti/overflow.ti", b"TI01" + struct.pack("<IIIff", 2**32 - 1, 2**32 - 1, 2**32 - 1, 0, 1) + SAMPLES)

# Radiance pictures: plain pixels, runs by pixel (old) and by component, and one that claims 2^30 pixels.
RADIANCE = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n"
save("picture_hdr/plain.hdr", RADIANCE + b"-Y 2 +X 3\n" + bytes([128, 64, 32, 129] * 6))
save("picture_hdr/old-runs.hdr", RADIANCE + b"-Y 2 +X 3\n" + bytes([128, 64, 32, 129, 1, 1, 1, 5]))
line = bytes([2, 2, 0, 9]) + bytes([137, 7] * 3) + bytes([9] + [129] * 9)
save("picture_hdr/runs.hdr", RADIANCE + b"-Y 2 +X 9\n" + 2 * line)
save("picture_hdr/claims-much.hdr", RADIANCE + b"-Y 32768 +X 32768\n" + bytes([2, 2, 128, 0, 255, 7]))

# What once ended in a panic, was dropped in silence, or took long.
save("scene/column-65536.toml", "camera = 1\nb = \"" + "x" * 65536 + "\" ]\n")
save("scene/column-65535.toml", "b = [" + "1, " * 22000 + "wrong ]\n")
for number in [2**63 - 1, 2**63, 2**64 - 1, 2**64]:
    save(f"scene/integer-{number}.toml", f"[camera]\neye = [0, 0, {number}]\nlook_at = [0, 0, 0]\nsize = [{number}, 4]\n")
save("scene/escapes.toml", "[camera]\n\"\x1b[2J\x9b31m\u202e\" = 1\n")
save("scene/deep.toml", "a = " + "[" * 2000 + "\n")
events = "".join(f"[[diagram.event]]\nname = \"E{i}\"\nat = [{i % 7}, {i % 5}]\nlabel = \"E{i}\"\n" for i in range(200))
save("diagram/events.toml", events)
lines = "".join(f"[[diagram.worldline]]\nname = \"L{i}\"\nat = [0, {i}]\nvelocity = 0.{i % 9}\nticks = 0.001\n" for i in range(60))
save("diagram/ticked.toml", lines)

for index, setting in enumerate(["camera.velocity={beta=[0.5,0,0]}", "camera.time=3 m", "object.0.velocity.beta=0.9",
                                 "display.white=1e300", "camera.size=[9223372036854775807, 4]", "object.dice.name=x",
                                 "a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r=1", "camera.\"\u202e\"=1"]):
    save(f"override/{index}.txt", setting)
save("spectrum/plain.csv", "nm,value\n400,0.1\n500 0.5\n600;1\n# done\n")
save("spectrum/wrong.csv", "400,nan\n300,1e400\n")
TEXTS = ["event,normal,uv.u", "all", "outlines,beta", "radiance.rmse=0.1", "psnr=30", "12 ns", "0.6 m", "299792458 m/s",
         "60 deg", "99 %", "9.81 m/s^2", "raster:adaptive=0.5,attributes=vertex", "warp:panorama=2048x1024,lookup=nearest",
         "x_{1}^{2} *ct* \u03b3\u2032", "_{_{_{", "1e400 m", "-0 s", "\u22125 ps"]
for index, text in enumerate(TEXTS):
    save(f"texts/{index:02}.txt", text)

# A reconstruction by COLMAP, as binary files and as texts: two images, a pinhole.
images = struct.pack("<Q", 2)
for number, pose, camera, name, points in [(1, [1, 0, 0, 0, 0, 0, 0], 1, b"b", 2), (7, [.5, .5, .5, -.5, -2, 5, 1], 1, b"a", 0)]:
    images += struct.pack("<I7dI", number, *pose, camera) + name + b"\0" + struct.pack("<Q", points) + b"\x09" * (24 * points)
save("colmap/images.bin", images)
save("colmap/cameras.bin", struct.pack("<QIIQQ4d", 1, 1, 1, 640, 480, 320, 320, 320, 240))
save("colmap/images.txt.bin", "# list\n1 0.5 0.5 0.5 -0.5 -2 5 1 1 a\n1 2 3\n")
save("colmap/cameras.txt.bin", "1 SIMPLE_PINHOLE 640 480 320 320 240\n")


# Models, each with what the others have not.
def glb(document, data=b""):
    import json

    document = {"asset": {"version": "2.0"}, **document}
    if data:
        document["buffers"] = [{"byteLength": len(data)}]
        data += b"\0" * (-len(data) % 4)
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if data:
        chunks += struct.pack("<II", len(data), 0x004E4942) + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def model(primitive, views, accessors, **more):
    document = {
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "a", "mesh": 0}],
        "meshes": [{"primitives": [primitive]}],
        "bufferViews": [],
        "accessors": accessors,
    }
    data = b""
    for view, extra in views:
        data += b"\0" * (-len(data) % 4)
        document["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": len(view), **extra})
        data += view
    document.update(more)
    return glb(document, data)


CORNERS = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0)
PLACES = {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}
POSITION = {"attributes": {"POSITION": 0}}


def indexed(kind, code, numbers, mode=4):
    view = struct.pack(f"<{len(numbers)}{code}", *numbers)
    accessor = {"bufferView": 1, "componentType": kind, "count": len(numbers), "type": "SCALAR"}
    return model({**POSITION, "indices": 1, "mode": mode}, [(CORNERS, {}), (view, {})], [PLACES, accessor])


UVS = struct.pack("<8H", 0, 0, 65535, 0, 0, 65535, 65535, 65535)
IMAGE = png(2, 2, 8, 2, rows(2, 6))
TRANSFORM = {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 1, "scale": [2, 2]}}
GLASS = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5}}
LIGHTS = [{"type": "point", "intensity": 3}, {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}}]
TURN = struct.pack("<2f", 0, 1) + struct.pack("<6f", 0, 0, 0, 1, 2, 3)
INSTANCES = struct.pack("<6f", 0, 0, 0, 2, 0, 0)
MODELS = {
    "bytes": indexed(5121, "B", [0, 1, 2, 2, 1, 3]),
    "strip": indexed(5123, "H", [0, 1, 2, 3], 5),
    "fan": indexed(5125, "I", [0, 1, 3, 2], 6),
    "interleaved": model(
        {"attributes": {"POSITION": 0, "COLOR_0": 1}},
        [(b"".join(CORNERS[12 * k : 12 * k + 12] + b"\xff\x80\0\xff" for k in range(3)), {"byteStride": 16})],
        [
            {**PLACES, "count": 3},
            {"bufferView": 0, "byteOffset": 12, "componentType": 5121, "normalized": True, "count": 3, "type": "VEC4"},
        ],
    ),
    "textured": model(
        {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "mode": 5, "material": 0},
        [(CORNERS, {}), (UVS, {}), (IMAGE, {})],
        [PLACES, {"bufferView": 1, "componentType": 5123, "normalized": True, "count": 4, "type": "VEC2"}],
        images=[{"bufferView": 2, "mimeType": "image/png"}],
        samplers=[{"wrapS": 33071, "magFilter": 9728}],
        textures=[{"source": 0, "sampler": 0}],
        materials=[
            {
                "name": "m",
                "doubleSided": True,
                "alphaMode": "MASK",
                "extensions": GLASS,
                "emissiveFactor": [1, 0, 0],
                "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": TRANSFORM}, "roughnessFactor": 0},
            }
        ],
        extensionsUsed=["KHR_texture_transform", "KHR_materials_transmission", "KHR_materials_ior"],
    ),
    "sparse": model(
        {**POSITION, "mode": 5},
        [(b"\1\0", {}), (struct.pack("<3f", 5, 6, 7), {})],
        [
            {
                "componentType": 5126,
                "count": 4,
                "type": "VEC3",
                "min": [0, 0, 0],
                "max": [5, 6, 7],
                "sparse": {"count": 1, "indices": {"bufferView": 0, "componentType": 5123}, "values": {"bufferView": 1}},
            }
        ],
    ),
    "moving": model(
        {**POSITION, "mode": 5},
        [(CORNERS, {}), (TURN[:8], {}), (TURN[8:], {})],
        [
            PLACES,
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"},
        ],
        nodes=[
            {"name": "a", "mesh": 0, "children": [1, 2, 3], "rotation": [0, 0.6, 0, 0.8], "scale": [1, -1, 2]},
            {"name": "c", "camera": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
            {"name": "l", "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"name": "s", "extensions": {"KHR_lights_punctual": {"light": 1}}},
        ],
        cameras=[{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1, "aspectRatio": 1.5}}],
        animations=[
            {
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                "samplers": [{"input": 1, "output": 2}],
            }
        ],
        extensions={"KHR_lights_punctual": {"lights": LIGHTS}},
        extensionsUsed=["KHR_lights_punctual"],
    ),
    "instances": model(
        {**POSITION, "mode": 5},
        [(CORNERS, {}), (INSTANCES, {})],
        [PLACES, {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC3"}],
        nodes=[{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}}}],
        extensionsUsed=["EXT_mesh_gpu_instancing"],
        extensionsRequired=["EXT_mesh_gpu_instancing"],
    ),
    # Accessors that lie: counts beyond the view, indices beyond the corners, a loop of nodes.
    "beyond": model(POSITION, [(CORNERS, {})], [{**PLACES, "count": 4294967295}]),
    "stray": indexed(5125, "I", [0, 1, 4294967295]),
    "loop": model(POSITION, [(CORNERS, {})], [{**PLACES, "count": 3}], nodes=[{"mesh": 0, "children": [0]}]),
}
for name, data in MODELS.items():
    save(f"gltf/{name}.glb", data)
