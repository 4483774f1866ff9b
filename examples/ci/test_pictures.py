"""Fails when a picture drifts from its reference; for pytest.

    REFERENCES=references CANDIDATES=pictures pytest test_pictures.py

compares every picture of the first folder with the one of the same name in the second. $NULLRAY is the program; by
default it is found in the path.
"""
import json
import os
import pathlib
import subprocess

import pytest

REFERENCES = pathlib.Path(os.environ.get("REFERENCES", "references"))
CANDIDATES = pathlib.Path(os.environ.get("CANDIDATES", "pictures"))
LIGHT = {"relrmse": 0.05}
# Channels of surfaces that no other limit is about; at edges of triangles a few pixels show the next one.
CHANNELS = {f"normal.{axis}:p90": 0.02 for axis in "xyz"} | {f"uv.{axis}:p90": 0.01 for axis in "uv"}
CHANNELS |= {f"barycentric.{axis}:p90": 0.05 for axis in "uv"}
CHANNELS |= {f"direction.{axis}:p90": 0.001 for axis in "xyz"}
CHANNELS |= {"distance:p90": 0.05, "object_event.ct:p90": 0.05, "alpha:mae": 0.01}
SURFACES = {"geometric.p99": 0.1, "coverage": 0.99, "time.p99": 0.05, "w.p99": 0.01, **CHANNELS, **LIGHT}
PICTURES = sorted(path.name for path in REFERENCES.glob("*.*") if path.suffix in {".exr", ".npz", ".npy", ".png"})


def test_there_are_references():
    assert PICTURES, f"{REFERENCES} holds no picture"


@pytest.mark.parametrize("name", PICTURES)
def test_picture(name):
    wanted = LIGHT if name.endswith((".png", ".npy")) else SURFACES  # .png and .npy hold light alone
    limits = [word for metric, value in wanted.items() for word in ("--tolerance", f"{metric}={value}")]
    command = [os.environ.get("NULLRAY", "nullray"), "compare", REFERENCES / name, CANDIDATES / name, "--json", *limits]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    found = json.loads(done.stdout)
    named = [diagnosis["what"] for diagnosis in found["diagnoses"]]
    assert not found["breaches"] and not named, f"{found['breaches']}; {named}"
