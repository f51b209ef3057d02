"""Zarr's levels, channels and time points; formats of ITK's readers."""

import json
import struct
import unittest

import adaptiso
import numpy as np
from support import BIN, InFolder, ball


@unittest.skipUnless((BIN.parent / "lib/adaptiso/itk/libadaptisoItkIO.so").exists(),
                     "ITK's readers are not built")
class ItksFormats(InFolder):
    def test_is_read_with_size_place_and_warning(self):
        samples = np.arange(192, dtype=">i2")
        file = self.folder / "image.gipl"
        file.write_bytes(struct.pack(">4HH4f", 8, 6, 4, 1, 15, 2, 1.5, 2.5, 0).ljust(204, b"\0") + struct.pack(
            ">4d", 10, -20, 30, 0).ljust(48, b"\0") + struct.pack(">I", 719555000) + samples.tobytes())
        with self.assertLogs("adaptiso", "WARNING"):
            image = adaptiso.read(file)
        np.testing.assert_array_equal(image.array, samples.reshape(8, 6, 4, order="F"))
        np.testing.assert_array_equal(image.affine, np.diag([-2, -1.5, 2.5, 1]) + np.array(
            [[0, 0, 0, -10], [0, 0, 0, 20], [0, 0, 0, 30], [0, 0, 0, 0]]))
        self.assertEqual(image.format, "GIPL (ITK)")
        self.assertEqual([each.code for each in image.warnings], ["guessed-orientation"])
        self.assertTrue(adaptiso.surface(file, 100.5).is_closed)
        file.write_bytes(file.read_bytes()[:-20])
        with self.assertRaisesRegex(adaptiso.Error, "shorter than its header says"):
            adaptiso.read(file)


class Zarr(InFolder):
    """An OME-Zarr of two time points, two channels and two levels, written here byte by byte."""

    def setUp(self):
        super().setUp()
        self.root = self.folder / "image.zarr"
        self.root.mkdir()
        (self.root / ".zgroup").write_text('{"zarr_format": 2}')
        axes = [{"name": "t", "type": "time"}, {"name": "c", "type": "channel"},
                *({"name": n, "type": "space", "unit": "millimeter"} for n in "zyx")]
        self.levels, datasets = [], []
        for level, side in enumerate((8, 4)):
            samples = np.random.default_rng(level).integers(0, 9, (2, 2, side, side, side), np.uint8)
            self.levels.append(samples)
            scale = [1, 1, 2.0**level, 2.0**level, 2.0**level]
            datasets.append({"path": str(level), "coordinateTransformations": [
                {"type": "scale", "scale": scale}]})
            folder = self.root / str(level)
            folder.mkdir()
            (folder / ".zarray").write_text(json.dumps({
                "zarr_format": 2, "shape": samples.shape, "chunks": [1, 1, side, side, side],
                "dtype": "|u1", "compressor": None, "filters": None, "fill_value": 7, "order": "C"}))
            for t in range(2):
                for c in range(2):
                    (folder / f"{t}.{c}.0.0.0").write_bytes(samples[t, c].tobytes())
        (self.root / ".zattrs").write_text(json.dumps({"multiscales": [
            {"version": "0.4", "name": "image", "axes": axes, "datasets": datasets}]}))

    def test_level_channel_and_time_are_chosen(self):
        for level, time, channel in ((None, 0, 1), (1, 1, 0), (0, 1, 1)):
            image = adaptiso.read(self.root, level=level, time=time, channel=channel)
            truth = self.levels[level or 0][time, channel].T  # x fastest
            np.testing.assert_array_equal(image.array, truth)
            self.assertEqual(abs(image.affine[0, 0]), 2.0**(level or 0))
            self.assertIn("Zarr", image.format)
        mesh = adaptiso.surface(adaptiso.read(self.root, level=1, time=0, channel=0), 5)
        self.assertTrue(mesh.is_closed)

    def test_what_has_to_be_chosen_is_asked_for(self):
        for options in ({}, {"time": 0}, {"channel": 5, "time": 0}, {"level": 2, "time": 0, "channel": 0},
                        {"level": -1}, {"time": "first"}, {"all_chunks": 1}):
            with self.assertRaises(adaptiso.Error) as caught:
                adaptiso.read(self.root, **options)
            self.assertNotIn("\n", str(caught.exception))
            self.assertNotIn("--", str(caught.exception))  # options of the programs
        with self.assertRaisesRegex(adaptiso.Error, r"\((channel|time)= of adaptiso.read\)"):
            adaptiso.surface(self.root, 5)

    def test_missing_chunks_are_told_or_refused(self):
        (self.root / "0" / "0.0.0.0.0").unlink()
        with self.assertLogs("adaptiso", "WARNING") as logs:
            image = adaptiso.read(self.root, channel=0, time=0)
        self.assertIn("(image_space= chooses)", logs.output[0] + logs.output[-1])
        self.assertTrue((image.array == 7).all())
        with self.assertRaises(adaptiso.Error):
            adaptiso.read(self.root, channel=0, time=0, all_chunks=True)

    def test_other_files_have_no_levels(self):
        image = self.folder / "a.nrrd"
        image.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n"
                          b"spacings: 1 1 1\n\n" + bytes(8))
        for options in ({"level": 0}, {"channel": 0}, {"time": 0}, {"all_chunks": True}):
            with self.assertRaisesRegex(adaptiso.Error, "all_chunks.* Zarr"):
                adaptiso.read(image, **options)

    def test_surfaces_and_images_name_the_function_that_reads_them(self):
        mesh = adaptiso.surface(ball((9, 9, 9)), -3)
        for extension in ("stl", "ply", "3mf"):
            file = self.folder / f"a.{extension}"
            mesh.save(file)
            with self.assertRaisesRegex(adaptiso.Error, f"a.{extension}: is a surface; adaptiso.load reads it$"):
                adaptiso.read(file)
        (self.folder / "a.nrrd").write_bytes(b"NRRD0004\n")
        for call in (adaptiso.load, adaptiso.check, adaptiso.simplify):
            with self.assertRaisesRegex(adaptiso.Error, "not a surface; adaptiso.surface makes surfaces"):
                call(self.folder / "a.nrrd")


if __name__ == "__main__":
    unittest.main(verbosity=2)
