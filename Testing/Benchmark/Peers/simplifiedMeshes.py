"""The meshes that simplifyMeshes.py simplifies, made once and kept in a folder.

head       marching cubes of ch2 at 100: folds, thin sheets, 1,169 pieces
remeshed   the head's outside, remeshed evenly to a million triangles by this library
noisy      the same with up to 0.3 mm of noise along its normals, as a scanner's depth has
sphere     1.3 million triangles of equal size
jittered   head with up to 0.3 mm of noise in every direction: a third of a triangle's side, so that
           a tenth of its triangles cross others (these are to be kept as they are)
"""
import subprocess

import numpy as np

HEAD = "/usr/share/mricron/templates/ch2.nii.gz"
NAMES = ("head", "remeshed", "noisy", "sphere", "jittered")
NOISE_MM = 0.3
MILLION = 500_002  # vertices of a closed mesh of genus 0 with a million triangles


def write_ply(path, points, triangles):
    rows = np.zeros(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, triangles
    with open(path, "wb") as file:
        file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
                    "property double x\nproperty double y\nproperty double z\n"
                    f"element face {len(triangles)}\nproperty list uchar int vertex_indices\n"
                    "end_header\n").encode())
        file.write(points.astype("<f8").tobytes())
        file.write(rows.tobytes())


def read_ply(path):
    import vtkmodules.vtkIOPLY as ply
    from vtkmodules.util.numpy_support import vtk_to_numpy
    reader = ply.vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    return (vtk_to_numpy(data.GetPoints().GetData()).astype(float),
            vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3))


def sphere(steps, radius=100.0):
    """An octahedron whose faces are cut into steps x steps triangles, blown up."""
    corners = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    points, triangles, first = [], [], 0
    for face in faces:
        i, j = np.nonzero(np.add.outer(np.arange(steps + 1), np.arange(steps + 1)) <= steps)
        number = np.full((steps + 2, steps + 2), -1)
        number[i, j] = np.arange(len(i)) + first
        points.append((steps - i - j)[:, None] * corners[face[0]] + i[:, None] * corners[face[1]]
                      + j[:, None] * corners[face[2]])
        up, down = i + j < steps, i + j < steps - 1
        triangles.append(np.stack([number[i, j], number[i + 1, j], number[i, j + 1]], 1)[up])
        triangles.append(np.stack([number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]],
                                  1)[down])
        first += len(i)
    points, same = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    return (radius * points / np.linalg.norm(points, axis=1)[:, None],
            same.reshape(-1)[np.concatenate(triangles)])


def normals(points, triangles):
    corners = points[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros_like(points)
    for corner in range(3):
        np.add.at(sums, triangles[:, corner], areas)
    return sums / np.linalg.norm(sums, axis=1)[:, None]


def filled_head(path):
    """The outside of the head without canals or hollows, smooth enough to have no handles."""
    import nibabel
    from scipy import ndimage
    image = nibabel.load(HEAD)
    inside = image.get_fdata() > 40
    pieces, _ = ndimage.label(inside)
    inside = pieces == 1 + np.argmax(np.bincount(pieces.ravel())[1:])
    inside = np.pad(ndimage.binary_closing(inside, iterations=4), 2)
    inside = ndimage.binary_fill_holes(inside)
    for axis in (2, 0):
        slices = np.moveaxis(inside, axis, 0)
        for one in slices:
            one[:] = ndimage.binary_fill_holes(one)
    affine = image.affine.copy()
    affine[:3, 3] -= affine[:3, :3] @ [2, 2, 2]
    smooth = ndimage.gaussian_filter(100 * inside.astype(np.float32), 1.0)
    nibabel.save(nibabel.Nifti1Image(smooth, affine), path)


class Maker:
    """\\param programs  the folder with adaptiso-mesh \\param remesher  the program remeshEvenly"""

    def __init__(self, folder, programs, remesher):
        self.folder, self.programs, self.remesher = folder, programs, remesher
        self.random = np.random.default_rng(1)

    def path(self, name):
        file = self.folder / f"{name}.ply"
        if not file.exists():
            getattr(self, name)(file)
        return file

    def marching_cubes(self, image, isovalue, file):
        subprocess.run([self.programs / "adaptiso-mesh", image, "--iso", isovalue, "--method", "mc",
                        "--coordinates", "lps", "-o", file, "--quiet"], check=True)

    def head(self, file):
        self.marching_cubes(HEAD, "100", file)

    def remeshed(self, file):
        filled = self.folder / "filled.nii"
        filled_head(filled)
        dense = self.folder / "filled.ply"
        self.marching_cubes(filled, "50", dense)
        subprocess.run([self.remesher, dense, "--vertices", str(MILLION), "-o", file], check=True,
                       stdout=subprocess.DEVNULL)

    def noisy(self, file):
        points, triangles = read_ply(self.path("remeshed"))
        depth = NOISE_MM * self.random.uniform(-1, 1, (len(points), 1))
        write_ply(file, points + depth * normals(points, triangles), triangles)

    def jittered(self, file):
        points, triangles = read_ply(self.path("head"))
        write_ply(file, points + NOISE_MM * self.random.uniform(-1, 1, points.shape), triangles)

    def sphere(self, file):
        write_ply(file, *sphere(404))
