"""Zarr arrays of versions 2 and 3, by zarr-python (3.1.6 was used); see README.md. Usage: python make.py"""
import shutil
import numcodecs
import numpy as np
import zarr
from zarr.codecs import BloscCodec, BytesCodec, Crc32cCodec, GzipCodec, ShardingCodec, TransposeCodec, ZstdCodec

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

# Blosc, in arrays that are long enough to be split into streams: (H, W, T) = (12, 16, 20), the last chunk along T partly empty.
longer = np.arange(3840.0).reshape(12, 16, 20)
for name, cname, shuffle, kind in [
    ("blosc_lz4", "lz4", "shuffle", "f4"),
    ("blosc_lz4hc_bits", "lz4hc", "bitshuffle", "f8"),
    ("blosc_zstd", "zstd", "shuffle", "i2"),
    ("blosc_zlib", "zlib", "noshuffle", "u4"),
    ("blosc_blosclz", "blosclz", "shuffle", "f4"),
    ("blosc_blosclz_plain", "blosclz", "noshuffle", "f8"),
]:
    shutil.rmtree(name, ignore_errors=True)
    codec = BloscCodec(cname=cname, clevel=5, shuffle=shuffle, typesize=np.dtype(kind).itemsize)
    zarr.create_array(store=name, data=longer.astype(kind), chunks=(12, 16, 12), compressors=codec)

# Version 2, of which zarr-python wrote Blosc with LZ4 by default.
for name, options in {
    "v2": dict(data=longer.astype("f4"), compressors=numcodecs.Blosc(), attributes={"start": 1.5, "bin_width": 0.25, "_ARRAY_DIMENSIONS": ["y", "x", "t"]}),
    "v2_fortran": dict(data=longer.astype(">f8"), order="F", compressors=numcodecs.Zlib(level=5)),
    "v2_lz4": dict(data=longer.astype("u2"), compressors=numcodecs.LZ4(), chunk_key_encoding={"name": "v2", "separator": "/"}),
    "v2_gzip": dict(data=longer.astype("<i4"), compressors=numcodecs.GZip()),
    "v2_zstd": dict(data=longer.astype(">i8"), compressors=numcodecs.Zstd()),
    "v2_plain": dict(data=longer.astype("<f4"), compressors=None),
    "v2_bz2": dict(data=longer.astype("f4"), compressors=numcodecs.BZ2()),
}.items():
    shutil.rmtree(name, ignore_errors=True)
    zarr.create_array(store=name, zarr_format=2, chunks=(12, 16, 12), **options)
shutil.rmtree("v2_group", ignore_errors=True)
group = zarr.create_group("v2_group", zarr_format=2)
for name in ["one", "two"]:
    group.create_array(name, data=longer.astype("f4"), chunks=(12, 16, 20), compressors=numcodecs.Blosc())
