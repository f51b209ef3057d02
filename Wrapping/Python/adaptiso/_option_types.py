"""Generated from the library's rows of options: types of keyword arguments. Do not edit."""

from typing import Literal, Optional, Tuple, TypedDict, Union


class SurfaceOptions(TypedDict, total=False):
    max_error: Optional[float]
    triangles: Optional[int]
    reduction: Optional[float]
    min_angle: Optional[float]
    method: Optional[Literal["adaptive", "boxes", "dmc", "asc", "mc"]]
    border: Optional[Literal["closed", "open"]]
    largest: Optional[bool]
    min_volume: Optional[float]
    fill_cavities: Optional[bool]
    crop: Optional[Union[str, Tuple[slice, slice, slice]]]
    smooth: Optional[float]
    resample: Optional[float]
    interpolation: Optional[Literal["linear", "bspline", "nearest"]]


class CheckOptions(TypedDict, total=False):
    min_angle: Optional[float]
    min_wall: Optional[float]
    max_pairs: Optional[int]


class CheckNestedOptions(TypedDict, total=False):
    min_gap: Optional[float]
    min_angle: Optional[float]
    min_wall: Optional[float]
    max_pairs: Optional[int]


class SimplifyOptions(TypedDict, total=False):
    max_error: Optional[float]
    triangles: Optional[int]
    reduction: Optional[float]
    min_angle: Optional[float]
    keep_borders: Optional[bool]
    weld: Optional[bool]


class MendOptions(TypedDict, total=False):
    max_error: Optional[float]
    max_hole: Optional[float]
    open: Optional[bool]
    ball: Optional[bool]
    largest: Optional[bool]
    min_volume: Optional[float]
    fill_cavities: Optional[bool]


class LabelsOptions(TypedDict, total=False):
    max_error: Optional[float]
    triangles: Optional[int]
    reduction: Optional[float]
    min_angle: Optional[float]


class BemOptions(TypedDict, total=False):
    sulci: Optional[float]
    smoothing: Optional[float]
    closing: Optional[float]
    cut_necks: Optional[float]
    voxel: Optional[float]
    csf: Optional[float]
    skull: Optional[float]
    max_skull: Optional[float]
    age: Optional[float]
    skull_hu: Optional[float]
    skin_hu: Optional[float]
    source_count: Optional[int]
    source_grid: Optional[float]
    element_size: Optional[float]


class ReadOptions(TypedDict, total=False):
    series: Optional[str]
    volume_index: Optional[int]
    level: Optional[int]
    channel: Optional[int]
    time: Optional[int]
    image_space: Optional[Literal["lps", "ras"]]
    all_chunks: Optional[bool]
    resample_slices: Optional[bool]


class GiantOptions(TypedDict, total=False):
    series: Optional[str]
    volume_index: Optional[int]
    zarr_level: Optional[int]
    channel: Optional[int]
    time: Optional[int]
    image_space: Optional[Literal["lps", "ras"]]
    all_chunks: Optional[bool]
