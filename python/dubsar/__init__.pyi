# SPDX-License-Identifier: Apache-2.0
# Copyright The Dubsar developers
# Lengths are millimetres, angles radians, transforms [4, 4] target_from_source.
from os import PathLike
from typing import Any, Callable, Optional, Sequence, TypedDict, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

Path = Union[str, bytes, PathLike[str], PathLike[bytes]]
Progress = Optional[Callable[[str, float], Optional[bool]]]

class Error(Exception):
    what: str
    where: str
    mend: str

class UsageError(Error, ValueError): ...
class BadInputError(Error, ValueError): ...
class DeviceError(Error, OSError): ...
class StorageError(Error, OSError): ...
class Cancelled(Error): ...
class InternalError(Error, RuntimeError): ...
class ScanWarning(UserWarning): ...
class MeshWarning(UserWarning): ...

class Grid:
    def __init__(
        self,
        x: ArrayLike,
        y: ArrayLike,
        z: ArrayLike,
        valid: Optional[ArrayLike] = None,
        intensity: Optional[ArrayLike] = None,
        confidence: Optional[ArrayLike] = None,
        spacing_mm: float = 0.0,
        source: str = "",
    ) -> None: ...
    spacing_mm: float
    source: str
    @property
    def rows(self) -> int: ...
    @property
    def cols(self) -> int: ...
    @property
    def shape(self) -> tuple[int, int]: ...
    @property
    def x(self) -> NDArray[np.float32]: ...
    @property
    def y(self) -> NDArray[np.float32]: ...
    @property
    def z(self) -> NDArray[np.float32]: ...
    @property
    def valid(self) -> NDArray[np.bool_]: ...
    @property
    def intensity(self) -> Optional[NDArray[np.float32]]: ...
    @property
    def confidence(self) -> Optional[NDArray[np.float32]]: ...
    @property
    def rgb(self) -> Optional[NDArray[np.uint8]]: ...
    @property
    def device(self) -> str: ...
    def points(self) -> NDArray[np.float32]: ...
    def __len__(self) -> int: ...

class Mesh:
    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        normals: Optional[ArrayLike] = None,
        reliability: Optional[ArrayLike] = None,
    ) -> None: ...
    @property
    def vertices(self) -> NDArray[np.float32]: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def normals(self) -> Optional[NDArray[np.float32]]: ...
    @property
    def reliability(self) -> Optional[NDArray[np.float32]]: ...
    @property
    def sigma_mm(self) -> Optional[NDArray[np.float32]]: ...
    @property
    def scans(self) -> Optional[NDArray[np.uint8]]: ...
    @property
    def flags(self) -> Optional[NDArray[np.uint8]]: ...
    @property
    def colours(self) -> Optional[NDArray[np.uint8]]: ...

class _MeshReport(TypedDict):
    manifold: bool
    closed: bool
    vertices: int
    faces: int
    components: int
    largest_component_faces: int
    boundary_loops: int
    boundary_edges: int
    boundary_length_mm: float
    longest_boundary_loop_mm: float
    non_manifold_edges: int
    non_manifold_vertices: int
    inconsistent_faces: int
    degenerate_faces: int
    duplicate_faces: int
    repeated_faces: int
    self_intersections: int
    unreferenced_vertices: int
    share_below_10_deg: float
    min_angle_deg: float
    area_mm2: float
    size_mm: tuple[float, float, float]
    inside_out: bool

class Pose:
    def __init__(
        self, id: int, model_from_scanner: ArrayLike, file: str = "", sigma_mm: float = 0.0
    ) -> None: ...
    @property
    def id(self) -> int: ...
    @property
    def file(self) -> str: ...
    @property
    def status(self) -> str: ...
    @property
    def registered(self) -> bool: ...
    @property
    def model_from_scanner(self) -> NDArray[np.float64]: ...
    @property
    def rms_mm(self) -> float: ...
    @property
    def sigma_mm(self) -> float: ...
    @property
    def overlap(self) -> float: ...
    @property
    def reason(self) -> str: ...
    @property
    def warning(self) -> str: ...
    @property
    def covariance(self) -> Optional[NDArray[np.float64]]: ...

class _Rejected(TypedDict):
    reason: str
    depth_point_mm: tuple[float, float, float]

class Wedges:
    @property
    def table(self) -> NDArray[np.void]:
        """One row a wedge. Columns: id, body (of a mesh that holds several: from 1 by falling area; else 0),
        depth_point_mm[3], exit_points_mm[3, 3], exit_points_surface_mm[3, 3], exit_points_extent_mm[3, 3],
        outer_vertices_mm[3, 3], face_normals[3, 3], surface_normal[3],
        directional_edge, directional_by (bytes, b"longest"), directional_margin, depth_mm, face_angles_rad[3],
        opening_angles_rad[3], edge_lengths_mm[3], edge_slopes_rad[3], face_slopes_rad[3], edge_bows_mm[3],
        volume_mm3, sigma_depth_point_mm, sigma_depth_mm, sigma_edge_rad[3] (direction),
        sigma_edge_slope_rad[3], sigma_opening_rad[3], sigma_face_angle_rad[3], sigma_face_slope_rad[3],
        sigma_length_mm[3], sigma_volume_mm3, side (bytes, b"obverse"; b"" where not known, line and order are 0
        then), line, order, turn_rad, reliability, confidence, vertex_count, intact,
        faces_intact[3], beyond_mesh[3] (bool), roundness, by_hand (b"no", or what a person said: b"merged", b"split", b"added"). What each means: wedges.json's page,
        docs/formats/wedges.md. Sigmas, face slopes, bows, faces_intact and roundness that a file does not say are NaN,
        sigma_length_mm and sigma_volume_mm3 with exit='extent' too, and of an edge that is beyond_mesh. Edges and faces of a measured wedge are counted
        from the directional one on."""
    @property
    def rejected(self) -> list[_Rejected]: ...
    @property
    def fields(self) -> dict[str, NDArray[Any]]: ...
    @property
    def text_from_model(self) -> Optional[NDArray[np.float64]]: ...
    @property
    def text_certainty(self) -> float:
        """0 to 1: how clearly the wedges show a direction of writing; below 0.1 they may be none."""
    @property
    def timings_s(self) -> dict[str, float]: ...
    def annotated_mesh(self) -> Mesh: ...
    def to_json(self) -> str: ...
    def write(self, path: Path) -> None: ...
    def __len__(self) -> int: ...

class SimulatedTablet:
    @property
    def mesh(self) -> Mesh: ...
    @property
    def wedges(self) -> NDArray[np.void]: ...

# Warns (ScanWarning) of scans that are read otherwise than their files say, or that are doubtful.
def read_grids(path: Path, unit: Optional[str] = None, progress: Progress = None) -> list[Grid]: ...
def write_grid(path: Path, grid: Grid) -> None: ...
def read_mesh(path: Path, unit: Optional[str] = None) -> Mesh: ...
def write_mesh(path: Path, mesh: Mesh) -> None: ...
def check_mesh(mesh: Mesh) -> _MeshReport: ...
def read_poses(path: Path) -> list[Pose]: ...
def write_poses(path: Path, poses: Sequence[Pose]) -> None: ...
# Warns (ScanWarning) of a registered grid with the very samples of another, which counts once.
def register(
    grids: Sequence[Grid],
    starts: Optional[Sequence[Optional[ArrayLike]]] = None,
    pins: Optional[Path] = None,
    progress: Progress = None,
) -> list[Pose]: ...
# A pose is of the grid whose source its file names, where each pose has a file that is the source of just one grid, else
# of the grid whose place is its id. Warns (ScanWarning) as the command does: of what was in the way of a scan, of grids that
# are no part of the mesh, of poses that look wrong.
def stitch(
    grids: Sequence[Grid],
    poses: Sequence[Pose],
    pins: Optional[Path] = None,
    progress: Progress = None,
) -> Mesh: ...
# Warns (MeshWarning) of a mesh that is inside out or hardly in millimetres, and of what is to be doubted in the wedges:
# several bodies in one mesh, no direction of writing, a mesh too coarse, most of them worn. So does read_wedges.
def analyze(mesh: Mesh, exit: str = "surface", name: str = "", progress: Progress = None) -> Wedges: ...
def read_wedges(path: Path) -> Wedges: ...
def simulate_tablet(
    seed: int = 1,
    size_mm: Sequence[float] = (50.0, 40.0, 20.0),
    spacing_mm: float = 0.1,
    damage: float = 0.3,
    progress: Progress = None,
) -> SimulatedTablet: ...
def simulate_scans(
    tablet: SimulatedTablet,
    views: int = 12,
    spacing_mm: float = 0.1,
    noise_mm: float = 0.02,
    seed: int = 1,
    progress: Progress = None,
) -> tuple[list[Grid], list[Pose]]: ...
