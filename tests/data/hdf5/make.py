"""Captures of one hidden point, in the forms of several programs, by their own writers where there are such; see README.md.

Usage: python make.py, with numpy, h5py, hdf5storage and y-tal (0.20 was used)."""
import os
import h5py
import hdf5storage
import numpy as np
import tal.io
from tal.enums import GridFormat, HFormat

ROWS, COLUMNS, BINS, WIDTH, START = 4, 5, 96, 0.05, 1.0
HIDDEN = np.array([0.1, 0.2, 0.9])
LASER, SENSOR = np.array([-0.5, 0.0, 0.8]), np.array([0.3, -0.2, 0.7])
# A wall in the plane z = 0: 0.25 m between rows and 0.2 m between columns, of points (row, column).
WALL = np.array([[[-0.4 + 0.2 * j, -0.3 + 0.25 * i, 0] for j in range(COLUMNS)] for i in range(ROWS)])
LIT = WALL[1, 2]
NORMAL = np.array([0.0, 0.0, 1.0])


def far(a, b):
    return np.linalg.norm(np.asarray(a) - np.asarray(b), axis=-1)


def histogram(path):
    """Energy per bin of a Gaussian pulse of 0.15 m that arrives after `path`, along the first axis."""
    t = START + WIDTH * (np.arange(BINS) + 0.5)
    return np.exp(-0.5 * ((t.reshape(-1, *[1] * np.ndim(path)) - path) / 0.15) ** 2)


def paths(lit, both):
    way = far(lit, HIDDEN) + far(HIDDEN, WALL)
    return way + far(LASER, lit) + far(WALL, SENSOR) if both else way


def tal_data(h, h_format, both, laser_grid, as_list):
    data = tal.io.NLOSCaptureData()
    grid = (lambda a: a.reshape(-1, 3)) if as_list else (lambda a: a)
    data.H, data.H_format = h.astype(np.float32), h_format
    data.sensor_xyz, data.laser_xyz = SENSOR.astype(np.float32), LASER.astype(np.float32)
    data.sensor_grid_xyz = grid(WALL).astype(np.float32)
    data.sensor_grid_normals = np.broadcast_to(NORMAL, grid(WALL).shape).astype(np.float32)
    data.laser_grid_xyz = laser_grid.astype(np.float32)
    data.laser_grid_normals = np.broadcast_to(NORMAL, laser_grid.shape).astype(np.float32)
    data.sensor_grid_format = data.laser_grid_format = GridFormat.N_3 if as_list else GridFormat.X_Y_3
    data.delta_t, data.t_start, data.t_accounts_first_and_last_bounces = WIDTH, START, both
    return data


one = histogram(paths(LIT, False))
tal.io.write_capture("tal_1.hdf5", tal_data(one, HFormat.T_Sx_Sy, False, LIT.reshape(1, 1, 3), False))
tal.io.write_capture("tal_1_both.hdf5", tal_data(histogram(paths(LIT, True)), HFormat.T_Sx_Sy, True, LIT.reshape(1, 1, 3), False))
lasers = WALL[1:3, 1:3]
many = np.stack([[histogram(paths(lasers[i, j], False)) for j in range(2)] for i in range(2)])
tal.io.write_capture("tal_2.hdf5", tal_data(np.moveaxis(many, 2, 0), HFormat.T_Lx_Ly_Sx_Sy, False, lasers, False))
tal.io.write_capture("tal_3.hdf5", tal_data(one.reshape(BINS, -1), HFormat.T_Si, False, LIT.reshape(1, 3), True))
tal.io.write_capture("tal_4.hdf5", tal_data(np.moveaxis(many, 2, 0).reshape(BINS, 4, -1), HFormat.T_Li_Si, False, lasers.reshape(4, 3), True))
# Confocal: the laser lights each point while that is recorded.
tal.io.write_capture("tal_confocal.hdf5", tal_data(histogram(2 * far(WALL, HIDDEN)), HFormat.T_Sx_Sy, False, WALL, False))
# Written by hand: the other spelling.
with h5py.File("tal_1_both.hdf5") as source, h5py.File("tal_spelling.hdf5", "w") as target:
    for key in source:
        source.copy(key, target, key.replace("bounces", "bounce"))

# The Zaragoza NLOS data set (layout of its files as read by y-tal): single precision, (colours, T, bounces, sx, sy[, lx, ly]),
# chunks compressed by gzip; coordinates first.
both = histogram(paths(LIT, True))
bounces = np.stack([0.75 * both, 0.25 * both], 1)[None]
for name, data in [("zaragoza_5.hdf5", bounces), ("zaragoza_7.hdf5", bounces[..., None, None])]:
    with h5py.File(name, "w") as f:
        f.create_dataset("data", data=data.astype("f4"), compression="gzip", shuffle=True, chunks=(1, 16, 1) + data.shape[3:])
        f["cameraGridPositions"] = np.moveaxis(WALL, 2, 0).astype("f4")
        f["cameraGridNormals"] = np.moveaxis(np.broadcast_to(NORMAL, WALL.shape), 2, 0).astype("f4")
        f["cameraPosition"], f["laserPosition"] = SENSOR.astype("f4"), LASER.astype("f4")
        f["laserGridPositions"] = LIT.reshape(3, 1, 1).astype("f4")
        f["deltaT"], f["t0"], f["t"], f["isConfocal"] = np.float32([WIDTH]), np.float32([START]), np.int32([BINS]), np.int8([0])

# Phasor fields: MATLAB's (lasers, camera, T), with lasers in columns of three.
swapped = far(LIT, HIDDEN) + far(HIDDEN, WALL) + far(LIT, SENSOR) + far(WALL, LASER)
dataset = {
    "data": histogram(swapped).reshape(BINS, 1, -1).T.astype("f4"), "t": float(BINS), "t0": START, "deltat": WIDTH,
    "laserPos": WALL.reshape(-1, 3), "laserNorm": np.broadcast_to(NORMAL, (ROWS * COLUMNS, 3)).copy(),
    "laserOrigin": LASER, "cameraPos": LIT, "cameraNormal": NORMAL, "cameraOrigin": SENSOR,
}
if os.path.exists("phasor_fields.mat"):
    os.remove("phasor_fields.mat")
hdf5storage.savemat("phasor_fields.mat", {"dataset": dataset}, format="7.3", oned_as="column")

# TransientNeRF, synthetic: (H, W, T, 4).
rgba = np.moveaxis(np.stack([one * c for c in (1.0, 0.5, 0.25, 1.0)], -1), 0, 2)
with h5py.File("transient_nerf.h5", "w") as f:
    f.create_dataset("data", data=rgba.astype("f2"))

# All kinds of numbers and of storage, of which each array has the values 0 to 23 in (2, 3, 4).
values = np.arange(24).reshape(2, 3, 4)
with h5py.File("kinds.h5", "w", libver="latest") as f:
    for kind in ["<f2", ">f2", "<f4", ">f4", "<f8", ">f8", "u1", "i1", "<u2", ">i2", "<u4", ">i4", "<u8", ">i8"]:
        f[f"number {kind}"] = values.astype(kind)
    for name, options in [("gzip", dict(compression="gzip", chunks=(1, 2, 3))), ("lzf", dict(compression="lzf", chunks=(2, 2, 2))),
                          ("checked", dict(fletcher32=True, shuffle=True, chunks=(2, 3, 1))),
                          ("growing", dict(maxshape=(None, 3, 4), chunks=(1, 3, 2))),
                          ("growing twice", dict(maxshape=(None, None, 4), chunks=(1, 3, 2))), ("scaled", dict(scaleoffset=8, chunks=(2, 3, 4)))]:
        f.create_dataset(f"storage/{name}", data=values.astype("i4" if name == "scaled" else "f4"), **options)
