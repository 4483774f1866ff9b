"""Frames of the unwarped capture as mitransient writes them: python make_frames.py"""

import pathlib

import mitsuba
import numpy

mitsuba.set_variant("scalar_rgb")
import mitransient  # noqa: E402

here = pathlib.Path(__file__).parent
data = numpy.load(here / "unwarped.npz")["data"].astype(numpy.float32)
# Ten bins of a corner of the picture, in which light passes.
mitransient.vis.save_frames(data[4:20, 10:30, 18:28], str(here / "frames"))
