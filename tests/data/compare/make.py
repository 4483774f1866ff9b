"""Reference values for tests/compare: numpy, scikit-image and the published FLIP, on pictures made by integer formulas.

    pip install numpy scikit-image flip-evaluator && python make.py > metrics.csv
"""
import numpy as np
import flip_evaluator
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

def light(width, height):
    """The reference and the candidate: see `pictures.rs`."""
    y, x, c = np.meshgrid(np.arange(height), np.arange(width), np.arange(3), indexing="ij")
    noise = ((x * 37 + y * 57 + c * 101) ^ (x * y)) % 256
    smooth = (x * x + 3 * y * y + c * 50 * x) % 1024
    board = np.where((x // 40 + y // 30) % 2 == 1, 4.0, 1.0)
    ramp = 2.0 ** (x * 6 // width)
    reference = (noise / 1024.0 + smooth / 256.0) * board * ramp / 64.0
    factor = 1.0 + ((x * 13 + y * 7 + c) % 17 - 6) / 64.0
    return reference.astype(np.float32), (reference * factor).astype(np.float32)

def codes(width, height):
    """The same as 8-bit codes."""
    clip = lambda v: np.floor(255.0 * np.minimum(v, 1.0)) / 255.0
    return [clip(v.astype(np.float64)) for v in light(width, height)]

def numbers(r, c, peak):
    r, c = r.astype(np.float64), c.astype(np.float64)
    e = c - r
    yield "bias", e.mean()
    yield "mae", np.abs(e).mean()
    yield "rmse", np.sqrt((e * e).mean())
    yield "relrmse", np.sqrt((e * e).sum() / (r * r).sum())
    yield "mrse", (e * e / (r + 0.01) ** 2).mean()
    yield "max", np.abs(e).max()
    for p in (50, 90, 99, 99.9):
        yield f"p{p}", np.percentile(np.abs(e), p, method="inverted_cdf")
    yield "psnr", peak_signal_noise_ratio(r, c, data_range=peak)
    yield "ssim", structural_similarity(r, c, data_range=peak, channel_axis=2)

def flip(r, c, kind):
    _, mean, parameters = flip_evaluator.evaluate(r, c, kind, inputsRGB=(kind == "LDR"), applyMagma=False)
    error = flip_evaluator.evaluate(r, c, kind, inputsRGB=(kind == "LDR"), applyMagma=False)[0]
    yield "flip", float(mean)
    yield "flip_max", float(np.max(error))
    if kind == "HDR":
        yield "flip_start", parameters["startExposure"]
        yield "flip_stop", parameters["stopExposure"]
        yield "flip_steps", parameters["numExposures"]

print("picture,width,height,metric,value")
for width, height in ((61, 47), (600, 300)):
    r, c = light(width, height)
    for name, value in [*numbers(r, c, float(np.abs(r).max())), *flip(r, c, "HDR")]:
        print(f"light,{width},{height},{name},{value!r}".replace("np.float64(", "").replace(")", ""))
    r, c = codes(width, height)
    for name, value in [*numbers(r, c, 1.0), *flip(r.astype(np.float32), c.astype(np.float32), "LDR")]:
        print(f"codes,{width},{height},{name},{value!r}".replace("np.float64(", "").replace(")", ""))
