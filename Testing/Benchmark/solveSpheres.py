#!/usr/bin/python3
"""EEG potentials of three spheres: MNE's boundary elements against the analytic series.

    solveSpheres.py FOLDER... [--dipoles N] [--eccentricities E,E,...]

FOLDER/bem holds inner_skull.surf, outer_skull.surf and outer_skin.surf (makeSpheres): spheres of
80, 86 and 92 mm around the origin. They go the way a user's go, through mne.make_bem_model and
mne.make_bem_solution. Prints for each folder and eccentricity (distance of the dipoles from the
centre / 80 mm) the mean of
    RDM  |v/|v| - a/|a||   (0: same topography)
    MAG  |v| / |a|         (1: same strength)
over dipoles of random places and directions, v MNE's and a the analytic potentials at 60
electrodes spread over the whole sphere, both against their average. Needs Debian's python3-mne.
"""
import argparse

import mne
import numpy as np

import layeredSphere

RADII = np.array([0.080, 0.086, 0.092])  # m
CONDUCTIVITIES = np.array([0.33, 0.0041, 0.33])  # S/m, from inside out
ELECTRODES = 60


def analytic(places, moments, electrodes):
    """Potentials (V) on the outermost sphere, one row a dipole."""
    return layeredSphere.potentials(layeredSphere.Layers(tuple(RADII), tuple(CONDUCTIVITIES)), places,
                                    moments, electrodes)


def spread_over_sphere(count):
    """Points of the golden spiral."""
    return layeredSphere.spread_over_sphere(count, RADII[-1])


def electrode_info(electrodes):
    names = [f"EEG{n + 1:03d}" for n in range(len(electrodes))]
    info = mne.create_info(names, 1000.0, "eeg")
    r = RADII[-1]
    info.set_montage(mne.channels.make_dig_montage(
        dict(zip(names, electrodes)), nasion=[0, r, 0], lpa=[-r, 0, 0], rpa=[r, 0, 0],
        coord_frame="head"))
    return info


def bem_potentials(places, moments, electrodes, solution):
    sources = mne.setup_volume_source_space(pos=dict(rr=places, nn=moments))
    forward = mne.make_forward_solution(
        electrode_info(electrodes), mne.Transform("head", "mri", np.eye(4)), sources, solution,
        meg=False, mindist=0)
    gains = forward["sol"]["data"].reshape(len(electrodes), len(places), 3)
    return np.einsum("edk,dk->de", gains, moments)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", metavar="FOLDER")
    parser.add_argument("--dipoles", type=int, default=400)
    parser.add_argument("--eccentricities", default="0.3,0.5,0.7,0.8,0.9")
    options = parser.parse_args()
    mne.set_log_level("error")
    random = np.random.RandomState(0)

    def directions():
        vectors = random.randn(options.dipoles, 3)
        return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)

    axes, moments = directions(), directions()
    electrodes = spread_over_sphere(ELECTRODES)
    print(f"{'surfaces':24} {'eccentricity':>12} {'RDM':>7} {'MAG':>7}")
    for folder in options.folders:
        parent, subject = folder.rstrip("/").rpartition("/")[::2]
        model = mne.make_bem_model(subject, ico=None, conductivity=CONDUCTIVITIES,
                                   subjects_dir=parent or ".")
        solution = mne.make_bem_solution(model)
        for eccentricity in map(float, options.eccentricities.split(",")):
            places = eccentricity * RADII[0] * axes
            found = bem_potentials(places, moments, electrodes, solution)
            truth = analytic(places, moments, electrodes)
            found -= found.mean(axis=1, keepdims=True)
            truth -= truth.mean(axis=1, keepdims=True)
            found_norm = np.linalg.norm(found, axis=1, keepdims=True)
            truth_norm = np.linalg.norm(truth, axis=1, keepdims=True)
            rdm = np.linalg.norm(found / found_norm - truth / truth_norm, axis=1).mean()
            print(f"{subject:24} {eccentricity:12g} {rdm:7.4f} "
                  f"{(found_norm / truth_norm).mean():7.4f}", flush=True)


if __name__ == "__main__":
    main()
