#!/usr/bin/python3
"""Four spheres through the whole of adaptiso-bem into tetrahedra, and what these are worth.

    femSpheres.py ADAPTISO-BEM FOLDER [--image labels|partial] [--mesher tetgen|gmsh] [--dipoles N]
                  [--eccentricities E,E,...] [--degree 1|2] [-- OPTION...]

Makes an image of spheres of 78, 80, 86 and 92 mm (brain, CSF, skull, scalp) in voxels of 1 mm, centre off the
lattice: labels, or tissue maps (parts of voxels by counting 10^3 points). adaptiso-bem makes four layers and
tetrahedra of it; what follows `--` are further options of it. Potentials of dipoles at 60 electrodes by finite
elements (DOLFINx) against the analytic series; 0.33, 1.79, 0.01, 0.43 S/m. Prints for each eccentricity
(distance of the dipoles from the centre / 78 mm) the mean of RDM and MAG, as layeredSphere.py has them, over
dipoles of random places and directions.

The dipole's singular potential is taken out (full subtraction [Drechsler2009]): in a medium of the brain's
conductivity it is known, and what is solved for is the rest, whose sources lie where the conductivity changes
and at the skin.

Needs Debian's python3-dolfinx, python3-meshio, python3-nibabel; tetgen or gmsh.
"""
import argparse
import json
import logging
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import ufl
from dolfinx import fem, geometry, mesh
from mpi4py import MPI
from petsc4py import PETSc

import layeredSphere
from layeredSphere import FOUR
from sphereImages import CENTRE, four_spheres

ELECTRODES = 60
FIRST_TISSUE = 2  # of head.msh: brain, CSF, skull, scalp


class Head:
    """Tetrahedra (points in metres), each of a conductivity (S/m)."""

    def __init__(self, points, cells, tissues, degree):
        element = ufl.Mesh(ufl.VectorElement("Lagrange", "tetrahedron", 1))
        self.mesh = mesh.create_mesh(MPI.COMM_SELF, cells.astype(np.int64), points, element)
        order = np.asarray(self.mesh.topology.original_cell_index)
        self.tissues = tissues[order].astype(np.int32)
        constants = fem.FunctionSpace(self.mesh, ("DG", 0))
        self.sigma = fem.Function(constants)
        self.sigma.x.array[:] = np.array(FOUR.conductivities)[self.tissues]
        self.space = fem.FunctionSpace(self.mesh, ("Lagrange", degree))
        u, v = ufl.TrialFunction(self.space), ufl.TestFunction(self.space)
        self.matrix = fem.petsc.assemble_matrix(
            fem.form(self.sigma * ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx))
        self.matrix.assemble()
        self.constant = PETSc.NullSpace().create(constant=True, comm=MPI.COMM_SELF)
        self.matrix.setNullSpace(self.constant)
        self.solver = PETSc.KSP().create(MPI.COMM_SELF)
        self.solver.setOperators(self.matrix)
        self.solver.setType("cg")
        self.solver.getPC().setType("hypre")
        self.solver.setTolerances(rtol=1e-8)
        self._form(v)

    def _form(self, v):
        """The right side, of a place and a moment that are set later."""
        self.place = fem.Constant(self.mesh, PETSc.ScalarType((0, 0, 0)))
        self.moment = fem.Constant(self.mesh, PETSc.ScalarType((0, 0, 0)))
        ray = ufl.SpatialCoordinate(self.mesh) - self.place
        far = ufl.sqrt(ufl.dot(ray, ray))
        brain = FOUR.conductivities[0]
        slope = (self.moment / far ** 3
                 - 3 * ufl.dot(self.moment, ray) / far ** 5 * ray) / (4 * np.pi * brain)
        tags = mesh.meshtags(self.mesh, 3, np.arange(len(self.tissues), dtype=np.int32), self.tissues)
        dx = ufl.Measure("dx", self.mesh, subdomain_data=tags, metadata={"quadrature_degree": 4})
        ds = ufl.Measure("ds", self.mesh, metadata={"quadrature_degree": 4})
        layers = dx(1) + dx(2) + dx(3)  # the brain has no source of the rest
        self.right = fem.form(
            -(self.sigma - brain) * ufl.inner(slope, ufl.grad(v)) * layers
            - brain * ufl.dot(slope, ufl.FacetNormal(self.mesh)) * v * ds)

    def find(self, electrodes):
        """Where the skin lies between the centre and the electrodes."""
        self.mesh.topology.create_connectivity(2, 3)
        tree = geometry.BoundingBoxTree(self.mesh, 3)
        places, cells = [], []
        for electrode in electrodes:
            for share in 1 - np.geomspace(1e-7, 1e-2, 200):  # faces lie within the sphere
                hits = geometry.compute_colliding_cells(
                    self.mesh, geometry.compute_collisions(tree, share * electrode), share * electrode)
                if len(hits) > 0:
                    break
            places.append(share * electrode)
            cells.append(hits[0])
        self.places, self.cells = np.array(places), np.array(cells, np.int32)

    def potentials(self, place, moment):
        self.place.value[:], self.moment.value[:] = place, moment
        right = fem.petsc.assemble_vector(self.right)
        self.constant.remove(right)
        rest = fem.Function(self.space)
        self.solver.solve(right, rest.vector)
        if self.solver.getConvergedReason() <= 0:
            raise RuntimeError("the solver did not converge")
        ray = self.places - place
        endless = ray @ moment / np.linalg.norm(ray, axis=1) ** 3 / (4 * np.pi * FOUR.conductivities[0])
        return endless + rest.eval(self.places, self.cells).ravel()


def read_head(path, degree):
    made = meshio.read(path)
    cells = np.concatenate([c.data for c in made.cells if c.type == "tetra"])
    tissues = np.concatenate([data for data, c in zip(made.cell_data["gmsh:physical"], made.cells)
                              if c.type == "tetra"]) - FIRST_TISSUE
    return Head((made.points - CENTRE) / 1000, cells, tissues, degree)


def describe(report):
    tetrahedra = report["tetrahedra"]
    count = sum(layer["tetrahedra"] for layer in tetrahedra["layers"])
    print(f"vertices {[s['vertices'] for s in report['surfaces']]}; {tetrahedra['points']} points, {count} "
          f"tetrahedra {[layer['tetrahedra'] for layer in tetrahedra['layers']]}", flush=True)


def main():
    arguments, further = sys.argv[1:], []
    if "--" in arguments:
        at = arguments.index("--")
        arguments, further = arguments[:at], arguments[at + 1:]
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--image", choices=("labels", "partial"), default="labels")
    parser.add_argument("--mesher", choices=("tetgen", "gmsh"), default="tetgen")
    parser.add_argument("--dipoles", type=int, default=40)
    parser.add_argument("--eccentricities", default="0.5,0.9,0.95")
    parser.add_argument("--degree", type=int, default=1)
    options = parser.parse_args(arguments)
    logging.getLogger().setLevel(logging.WARNING)  # the compiler of forms tells every step
    options.folder.mkdir(parents=True, exist_ok=True)
    model = options.folder / "model"
    subprocess.run([options.program, *four_spheres(options.folder, options.image, FOUR.radii), "--layers", "4", "--tetrahedra",
                    options.mesher, "-o", model, "--force", "--quiet", *further], check=True)
    describe(json.loads((model / "report.json").read_text()))
    head = read_head(model / "head.msh", options.degree)
    electrodes = layeredSphere.spread_over_sphere(ELECTRODES, FOUR.radii[-1])
    head.find(electrodes)
    for eccentricity in map(float, options.eccentricities.split(",")):
        random = np.random.RandomState(7)
        places = eccentricity * FOUR.radii[0] * layeredSphere.random_directions(options.dipoles, random)
        moments = layeredSphere.random_directions(options.dipoles, random)
        truth = layeredSphere.potentials(FOUR, places, moments, electrodes)
        found = np.array([head.potentials(p, q) for p, q in zip(places, moments)])
        rdm, mag = layeredSphere.rdm_and_mag(found, truth)
        print(f"{eccentricity:5}: RDM mean {rdm.mean():.4f} largest {rdm.max():.4f}; MAG mean {mag.mean():.4f} "
              f"from {mag.min():.4f} to {mag.max():.4f}", flush=True)


if __name__ == "__main__":
    main()
