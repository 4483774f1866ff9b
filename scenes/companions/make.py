"""Writes landscape.npz: rows, columns and five channels, "R", "G", "B", "IR", "UV", of sunlit water, trees, snow and a fire.

Infrared and ultraviolet are in units of the white's radiance at 830 and at 360 nm, as `channels` of a cube are.
"""

import numpy as np

ROWS, COLUMNS = 144, 192
y, x = np.mgrid[0:ROWS, 0:COLUMNS] / [[[ROWS]], [[COLUMNS]]]
rng = np.random.default_rng(1)


def waves(*parts):
    """A sum of sines across the picture, of amplitudes, numbers of waves and phases."""
    return sum(a * np.sin(2 * np.pi * n * x + phase) for a, n, phase in parts)


def relief():
    """The slope of a rough surface towards the left, about 1 at most: waves of all lengths, the longer the higher."""
    n, m = np.fft.fftfreq(ROWS)[:, None] * ROWS, np.fft.rfftfreq(COLUMNS) * COLUMNS
    heights = rng.standard_normal((ROWS, COLUMNS // 2 + 1)) * np.exp(2j * np.pi * rng.random((ROWS, COLUMNS // 2 + 1)))
    heights /= np.maximum(np.hypot(n, m), 3) ** 1.7
    surface = np.fft.irfft2(heights, (ROWS, COLUMNS))
    slope = np.gradient(surface, axis=1) + 0.6 * np.gradient(surface, axis=0)
    return slope / (2 * slope.std())


# The sky: blue above, pale below, little infrared, much ultraviolet.
low = np.clip(y / 0.5, 0, 1)[..., None]
picture = (1 - low) * [0.1, 0.22, 0.6, 0.04, 0.55] + low * [0.5, 0.6, 0.75, 0.12, 0.5]
# Snow on mountains: white to the eye, bright in the ultraviolet, dim from a micrometre on; the sun comes from the left.
ridge = 0.3 + waves((0.07, 1.3, 1), (0.05, 2.9, 2.2), (0.02, 7, 0.4), (0.008, 17, 1))
mountains = y > ridge
lit = np.clip(0.55 + 0.5 * relief() + 0.1 * np.gradient(ridge, 1 / COLUMNS, axis=1), 0.08, 1)[..., None]
picture = np.where(mountains[..., None], lit * [0.85, 0.86, 0.88, 0.22, 0.7] + (1 - lit) * [0.05, 0.09, 0.2, 0.02, 0.25], picture)
# Trees: dark green, and bright in the infrared, as leaves are; each is lighter on its left.
for base, size, count, shade in [(0.62, 0.09, 34, 0.6), (0.7, 0.12, 23, 0.8), (0.8, 0.17, 15, 1.0)]:
    place = x * count + 0.3 * np.sin(7 * x)
    side = place % 1 - 0.5
    height = size * (0.75 + 0.25 * np.sin(np.floor(place) * 2.4))
    trees = (y > base - height * (1 - 2 * np.abs(side))) & (y < base + 0.2)
    light = shade * np.clip(0.55 - 0.9 * side + 0.12 * np.sin(260 * y), 0.08, 1)[..., None]
    picture = np.where(trees[..., None], light * [0.03, 0.08, 0.02, 0.6, 0.01], picture)
# Water: it mirrors some of the sky, with ripples, and is black in the infrared.
ripples = (0.7 + 0.3 * np.sin(900 * y**3 + 3 * np.sin(30 * x)))[..., None]
picture = np.where((y > 0.82)[..., None], ripples * [0.05, 0.1, 0.16, 0.004, 0.12], picture)
# A fire: far more infrared than light.
fire = ((x - 0.7) / 0.018) ** 2 + ((y - 0.77) / 0.035) ** 2 < 1
picture[fire] = [1.2, 0.4, 0.05, 12, 0]
np.savez_compressed("landscape.npz", np.maximum(picture, 0).astype(np.float16))
