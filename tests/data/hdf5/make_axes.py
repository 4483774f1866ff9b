"""Arrays whose axes are said in the ways that h5py, netCDF4 and xarray have; see README.md. Usage: python make_axes.py, with h5py (3.16 was used)."""
import h5py
import numpy as np

# Sample (row, column, bin) of each is 100 row + 10 column + bin.
ROWS, COLUMNS, BINS = 2, 3, 5
cube = np.array([[[100 * i + 10 * j + k for k in range(BINS)] for j in range(COLUMNS)] for i in range(ROWS)], "f4")
frames = np.moveaxis(cube, 2, 0)

with h5py.File("axes.h5", "w", track_order=False) as f:
    def array(name, data, labels=None, scales=None, **attributes):
        d = f.create_dataset(name, data=data)
        for n, label in enumerate(labels or []):
            if label:
                d.dims[n].label = label
        for n, scale in enumerate(scales or []):
            d.dims[n].attach_scale(f[scale])
        for key, value in attributes.items():
            d.attrs[key] = value

    for name, size in [("time", BINS), ("y", ROWS), ("x", COLUMNS)]:
        f.create_dataset("scale/" + name, data=np.arange(size))
        f["scale/" + name].make_scale(name)
    array("scale/of_group", frames, scales=["scale/time", "scale/y", "scale/x"])
    array("labels", frames, labels=["Time", "rows", "columns"])
    array("attribute", frames, axes="T H W", start=1.5, bin_width=0.25)
    array("fixed", frames, axes=np.bytes_("T H W"))
    array("both", frames, axes="T H W", labels=["x", "y", "time"])
    array("partly", cube, labels=["", "", "time"])
    array("others", frames, labels=["wavelength", "y", "x"])
    array("wrong", frames, axes="T Q W")
    array("unsaid", cube)
    # MATLAB's (rows, columns, bins).
    array("matlab", cube.T, MATLAB_class=np.bytes_("single"))
    array("picture", np.zeros((8, 9, 3), "f4"))
