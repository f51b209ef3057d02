"""ITK both ways: our readers as a plug-in in programs by others (Debian's elastix and plastimatch), and
ITK's readers of other formats in ours, against geometry known on paper, nibabel and minc-tools."""

import json
import os
import re
import shutil
import struct
import subprocess
import unittest
from pathlib import Path

from DicomTest import element, sequence
from support import BAD_INPUT, ApplicationTest, main

BUILD = Path(os.environ["ADAPTISO_BIN"]).parent
PLUGIN = BUILD / "lib" / "adaptiso" / "itk"
#: Columns: the steps of i, j, k in LPS mm; oblique, by angles of the 3-4-5 triangle.
STEPS = ((1.6, 1.2, 0), (-0.9, 1.2, 0), (0, 0, 2.5))
ORIGIN = (10, -20, 30)
SIZE = (8, 6, 4)


def samples():
    """All differ, i fastest."""
    return [100 + i + 8 * j + 48 * k for k in range(4) for j in range(6) for i in range(8)]


def us(value):
    return struct.pack("<H", value)


def text(*numbers):
    return "\\".join(f"{number:.12g}" for number in numbers)


def pixels(columns, rows, frames=b"", spacing=b""):
    """What a header says of 16-bit samples."""
    return b"".join([
        element(0x0028, 0x0002, "US", us(1)), element(0x0028, 0x0004, "CS", "MONOCHROME2"), frames,
        element(0x0028, 0x0010, "US", us(rows)), element(0x0028, 0x0011, "US", us(columns)), spacing,
        element(0x0028, 0x0100, "US", us(16)), element(0x0028, 0x0101, "US", us(16)),
        element(0x0028, 0x0102, "US", us(15)), element(0x0028, 0x0103, "US", us(0))])


def data(values):
    return element(0x7FE0, 0x0010, "OW", struct.pack(f"<{len(values)}H", *values))


AXES = text(0.8, 0.6, 0, -0.6, 0.8, 0)


def mosaic():
    """Four slices as the tiles of one image, as Siemens stores an EPI volume."""
    def tag(name, *items):
        head = name.encode().ljust(64, b"\0") + struct.pack("<i4sii i", 1, b"DS\0\0", 0, len(items), 77)
        return head + b"".join(struct.pack("<4i", 0, len(item) + 1, 77, 0) +
                               item.encode().ljust((len(item) + 4) // 4 * 4, b"\0") for item in items)

    csa = b"SV10\4\3\2\1" + struct.pack("<ii", 2, 77) + tag("NumberOfImagesInMosaic", "4") + tag(
        "SliceNormalVector", "0.0", "0.0", "1.0")
    all_samples = samples()
    tiled = [all_samples[i % 8 + 8 * (j % 6) + 48 * (i // 8 + 2 * (j // 6))]
             for j in range(12) for i in range(16)]
    # the header's position is that of an image as large as the mosaic around the slice's centre
    corner = [ORIGIN[row] - 4 * STEPS[0][row] - 3 * STEPS[1][row] for row in range(3)]
    return bytes(128) + b"DICM" + b"".join([
        element(0x0002, 0x0010, "UI", "1.2.840.10008.1.2.1"),
        element(0x0008, 0x0008, "CS", "ORIGINAL\\PRIMARY\\M\\ND\\MOSAIC"),
        element(0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.4"),
        element(0x0008, 0x0060, "CS", "MR"), element(0x0018, 0x0088, "DS", "2.5"),
        element(0x0020, 0x000E, "UI", "1.2.3"), element(0x0020, 0x0032, "DS", text(*corner)),
        element(0x0020, 0x0037, "DS", AXES), pixels(16, 12, spacing=element(0x0028, 0x0030, "DS", "1.5\\2")),
        element(0x0029, 0x0010, "LO", "SIEMENS CSA HEADER"), element(0x0029, 0x1010, "OB", csa),
        data(tiled)])


def enhanced():
    """A multi-frame file with a position for each frame."""
    frames = [[ORIGIN[row] + k * STEPS[2][row] for row in range(3)] for k in range(4)]
    return bytes(128) + b"DICM" + b"".join([
        element(0x0002, 0x0010, "UI", "1.2.840.10008.1.2.1"),
        element(0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.4.1"),
        element(0x0008, 0x0060, "CS", "MR"), element(0x0020, 0x000E, "UI", "1.2.3"),
        pixels(8, 6, frames=element(0x0028, 0x0008, "IS", "4")),
        sequence(0x5200, 0x9229, [
            sequence(0x0020, 0x9116, [element(0x0020, 0x0037, "DS", AXES)]) +
            sequence(0x0028, 0x9110, [element(0x0018, 0x0088, "DS", "2.5") +
                                      element(0x0028, 0x0030, "DS", "1.5\\2")])]),
        sequence(0x5200, 0x9230, [
            sequence(0x0020, 0x9113, [element(0x0020, 0x0032, "DS", text(*frame))])
            for frame in frames]),
        data(samples())])


def slice_of(k):
    """One file of a series of four, by GDCM's and our own way to read it."""
    corner = [ORIGIN[row] + k * STEPS[2][row] for row in range(3)]
    return bytes(128) + b"DICM" + b"".join([
        element(0x0002, 0x0010, "UI", "1.2.840.10008.1.2.1"),
        element(0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.4"),
        element(0x0008, 0x0018, "UI", f"1.2.3.{k + 1}"), element(0x0008, 0x0060, "CS", "MR"),
        element(0x0018, 0x0050, "DS", "2.5"), element(0x0020, 0x000E, "UI", "1.2.3"),
        element(0x0020, 0x0032, "DS", text(*corner)), element(0x0020, 0x0037, "DS", AXES),
        pixels(8, 6, spacing=element(0x0028, 0x0030, "DS", "1.5\\2")), data(samples()[48 * k:48 * k + 48])])


def write_zarr(folder):
    """An OME-Zarr with its axes along LPS."""
    (folder / "0").mkdir(parents=True)
    (folder / ".zgroup").write_text('{"zarr_format": 2}')
    (folder / ".zattrs").write_text(json.dumps({"multiscales": [{
        "version": "0.4", "axes": [{"name": n, "type": "space", "unit": "millimeter"} for n in "zyx"],
        "datasets": [{"path": "0", "coordinateTransformations": [
            {"type": "scale", "scale": [2.5, 1.5, 2]},
            {"type": "translation", "translation": [30, -20, 10]}]}]}]}))
    (folder / "0" / ".zarray").write_text(json.dumps({
        "zarr_format": 2, "shape": [4, 6, 8], "chunks": [4, 6, 8], "dtype": "<u2", "compressor": None,
        "filters": None, "fill_value": 0, "order": "C"}))
    (folder / "0" / "0.0.0").write_bytes(struct.pack("<192H", *samples()))


def nifti():
    """Oblique, by its sform."""
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, *SIZE, 1, 1, 1, 1)
    struct.pack_into("<hh", head, 70, 512, 16)  # uint16
    struct.pack_into("<8f", head, 76, 1, 2, 1.5, 2.5, 0, 0, 0, 0)
    struct.pack_into("<f", head, 108, 352)
    head[123] = 2  # mm
    struct.pack_into("<hh", head, 252, 0, 1)
    for row in range(3):
        sign = -1 if row < 2 else 1  # RAS
        struct.pack_into("<4f", head, 280 + 16 * row, *(sign * step[row] for step in STEPS),
                         sign * ORIGIN[row])
    head[344:348] = b"n+1\0"
    return bytes(head) + struct.pack(f"<{len(samples())}H", *samples())


PARAMETERS = """(Transform "TranslationTransform")
(NumberOfParameters 3)
(TransformParameters 0 0 0)
(InitialTransformParametersFileName "NoInitialTransform")
(HowToCombineTransforms "Compose")
(FixedImageDimension 3)
(MovingImageDimension 3)
(FixedInternalImagePixelType "float")
(MovingInternalImagePixelType "float")
(Size 8 6 4)
(Index 0 0 0)
(Spacing 2 1.5 2.5)
(Origin 10 -20 30)
(Direction 0.8 0.6 0 -0.6 0.8 0 0 0 1)
(UseDirectionCosines "true")
(ResampleInterpolator "FinalBSplineInterpolator")
(FinalBSplineInterpolationOrder 0)
(Resampler "DefaultResampler")
(DefaultPixelValue 0)
(ResultImageFormat "mhd")
(ResultImagePixelType "unsigned short")
(CompressResultImage "false")
"""


def has(*programs):
    missing = [name for name in programs if shutil.which(name) is None]
    return unittest.skipIf(missing, "not installed: " + ", ".join(missing))


@unittest.skipUnless(PLUGIN.exists(), "the plug-in is not built")
class PlugIn(ApplicationTest):
    """Programs by others read the same three files with the plug-in and without."""

    FILES = {"mosaic.dcm": mosaic, "enhanced.dcm": enhanced, "oblique.nii": nifti}

    def setUp(self):
        super().setUp()
        for name, make in self.FILES.items():
            self.path(name).write_bytes(make())

    def run_by(self, command, with_plugin):
        env = {**os.environ, "ITK_AUTOLOAD_PATH": str(PLUGIN) if with_plugin else ""}
        done = subprocess.run(list(map(str, command)), text=True, capture_output=True, env=env,
                              cwd=self.folder)
        return done.stdout + done.stderr

    def test_our_own_program_agrees(self):
        for name in self.FILES:
            said = self.mesh(name, "--info").stdout
            self.assertIn("8 x 6 x 4", said, name)
            self.assertIn("2 x 1.5 x 2.5 mm", said, name)

    def resampled(self, name, with_plugin, parameters=PARAMETERS):
        """The file's samples where they must lie, as transformix finds them."""
        out = self.path("out")
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir()
        self.path("identity.txt").write_text(parameters)
        self.run_by(["transformix", "-in", name, "-tp", "identity.txt", "-out", out], with_plugin)
        raw = out / "result.raw"
        return list(struct.unpack("<192H", raw.read_bytes())) if raw.exists() else None

    @has("transformix")
    def test_elastix_resamples_them_in_place(self):
        for name in self.FILES:
            self.assertEqual(self.resampled(name, True), samples(), name)
        self.assertNotEqual(self.resampled("mosaic.dcm", False), samples())

    @has("transformix")
    def test_elastix_reads_folders(self):
        """A DICOM series and a Zarr, which stock ITK does not open by their folder."""
        self.path("series").mkdir()
        for k in (2, 0, 3, 1):
            self.path(f"series/{9 - k}").write_bytes(slice_of(k))
        self.assertEqual(self.resampled("series", True), samples())
        self.assertIsNone(self.resampled("series", False))
        write_zarr(self.path("image.zarr"))
        straight = PARAMETERS.replace("0.8 0.6 0 -0.6 0.8 0 0 0 1", "1 0 0 0 1 0 0 0 1")
        self.assertEqual(self.resampled("image.zarr", True, straight), samples())

    @has("plastimatch")
    def test_one_slice_is_left_to_itks_own_reader(self):
        self.path("slice.dcm").write_bytes(slice_of(1))
        with_plugin, without = (self.run_by(["plastimatch", "header", "slice.dcm"], each)
                                for each in (True, False))
        self.assertIn("Size = 8 6 1", with_plugin)
        self.assertEqual(with_plugin, without)

    @has("plastimatch")
    def test_plastimatch_prints_their_geometry(self):
        for name in self.FILES:
            said = self.run_by(["plastimatch", "header", name], True)
            numbers = {key: [float(n) for n in values.split()] for key, values in
                       re.findall(r"(Origin|Size|Spacing|Direction) = ([-\d. ]+)", said)}
            for key, wanted in (("Origin", ORIGIN), ("Size", SIZE), ("Spacing", (2, 1.5, 2.5)),
                                ("Direction", (0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1))):
                self.assertEqual(len(numbers.get(key, [])), len(wanted), f"{name}: {key}: {said}")
                for found, value in zip(numbers[key], wanted):
                    self.assertAlmostEqual(found, value, delta=1e-4, msg=f"{name}: {key}")
        self.assertNotIn("Size = 8 6 4", self.run_by(["plastimatch", "header", "mosaic.dcm"], False))

    @has("plastimatch")
    def test_what_is_refused_is_refused_with_the_line(self):
        self.path("cut.nii").write_bytes(nifti()[:-10])
        said = self.run_by(["plastimatch", "header", "cut.nii"], True)
        self.assertIn("cut.nii: ", said)
        line = self.run_mesh("cut.nii", "--info").stderr
        self.assertIn(line.strip().removeprefix("adaptiso-mesh: "), said)


def gipl():
    head = bytearray(256)
    struct.pack_into(">4HH", head, 0, *SIZE, 1, 15)  # 16 bits
    struct.pack_into(">4f", head, 10, 2, 1.5, 2.5, 0)
    struct.pack_into(">4d", head, 204, *ORIGIN, 0)
    struct.pack_into(">I", head, 252, 719555000)
    return bytes(head) + struct.pack(f">{len(samples())}h", *samples())


def vtk_image():
    return b"""# vtk DataFile Version 3.0
made up
BINARY
DATASET STRUCTURED_POINTS
DIMENSIONS 8 6 4
SPACING 2 1.5 2.5
ORIGIN 10 -20 30
POINT_DATA 192
SCALARS scalars unsigned_short 1
LOOKUP_TABLE default
""" + struct.pack(f">{len(samples())}H", *samples())


def mrc():
    head = bytearray(1024)
    struct.pack_into("<10i", head, 0, *SIZE, 1, 0, 0, 0, *SIZE)  # 16 bits
    struct.pack_into("<6f", head, 40, 16, 9, 10, 90, 90, 90)  # 8 * 2, 6 * 1.5, 4 * 2.5
    struct.pack_into("<3i", head, 64, 1, 2, 3)
    struct.pack_into("<3f", head, 196, *ORIGIN)
    head[208:216] = b"MAP DA\0\0"
    return bytes(head) + struct.pack(f"<{len(samples())}h", *samples())


def fields(size, *items):
    """`size` bytes of a header: (position, struct's letters, values...)."""
    head = bytearray(size)
    for at, letters, *values in items:
        struct.pack_into(letters, head, at, *values)
    return bytes(head)


def big(values):
    return struct.pack(f">{len(values)}h", *values)


def ge_5(k):
    """Genesis, version 3. The corners of slice k are RAS."""
    exam, series, image = 200, 1300, 2400

    def ras(*index):
        x, y, z = (ORIGIN[row] + sum(n * step[row] for n, step in zip(index, STEPS)) for row in range(3))
        return -x, -y, z

    return fields(
        6000, (0, ">4si", b"IMGF", 6000), (52, ">h", 3), (132, ">6i", exam, 1024, series, 1020, image, 1022),
        (exam + 305, "2s", b"MR"), (series + 10, ">h", 7), (image + 12, ">h", k + 1),
        (image + 26, ">f2h", 2, 8, 6), (image + 50, ">2f", 2, 1.5), (image + 114, ">h", 2),
        (image + 126, ">f", 2.5 * k), (image + 150, ">f", 1),
        (image + 154, ">9f", *ras(0, 0, k), *ras(7, 0, k), *ras(7, 5, k)),
        (image + 210, ">2h", 1, 1)) + big(samples()[48 * k:48 * k + 48])


def ge_4(k):
    """Square pixels; floating-point numbers of Data General, by powers of 16."""
    def number(value):
        exponent = 64
        while value >= 1:
            value, exponent = value / 16, exponent + 1
        return exponent << 24 | int(value * (1 << 24)) if value else 0

    series, image = 8 * 512, 10 * 512
    return fields(
        14336, (series + 62, "s", b"7"), (series + 278, "5s", b"AXIAL"), (series + 302, ">I", number(16)),
        (image + 88, "s", b"%d" % (k + 1)), (image + 600, "s", b"1"), (image + 146, ">I", number(2.5 * k)),
        (image + 154, ">2I", number(2), number(0.5)), (image + 196, ">2h", 1, 1),
        (image + 274, ">2hI", 8, 6, number(2))) + big(samples()[48 * k:48 * k + 48])


def ge_advantage(k):
    return fields(
        3244, (3232, ">i", 16), (1166, ">h", 7), (2196, ">h", k + 1), (2212, ">f2h", 2.5, 8, 6),
        (2236, ">2f", 2, 1.5), (2300, ">h", 2), (2316, ">f", 2.5 * k),
        (2402, ">h", 1)) + big(samples()[48 * k:48 * k + 48])


def vision(k):
    """8 x 8 pixels, 2.5 mm thick; the last sample is the largest."""
    return fields(
        6144, (2864, ">i", 8), (5000, ">2d", 2, 1.5), (5546, "s", b"%d" % (k + 1)), (5695, "s", b"8"),
        (5700, "s", b"8"), (5752, "s", b"1"), (5794, "3s", b"2.5"), (5806, "4s", b"%.1f" % (2.5 * k)),
        (5814, "3s", b"Tra"), (5842, "2s", b"16"), (5846, "2s", b"12"), (5999, "s", b"7")) + big(
            [64 * k + n for n in range(64)])


#: As ParaVision 6 writes them.
VISU_PARS = """##TITLE=Parameter List, ParaVision 6.0.1
##JCAMPDX=4.24
##DATATYPE=Parameter Values
##ORIGIN=Bruker BioSpin MRI GmbH
##OWNER=nobody
$$ 2020-01-01 12:00:00.000 +0000  nobody@nowhere
$$ /opt/data/1/pdata/1/visu_pars
$$ process /opt/PV6.0.1/prog/bin/paravision
##$VisuVersion=3
##$VisuCoreDim=3
##$VisuCoreFrameCount=1
##$VisuCoreSize=( 3 )
8 6 4
##$VisuCoreExtent=( 3 )
16 9 10
##$VisuCorePosition=( 1, 3 )
9 -20.75 28.75
##$VisuCoreOrientation=( 1, 9 )
1 0 0 0 1 0 0 0 1
##$VisuCoreDataOffs=( 1 )
0
##$VisuCoreDataSlope=( 1 )
1
##$VisuCoreWordType=_16BIT_SGN_INT
##$VisuCoreByteOrder=littleEndian
##END=
"""

STIMULATE = """numDim: 3
dim: 8 6 4
origin: 10 -20 30
interval: 2 1.5 2.5
dataType: WORD
endian: ieee-be
"""


@unittest.skipUnless(PLUGIN.exists(), "the plug-in is not built")
class OtherFormats(ApplicationTest):
    """Read by ITK's readers in the sandbox process."""

    def image(self, name):
        """What --info says of a file: format, warning codes, image, values."""
        report = json.loads(self.mesh(name, "--info", "--json", "-", "--quiet").stdout)
        return (report["input"]["format"], {warning["code"] for warning in report["warnings"]},
                report["image"], report["values"])

    def check(self, name, kind, warned, origin=ORIGIN, steps=((2, 0, 0), (0, 1.5, 0), (0, 0, 2.5))):
        found, codes, image, values = self.image(name)
        self.assertEqual(found, kind)
        self.assertEqual(codes, warned)
        self.assertEqual(image["sizeVoxels"], list(SIZE))
        self.assertAlmostEqual(values["minimum"], 100, delta=1e-3)
        self.assertAlmostEqual(values["maximum"], 291, delta=1e-3)
        for axis in range(3):
            self.assertAlmostEqual(image["originMm"][axis], origin[axis], delta=1e-5)
        # a surface between two samples lies where they do: the sample of index (7, 5, 3) alone
        self.mesh(name, "--iso", 290.5, "--method", "mc", "--coordinates", "lps", "-o", "corner.obj")
        points = [tuple(map(float, line.split()[1:4]))
                  for line in self.path("corner.obj").read_text().splitlines()
                  if line.startswith("v ")]
        wanted = [origin[row] + sum(n * step[row] for n, step in zip((7, 5, 3), steps))
                  for row in range(3)]
        middle = [(min(p[row] for p in points) + max(p[row] for p in points)) / 2
                  for row in range(3)]
        reach = [sum(abs(step[row]) for step in steps) / 2 for row in range(3)]
        for row in range(3):
            self.assertAlmostEqual(middle[row], wanted[row], delta=reach[row])

    def check_cut(self, name):
        """A part of the file is refused."""
        whole = self.path(name).read_bytes()
        for tenths in (9, 6):
            self.path(name).write_bytes(whole[:len(whole) * tenths // 10])
            self.assert_fails(BAD_INPUT, re.escape(name), name, "--info")

    def test_gipl_vtk_and_mrc(self):
        for name, kind, make in (("x.gipl", "GIPL (ITK)", gipl), ("x.vtk", "VTK image (ITK)", vtk_image),
                                 ("x.mrc", "MRC (ITK)", mrc)):
            with self.subTest(name):
                self.path(name).write_bytes(make())
                self.check(name, kind, {"guessed-orientation"} | ({"guessed-unit"} if make is mrc else set()))
                self.check_cut(name)

    def test_mrc_that_itk_reads_wrong_is_refused(self):
        whole = bytearray(mrc())
        whole[64:72] = struct.pack("<2i", 2, 1)
        self.path("swapped.mrc").write_bytes(whole)
        self.assert_fails(BAD_INPUT, "are not x, y and z", "swapped.mrc", "--info")
        whole = bytearray(mrc()[:1024 + 192])
        whole[12:16] = bytes(4)
        self.path("signed.mrc").write_bytes(whole)
        self.assert_fails(BAD_INPUT, "signed 8-bit samples", "signed.mrc", "--info")
        whole[152:160] = struct.pack("<2i", 1146047817, 0)
        self.path("imod.mrc").write_bytes(whole)
        self.assertEqual(self.image("imod.mrc")[2]["sizeVoxels"], list(SIZE))

    def test_tiff_of_several_pages(self):
        from PIL import Image
        pages = [Image.frombytes("I;16", (8, 6), struct.pack("<48H", *samples()[48 * k:48 * k + 48]))
                 for k in range(4)]
        pages[0].save(self.path("x.tif"), save_all=True, append_images=pages[1:])
        self.check("x.tif", "TIFF (ITK)", {"guessed-orientation", "guessed-spacing"}, (0, 0, 0),
                   ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
        self.check_cut("x.tif")

    def test_tiff_pages_that_itk_reads_wrong_are_refused(self):
        from PIL import Image

        def page(kind, size=(8, 6)):
            return Image.new(kind, size, 7)

        for name, pages, fault, tags in (
                ("size", [page("L"), page("L", (16, 12))], "its pages differ", {}),
                ("type", [page("I;16"), page("L")], "its pages differ", {}),
                ("colour", [page("L"), page("RGB")], "its pages differ", {}),
                ("integers", [page("I"), page("I")], "32-bit integers", {}),
                ("white", [page("L"), page("L")], "0 is white", {262: 0})):
            with self.subTest(name):
                pages[0].save(self.path("x.tif"), save_all=True, append_images=pages[1:], tiffinfo=tags)
                self.assert_fails(BAD_INPUT, fault, "x.tif", "--info")

    @has("rawtominc", "voxeltoworld")
    def test_minc_lies_where_its_own_tools_have_it(self):
        for version in ([], ["-2"]):  # netCDF, HDF5
            with self.subTest(version):
                self.check_minc(version)

    def check_minc(self, version):
        subprocess.run(
            ["rawtominc", *version, "-clobber", "-short", "-unsigned", "-range", "100", "291",
             "-real_range", "100", "291", "-xstep", "2", "-ystep", "1.5", "-zstep", "2.5", "-xstart", "5", "-ystart", "-7",
             "-zstart", "30", "-xdircos", "0.8", "0.6", "0", "-ydircos", "-0.6", "0.8", "0", "-zdircos",
             "0", "0", "1", "x.mnc", "4", "6", "8"],
            cwd=self.folder, check=True, input=struct.pack("<192H", *samples()))

        def lps(i, j, k):
            said = subprocess.check_output(["voxeltoworld", "x.mnc", str(k), str(j), str(i)],
                                           cwd=self.folder, text=True)
            x, y, z = map(float, said.split())  # MINC's own axes are RAS
            return -x, -y, z

        origin = lps(0, 0, 0)
        steps = [[a - b for a, b in zip(lps(*index), origin)]
                 for index in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
        self.check("x.mnc", "MINC (ITK)", set(), origin, steps)
        self.check_cut("x.mnc")

    @has("plastimatch")
    def test_hdf5_of_itk(self):
        self.path("x.nii").write_bytes(nifti())
        subprocess.run(["plastimatch", "convert", "--input", "x.nii", "--output-img", "x.h5"],
                       cwd=self.folder, check=True, capture_output=True)
        self.check("x.h5", "ITK HDF5 (ITK)", set(), ORIGIN, STEPS)
        self.check_cut("x.h5")

    def write_slices(self, make):
        for k in range(4):
            self.path(f"I.00{k}").write_bytes(make(k))

    def test_ge_5_lies_where_its_corners_are(self):
        self.write_slices(ge_5)
        self.check("I.002", "GE 5 (ITK)", {"guessed-spacing", "guessed-position"}, ORIGIN, STEPS)
        self.check_cut("I.002")

    def test_ge_4_and_advantage_have_size_and_plane_alone(self):
        warned = {"guessed-spacing", "guessed-orientation", "guessed-position"}
        for make, kind, row in ((ge_4, "GE 4 (ITK)", 2), (ge_advantage, "GE Advantage (ITK)", 1.5)):
            with self.subTest(kind):
                self.write_slices(make)
                self.check("I.000", kind, warned, (0, 0, 0), ((2, 0, 0), (0, row, 0), (0, 0, 2.5)))
                if make is ge_4:
                    self.path("I.002").write_bytes(make(2)[:-2])
                    self.assert_fails(BAD_INPUT, "I.002: is shorter", "I.000", "--info")

    def test_siemens_vision_is_warned_of_as_its_thickness_is_cut_to_whole_mm(self):
        self.write_slices(vision)
        kind, codes, image, values = self.image("I.000")
        self.assertEqual((kind, image["sizeVoxels"]), ("Siemens Vision (ITK)", [8, 8, 4]))
        self.assertEqual(codes, {"guessed-spacing", "guessed-orientation", "guessed-position"})
        self.assertEqual((values["minimum"], values["maximum"]), (0, 255))
        self.assertEqual(image["spacingMm"], [2, 1.5, 2])  # by ITK 5.2; 2.5 in the file

    def test_bruker_2dseq(self):
        self.path("visu_pars").write_text(VISU_PARS)
        self.path("2dseq").write_bytes(struct.pack("<192h", *samples()))
        self.check("2dseq", "Bruker 2dseq (ITK)", {"guessed-spacing", "guessed-position"})
        self.path("notes").write_bytes(b"any other file " * 99)
        self.assert_fails(BAD_INPUT, "notes: not a format that is read here", "notes", "--info")
        self.check_cut("2dseq")

    def test_stimulate_reads_data_beside_it_alone(self):
        self.path("x.spr").write_text(STIMULATE)
        self.path("x.sdt").write_bytes(big(samples()))
        self.check("x.spr", "Stimulate (ITK)", {"guessed-orientation"})
        for line, fault in ((f"stimFileName: {self.path('x.sdt')}", "outside its own folder"),
                            ("dataType: LWORD", "reads wrong"),
                            ("dataType: COMPLEX", "reads wrong")):
            self.path("y.spr").write_text(STIMULATE + line + "\n")
            self.assert_fails(BAD_INPUT, fault, "y.spr", "--info")

    def test_files_beside_that_are_links_to_elsewhere_are_not_read(self):
        """ITK's readers of these take slices, headers and data from other files than the one named."""
        def series(make):
            return {f"I.00{k}": make(k) for k in range(4)}

        cases = {"GE 5": (series(ge_5), "I.000", "I.002"), "GE 4": (series(ge_4), "I.000", "I.002"),
                 "GE Advantage": (series(ge_advantage), "I.000", "I.002"),
                 "Siemens Vision": (series(vision), "I.000", "I.002"),
                 "Bruker": ({"2dseq": struct.pack("<192h", *samples()), "visu_pars": VISU_PARS.encode()},
                            "2dseq", "visu_pars"),
                 "Stimulate": ({"x.spr": STIMULATE.encode(), "x.sdt": big(samples())}, "x.spr", "x.sdt")}
        for kind, (files, named, linked) in cases.items():
            with self.subTest(kind):
                shutil.rmtree(self.path("in"), ignore_errors=True)
                shutil.rmtree(self.path("elsewhere"), ignore_errors=True)
                self.path("in").mkdir()
                self.path("elsewhere").mkdir()
                for name, content in files.items():
                    (self.path("in") / name).write_bytes(content)
                self.image(f"in/{named}")
                (self.path("in") / linked).rename((self.path("elsewhere") / linked))
                (self.path("in") / linked).symlink_to((self.path("elsewhere") / linked))
                self.assert_fails(BAD_INPUT, f"{linked}: is, or lies behind, a link to outside of its folder",
                                  f"in/{named}", "--info")
                # links within the folder are as good as files, and so is a folder of a link's target
                (self.path("elsewhere") / linked).rename((self.path("in") / "kept"))
                (self.path("in") / linked).unlink()
                (self.path("in") / linked).symlink_to("kept")
                if kind in ("Bruker", "Stimulate"):
                    self.image(f"in/{named}")
                    (self.path("elsewhere") / named).symlink_to((self.path("in") / named))
                    (self.path("in") / linked).unlink()
                    (self.path("in") / "kept").rename((self.path("in") / linked))
                    if kind == "Stimulate":
                        (self.path("elsewhere") / linked).symlink_to((self.path("in") / linked))
                        self.image(f"elsewhere/{named}")

    def test_bruker_may_have_its_other_headers_two_folders_above(self):
        folder = self.path("7") / "pdata" / "1"
        folder.mkdir(parents=True)
        (folder / "visu_pars").write_text(VISU_PARS)
        (folder / "2dseq").write_bytes(struct.pack("<192h", *samples()))
        (self.path("7") / "acqp").write_text(VISU_PARS)
        self.image("7/pdata/1/2dseq")
        (self.path("7") / "acqp").rename(self.path("acqp"))
        (self.path("7") / "acqp").symlink_to(self.path("acqp"))
        self.assert_fails(BAD_INPUT, "acqp: is, or lies behind, a link to outside", "7/pdata/1/2dseq", "--info")

    def test_plug_ins_by_others_are_asked_last(self):
        """As ITK_AUTOLOAD_PATH names them; our own one there does no harm."""
        self.path("x.others").write_bytes(b"by others")
        self.path("x.nii").write_bytes(nifti())
        self.path("x.PAR").write_bytes(b"# === DATA DESCRIPTION FILE by others")
        self.path("y.PAR").write_bytes(b"# === DATA DESCRIPTION FILE")
        self.assert_fails(BAD_INPUT, "x.others: not a format that is read here", "x.others", "--info")
        os.environ["ITK_AUTOLOAD_PATH"] = f"{PLUGIN}:{BUILD / 'Testing' / 'itk'}"
        self.addCleanup(os.environ.pop, "ITK_AUTOLOAD_PATH")
        for name in ("x.others", "x.PAR"):
            self.check(name, "OthersImageIO (ITK)", {"guessed-orientation"})
        self.assert_fails(BAD_INPUT, "y.PAR: is a PAR header of Philips", "y.PAR", "--info")
        self.assertEqual(self.image("x.nii")[0], "NIfTI-1")

    def test_what_no_reader_takes_is_named(self):
        self.path("x.dat").write_bytes(b"what is this" * 100)
        self.assert_fails(BAD_INPUT, "x.dat: not a format that is read here", "x.dat", "--info")


if __name__ == "__main__":
    main()
