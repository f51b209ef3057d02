"""mend(): a solid of any mesh."""
import unittest

import numpy as np

import adaptiso


def ball(size=24, radius=9):
    i, j, k = np.indices((size,) * 3) - (size - 1) / 2
    return adaptiso.surface(-np.sqrt(i**2 + j**2 + k**2), -radius, max_error=0.1)


def crossing():
    """Two balls that cross each other."""
    one = ball()
    shift = np.array([7.0, 0, 0])
    return (np.concatenate([one.vertices, one.vertices + shift]),
            np.concatenate([one.faces, one.faces + len(one.vertices)]))


class Mend(unittest.TestCase):
    def test_crossing_balls_become_their_union(self):
        vertices, faces = crossing()
        self.assertFalse(adaptiso.check((vertices, faces)))
        mended = adaptiso.mend(vertices, faces, max_error=0.3)
        self.assertTrue(adaptiso.check(mended))
        r, d = 9, 7  # of the lens: pi (4 r + d) (2 r - d)^2 / 12
        union = 2 * 4 / 3 * np.pi * r ** 3 - np.pi * (4 * r + d) * (2 * r - d) ** 2 / 12
        self.assertAlmostEqual(mended.volume / union, 1, delta=0.02)
        found = mended.report
        self.assertGreater(found["crossing_triangles"], 0)
        self.assertEqual(len(found["inner"]), 2)
        self.assertLessEqual(found["result_to_input"], 0.3)
        self.assertLessEqual(found["input_to_result"], 0.3)

    def test_handles_are_cut(self):
        i, j, k = np.indices((32, 32, 12)) - np.array([15.5, 15.5, 5.5])[:, None, None, None]
        ring = adaptiso.surface(-np.hypot(np.hypot(i, j) - 9, k), -3, max_error=0.1)
        cut = adaptiso.mend(ring, ball=True)
        self.assertEqual((cut.report["handles"], len(cut.report["cut_handles"])), (1, 1))
        self.assertAlmostEqual(cut.report["cut_handles"][0]["area"] / (9 * np.pi), 1, delta=0.05)
        self.assertTrue(adaptiso.check(cut))

    def test_lies_around_another_surface(self):
        inner, outer = ball(24, 7), ball(32, 8)
        inner = (inner.vertices + 5, inner.faces)
        moved = adaptiso.mend(outer.vertices, outer.faces, around=inner, gap=0.5)
        self.assertGreaterEqual(moved.report["gap"], 0.5)
        self.assertGreater(moved.report["moved_vertices"], 0)
        self.assertGreaterEqual(moved.report["result_to_input"], moved.report["largest_move"])
        self.assertTrue(adaptiso.check_nested([inner, moved], profile="view"))
        with self.assertRaisesRegex(adaptiso.Error, "each needs the other"):
            adaptiso.mend(outer, gap=1)
        with self.assertRaisesRegex(adaptiso.Error, "around: they are apart"):
            adaptiso.mend(outer.vertices, outer.faces, around=(inner[0] + 100, inner[1]), gap=1)

    def test_a_sound_mesh_stays_as_it_is(self):
        whole = ball()
        mended = adaptiso.mend(whole)
        self.assertTrue(mended.report["was_sound"])
        np.testing.assert_array_equal(mended.vertices, whole.vertices)
        np.testing.assert_array_equal(mended.faces, whole.faces)

    def test_holes_are_closed_up_to_a_width(self):
        whole = ball()
        kept = whole.faces[~(whole.vertices[whole.faces][:, :, 2] >
                             whole.vertices[:, 2].max() - 3).any(axis=1)]
        with self.assertRaisesRegex(adaptiso.Error, "hole near .* wide, more than max_hole"):
            adaptiso.mend(whole.vertices, kept)
        closed = adaptiso.mend(whole.vertices, kept, max_hole=25)
        self.assertTrue(closed.is_closed)
        self.assertEqual(len(closed.report["filled"]), 1)
        opened = adaptiso.mend(whole.vertices, kept, open=True)
        self.assertFalse(opened.is_closed)
        self.assertEqual(len(opened.report["left_open"]), 1)

    def test_is_the_same_for_any_number_of_threads(self):
        one, two = (adaptiso.mend(*crossing(), max_error=0.3, threads=n) for n in (1, 2))
        self.assertEqual(one, two)

    def test_progress_can_stop_it(self):
        def stop(stage, done):
            raise KeyError("enough")
        with self.assertRaisesRegex(KeyError, "enough"):
            adaptiso.mend(*crossing(), max_error=0.3, progress=stop)

    def test_what_is_no_mesh_is_refused(self):
        vertices, faces = crossing()
        for arguments, words in (({"max_error": 0}, "max_error"), ({"max_hole": -1}, "max_hole")):
            with self.assertRaisesRegex(adaptiso.Error, words):
                adaptiso.mend(vertices, faces, **arguments)
        with self.assertRaisesRegex(adaptiso.Error, "area"):
            adaptiso.mend([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
        with self.assertRaises(adaptiso.Error):
            adaptiso.mend(vertices, faces + 10000)


if __name__ == "__main__":
    unittest.main()
