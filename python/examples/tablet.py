# SPDX-License-Identifier: Apache-2.0
# Copyright The Dubsar developers
# From range grids to wedges in a notebook. Each "# %%" begins a cell (Jupyter, Spyder and VS Code read this file so);
# as a whole it runs with python3.

# %% A tablet that nobody pressed: its true surface and its true wedges are known.
import os
import sys

import numpy as np

import dubsar

if len(sys.argv) > 1:  # a folder to keep model and wedges in; said now if it cannot be made
    os.makedirs(sys.argv[1], exist_ok=True)
tablet = dubsar.simulate_tablet(seed=3, size_mm=(22, 18, 10), spacing_mm=0.12, damage=0)
grids, true_poses = dubsar.simulate_scans(tablet, views=12, spacing_mm=0.12, noise_mm=0.01)
# With a scanner's files: grids = dubsar.read_grids("scans/", unit="m")
print(len(grids), "grids, the first:", grids[0])

# %% numpy sees the samples where they lie. How far is each from its neighbour along the row?
first = grids[0]
step = np.hypot(np.diff(first.x, axis=1), np.diff(first.y, axis=1))
both = first.valid[:, 1:] & first.valid[:, :-1]
print(f"spacing {np.median(step[both]):.3f} mm, nominal {first.spacing_mm:.3f} mm")

# %% Where did each scan lie? Nothing is given but the surfaces. A pose that is not certain says so.
poses = dubsar.register(grids)
for pose in poses:
    if not pose.registered:
        print(pose.id, pose.status, pose.reason)
print(sum(pose.registered for pose in poses), "registered,",
      f"{1000 * max(pose.sigma_mm for pose in poses if pose.registered):.1f} micrometres at worst, as predicted")

# %% Against the truth: the model's frame is that of the first scan.
to_model = poses[0].model_from_scanner @ np.linalg.inv(true_poses[0].model_from_scanner)
off_um = []
for pose, truth in zip(poses, true_poses):
    if pose.registered:
        points = np.c_[grids[pose.id].points(), np.ones(len(grids[pose.id]))]
        moved = points @ (pose.model_from_scanner - to_model @ truth.model_from_scanner).T
        off_um.append(1000 * np.sqrt((moved[:, :3] ** 2).sum(axis=1).mean()))
print(f"displaced by {np.mean(off_um):.1f} micrometres RMS, the first scan's own error included")

# %% One mesh.
mesh = dubsar.stitch(grids, poses)
report = dubsar.check_mesh(mesh)
print(mesh, "manifold" if report["manifold"] else "NOT manifold", f"{report['area_mm2']:.0f} mm2")

# %% Its wedges as a table: numpy's own, or pandas.DataFrame of its plain columns.
wedges = dubsar.analyze(mesh)
table = wedges.table
print(wedges, "depth", np.round(np.percentile(table["depth_mm"], [5, 50, 95]), 3), "mm")
print("opening angles", np.round(np.degrees(np.median(table["opening_angles_rad"], axis=0)), 1), "degrees")

# %% How many of the true wedges that later ones left 60 % of were found, within 0.2 mm of their depth points?
whole = tablet.wedges[tablet.wedges["intact"] >= 0.6]
true_points = whole["depth_point_mm"] @ to_model[:3, :3].T + to_model[:3, 3]
apart = np.linalg.norm(true_points[:, None, :] - table["depth_point_mm"][None, :, :], axis=2)
found = (apart.min(axis=1) < 0.2).mean()
print(f"{100 * found:.0f} % of {len(true_points)} found")

# %% Keep them.
if len(sys.argv) > 1:
    dubsar.write_mesh(sys.argv[1] + "/model.ply", mesh)
    wedges.write(sys.argv[1] + "/wedges.json")
