"""Frames as TIFF, by tifffile (2025 or later); see README.md. Usage: python make.py"""
import numpy as np
import tifffile

# Frame k of (4, 5, 6): sample (i, j) is 30 k + 6 i + j.
frames = np.arange(120).reshape(4, 5, 6)
for k, frame in enumerate(frames):
    tifffile.imwrite(f"f32_{k:03d}.tif", frame.astype("f4"), compression="zlib")
    tifffile.imwrite(f"u16_{k:03d}.tiff", (100 * frame).astype("u2"), byteorder=">", tile=(16, 16))
    tifffile.imwrite(f"rgb_{k:03d}.tif", np.stack([frame, 2 * frame, 0 * frame], -1).astype("u1"), photometric="rgb", compression="zlib", rowsperstrip=3)
    tifffile.imwrite(f"f16_{k:03d}.tif", frame.astype("f2"), rowsperstrip=2)
# All in one file, and the first with a preview behind it.
tifffile.imwrite("stack.tif", frames.astype("f4"), photometric="minisblack")
with tifffile.TiffWriter("preview.tif") as f:
    f.write(frames[0].astype("f4"))
    f.write(frames[0, ::2, ::2].astype("f4"), subfiletype=1)
