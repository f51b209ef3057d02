"""Images of balls in voxels of 1 mm, centre off the lattice, for bemSpheres.py and femSpheres.py."""
import nibabel
import numpy as np

CENTRE = np.array([3.3, -7.1, 5.7])  # scanner RAS, off the voxels' lattice
SIZE = 200
AFFINE = np.diag([1.0, 1, 1, 1])
AFFINE[:3, 3] = -99.5


def part_of_ball(radius, points_a_side, centre=CENTRE):
    axis = np.arange(SIZE) - 99.5
    squares = [(axis - c) ** 2 for c in centre]
    distance = np.sqrt(squares[0][:, None, None] + squares[1][:, None] + squares[2])
    part = (distance <= radius).astype(np.float32)
    if points_a_side == 1:
        return part
    near = np.argwhere(np.abs(distance - radius) < 1)
    places = near - 99.5 - centre
    offsets = (np.arange(points_a_side) + 0.5) / points_a_side - 0.5
    count = np.zeros(len(near))
    for offset in np.stack(np.meshgrid(offsets, offsets, offsets), axis=-1).reshape(-1, 3):
        count += np.linalg.norm(places + offset, axis=1) <= radius
    part[tuple(near.T)] = count / points_a_side ** 3
    return part


def save(path, data):
    nibabel.save(nibabel.Nifti1Image(data, AFFINE), path)


def four_spheres(folder, kind, radii, offsets=(0, 0, 0, 0)):
    """Writes an image of brain, CSF, skull and scalp, radii in m: labels, or partial volume. Each sphere's centre lies
    `offsets` (m) below CENTRE. returns adaptiso-bem's arguments"""
    radii = [1000 * r for r in radii]
    centres = [CENTRE - [0, 0, 1000 * o] for o in offsets]
    if kind == "labels":
        labels = sum(part_of_ball(r, 1, c) for r, c in zip(radii, centres)).astype(np.uint8)
        save(folder / "labels.nii.gz", labels)
        tissues = ("brain=4", "csf=3", "skull=2", "scalp=1")
        return ["--labels", folder / "labels.nii.gz", *(w for t in tissues for w in ("--tissue", t))]
    brain, inner, outer, skin = (part_of_ball(r, 10, c) for r, c in zip(radii, centres))
    maps = (0.5 * brain, 0.5 * brain, inner - brain, outer - inner, skin - outer)
    files = [folder / f"c{n + 1}.nii.gz" for n in range(5)]
    for file, values in zip(files, maps):
        save(file, values.astype(np.float32))
    return ["--probabilities", *files]
