"""Zarr arrays of version 3, by zarr-python (3.1.6 was used); see README.md. Usage: python make.py"""
import shutil
import numpy as np
import zarr
from zarr.codecs import BytesCodec, Crc32cCodec, GzipCodec, ShardingCodec, TransposeCodec, ZstdCodec

# Sample n of each is n: (H, W, T) = (5, 6, 7), and with colours (5, 6, 7, 3).
grey = np.arange(210.0).reshape(5, 6, 7)
rgb = np.arange(630.0).reshape(5, 6, 7, 3)
arrays = {
    "plain": dict(data=grey.astype("f4"), chunks=(2, 3, 4), compressors=None, dimension_names=["y", "x", "time"], attributes={"start": 1.5, "bin_width": 0.25}),
    "zstd": dict(data=grey.astype("f8"), chunks=(2, 6, 7)),
    "gzip": dict(data=grey.astype("u2"), chunks=(5, 2, 3), compressors=[GzipCodec(level=5), Crc32cCodec()]),
    "big": dict(data=grey.astype("i4"), chunks=(3, 3, 3), serializer=BytesCodec(endian="big"), compressors=None),
    "frames": dict(data=np.moveaxis(grey, 2, 0).astype("f2"), chunks=(1, 5, 6), dimension_names=["T", "H", "W"], chunk_key_encoding={"name": "v2", "separator": "."}),
    "turned": dict(data=rgb.astype("f4"), chunks=(2, 3, 4, 3), filters=[TransposeCodec(order=(3, 2, 0, 1))], compressors=ZstdCodec(level=3, checksum=True)),
    "sharded": dict(data=rgb.astype("f4"), shards=(4, 6, 4, 3), chunks=(2, 3, 2, 3), dimension_names=["H", "W", "T", "C"]),
    "sharded_start": dict(data=grey.astype("i8"), chunks=(4, 6, 8), compressors=None,
                          serializer=ShardingCodec(chunk_shape=(2, 2, 4), codecs=[BytesCodec(), GzipCodec()], index_location="start")),
}
for name, options in arrays.items():
    shutil.rmtree(name, ignore_errors=True)
    zarr.create_array(store=name, **options)

# Only the first two rows are written: chunks that hold nothing but the fill value have no file.
for name, options in {"missing": dict(chunks=(2, 3, 4)), "missing_in_shard": dict(shards=(4, 6, 8), chunks=(2, 3, 4))}.items():
    shutil.rmtree(name, ignore_errors=True)
    array = zarr.create_array(store=name, shape=(5, 6, 7), dtype="f4", fill_value=0.5, compressors=None, **options)
    array[:2] = grey[:2]

shutil.rmtree("group", ignore_errors=True)
group = zarr.create_group("group")
for name in ["one", "two"]:
    group.create_array(name, data=grey.astype("f4"), chunks=(5, 6, 7), compressors=None)
