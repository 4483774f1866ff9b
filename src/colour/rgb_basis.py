"""Makes rgb_basis.csv: the white of sRGB as a spectrum, and three weights that turn linear sRGB into spectra.

Method: I. Mallett, C. Yuksel, "Spectral Primary Decomposition for Rendering with sRGB Reflectance", EGSR 2019:
of all weights b_r, b_g, b_b >= 0 with b_r + b_g + b_b = 1 at every wavelength, and with

    integral white(l) b_i(l) c_j(l) dl = 1 if i = j, else 0     (c_j: the sRGB matching functions)

those with the least sum of squared differences between neighbours: a convex quadratic programme. It is solved here
rather than taken from the paper's table, because that one covers 380 to 780 nm, and reproduces sRGB to 1e-3 only.

The white is CIE daylight, S_0 + M_1 S_1 + M_2 S_2 (CIE 015:2018, table 6), with M_1 and M_2 such that its
chromaticity is exactly that of sRGB's white, (0.3127, 0.3290), and with a luminance of 1 (per metre of wavelength).

All functions are linear between their knots (every 5 nm, the observer's every 1 nm), and products are integrated
exactly, as by src/colour/spectrum.rs.

    pip install numpy quadprog colour-science==0.4.7
    python3 rgb_basis.py > rgb_basis.csv      (in this folder)
"""

import numpy
import quadprog
from colour.colorimetry.datasets.illuminants.sds_d_illuminant_series import DATA_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES as DAYLIGHT

FIRST, LAST, STEP = 360, 830, 5
knots = numpy.arange(FIRST, LAST + STEP, STEP, dtype=float)
n = len(knots)

# Three points of Gauss in every nanometre: exact to the fifth degree.
nodes, weights = numpy.polynomial.legendre.leggauss(3)
wavelengths = (numpy.arange(FIRST, LAST)[:, None] + (nodes + 1) / 2).ravel()
weights = numpy.tile(weights / 2, LAST - FIRST) * 1e-9
observer = numpy.loadtxt("cie_1931_2deg.csv", delimiter=",")
xyz = [numpy.interp(wavelengths, observer[:, 0], observer[:, k]) for k in (1, 2, 3)]

# The white: two linear equations for M_1 and M_2, X - x/y Y = 0 and Z - z/y Y = 0.
parts = [numpy.array([DAYLIGHT[name][l] for l in knots]) for name in ("S0", "S1", "S2")]
values = numpy.array([[weights @ (c * numpy.interp(wavelengths, knots, s)) for s in parts] for c in xyz])
x, y = 0.3127, 0.3290
rows = numpy.array([values[0] - x / y * values[1], values[2] - (1 - x - y) / y * values[1]])
m = numpy.linalg.solve(rows[:, 1:], -rows[:, 0])
white = parts[0] + m[0] * parts[1] + m[1] * parts[2]
white /= values[1] @ [1, *m]

# A[j][k] = integral white hat_k c_j.
rgb_from_xyz = numpy.array([
    [3.240969941904523, -1.537383177570094, -0.498610760293003],
    [-0.969243636280880, 1.875967501507721, 0.041555057407176],
    [0.055630079696994, -0.203976958888977, 1.056971514242879],
])
matching = rgb_from_xyz @ numpy.array(xyz)
hats = numpy.array([numpy.interp(wavelengths, knots, row) for row in numpy.eye(n)])
A = (matching * weights * numpy.interp(wavelengths, knots, white)) @ hats.T

# Unknowns: b_r and b_g; b_b = 1 - b_r - b_g.
D = numpy.diff(numpy.eye(n), axis=0)
Q = D.T @ D + 1e-10 * numpy.eye(n)
Z = numpy.zeros((3, n))
G = numpy.block([[2 * Q, Q], [Q, 2 * Q]])
# The blue term's linear part, (1 - b_r - b_g) Q (1 - b_r - b_g), is -2 1'Q (b_r + b_g).
a = numpy.tile(Q @ numpy.ones(n), 2)
I = numpy.eye(n)
O = numpy.zeros((n, n))
equal = numpy.block([[A, Z], [Z, A]])
at_least = numpy.block([[I, O], [O, I], [-I, -I]])
C = numpy.vstack([equal, at_least]).T
b = numpy.concatenate([[1, 0, 0], [0, 1, 0], numpy.zeros(2 * n), -numpy.ones(n)])
solution = quadprog.solve_qp(G, a, C, b, meq=6)[0]
red, green = solution[:n], solution[n:]
# Rounding of the solver: below 0 by 1e-17 or so.
basis = numpy.maximum(numpy.round([red, green, 1 - red - green], 13), 0)
basis /= basis.sum(axis=0)

print("nm,white,red,green,blue")
for k in range(n):
    print(",".join([f"{knots[k]:.0f}"] + [repr(float(v)) for v in (white[k], *basis[:, k])]))
import sys
print("M_1, M_2 =", m, "error of M(1):", abs(A @ basis.T - numpy.eye(3)).max(), file=sys.stderr)
