"""Meshes: files and back, pickles, and what other packages make of them. Label client for those."""

import copy
import gc
import importlib.util
import os
import pickle
import re
import sys
import unittest
from pathlib import Path
from unittest import mock

import adaptiso
import numpy as np
from adaptiso._triangles import _MEANT
from support import InFolder, ball, needs, place

LIA = np.array([[-1, 0, 0, 13], [0, 0, 1, -9], [0, -1, 0, 15], [0, 0, 0, 1.0]])


def sphere(**options):
    return adaptiso.surface(ball((24, 24, 24)), -8, **options)


class Values(unittest.TestCase):
    def test_repr_tells_triangles_bound_and_frame(self):
        text = repr(sphere(max_error=0.1))
        self.assertRegex(text, r"^<adaptiso.Mesh of [\d,]+ triangles, [\d,]+ vertices, "
                               r"within 0\.\d+, voxel indices \(identity affine\)>$")
        self.assertRegex(repr(sphere(max_error=0.1, affine=LIA)), r"within 0\.\d+ mm, RAS mm>$")
        self.assertNotIn("within", repr(sphere(method="mc")))

    def test_pickles_are_whole(self):
        mesh = sphere()
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
            again = pickle.loads(pickle.dumps(mesh, protocol))
            self.assertEqual(again, mesh)
            self.assertEqual(again.report, mesh.report)
            self.assertEqual(again.error_bound, mesh.error_bound)
        np.testing.assert_array_equal(again.to_nibabel_freesurfer()[0],
                                      mesh.to_nibabel_freesurfer()[0])

    def test_copies_are_equal(self):
        mesh = sphere()
        self.assertEqual(copy.copy(mesh), mesh)
        self.assertEqual(copy.deepcopy(mesh), mesh)
        self.assertNotEqual(mesh, sphere(method="mc"))

    def test_arrays_stay_read_only(self):
        mesh = sphere()
        for array in (mesh.vertices, mesh.faces, mesh.normals):
            with self.assertRaises(ValueError):
                array.setflags(write=True)

    def test_findings_and_images_are_values_too(self):
        mesh, other = sphere(), sphere(method="mc")
        image = adaptiso.Image(np.zeros((2, 3, 4)), np.eye(4), [], "array")
        for value, unlike in ((adaptiso.check(mesh), adaptiso.check(other)),
                              (adaptiso.compare(mesh, other), adaptiso.compare(other, mesh)),
                              (image, image._replace(array=np.ones((2, 3, 4))))):
            for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
                self.assertEqual(pickle.loads(pickle.dumps(value, protocol)), value)
            self.assertEqual(copy.deepcopy(value), value)
            self.assertNotEqual(value, unlike)
            self.assertNotEqual(value, None)
        self.assertEqual(repr(image), "<adaptiso.Image of 2 x 3 x 4 voxels, float64, array>")

    def test_checks_take_vertices_and_faces_and_vtk_data(self):
        mesh = sphere()
        expected = adaptiso.check(mesh, "bem")
        for given in ((mesh.vertices, mesh.faces, "bem"), ((mesh.vertices, mesh.faces), "bem")):
            self.assertEqual(adaptiso.check(*given).failed, expected.failed)
        self.assertEqual(adaptiso.check(mesh.vertices, mesh.faces[1:]).failed, ["closed"])
        for call in (adaptiso.check, adaptiso.mend, adaptiso.simplify):
            with self.assertRaisesRegex(adaptiso.Error, "^faces 0.2: must be a table of integers"):
                call(mesh, 0.2)
        if importlib.util.find_spec("vtkmodules"):
            data = mesh.to_vtk()
            self.assertEqual(adaptiso.check(data, "bem").failed, expected.failed)
            np.testing.assert_array_equal(adaptiso.mend(data).faces, mesh.faces)
            with self.assertRaisesRegex(adaptiso.Error, "^mesh: has no triangles$"):
                adaptiso.check(type(data)())

    def test_a_comparison_encloses_the_hausdorff_distance(self):
        mesh = sphere()
        moved = adaptiso.Mesh(mesh.vertices + (0.25, 0, 0), mesh.faces)
        for comparison in (adaptiso.compare(mesh, moved, samples=1000),
                           adaptiso.compare(mesh, moved, samples=1000, symmetric=False)):
            lower, upper = comparison.hausdorff
            self.assertLessEqual(comparison.max - 1e-9, upper)
            self.assertLessEqual(lower, upper)
            self.assertLessEqual(upper, 0.25 * (1 + 2e-3))  # no point went farther than it was moved
            self.assertLessEqual(upper - lower, 1e-3 * upper)
            self.assertIn(f"max {comparison.max:.4g} mm, proved at most {upper:.4g} mm>", repr(comparison))

    def test_own_arrays_make_a_mesh_and_are_copied(self):
        points = np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], np.float32)
        mesh = adaptiso.Mesh(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
        points[:] = 7
        self.assertAlmostEqual(mesh.volume, 9**3 / 6)
        self.assertEqual(mesh.report, {})
        self.assertIsNone(mesh.error_bound)

    def test_triangles_that_name_a_vertex_twice_are_checked(self):
        """Of two that share it a corner outside the triangle was read, which ended the program."""
        rows = np.zeros((9, 3), int)
        rows[[0, 1, 7], 2] = 4, 2, 3
        check = adaptiso.check((rows, rows), threads=1)
        self.assertIn("noDegenerateTriangles", check.failed)

    def test_arrays_that_are_no_mesh_are_refused(self):
        points, faces = np.eye(3), [[0, 1, 2]]
        for arguments in ((points[:, :2], faces), (points, [[0, 1]]), (points, [[0, 1, 3]]),
                          (points, [[0, 1, -1]]), (points * np.inf, faces), ("abc", faces),
                          (points, [[0.0, 1, 2]]), (points, faces, np.eye(2)),
                          (points, faces, np.ones((2, 3))), (points * 1e308 * 10, faces),
                          (points, np.array([[0, 1, 2**63]], np.uint64)), (None, None),
                          ([[1, 2, 3], [4, 5]], faces), (points.astype(complex), faces),
                          (np.ma.masked_equal(points, 1), faces)):
            with np.errstate(all="ignore"), self.assertRaises(adaptiso.Error) as caught:
                adaptiso.Mesh(*arguments)
            self.assertNotIn("\n", str(caught.exception))


    def test_has_what_trimesh_and_pyvista_call_by_the_same_names(self):
        mesh = sphere()
        np.testing.assert_array_equal(mesh.points, mesh.vertices)
        np.testing.assert_array_equal(mesh.bounds, [mesh.vertices.min(0), mesh.vertices.max(0)])
        self.assertTrue(np.isnan(adaptiso.Mesh([], []).bounds).all())
        self.assertTrue(mesh.is_watertight)
        self.assertFalse(adaptiso.Mesh(mesh.vertices, mesh.faces[1:]).is_watertight)
        flipped = np.concatenate([mesh.faces[1:], mesh.faces[:1, ::-1]])
        self.assertFalse(adaptiso.Mesh(mesh.vertices, flipped).is_watertight)
        self.assertEqual(mesh.simplify(max_error=0.3), adaptiso.simplify(mesh, max_error=0.3))
        self.assertEqual(mesh.simplify(max_error=0.3).report, adaptiso.simplify(mesh, max_error=0.3).report)

    def test_names_of_trimesh_and_pyvista_are_answered_by_ours(self):
        mesh, walls = sphere(), adaptiso.labels((ball((9, 9, 9)) > -3).astype(np.uint8))
        for value, name, answer in ((mesh, "export", r"did you mean save\(path\)\?"), (walls, "export", "did you mean save"),
                                    (mesh, "n_points", r"did you mean len\(mesh.vertices\)\?"),
                                    (mesh, "xyzzy", "'Mesh' object has no attribute 'xyzzy'$"),
                                    (walls, "decimate", "'decimate'$")):
            with self.assertRaisesRegex(AttributeError, answer):
                getattr(value, name)
        for meant in _MEANT.values():
            if "mesh" not in meant:
                self.assertTrue(hasattr(mesh, meant.partition("(")[0]), meant)

    def test_an_array_without_affine_is_in_voxel_indices(self):
        for mesh, words in ((sphere(), "voxel indices"), (sphere(affine=LIA), "RAS mm"),
                            (sphere(spacing=(1, 1, 2)), "RAS mm")):
            self.assertIn(words, repr(mesh))
            self.assertEqual(mesh.frame, "ras")
        mesh = sphere()
        self.assertEqual(mesh.transform(np.eye(4)), mesh)
        self.assertEqual(adaptiso.Mesh(mesh.vertices, mesh.faces, mesh.normals), mesh)

    def test_transforms_keep_the_outside_outside(self):
        mesh = sphere(affine=LIA, max_error=0.1)
        matrix = [[-2, 0, 0, 5], [0, 1, 1, 0], [0, 0, 1, -7], [0, 0, 0, 1]]  # mirrors, scales, shears
        moved = mesh.transform(matrix)
        points = mesh.vertices @ np.array(matrix)[:3, :3].T + (5, 0, -7)
        np.testing.assert_allclose(moved.vertices, points, atol=1e-12)
        self.assertAlmostEqual(moved.volume, 2 * mesh.volume, 6)
        out = moved.vertices - moved.vertices.mean(axis=0)
        self.assertGreater((out * moved.normals).sum(axis=1).min(), 0)
        self.assertAlmostEqual(moved.error_bound, 2 * mesh.error_bound)
        self.assertEqual((moved.frame, moved.report), ("ras", {}))
        self.assertEqual(mesh.transform(np.eye(4)), mesh)
        for bad in (np.eye(3), np.zeros((4, 4)), np.diag([1, 1, 1, 2]), np.diag([1, np.nan, 1, 1]), "turn"):
            with self.assertRaisesRegex(adaptiso.Error, "^matrix"):
                mesh.transform(bad)


class TransformedFiles(InFolder):
    def test_are_sound_or_refused(self):
        """20 km off, single precision has steps of 2 mm."""
        mesh = sphere(affine=LIA, max_error=0.1)
        for offset, is_sound in ((7e4, True), (2e7, False)):
            matrix = np.eye(4)
            matrix[:3, 3] = offset
            moved = mesh.transform(matrix)
            moved.save(self.folder / "moved.vtp")
            file = self.folder / f"{offset}.stl"
            if is_sound:
                moved.save(file)
                self.assertTrue(adaptiso.check(file).passed)
                continue
            with self.assertRaisesRegex(adaptiso.Error, "STL"):
                moved.save(file)
            self.assertFalse(file.exists())


class Plots(InFolder):
    def test_draws_without_a_display(self):
        file = self.folder / "a.png"
        with mock.patch.dict(os.environ):
            os.environ.pop("DISPLAY", None)
            sphere().plot(file)
            self.assertEqual(file.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
            with mock.patch.dict(sys.modules, pyvista=None):
                with self.assertRaisesRegex(adaptiso.Error, "^plot: (there is no display|needs PyVista)"):
                    sphere().plot()
                with self.assertRaisesRegex(adaptiso.Error, "color= needs PyVista"):
                    sphere().plot(color="w")
                with mock.patch.dict(sys.modules, {"adaptiso._vtk_data": None}), \
                        self.assertRaisesRegex(adaptiso.Error, "needs PyVista .* or VTK"):
                    sphere().plot()
        for bad in (lambda: sphere().plot(self.folder / "a.jpg"), lambda: adaptiso.Mesh([], []).plot()):
            with self.assertRaisesRegex(adaptiso.Error, "^plot: "):
                bad()

    @needs("vtkmodules")
    def test_shows_by_pyvista_where_it_is(self):
        pyvista = mock.MagicMock()
        with mock.patch.dict(sys.modules, pyvista=pyvista):
            sphere().plot(color="w")
        pyvista.PolyData.return_value.plot.assert_called_once_with(color="w")


class Files(InFolder):
    def test_what_is_saved_comes_back(self):
        mesh = adaptiso.surface(np.asfortranarray(ball((24, 24, 24))), -8, affine=LIA)
        for extension, atol in ((".vtp", 0), (".vtk", 0), (".ply", 0), (".obj", 1e-7),
                                (".off", 1e-7), (".gii", 4e-6), (".surf", 4e-6)):
            file = self.folder / ("a" + extension)
            mesh.save(file)
            again = adaptiso.load(file)
            # nine digits, or 24 bits, of less than 64 mm; tkRAS goes by a matrix and back
            np.testing.assert_allclose(again.vertices, mesh.vertices, rtol=0, atol=atol)
            np.testing.assert_array_equal(again.faces, mesh.faces)
            self.assertEqual(again.frame, "ras")

    def test_a_frame_that_is_not_told_is_warned_of(self):
        sphere().save(self.folder / "a.tri")
        with self.assertLogs("adaptiso", "WARNING") as logs:
            mesh = adaptiso.load(self.folder / "a.tri")
        self.assertIn("a.tri: does not say its coordinate frame", logs.output[0])
        self.assertEqual(mesh.frame, "unknown")
        self.assertIn("unknown frame", repr(mesh))
        self.assertEqual(pickle.loads(pickle.dumps(mesh)), mesh)
        self.assertEqual(adaptiso.simplify(mesh, max_error=0.1).frame, "unknown")

    def test_counts_that_do_not_fit_the_file_are_warned_of_or_refused(self):
        file = self.folder / "a.stl"
        sphere().save(file)
        stored = file.read_bytes()
        file.write_bytes(stored[:80] + bytes(4) + stored[84:])  # as stream writers leave it
        for read in (adaptiso.load, adaptiso.check):
            with self.assertLogs("adaptiso", "WARNING") as logs:
                read(file)
            self.assertRegex(logs.output[0], "a.stl: its count of triangles is 0; the .* that follow")
        file.write_bytes(stored + stored)
        for read in (adaptiso.load, adaptiso.check):
            with self.assertRaisesRegex(adaptiso.Error, "are two files joined"):
                read(file)

    def test_an_unknown_frame_is_no_guess(self):
        known = sphere()
        known.save(self.folder / "a.tri")
        with self.assertLogs("adaptiso", "WARNING"):
            mesh = adaptiso.load(self.folder / "a.tri")
        mesh.save(self.folder / "b.ply")
        content = (self.folder / "b.ply").read_bytes()
        self.assertNotIn(b"CoordinateFrame", content)
        self.assertNotIn(b"SPACE", content)
        for wrong in (lambda: mesh.save(self.folder / "c.ply", "lps"),
                      lambda: mesh.save(self.folder / "lh.pial"),
                      lambda: adaptiso.compare(mesh, known),
                      lambda: adaptiso.compare(known, self.folder / "a.tri"),
                      lambda: adaptiso.compare(self.folder / "a.tri", self.folder / "b.ply"),
                      lambda: adaptiso.check_nested([known, mesh]),
                      lambda: adaptiso.bem(surfaces=[known, mesh, known])):
            with self.assertRaisesRegex(adaptiso.Error, "input_coordinates="):
                wrong()
        self.assertLess(adaptiso.compare(mesh, mesh).max, 1e-9)
        self.assertEqual(adaptiso.compare(mesh, mesh).report["warnings"], [])

    def test_a_mesh_of_no_triangle_is_no_sound_surface(self):
        points = sphere().vertices
        for empty in (([], []), (points, []), adaptiso.Mesh(points, [])):
            with self.assertRaisesRegex(adaptiso.Error, "^mesh: has no triangles$"):
                adaptiso.check(empty)
            with self.assertRaisesRegex(adaptiso.Error, "^surface 2: has no triangles$"):
                adaptiso.check_nested([sphere(), empty])

    def test_distances_of_fewer_points_are_warned_of(self):
        n = np.arange(2000)  # triangles through a ball's middle, which all cross
        a, b = 2 * np.pi * n * 0.618034, np.arccos(1 - 2 * ((n * 0.7548777) % 1))
        u = 50 * np.stack([np.cos(a) * np.sin(b), np.sin(a) * np.sin(b), np.cos(b)], axis=1)
        v = 50 * np.stack([-np.sin(a), np.cos(a), 0 * a], axis=1)
        points = np.stack([u, v, -(u + v)], axis=1).reshape(-1, 3)
        faces = np.arange(6000).reshape(-1, 3)
        with self.assertLogs("adaptiso", "WARNING") as logs:
            found = adaptiso.compare((points, faces), (points + [0.1, 0, 0], faces),
                                     samples=20000, symmetric=False)
        self.assertEqual([w["code"] for w in found.report["warnings"]], ["distance-rough"])
        self.assertRegex(logs.output[0], r"compare: [\d,]+ points lie near more than 500 triangles")
        self.assertIn(found.report["distances"]["combined"]["measured"], range(100, 10000))

    def test_the_frame_of_a_file_is_stated(self):
        known = sphere()
        known.save(self.folder / "a.tri", "lps")
        mesh = adaptiso.load(self.folder / "a.tri", input_coordinates="lps")
        self.assertEqual(mesh.frame, "ras")
        np.testing.assert_allclose(mesh.vertices, known.vertices, atol=1e-7)  # nine digits
        file = self.folder / "a.tri"
        self.assertLess(adaptiso.compare(known, file, input_coordinates=[None, "lps"]).max, 1e-6)
        self.assertTrue(adaptiso.check(file, input_coordinates="lps"))
        self.assertEqual(adaptiso.simplify(file, max_error=0.1, input_coordinates="lps").frame,
                         "ras")
        # over what a file says
        known.save(self.folder / "a.ply")
        turned = adaptiso.load(self.folder / "a.ply", input_coordinates="lps")
        np.testing.assert_array_equal(turned.vertices, known.vertices * [-1, -1, 1])
        for words, pattern in (("up", "input_coordinates 'up'"), (["lps"], "one for each surface")):
            with self.assertRaisesRegex(adaptiso.Error, pattern):
                adaptiso.compare(file, file, input_coordinates=words)
        with self.assertRaisesRegex(adaptiso.Error, "a mesh in memory has its frame"):
            adaptiso.compare(known, known, input_coordinates="ras")
        with self.assertRaisesRegex(adaptiso.Error, "volume="):
            adaptiso.load(file, input_coordinates="voxel")

    @needs("nibabel")
    def test_tkras_without_its_volume_stays_tkras_until_the_volume_is_given(self):
        import nibabel
        mesh = adaptiso.surface(np.asfortranarray(ball((24, 24, 24))), -8, affine=LIA)
        coordinates, faces, _ = mesh.to_nibabel_freesurfer()
        nibabel.freesurfer.write_geometry(self.folder / "lh.pial", coordinates, faces)
        loose = adaptiso.load(self.folder / "lh.pial")
        self.assertEqual(loose.frame, "tkras")
        self.assertIn("tkRAS", repr(loose))
        image = nibabel.Nifti1Image(np.zeros((24, 24, 24), np.uint8), LIA)
        placed = adaptiso.load(self.folder / "lh.pial", volume=image)
        self.assertEqual(placed.frame, "ras")
        np.testing.assert_allclose(placed.vertices, mesh.vertices, atol=4e-6)  # float32
        with self.assertRaisesRegex(adaptiso.Error, "tkras"):
            adaptiso.compare(loose, mesh)
        loose.save(self.folder / "again.pial")
        np.testing.assert_array_equal(
            nibabel.freesurfer.read_geometry(self.folder / "again.pial")[0],
            nibabel.freesurfer.read_geometry(self.folder / "lh.pial")[0])

    def test_a_file_is_whole_or_not_there(self):
        mesh = sphere()
        file = self.folder / "a.ply"
        mesh.save(file)
        before = file.read_bytes()
        for path, frame in ((file, "scanner"), (self.folder / "a.xyz", None),
                            (self.folder / "b.surf", "voxel"), (self.folder / "no" / "a.ply", None),
                            (self.folder, None), ("", None), (3, None),
                            (f"{self.folder}/b.ply/", None), (f"{self.folder}/b.ply/.", None)):
            with self.assertRaises(adaptiso.Error) as caught:
                mesh.save(path, frame)
            self.assertNotIn("\n", str(caught.exception))
        with self.assertRaisesRegex(adaptiso.Error, "does not know its image"):
            adaptiso.Mesh(mesh.vertices, mesh.faces).save(self.folder / "a.surf")
        self.assertEqual(file.read_bytes(), before)
        self.assertEqual([entry.name for entry in self.folder.iterdir()], ["a.ply"])

    def test_a_format_with_too_few_digits_is_refused(self):
        # at 1e8 mm single precision has steps of 8 mm
        affine = np.diag([-1.0, -1, 1, 1])
        affine[:3, 3] = 1e8
        mesh = adaptiso.surface(np.asfortranarray(ball((16, 16, 16))), -5, affine=affine)
        simplified = adaptiso.simplify(mesh, max_error=0.5)
        for extension in (".stl", ".gii"):
            for surface in (mesh, simplified, pickle.loads(pickle.dumps(mesh))):
                with self.assertRaisesRegex(adaptiso.Error, "far.* keeps 24 bits of a coordinate: "
                                            ".* triangles would lose their area"):
                    surface.save(self.folder / ("far" + extension))
        self.assertEqual(list(self.folder.iterdir()), [])
        mesh.save(self.folder / "far.ply")
        # what was made elsewhere is written as it is
        adaptiso.Mesh(mesh.vertices, mesh.faces).save(self.folder / "far.stl")

    def test_rounding_beyond_the_bound_is_refused_or_told(self):
        # at 4e5 mm single precision has steps of 1/32 mm, nine digits of 1e-3 mm
        affine = np.diag([-1.0, -1, 1, 1])
        affine[:3, 3] = 4e5, -4e5, 4e5
        image = np.asfortranarray(ball((24, 24, 24)))
        for make in (lambda bound: adaptiso.surface(image, -7, affine=affine, max_error=bound),
                     lambda bound: adaptiso.simplify(
                         adaptiso.surface(image, -7, affine=affine, method="mc"), max_error=bound)):
            with self.assertRaisesRegex(adaptiso.Error, "far.stl: STL.*24 bits.*more than the bound "
                                                        "of 0.01 mm"):
                make(0.01).save(self.folder / "far.stl")
            mesh = make(0.1)
            with self.assertLogs("adaptiso", "WARNING") as logs:
                mesh.save(self.folder / "far.gii")
            told = re.search(r"far.gii: lies within (0\.1\d+) mm, not 0.1 mm", logs.output[0])
            moved = np.linalg.norm(adaptiso.load(self.folder / "far.gii").vertices - mesh.vertices,
                                   axis=1).max()
            self.assertGreaterEqual(float(told[1]), mesh.error_bound + moved - 1e-9)
            self.assertLess(float(told[1]), mesh.error_bound + moved + 1e-3)
            with self.assertNoLogs("adaptiso"):
                mesh.save(self.folder / "far.ply")

    def test_a_link_stays_a_link(self):
        (self.folder / "link.ply").symlink_to(self.folder / "real.ply")
        sphere().save(self.folder / "link.ply")
        self.assertTrue((self.folder / "link.ply").is_symlink())
        self.assertGreater((self.folder / "real.ply").stat().st_size, 1000)

    def test_files_that_are_no_surface_are_refused(self):
        (self.folder / "a.ply").write_text("no surface")
        for path in (self.folder / "a.ply", self.folder / "none.ply", self.folder, "x.png", 3, ""):
            with self.assertRaises(adaptiso.Error) as caught:
                adaptiso.load(path)
            self.assertNotIn("\n", str(caught.exception))


class Clients(InFolder):
    """What other packages make of the meshes."""

    @needs("vtkmodules")
    def test_vtk_takes_the_arrays_and_keeps_them(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkFiltersCore import vtkMassProperties
        mesh = sphere()
        volume = mesh.volume
        data = mesh.to_vtk()
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPoints().GetData()), mesh.vertices)
        self.assertTrue(np.shares_memory(vtk_to_numpy(data.GetPoints().GetData()), mesh.vertices))
        self.assertEqual(adaptiso.Mesh.from_vtk(data), mesh)
        with self.assertRaisesRegex(adaptiso.Error, "^data 5: must be a vtkPolyData"):
            adaptiso.Mesh.from_vtk(5)
        del mesh
        gc.collect()
        properties = vtkMassProperties()
        properties.SetInputData(data)
        self.assertAlmostEqual(properties.GetVolume() / volume, 1, places=6)  # its own formula
        normals = vtk_to_numpy(data.GetPointData().GetNormals())
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)

    @needs("pyvista")
    def test_pyvista_takes_the_mesh(self):
        mesh = sphere()
        data = mesh.to_pyvista()
        self.assertEqual(data.n_cells, len(mesh.faces))
        self.assertTrue(data.is_manifold)

    @needs("trimesh")
    def test_trimesh_takes_the_mesh(self):
        mesh = sphere()
        data = mesh.to_trimesh()
        self.assertTrue(data.is_watertight)
        self.assertAlmostEqual(data.volume / mesh.volume, 1, places=9)
        self.assertTrue(adaptiso.check(data))

    @needs("nibabel")
    def test_nibabel_writes_and_reads_the_gifti(self):
        import nibabel
        mesh = sphere()
        nibabel.save(mesh.to_gifti(), self.folder / "a.gii")
        points, faces = nibabel.load(self.folder / "a.gii").agg_data(("pointset", "triangle"))
        np.testing.assert_array_equal(points, mesh.vertices.astype(np.float32))
        np.testing.assert_array_equal(faces, mesh.faces)
        self.assertEqual(adaptiso.load(self.folder / "a.gii").frame, "ras")

    @needs("nibabel")
    def test_nibabel_s_freesurfer_surface_lies_where_the_image_does(self):
        import nibabel
        for affine in (LIA, np.diag([1.0, 1, 1, 1]), np.diag([-2.0, 1.5, 1, 1])):
            volume = np.asfortranarray(ball((24, 24, 24), affine=affine))
            mesh = adaptiso.surface(volume, -8, affine=affine)
            nibabel.freesurfer.write_geometry(self.folder / "lh.white", *mesh_and_info(mesh))
            ours = adaptiso.load(self.folder / "lh.white")
            self.assertEqual(ours.frame, "ras")
            np.testing.assert_allclose(ours.vertices, mesh.vertices, atol=1e-5)  # float32
            self.assertGreater(ours.volume, 0)

    @needs("mne")
    def test_mne_reads_the_surface_and_finds_it_complete(self):
        import mne
        mesh = adaptiso.surface(np.asfortranarray(ball((60, 60, 60))), -26, affine=np.diag(
            [3.0, 3, 3, 1]) @ LIA, max_error=1)
        mesh.save(self.folder / "inner_skull.surf")
        points, faces = mne.read_surface(self.folder / "inner_skull.surf")
        self.assertEqual(len(points), len(mesh.vertices))
        np.testing.assert_array_equal(faces, mesh.faces)


def mesh_and_info(mesh):
    coordinates, faces, info = mesh.to_nibabel_freesurfer()
    return coordinates, faces, None, info


if __name__ == "__main__":
    unittest.main(verbosity=2)
