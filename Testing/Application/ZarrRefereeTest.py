"""Zarr and N5 as others write them: python3-zarr makes arrays of version 2 and N5 with random shapes, chunks,
types, codecs, orders and holes, and shards of version 3, which Debian's has not, are written here from the
specification. The surface of each must have the bytes of that of the same samples in a MetaImage. Exits 77
(skipped) without python3-zarr."""

import json
import random
import subprocess
import sys
import unittest
from itertools import product

from support import MESH, ApplicationTest, main

try:
    import numcodecs
    import numpy
    import zarr
    from zarr.n5 import N5Store
except ImportError:
    print("skipped: needs python3-zarr")
    sys.exit(77)

TYPES = ("u1", "i1", "<u2", ">u2", "<i2", ">i2", "<i4", ">i4", "<f4", ">f4", "<f8", ">f8")
FILL = 3


def crc32c(data):
    value = 0xffffffff
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0x82f63b78 if value & 1 else 0)
    return (~value & 0xffffffff).to_bytes(4, "little")


class ZarrReferee(ApplicationTest):
    def setUp(self):
        super().setUp()
        self.chance = random.Random(self.id())
        self.numbers = numpy.random.default_rng(self.chance.randrange(1 << 30))

    def values(self, dtype, shape, chunks):
        """Noise, and in one or two chunks the fill value alone."""
        array = self.numbers.integers(0, 100, shape).astype(dtype)
        for _ in range(2):
            at = [self.chance.randrange(-(-side // chunk)) * chunk for side, chunk in zip(shape, chunks)]
            array[tuple(slice(a, a + chunk) for a, chunk in zip(at, chunks))] = FILL
        return array

    def sizes(self):
        """Two chunks a side at least."""
        return ([self.chance.randrange(8, 17) for _ in range(3)], [self.chance.randrange(2, 8) for _ in range(3)])

    def surface_of(self, path):
        subprocess.run([MESH, path, "--iso", "50", "--method", "mc", "-o", "out.ply", "-q", "--no-warnings"],
                       cwd=self.folder, check=True, timeout=120)
        return self.path("out.ply").read_bytes()

    def same_surface(self, path, array):
        head = ("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                f"DimSize = {' '.join(map(str, array.shape[::-1]))}\nElementSpacing = 1 1 1\nOffset = 0 0 0\n"
                "TransformMatrix = 1 0 0 0 1 0 0 0 1\nElementType = MET_SHORT\nElementDataFile = LOCAL\n")
        self.path("same.mha").write_bytes(head.encode() + array.astype("<i2").tobytes())
        self.assertTrue(self.surface_of(path) == self.surface_of("same.mha"))

    def test_version_2(self):
        codecs = [None, numcodecs.Zlib(3), numcodecs.GZip(3), numcodecs.Zstd(3), numcodecs.LZ4(),
                  *(numcodecs.Blosc(name, shuffle=how) for name in ("lz4", "zstd", "zlib", "blosclz", "lz4hc")
                    for how in (0, 1, 2))]
        for n, codec in enumerate(codecs):
            shape, chunks = self.sizes()
            dtype, order, separator = TYPES[n % len(TYPES)], "CF"[n % 2], "./"[n // 2 % 2]
            with self.subTest(codec=codec, dtype=dtype, order=order, shape=shape, chunks=chunks):
                array = self.values(dtype, shape, chunks)
                stored = zarr.open_array(str(self.path(f"v2-{n}")), "w", shape=shape, chunks=chunks, dtype=dtype,
                                         compressor=codec, order=order, dimension_separator=separator,
                                         fill_value=FILL, write_empty_chunks=False)
                stored[...] = array
                self.same_surface(f"v2-{n}", array)

    def test_n5(self):
        for n, codec in enumerate((None, numcodecs.GZip(3), numcodecs.Zstd(3), numcodecs.Blosc("lz4"))):
            shape, chunks = self.sizes()
            dtype = ("u1", "<i2", "<f4", "<i4")[n]
            with self.subTest(codec=codec, shape=shape, chunks=chunks):
                array = self.numbers.integers(0, 100, shape).astype(dtype)
                stored = zarr.open_array(N5Store(str(self.path(f"n5-{n}"))), "w", shape=shape, chunks=chunks,
                                         dtype=dtype, compressor=codec, fill_value=0)
                stored[...] = array
                self.same_surface(f"n5-{n}", array)

    def test_shards_of_version_3(self):
        for n in range(8):
            shape, inner = [self.chance.randrange(6, 20) for _ in range(3)], [self.chance.randrange(1, 4) for _ in range(3)]
            shard = [side * self.chance.randrange(1, 4) for side in inner]
            order = self.chance.sample(range(3), 3)
            with self.subTest(shape=shape, inner=inner, shard=shard, order=order):
                array = self.values("i2", shape, shard)
                self.write_shards(f"v3-{n}", array, shard, inner, order, isAtEnd=n % 2 == 0, hasSum=n % 3 > 0)
                self.same_surface(f"v3-{n}", array)

    def write_shards(self, name, array, shard, inner, order, isAtEnd, hasSum):
        folder = self.path(name)
        folder.mkdir()
        pack = numcodecs.Zstd(3).encode
        sums = [{"name": "crc32c"}] if hasSum else []
        (folder / "zarr.json").write_text(json.dumps({
            "zarr_format": 3, "node_type": "array", "shape": array.shape, "data_type": "int16",
            "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": shard}},
            "chunk_key_encoding": {"name": "default"}, "fill_value": FILL,
            "codecs": [{"name": "sharding_indexed", "configuration": {
                "chunk_shape": inner, "index_location": "end" if isAtEnd else "start",
                "codecs": [{"name": "transpose", "configuration": {"order": order}},
                           {"name": "bytes", "configuration": {"endian": "big"}}, {"name": "zstd"}, *sums],
                "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}, *sums]}}]}))
        padded = numpy.full([-(-side // s) * s for side, s in zip(array.shape, shard)], FILL, "i2")
        padded[tuple(map(slice, array.shape))] = array
        for at in product(*(range(side // s) for side, s in zip(padded.shape, shard))):
            block = padded[tuple(slice(a * s, a * s + s) for a, s in zip(at, shard))]
            if (block == FILL).all():
                continue
            counts = [s // i for s, i in zip(shard, inner)]
            head = 16 * int(numpy.prod(counts)) + (4 if hasSum else 0)
            data, index = b"", []
            for chunk in product(*map(range, counts)):
                piece = block[tuple(slice(c * i, c * i + i) for c, i in zip(chunk, inner))]
                if (piece == FILL).all():
                    index += [2 ** 64 - 1] * 2
                    continue
                packed = bytes(pack(piece.transpose(order).astype(">i2").tobytes()))
                packed += crc32c(packed) if hasSum else b""
                index += [len(data) + (0 if isAtEnd else head), len(packed)]
                data += packed
            table = numpy.array(index, "<u8").tobytes()
            table += crc32c(table) if hasSum else b""
            file = folder.joinpath("c", *map(str, at))
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(data + table if isAtEnd else table + data)


if __name__ == "__main__":
    main()
