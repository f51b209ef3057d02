"""simplify(): any mesh with fewer triangles."""
import pickle
import unittest

import numpy as np

import adaptiso


def ball(size=40, radius=15):
    i, j, k = np.indices((size,) * 3) - (size - 1) / 2
    return adaptiso.surface(-np.sqrt(i**2 + j**2 + k**2), -radius, method="mc")


def square(steps=20):
    grid = np.arange((steps + 1) ** 2).reshape(steps + 1, steps + 1)
    vertices = [[x, y, 0] for x in range(steps + 1) for y in range(steps + 1)]
    faces = [t for x in range(steps) for y in range(steps)
             for t in ([grid[x, y], grid[x + 1, y], grid[x + 1, y + 1]],
                       [grid[x, y], grid[x + 1, y + 1], grid[x, y + 1]])]
    return np.array(vertices, float), np.array(faces)


class Simplify(unittest.TestCase):
    def test_a_ball_stays_sound_within_the_bound(self):
        fine = ball()
        coarse = adaptiso.simplify(fine, max_error=0.2)
        self.assertLess(len(coarse.faces), len(fine.faces) / 10)
        self.assertTrue(adaptiso.check(coarse))
        self.assertLessEqual(coarse.error_bound, 0.2)
        self.assertLessEqual(adaptiso.compare(fine, coarse).max, coarse.error_bound * (1 + 1e-9))
        self.assertEqual(coarse.report["crossing_triangles"], [])
        self.assertEqual(len(coarse.normals), len(coarse.vertices))

    def test_warnings_of_the_report_are_logged_once(self):
        for change in (adaptiso.simplify, adaptiso.mend):
            with self.assertLogs("adaptiso", "WARNING") as logs:
                made = change(ball(12, 4), max_error=50)
            (warning,) = made.report["warnings"]
            self.assertEqual(warning.code, "bound-over-size")
            self.assertEqual(logs.output, [f"WARNING:adaptiso:{change.__name__}: {warning}"])

    def test_a_count_is_met_and_told(self):
        coarse = adaptiso.simplify(ball(), triangles=500)
        self.assertEqual(len(coarse.faces), 500)
        self.assertEqual(coarse.report["wanted_triangles"], 500)
        half = adaptiso.simplify(ball(), reduction=0.5)
        self.assertLessEqual(abs(len(half.faces) - len(ball().faces) / 2), 1)

    def test_arrays_meshes_tuples_and_files_are_alike(self):
        vertices, faces = square()
        expected = adaptiso.simplify(adaptiso.Mesh(vertices, faces), max_error=0.01)
        self.assertEqual(adaptiso.simplify(vertices, faces, max_error=0.01), expected)
        self.assertEqual(adaptiso.simplify((vertices, faces), max_error=0.01), expected)
        self.assertLessEqual(len(expected.faces), 8)
        self.assertEqual(expected.report["border_edges"], 80)

    def test_borders_are_kept_when_asked(self):
        vertices, faces = square()
        kept = adaptiso.simplify(vertices, faces, max_error=0.01, keep_borders=True)
        on_border = {tuple(v) for v in vertices if min(v[:2]) == 0 or max(v[:2]) == 20}
        self.assertLessEqual(on_border, {tuple(v) for v in kept.vertices})

    def test_points_at_one_place_are_joined_by_weld(self):
        vertices, faces = square()
        split = np.asarray(vertices)[np.asarray(faces)].reshape(-1, 3)
        alone = np.arange(len(split)).reshape(-1, 3)
        self.assertEqual(len(adaptiso.simplify(split, alone, max_error=0.01).faces), len(faces))
        self.assertLessEqual(
            len(adaptiso.simplify(split, alone, max_error=0.01, weld=True).faces), 8)

    def test_what_is_no_manifold_is_told(self):
        faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4]]
        points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]]
        self.assertEqual(
            adaptiso.simplify(points, faces, max_error=0.1).report["non_manifold_vertices"],
            [0, 1])

    def test_threads_and_pickling_change_nothing(self):
        fine = ball()
        one = adaptiso.simplify(fine, max_error=0.1, threads=1)
        two = adaptiso.simplify(fine, max_error=0.1, threads=2)
        self.assertEqual(one, two)
        again = pickle.loads(pickle.dumps(one))
        self.assertEqual((again, again.report, again.error_bound),
                         (one, one.report, one.error_bound))

    def test_progress_is_told_and_can_end_the_call(self):
        def stop(stage, fraction):
            raise KeyboardInterrupt
        with self.assertRaises(KeyboardInterrupt):
            adaptiso.simplify(ball(), max_error=0.1, progress=stop)

    def test_what_can_t_be_used_is_refused_in_one_line(self):
        vertices, faces = square(2)
        for arguments in ({}, {"max_error": 0}, {"max_error": float("nan")}, {"triangles": -1},
                          {"reduction": 1.5}, {"max_error": 1, "min_angle": 50}, {"triangles": "a"}):
            with self.assertRaises(adaptiso.Error) as caught:
                adaptiso.simplify(vertices, faces, **arguments)
            self.assertNotIn("\n", str(caught.exception))
        image = np.zeros((4, 4, 4), np.float32)
        for make in (lambda **aims: adaptiso.simplify(vertices, faces, **aims),
                     lambda **aims: adaptiso.surface(image, 0.5, **aims),
                     lambda **aims: adaptiso.labels(image.astype(np.uint8), **aims)):
            with self.assertRaisesRegex(adaptiso.Error, "^triangles and reduction: are two ways to ask for one count$"):
                make(triangles=5, reduction=0.5)
        with self.assertRaisesRegex(adaptiso.Error, r"^faces 0\.5: must be a table of integers; max_error=0\.5\?$"):
            adaptiso.simplify(adaptiso.Mesh(vertices, faces), 0.5)
        with self.assertRaises(adaptiso.Error):
            adaptiso.simplify(vertices, [], max_error=1)
        with self.assertRaises(adaptiso.Error):
            adaptiso.simplify(vertices, faces + 100, max_error=1)
        with self.assertRaises(adaptiso.Error):
            adaptiso.simplify(vertices * np.nan, faces, max_error=1)


if __name__ == "__main__":
    unittest.main()
