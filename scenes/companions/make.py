"""Writes landscape.npz: rows, columns and five channels, "R", "G", "B", "IR", "UV", of sunlit water, trees, snow and a fire.

Infrared and ultraviolet are in units of the white's radiance at 830 and at 360 nm, as `channels` of a cube are.
"""

import numpy as np

ROWS, COLUMNS = 72, 96
y, x = np.mgrid[0:ROWS, 0:COLUMNS] / [[[ROWS]], [[COLUMNS]]]
rng = np.random.default_rng(1)
picture = np.empty((ROWS, COLUMNS, 5))

# The sky: blue, little infrared, much ultraviolet.
picture[:] = [0.25, 0.42, 0.75, 0.08, 0.6]
# Snow on mountains: white to the eye, bright in the ultraviolet, dim from a micrometre on.
mountains = y > 0.42 - 0.2 * np.abs(np.sin(9 * x)) - 0.05 * np.sin(31 * x)
picture[mountains] = [0.8, 0.82, 0.85, 0.25, 0.7]
# Trees: dark green, and bright in the infrared, as leaves are.
trees = y > 0.55 - 0.06 * np.abs(np.sin(40 * x)) - 0.03 * np.sin(17 * x)
picture[trees] = [0.03, 0.08, 0.02, 0.5, 0.01]
# Water: it mirrors some of the sky, and is black in the infrared.
picture[y > 0.75] = [0.05, 0.1, 0.14, 0.005, 0.1]
# A fire: far more infrared than light.
fire = (x - 0.7) ** 2 + (1.5 * (y - 0.7)) ** 2 < 0.03**2
picture[fire] = [1.2, 0.4, 0.05, 20, 0]
# What no channel of a picture lacks: a little unevenness.
picture *= 1 + 0.1 * rng.standard_normal((ROWS, COLUMNS, 1))
np.savez_compressed("landscape.npz", np.maximum(picture, 0).astype(np.float16))
