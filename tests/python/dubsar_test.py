# SPDX-License-Identifier: Apache-2.0
# Copyright The Dubsar developers
"""The Python module: arrays without copies, their lifetimes, files, errors, progress and stopping."""

import ast
import gc
import json
import os
import pathlib
import re
import runpy
import signal
import sys
import tempfile
import threading
import unittest
import warnings

import numpy as np

import dubsar

SOURCE = os.environ["DUBSAR_SOURCE_DIR"]
# To be quick the tablets here are coarse, which every analysis says: tested where it is meant.
warnings.filterwarnings("ignore", ".*too coarse for wedges of the usual size", dubsar.MeshWarning)


def plane(rows=20, cols=30):
    """A tilted plane on a grid of 0.1 mm, with one cell that saw nothing."""
    y, x = np.mgrid[0:rows, 0:cols] * 0.1
    z = 0.2 * x
    z[3, 4] = np.nan
    return dubsar.Grid(x, y, z, source="plane.ply")


class Scans(unittest.TestCase):
    """One small tablet and its scans, for all tests that need any."""

    @classmethod
    def setUpClass(cls):
        cls.tablet = dubsar.simulate_tablet(seed=1, size_mm=(16, 14, 9), spacing_mm=0.2)
        cls.grids, cls.truth = dubsar.simulate_scans(cls.tablet, views=8, spacing_mm=0.15, noise_mm=0.01)
        cls.poses = dubsar.register(cls.grids)
        cls.mesh = dubsar.stitch(cls.grids, cls.poses)


class Names(unittest.TestCase):
    """Names of files that are no UTF-8, as os.listdir gives them."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.name = os.fsdecode(b"tafel \xff\xe4")

    def path(self, ending):
        return os.path.join(self.folder.name, self.name + ending)

    def test_are_paths(self):
        mesh = dubsar.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        dubsar.write_mesh(self.path(".ply"), mesh)
        self.assertEqual(os.listdir(self.folder.name), [self.name + ".ply"])
        for path in (self.path(".ply"), os.fsencode(self.path(".ply")), pathlib.Path(self.path(".ply"))):
            self.assertEqual(len(dubsar.read_mesh(path).faces), 1)

    def test_come_back_as_they_are(self):
        dubsar.write_grid(self.path(".grid"), plane())
        grid = dubsar.read_grids(self.folder.name)[0]
        grid.source = self.name
        self.assertEqual(grid.source, self.name)
        self.assertIn(self.name, repr(grid))
        self.assertEqual(dubsar.Pose(0, np.eye(4), file=self.name).file, self.name)
        y, x = np.mgrid[0:20, 0:30] * 0.1
        self.assertEqual(dubsar.Grid(x, y, x, source=self.name).source, self.name)

    def test_are_told_in_errors_and_warnings(self):
        with self.assertRaises(dubsar.Error) as caught:
            dubsar.read_mesh(self.path(".ply"))
        self.assertEqual(caught.exception.where, self.path(".ply"))
        self.assertIn(self.name, str(caught.exception))
        turned = dubsar.simulate_tablet(seed=1, size_mm=(12, 10, 6), spacing_mm=0.4).mesh
        turned.faces[:] = turned.faces[:, ::-1].copy()
        with self.assertWarnsRegex(dubsar.MeshWarning, self.name):
            dubsar.analyze(turned, name=self.name)


class Grids(unittest.TestCase):
    def test_arrays_are_views_that_keep_the_grid(self):
        grid = plane()
        self.assertEqual((grid.rows, grid.cols, grid.shape), (20, 30, (20, 30)))
        self.assertEqual(grid.z.dtype, np.float32)
        self.assertEqual(grid.valid.dtype, np.bool_)
        self.assertTrue(np.shares_memory(grid.z, grid.z))
        self.assertFalse(grid.valid[3, 4])
        self.assertEqual(grid.valid.sum(), len(grid))
        z = grid.z
        z[0, 0] = 7
        self.assertEqual(grid.z[0, 0], 7)
        kept = z.copy()
        del grid
        gc.collect()
        trash = [np.full(600, 3.0, np.float32) for _ in range(200)]
        np.testing.assert_array_equal(z, kept)
        self.assertEqual(len(trash), 200)

    def test_missing_parts_are_none(self):
        grid = plane()
        self.assertIsNone(grid.intensity)
        self.assertIsNone(grid.rgb)
        x = np.zeros((2, 3))
        self.assertEqual(dubsar.Grid(x, x, x, intensity=x + 0.5).intensity[1, 2], 0.5)

    def test_points_and_spacing(self):
        grid = plane()
        self.assertEqual(grid.points().shape, (599, 3))
        self.assertAlmostEqual(grid.spacing_mm, 0.1, delta=0.005)

    def test_any_array_is_taken(self):
        x = np.asfortranarray(np.arange(6, dtype=np.int16).reshape(2, 3))
        np.testing.assert_array_equal(dubsar.Grid(x, x.tolist(), x[::1]).x, [[0, 1, 2], [3, 4, 5]])

    def test_wrong_shapes_are_told(self):
        x = np.zeros((4, 5))
        with self.assertRaises(dubsar.UsageError) as caught:
            dubsar.Grid(x, x, np.zeros((4, 4)))
        self.assertIn("z has another shape", caught.exception.what)
        for bad in (np.zeros(5), np.zeros((0, 0)), np.zeros((2, 2, 2))):
            with self.assertRaises(ValueError):
                dubsar.Grid(bad, bad, bad)
        with self.assertRaises(dubsar.UsageError):
            dubsar.Grid(x, x, x, valid=np.ones((5, 4), bool))

    def test_what_is_masked_is_no_sample(self):
        y, x = np.mgrid[0:4, 0:5] * 0.1
        z = np.ma.masked_equal(np.where(x > 0.35, -999.0, 0.0), -999.0)
        grid = dubsar.Grid(x, y, z)
        np.testing.assert_array_equal(grid.valid, ~z.mask)
        self.assertEqual(grid.z.min(), 0)
        self.assertEqual(len(dubsar.Grid(x, y, z, valid=x > 0.05)), 12)
        self.assertEqual(len(dubsar.Grid(np.ma.masked_less(x, 0.05), y, z)), 12)
        self.assertEqual(len(dubsar.Grid(x, y, np.ma.array(x))), 20)
        valid = np.ma.array(np.ones((4, 5), bool), mask=x < 0.05)
        self.assertEqual(len(dubsar.Grid(x, y, x, valid=valid)), 16)
        self.assertEqual(len(dubsar.Grid(x, y, np.ma.array(x, mask=True))), 0)
        bright = np.ma.array(x, mask=z.mask)
        self.assertEqual(dubsar.Grid(x, y, z, intensity=bright).intensity[0, 4], 0)
        for name in ("intensity", "confidence"):
            with self.assertRaisesRegex(dubsar.UsageError, f"^{name} is masked where the grid has a sample"):
                dubsar.Grid(x, y, x, **{name: bright})

    def test_intensity_and_confidence_are_shares(self):
        y, x = np.mgrid[0:4, 0:5] * 0.1
        z = np.where(x > 0.35, np.nan, 0.0)
        for name in ("intensity", "confidence"):
            self.assertEqual(getattr(dubsar.Grid(x, y, z, **{name: z + 1}), name)[0, 0], 1)
            for wrong in (np.full((4, 5), 200, np.uint8), x + 85, x - 0.1, np.where(x > 0.15, np.nan, 0.5)):
                with self.assertRaisesRegex(dubsar.UsageError, f"^{name} is not between 0 and 1"):
                    dubsar.Grid(x, y, z, **{name: wrong})

    def test_numbers_of_a_map_are_refused_before_they_are_rounded(self):
        y, x = np.mgrid[0:20, 0:30] * 0.1
        self.assertEqual(len(dubsar.Grid(x + 900, y, x)), 600)
        with self.assertRaisesRegex(dubsar.BadInputError, "utm.ply: lies 500 m from the origin, too far for its samples"):
            dubsar.Grid(x + 5e5, y, x, source="utm.ply")

    def test_files_give_the_same_samples_back(self):
        grid = plane()
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.grid", "b.ply"):
                dubsar.write_grid(os.path.join(folder, name), grid)
            both = dubsar.read_grids(folder)
            self.assertEqual(len(both), 2)
            for back in both:
                for axis in "xyz":
                    np.testing.assert_array_equal(
                        getattr(back, axis)[back.valid], getattr(grid, axis)[grid.valid]
                    )
            with self.assertRaises(dubsar.UsageError):
                dubsar.write_grid(os.path.join(folder, "c.txt"), grid)
            scaled = dubsar.read_grids(os.path.join(folder, "b.ply"), unit="um")[0]
            self.assertLess(scaled.points().max(), 0.1)

    def test_a_scan_that_is_read_otherwise_than_it_says_is_warned_of(self):
        grid = plane(60, 60)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.ply")
            dubsar.write_grid(path, grid)
            with warnings.catch_warnings(record=True) as said:
                warnings.simplefilter("always")
                dubsar.read_grids(path)
            self.assertEqual([str(one.message) for one in said], [])
            with open(path, "rb") as file:
                was = file.read()
            with open(path, "wb") as file:
                file.write(re.sub(rb"dubsar_spacing_mm \S+", b"dubsar_spacing_mm 2.5", was))
            with self.assertWarnsRegex(dubsar.ScanWarning, "a.ply: its header says a spacing of 2.5 mm"):
                (back,) = dubsar.read_grids(path)
            self.assertAlmostEqual(back.spacing_mm, 0.1, places=2)
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                with self.assertRaises(dubsar.ScanWarning):
                    dubsar.read_grids(path)


class Meshes(unittest.TestCase):
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    sides = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]

    def test_takes_no_mask(self):
        corners = np.ma.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
        faces = np.ma.array([[0, 1, 2]])
        self.assertEqual(len(dubsar.Mesh(corners, faces).vertices), 3)
        holes = np.ma.masked_equal(corners, 1)
        one = np.ma.array([1.0, 1, 1], mask=[0, 0, 1])
        matrix = np.ma.array(np.eye(4), mask=np.eye(4, k=3))
        for name, made in (
            ("vertices", lambda: dubsar.Mesh(holes, faces)),
            ("faces", lambda: dubsar.Mesh(corners, np.ma.masked_equal(faces, 2))),
            ("normals", lambda: dubsar.Mesh(corners, faces, normals=holes)),
            ("reliability", lambda: dubsar.Mesh(corners, faces, reliability=one)),
            ("model_from_scanner", lambda: dubsar.Pose(0, matrix)),
        ):
            with self.assertRaisesRegex(dubsar.UsageError, f"^{name} has masked values"):
                made()

    def test_reliability_is_a_share(self):
        self.assertEqual(len(dubsar.Mesh(self.corners, self.sides, reliability=[0, 0.5, 1, 1]).reliability), 4)
        for wrong in ([1, 1, 1, float("nan")], [100, 85, 90, 100], [1, 1, 1, -1]):
            with self.assertRaisesRegex(dubsar.UsageError, "^reliability is not between 0 and 1"):
                dubsar.Mesh(self.corners, self.sides, reliability=wrong)

    def test_tetrahedron(self):
        mesh = dubsar.Mesh(self.corners, self.sides)
        report = dubsar.check_mesh(mesh)
        self.assertTrue(report["manifold"] and report["closed"])
        self.assertEqual((report["vertices"], report["faces"], report["components"]), (4, 4, 1))
        self.assertAlmostEqual(report["area_mm2"], 1.5 + np.sqrt(3) / 2, places=5)
        mesh.vertices[3, 2] = 2
        self.assertEqual(dubsar.check_mesh(mesh)["size_mm"], (1, 1, 2))
        self.assertEqual((report["inside_out"], report["longest_boundary_loop_mm"]), (False, 0))
        self.assertAlmostEqual(report["min_angle_deg"], 45, places=5)
        self.assertEqual(report["share_below_10_deg"], 0)
        inwards = dubsar.check_mesh(dubsar.Mesh(self.corners, [side[::-1] for side in self.sides]))
        self.assertIs(inwards["inside_out"], True)
        self.assertFalse(dubsar.check_mesh(dubsar.Mesh(self.corners, self.sides[:3]))["closed"])

    def test_numbers_of_a_map_are_refused_before_they_are_rounded(self):
        near = dubsar.Mesh(np.array(self.corners) * 0.1 + 900, self.sides)
        self.assertEqual(len(near.faces), 4)
        with self.assertRaisesRegex(dubsar.BadInputError, "lies 500 m from the origin, too far for its vertices"):
            dubsar.Mesh(np.array(self.corners) * 0.1 + [5e5, 0, 0], self.sides)

    def test_the_report_is_what_the_stub_says(self):
        stub = os.path.join(os.path.dirname(dubsar.__file__), "__init__.pyi")
        with open(stub, encoding="utf-8") as file:
            (report,) = (
                node for node in ast.parse(file.read()).body if getattr(node, "name", "") == "_MeshReport"
            )
        self.assertEqual(
            {field.target.id for field in report.body},
            set(dubsar.check_mesh(dubsar.Mesh(self.corners, self.sides))),
        )

    def test_faces_of_vertices_that_are_not_there(self):
        for bad in ([[0, 1, 4]], [[0, 1, -1]], [[0, 1]]):
            with self.assertRaises(dubsar.UsageError):
                dubsar.Mesh(self.corners, bad)

    def test_faces_are_whole_numbers(self):
        # numpy would make a face of vertices 0, 1 and 2 of each of the first three, without a word.
        for bad in ([[0.7, 1.2, 2.9]], [["0", "1", "2"]], [[True, False, True]], [[np.nan, 1, 2]], None):
            with self.assertRaises(dubsar.UsageError, msg=bad):
                dubsar.Mesh(self.corners, bad)
        for good in (np.asfortranarray(self.sides), np.array(self.sides, np.uint8), np.repeat(self.sides, 2, 0)[::2]):
            np.testing.assert_array_equal(dubsar.Mesh(self.corners, good).faces, self.sides)

    def test_places_that_are_not_finite(self):
        for bad in (np.nan, np.inf):
            with self.assertRaisesRegex(dubsar.UsageError, "vertex 2 is not finite"):
                dubsar.Mesh([[0, 0, 0], [1, 0, 0], [0, bad, 0], [0, 0, 1]], self.sides)

    def test_what_was_written_into_the_arrays_is_looked_at(self):
        # A face of a vertex that is not there took the interpreter down (STL), or went into a file that none reads.
        astray = dubsar.Mesh(self.corners, self.sides)
        astray.faces[1, 2] = 10**9
        nowhere = dubsar.Mesh(self.corners, self.sides)
        nowhere.vertices[3] = np.nan
        with tempfile.TemporaryDirectory() as folder:
            for mesh, what in ((astray, "face 1 names vertex 1000000000 of 4"), (nowhere, "vertex 3 is not finite")):
                for call in (
                    dubsar.check_mesh,
                    dubsar.analyze,
                    lambda m: dubsar.write_mesh(folder + "/m.ply", m),
                    lambda m: dubsar.write_mesh(folder + "/m.stl", m),
                ):
                    with self.assertRaisesRegex(dubsar.UsageError, what):
                        call(mesh)
            self.assertEqual(os.listdir(folder), [])

    def test_files(self):
        mesh = dubsar.Mesh(self.corners, self.sides)
        with tempfile.TemporaryDirectory() as folder:
            for ending in ("ply", "obj", "stl", "glb"):
                path = os.path.join(folder, "mesh." + ending)
                dubsar.write_mesh(path, mesh)
                self.assertTrue(dubsar.check_mesh(dubsar.read_mesh(path))["closed"], ending)

    def test_empty(self):
        mesh = dubsar.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))
        self.assertEqual(mesh.vertices.shape, (0, 3))
        self.assertIsNone(mesh.normals)
        with self.assertRaises(dubsar.BadInputError):
            dubsar.analyze(mesh)


class Errors(unittest.TestCase):
    def test_what_where_and_mend_are_apart(self):
        with self.assertRaises(dubsar.BadInputError) as caught:
            dubsar.read_mesh("/nowhere/mesh.ply")
        error = caught.exception
        self.assertIsInstance(error, dubsar.Error)
        self.assertIsInstance(error, ValueError)
        self.assertEqual(error.where, "/nowhere/mesh.ply")
        self.assertTrue(error.what and error.mend)
        self.assertIn(error.what, str(error))

    def test_none_is_no_mesh(self):
        # Each of them took the interpreter down.
        for call in (
            lambda: dubsar.analyze(None),
            lambda: dubsar.check_mesh(None),
            lambda: dubsar.write_mesh("x.ply", None),
            lambda: dubsar.write_grid("x.grid", None),
            lambda: dubsar.simulate_scans(None),
        ):
            with self.assertRaises(TypeError):
                call()

    def test_storage(self):
        with self.assertRaises(OSError) as caught:
            dubsar.write_mesh("/proc/nowhere/mesh.ply", dubsar.Mesh(Meshes.corners, Meshes.sides))
        self.assertIsInstance(caught.exception, dubsar.StorageError)

    def test_a_sample_without_a_place_is_named(self):
        grid = plane()
        grid.z[2, 5] = np.nan
        for call in (
            lambda: dubsar.register([plane(), grid]),
            lambda: dubsar.stitch([plane(), grid], [dubsar.Pose(k, np.eye(4)) for k in range(2)]),
        ):
            with self.assertRaisesRegex(
                dubsar.UsageError, r"^grid 1 \(plane.ply\) has a sample that is not finite, in row 2, column 5"
            ):
                call()
        grid.valid[2, 5] = False
        self.assertEqual(len(dubsar.register([grid])), 1)

    def test_unit_and_options(self):
        for call in (
            lambda: dubsar.read_mesh("x.ply", unit="inch"),
            lambda: dubsar.simulate_tablet(spacing_mm=-1),
            lambda: dubsar.Pose(0, np.diag([2, 1, 1, 1])),
            lambda: dubsar.Pose(0, np.eye(4), sigma_mm=-1),
            lambda: dubsar.Pose(0, np.eye(4), sigma_mm=np.nan),
            lambda: setattr(plane(), "spacing_mm", np.nan),
            lambda: dubsar.Grid(*np.zeros((3, 2, 2)), spacing_mm=np.inf),
            lambda: dubsar.stitch([], [dubsar.Pose(0, np.eye(4))]),
            lambda: dubsar.stitch([plane()], []),
            lambda: dubsar.register([plane()], starts=[]),
            lambda: dubsar.analyze(dubsar.Mesh(Meshes.corners, Meshes.sides), exit="sideways"),
        ):
            with self.assertRaises(dubsar.UsageError):
                call()


class Stitching(unittest.TestCase):
    """Small scans of one bumpy surface, each from its own place: what is said of them, and which pose is whose."""

    @staticmethod
    def bumps(number, moved_mm=0.0, source=""):
        """Scan `number`, 4 mm square, and its pose, `moved_mm` too high."""
        y, x = np.mgrid[0:41, 0:41] * 0.1
        noise = np.random.default_rng(number).normal(0, 0.002, x.shape)
        z = 0.4 * np.sin(1.7 * (x + number)) * np.cos(1.3 * y)
        place = np.eye(4)
        place[:3, 3] = (number, 0, moved_mm)
        return dubsar.Grid(x, y, z + noise, source=source), place

    @classmethod
    def named(cls, count=3):
        scans = [cls.bumps(k, source=f"{'abcdef'[k]}.ply") for k in range(count)]
        return [grid for grid, _ in scans], [dubsar.Pose(k, at, file=scans[k][0].source) for k, (_, at) in enumerate(scans)]

    @staticmethod
    def said(grids, poses, **more):
        with warnings.catch_warnings(record=True) as heard:
            warnings.simplefilter("always")
            mesh = dubsar.stitch(grids, poses, **more)
        assert all(one.category is dubsar.ScanWarning for one in heard)
        return mesh, [str(one.message) for one in heard]

    def test_names_pair_poses_and_grids_in_any_order(self):
        grids, poses = self.named()
        for order in ((2, 1, 0), (1, 2, 0)):
            shuffled = [grids[k] for k in order]
            by_place = [dubsar.Pose(place, poses[k].model_from_scanner) for place, k in enumerate(order)]
            right, nothing = self.said(shuffled, by_place)
            self.assertEqual(nothing, [])
            for list_of_poses in (poses, poses[::-1], [poses[k] for k in order]):
                mesh, nothing = self.said(shuffled, list_of_poses)
                self.assertEqual(nothing, [])
                np.testing.assert_array_equal(mesh.vertices, right.vertices)
        of_two, left_out = self.said(grids[1:], poses[:0:-1])
        self.assertEqual((left_out, len(of_two.faces) > 0), ([], True))

    def test_a_name_that_contradicts_its_place_is_refused(self):
        grids, poses = self.named()
        grids[2].source = "a.ply"  # two of that name: now the ids tell
        with self.assertRaisesRegex(dubsar.UsageError, r"pose 0 is of a\.ply, and grid 0 \(b\.ply\) stands in that place"):
            dubsar.stitch([grids[1], grids[0], grids[2]], poses[:2])
        with self.assertRaisesRegex(dubsar.UsageError, r"pose 1 is of folder/a\.ply, and grid 1 \(b\.ply\)"):
            dubsar.stitch(grids, [poses[0], dubsar.Pose(1, np.eye(4), file="folder/a.ply")])
        # A name that no grid has says nothing.
        dubsar.stitch(grids[:2], [dubsar.Pose(k, poses[k].model_from_scanner, file="elsewhere") for k in range(2)])

    def test_a_grid_has_one_pose_and_a_pose_has_a_grid(self):
        grids, poses = self.named()
        for two in (poses + [poses[1]], [dubsar.Pose(1, np.eye(4))] * 2):
            with self.assertRaisesRegex(dubsar.UsageError, r"two poses are of grid 1 \(b\.ply\)"):
                dubsar.stitch(grids, two)
        with self.assertRaisesRegex(dubsar.UsageError, "there is no grid of pose 2"):
            dubsar.stitch(grids[:2], poses)

    def test_poses_that_are_off_are_said(self):
        (first, at), (second, higher) = self.bumps(0), self.bumps(1, moved_mm=0.15)
        _, said = self.said([first, second], [dubsar.Pose(0, at), dubsar.Pose(1, higher)])
        self.assertEqual(len(said), 1)
        self.assertRegex(said[0], r"scans 0 and 1 lie 0\.\d+ mm apart where they overlap, .*; register them again")

    def test_a_scan_that_lies_alone_is_said(self):
        grids, poses = self.named()
        alone = poses[2].model_from_scanner.copy()
        alone[1, 3] = 50
        _, said = self.said(grids, poses[:2] + [dubsar.Pose(2, alone, file="c.ply")])
        self.assertEqual(
            said,
            ["grid 2 (c.ply) overlaps no other scan where its pose puts it; look whether that pose is right"],
        )

    def test_poses_in_another_unit_are_said(self):
        # Each in the numbers of its own place, which a pose in metres hardly moves.
        y, x = np.mgrid[0:41, 0:41] * 0.1
        grids, poses = [], []
        for k in range(2):
            at = np.eye(4)
            at[0, 3] = 0.3 * k
            grids.append(dubsar.Grid(x - 300 * k, y, 0.4 * np.sin(1.7 * x + k)))
            poses.append(dubsar.Pose(k, at))
        said = self.said(grids, poses)[1]
        self.assertIn("the list of poses: its translations look 1000 times too small", said[0])

    def test_what_is_no_part_of_the_mesh_is_said(self):
        grids, poses = self.named(5)
        grids[3].valid[1:] = False
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "poses.json")
            dubsar.write_poses(path, poses[:4])
            with open(path) as file:
                stored = json.load(file)
            stored["scans"][2].update(status="unsure", reason="two places fit")
            with open(path, "w") as file:
                json.dump(stored, file)
            _, said = self.said(grids, dubsar.read_poses(path))
        self.assertEqual(len(said), 3)
        self.assertEqual(said[0], "grid 2 (c.ply) is left out: unsure, two places fit")
        self.assertEqual(said[1], "grid 4 (e.ply) is left out: there is no pose of it")
        self.assertRegex(said[2], r"^grid 3 \(d\.ply\) is left out: it has no surface, since no three .* scan again")
        with self.assertRaisesRegex(dubsar.BadInputError, "^the list of grids: its scans have no surface"):
            dubsar.stitch(grids[3:4], poses[3:4])

    def test_a_grid_that_is_hardly_in_millimetres_is_refused(self):
        grids, poses = self.named(1)
        for axis in "xyz":
            getattr(grids[0], axis)[:] /= 1000
        grids[0].spacing_mm = 0.0001
        with self.assertRaisesRegex(dubsar.BadInputError, r"grid 0 \(a\.ply\): it would be 0.00417 mm across"):
            dubsar.stitch(grids, poses)


class Pipeline(Scans):
    def test_poses(self):
        self.assertTrue(all(pose.registered for pose in self.poses), self.poses)
        to_truth = self.truth[0].model_from_scanner @ np.linalg.inv(self.poses[0].model_from_scanner)
        for pose, truth in zip(self.poses, self.truth):
            points = np.c_[self.grids[pose.id].points(), np.ones(len(self.grids[pose.id]))]
            off = points @ (to_truth @ pose.model_from_scanner - truth.model_from_scanner).T
            self.assertLess(np.sqrt((off[:, :3] ** 2).sum(axis=1).mean()), 0.05)
        covariance = self.poses[1].covariance
        self.assertEqual(covariance.shape, (6, 6))
        np.testing.assert_allclose(covariance, covariance.T, atol=1e-12)

    def test_starts_lead_to_the_same_place(self):
        starts = [truth.model_from_scanner for truth in self.truth]
        for pose, truth in zip(dubsar.register(self.grids, starts=starts), self.truth):
            self.assertTrue(pose.registered)
            np.testing.assert_allclose(pose.model_from_scanner, truth.model_from_scanner, atol=0.1)

    def test_same_bytes_again(self):
        again = dubsar.register(self.grids)
        for one, other in zip(again, self.poses):
            np.testing.assert_array_equal(one.model_from_scanner, other.model_from_scanner)
        np.testing.assert_array_equal(dubsar.stitch(self.grids, again).vertices, self.mesh.vertices)

    def test_a_grid_that_came_twice_is_left_out_and_said(self):
        pose = dubsar.Pose(len(self.grids), self.poses[0].model_from_scanner)
        with self.assertWarnsRegex(dubsar.ScanWarning, "grid 8.* is left out: .* samples of grid 0"):
            twice = dubsar.stitch(self.grids + [self.grids[0]], self.poses + [pose])
        np.testing.assert_array_equal(twice.vertices, self.mesh.vertices)
        np.testing.assert_array_equal(twice.scans, self.mesh.scans)

    def test_a_finger_in_a_grid_is_left_out_and_said(self):
        touched = self.grids[0]
        y, x = np.mgrid[0 : touched.rows, 0 : touched.cols]
        finger = touched.valid & (abs(x - touched.cols // 2) < 20) & (abs(y - touched.rows // 2) < 20)
        grid = dubsar.Grid(
            touched.x, touched.y, touched.z + np.float32(4) * finger, touched.valid, spacing_mm=touched.spacing_mm,
            source=touched.source,
        )
        with self.assertWarnsRegex(dubsar.ScanWarning, r"something was in the way of scan 0: \d+ mm² of it are left out"):
            mesh = dubsar.stitch([grid] + self.grids[1:], self.poses)
        for end in (np.min, np.max):
            np.testing.assert_allclose(end(mesh.vertices, axis=0), end(self.mesh.vertices, axis=0), atol=0.5)

    def test_a_grid_that_came_twice_is_registered_once_and_said(self):
        with self.assertWarnsRegex(dubsar.ScanWarning, "grid 8 has the very samples of grid 3, and counts as the same"):
            twice = dubsar.register(self.grids + [self.grids[3]])
        for one, other in zip(twice, self.poses + [self.poses[3]]):
            self.assertEqual((one.status, one.sigma_mm), (other.status, other.sigma_mm))
            np.testing.assert_array_equal(one.model_from_scanner, other.model_from_scanner)

    def test_poses_in_the_numbers_of_a_map_are_refused(self):
        far = np.eye(4)
        far[0, 3] = 1e6
        with self.assertRaisesRegex(dubsar.BadInputError, "1000 m from the origin"):
            dubsar.stitch([plane()], [dubsar.Pose(0, far)])

    def test_a_pose_in_the_numbers_of_a_map_fails_as_the_command_has_it(self):
        far = self.truth[0].model_from_scanner.copy()
        far[0, 3] += 5e5
        (pose,) = dubsar.register(self.grids[:1], starts=[far])
        self.assertEqual(pose.status, "failed")
        self.assertIn("500 m from the origin", pose.reason)

    def test_a_matrix_laid_out_otherwise_is_refused(self):
        right = self.truth[1].model_from_scanner
        np.testing.assert_allclose(dubsar.Pose(1, right).model_from_scanner, right, atol=1e-9)
        inverse = np.linalg.inv(right)
        np.testing.assert_allclose(dubsar.Pose(1, inverse).model_from_scanner, inverse, atol=1e-9)
        wrong = [right.T]
        for last in ([0, 0, 0, 2], [0, 0, 0, 0], [0.1, 0, 0, 1], [0, 0, 0, np.nan]):
            wrong.append(right.copy())
            wrong[-1][3] = last
        for matrix in wrong:
            with self.assertRaisesRegex(dubsar.UsageError, "model_from_scanner is no rigid .* last row 0 0 0 1"):
                dubsar.Pose(1, matrix)
            with self.assertRaisesRegex(dubsar.UsageError, "a start is no rigid transform; .* in the last column"):
                dubsar.register(self.grids[:2], starts=[None, matrix])

    def test_nothing_is_written_into_a_session_or_a_package(self):
        wedges = dubsar.analyze(self.mesh)
        with tempfile.TemporaryDirectory() as folder:
            for checked, mark, within in (("s", "session.sqlite", "mesh"), ("p", "bagit.txt", "data")):
                os.makedirs(os.path.join(folder, checked, within))
                with open(os.path.join(folder, checked, mark), "w") as file:
                    file.write(mark)
                os.symlink(os.path.join(folder, checked, within), os.path.join(folder, "link"))
                for call in (
                    lambda path: dubsar.write_grid(path + ".grid", self.grids[0]),
                    lambda path: dubsar.write_mesh(path + ".ply", self.mesh),
                    lambda path: dubsar.write_poses(path + ".json", self.poses),
                    lambda path: wedges.write(path + ".json"),
                ):
                    for path in ((checked, within, "new"), ("link", "new")):
                        with self.assertRaisesRegex(dubsar.UsageError, "keeps a checksum of every file"):
                            call(os.path.join(folder, *path))
                self.assertEqual(os.listdir(os.path.join(folder, checked, within)), [])
                os.remove(os.path.join(folder, "link"))

    def test_poses_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "poses.json")
            dubsar.write_poses(path, self.poses)
            for one, other in zip(dubsar.read_poses(path), self.poses):
                np.testing.assert_array_equal(one.model_from_scanner, other.model_from_scanner)

    def test_mesh(self):
        self.assertTrue(dubsar.check_mesh(self.mesh)["manifold"])
        count = len(self.mesh.vertices)
        for column in (self.mesh.normals, self.mesh.reliability, self.mesh.sigma_mm, self.mesh.scans, self.mesh.flags):
            self.assertEqual(len(column), count)
        self.assertLess(self.mesh.faces.max(), count)

    def test_wedges(self):
        wedges = dubsar.analyze(self.mesh, name="model.ply")
        table = wedges.table
        self.assertGreater(len(wedges), 30)
        self.assertEqual(len(table), len(wedges))
        self.assertEqual(table["exit_points_mm"].shape, (len(table), 3, 3))
        self.assertTrue((table["depth_mm"] > 0).all())
        self.assertTrue(set(table["side"]) <= {b"obverse", b"reverse", b"left", b"right", b"top", b"bottom", b""})
        lengths = np.linalg.norm(table["exit_points_mm"] - table["depth_point_mm"][:, None, :], axis=2)
        np.testing.assert_allclose(lengths, table["edge_lengths_mm"], rtol=1e-6)
        for name, values in wedges.fields.items():
            self.assertEqual(len(values), len(self.mesh.vertices), name)
        self.assertEqual(wedges.fields["free_surface"].dtype, np.bool_)
        self.assertEqual(len(wedges.annotated_mesh().colours), len(wedges.annotated_mesh().vertices))
        stored = json.loads(wedges.to_json())
        self.assertEqual(len(stored["wedges"]), len(wedges))
        np.testing.assert_allclose(
            [w["depth_point"] for w in stored["wedges"]], table["depth_point_mm"], atol=1e-5
        )
        for key, column, unit in (
            ("depth_point", "sigma_depth_point_mm", 1),
            ("depth", "sigma_depth_mm", 1),
            ("edges_deg", "sigma_edge_rad", np.pi / 180),
            ("edge_slopes_deg", "sigma_edge_slope_rad", np.pi / 180),
            ("opening_angles_deg", "sigma_opening_rad", np.pi / 180),
            ("face_angles_deg", "sigma_face_angle_rad", np.pi / 180),
            ("face_slopes_deg", "sigma_face_slope_rad", np.pi / 180),
            ("edge_lengths", "sigma_length_mm", 1),
            ("volume_mm3", "sigma_volume_mm3", 1),
        ):
            sigmas = unit * np.array([w["sigma"][key] for w in stored["wedges"]])
            np.testing.assert_allclose(table[column], sigmas, rtol=1e-9, err_msg=column)
        self.assertTrue((table["directional_edge"] == 0).all())
        as_seen = dubsar.analyze(self.mesh, name="model.ply", exit="extent").table
        self.assertTrue(np.isnan(as_seen["sigma_length_mm"]).all() and np.isnan(as_seen["sigma_volume_mm3"]).all())
        self.assertEqual(
            [w["directional_by"] for w in stored["wedges"]], [by.decode() for by in table["directional_by"]]
        )
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "wedges.json")
            wedges.write(path)
            back = dubsar.read_wedges(path)
            self.assertTrue(np.all(back.table["by_hand"] == b"no"))
            stored["wedges"][3]["by_hand"] = "merged"
            with open(path, "w") as corrected:
                json.dump(stored, corrected)
            self.assertEqual(dubsar.read_wedges(path).table["by_hand"][3], b"merged")
            self.assertTrue((back.table["body"] == 0).all())
            stored["wedges"][3]["place"]["body"] = 2
            with open(path, "w") as of_two:
                json.dump(stored, of_two)
            with self.assertWarnsRegex(dubsar.MeshWarning, r"place\.body tells them apart"):
                bodies = dubsar.read_wedges(path).table["body"]
            self.assertEqual((bodies[2], bodies[3], bodies[4]), (0, 2, 0))
            np.testing.assert_allclose(back.table["depth_mm"], table["depth_mm"], atol=1e-5)
            self.assertEqual(back.fields, {})
            with self.assertRaises(dubsar.UsageError):
                back.annotated_mesh()

    def test_a_mesh_in_metres_is_warned_of(self):
        metres = dubsar.Mesh(self.mesh.vertices / 1000, self.mesh.faces)
        with self.assertWarnsRegex(dubsar.MeshWarning, r"m\.ply: it would be 0\.0\d+ mm across; its numbers look like m:"):
            dubsar.analyze(metres, name="m.ply")

    def test_what_is_to_be_doubted_in_the_wedges_is_warned_of(self):
        coarse = dubsar.simulate_tablet(seed=5, size_mm=(14, 11, 8), spacing_mm=0.2).mesh
        with self.assertWarnsRegex(dubsar.MeshWarning, r"c\.ply: too coarse for wedges of the usual size"):
            wedges = dubsar.analyze(coarse, name="c.ply")
        stored = json.loads(wedges.to_json())
        self.assertAlmostEqual(wedges.text_certainty, stored["text_certainty"])
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "wedges.json")
            stored["text_certainty"] = 0.05
            with open(path, "w") as file:
                json.dump(stored, file)
            with warnings.catch_warnings(record=True) as said:
                warnings.simplefilter("always")
                self.assertEqual(dubsar.read_wedges(path).text_certainty, 0.05)
            self.assertTrue(all(one.category is dubsar.MeshWarning for one in said))
            said = [str(one.message) for one in said]
            self.assertRegex(said[0], r"wedges\.json: no direction of writing shows in the \d+ wedges that were found")
            self.assertRegex(said[1], r"wedges\.json: too coarse for wedges of the usual size")
            self.assertEqual(len(said), 2)

    def test_what_cannot_be_measured_is_refused(self):
        with self.assertRaisesRegex(dubsar.BadInputError, "its numbers look like um"):
            dubsar.analyze(dubsar.Mesh(self.mesh.vertices * 10000, self.mesh.faces))
        far = dubsar.Mesh(self.mesh.vertices, self.mesh.faces)
        far.vertices[:] += np.float32(1e6)
        with self.assertRaisesRegex(dubsar.BadInputError, "so far from the origin"):
            dubsar.analyze(far)
        with self.assertRaisesRegex(dubsar.BadInputError, "nothing inscribed is that large"):
            dubsar.analyze(dubsar.Mesh(self.mesh.vertices * 1e5, self.mesh.faces))

    def test_a_mesh_inside_out_is_warned_of_and_measured_as_the_command_does(self):
        inwards = dubsar.Mesh(self.mesh.vertices, self.mesh.faces[:, [0, 2, 1]])
        before = inwards.faces.copy()
        with self.assertWarnsRegex(dubsar.MeshWarning, "inside out"):
            wedges = dubsar.analyze(inwards)
        outwards = dubsar.analyze(dubsar.Mesh(self.mesh.vertices, self.mesh.faces))
        self.assertEqual(wedges.table.tobytes(), outwards.table.tobytes())
        np.testing.assert_array_equal(inwards.faces, before)

    def test_fields_outlive_the_wedges(self):
        openness = dubsar.analyze(self.mesh).fields["openness"]
        kept = openness.copy()
        gc.collect()
        dubsar.analyze(self.mesh)
        np.testing.assert_array_equal(openness, kept)

    def test_progress_is_told_on_the_calling_thread(self):
        told = []
        dubsar.register(self.grids[:2], progress=lambda *words: told.append((threading.get_ident(), *words)))
        self.assertTrue(told)
        self.assertEqual({ident for ident, _, _ in told}, {threading.get_ident()})
        self.assertTrue(all(0 <= fraction <= 1 for _, _, fraction in told))

    def test_false_stops(self):
        with self.assertRaises(dubsar.Cancelled):
            dubsar.register(self.grids, progress=lambda stage, fraction: False)
        with self.assertRaises(dubsar.Cancelled):
            dubsar.register(self.grids, progress=lambda stage, fraction: np.float64(fraction) > 2)

    def test_nothing_else_stops(self):
        for answer in (None, True, 0, np.int64(0), "", np.bool_(True)):
            self.assertEqual(len(dubsar.register(self.grids[:1], progress=lambda stage, fraction: answer)), 1)

    def test_what_progress_raises_comes_through(self):
        def broken(stage, fraction):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            dubsar.simulate_scans(self.tablet, views=200, spacing_mm=0.05, progress=broken)

    def test_control_c_stops(self):
        # The signal comes while the work runs, from within it: progress is told before it is finished.
        def interrupt(stage, fraction):
            os.kill(os.getpid(), signal.SIGINT)

        previous = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            with self.assertRaises(KeyboardInterrupt):
                dubsar.simulate_scans(self.tablet, views=200, spacing_mm=0.05, progress=interrupt)
        finally:
            signal.signal(signal.SIGINT, previous)

    def test_control_c_stops_what_has_no_progress(self):
        # Large enough that no step is over before the signal is looked for (every 50 ms).
        side = 1000
        y, x = np.mgrid[0:side, 0:side]
        corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
        mesh = dubsar.Mesh(
            np.stack([x, y, np.sin(x)], axis=-1).reshape(-1, 3) * 0.1,
            np.concatenate([np.stack([corner, corner + 1, corner + side], axis=-1)] * 2),
        )
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "mesh.obj")
            previous = signal.signal(signal.SIGALRM, signal.default_int_handler)
            try:
                with self.assertRaises(KeyboardInterrupt):
                    signal.setitimer(signal.ITIMER_REAL, 0.02)
                    dubsar.write_mesh(path, mesh)
                self.assertEqual(os.listdir(folder), [])
                dubsar.write_mesh(path, mesh)
                for work in (lambda: dubsar.read_mesh(path), lambda: dubsar.check_mesh(mesh)):
                    with self.assertRaises(KeyboardInterrupt):
                        signal.setitimer(signal.ITIMER_REAL, 0.02)
                        work()
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0)
                signal.signal(signal.SIGALRM, previous)

    def test_other_threads_run_meanwhile(self):
        # Each waits for the other inside its own call: with the lock held one would wait for ever.
        meet = threading.Barrier(2, timeout=60)
        met = []

        def progress(stage, fraction):
            if not met:
                meet.wait()
                met.append(True)

        def call():
            dubsar.register(self.grids[:2], progress=lambda *words: first.is_set() or (first.set(), meet.wait()))

        first = threading.Event()
        other = threading.Thread(target=call)
        other.start()
        dubsar.register(self.grids[:2], progress=progress)
        other.join()
        self.assertTrue(met)


class Stubs(unittest.TestCase):
    def test_they_name_what_is_there(self):
        with open(os.path.join(os.path.dirname(dubsar.__file__), "__init__.pyi"), encoding="utf-8") as file:
            stub = ast.parse(file.read())
        there = {name for name in dir(dubsar) if not name.startswith("_")}
        named = {}
        for node in stub.body:
            if isinstance(node, ast.FunctionDef):
                named[node.name] = {a.arg for a in node.args.args}
            elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                named[node.name] = {
                    n.name for n in node.body if isinstance(n, ast.FunctionDef) and not n.name.startswith("_")
                } | {n.target.id for n in node.body if isinstance(n, ast.AnnAssign)}
        self.assertEqual(set(named), there)
        for name, members in named.items():
            thing = getattr(dubsar, name)
            if isinstance(thing, type):
                own = {m for m in vars(thing) if not m.startswith("_")}
                if not issubclass(thing, Exception):
                    self.assertEqual(members, own, name)
            else:
                for argument in members:
                    self.assertIn(argument + ":", thing.__doc__, name)


class Example(unittest.TestCase):
    def test_it_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            previous = sys.argv
            sys.argv = ["tablet.py", folder]
            try:
                ran = runpy.run_path(os.path.join(SOURCE, "python/examples/tablet.py"))
            finally:
                sys.argv = previous
            self.assertTrue(ran["report"]["manifold"])
            self.assertGreater(ran["found"], 0.8)
            self.assertLess(np.mean(ran["off_um"]), 50)
            self.assertEqual(len(dubsar.read_wedges(folder + "/wedges.json")), len(ran["wedges"]))
            self.assertGreater(len(dubsar.read_mesh(folder + "/model.ply").faces), 1000)


if __name__ == "__main__":
    unittest.main()
