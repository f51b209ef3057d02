#pragma once

#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso {

/// A ready surface that changes by more is warned of, where it is mended or made anew: voxels,
/// smoothing and triangles take less.
inline constexpr double kMostChangeMm = 2;

/// The dense surface of every solid, by marching cubes (stage "extract"). Adds the boundaries'
/// notes and warnings to the model's, and an entry for every surface to its surfaces.
/// \return LPS mm, inside out
std::vector<TriangleMesh> extractSurfaces(const HeadBoundaries& boundaries, BemModel& model,
                                          const BemHooks& hooks);

/// Mends of ready surfaces what needs it (stages "check", and "boundaries", "extract"):
///   what adaptiso-check finds no fault with (but for the gaps) stays as it came;
///   a closed ball with vertices, triangles or small pieces of no use loses them; one with needles
///   or flat triangles is to be remeshed; one that is open, crosses itself or has loose pieces is
///   mended by mend(); where that leaves a handle, all are made anew from the solids that they
///   bound.
/// Fills the model's surfaces and notes; sizes that are no head's become findings.
/// \param surfaces  LPS mm, inside out; may be broken in any way
/// \return  as they came when the model got findings
/// \throws InvalidInput  a surface without a triangle or without volume
std::vector<TriangleMesh> mendSurfaces(std::vector<TriangleMesh> surfaces, BemModel& model,
                                       const BemHooks& hooks);

/// Takes dense or mended surfaces to a model that keeps its promises, or to findings that say why
/// there is none: near-equilateral triangles, as many as asked for (stage "remesh"), nested with
/// the gaps asked for ("nest"), checked by adaptiso-check's own code ("check"). Fills the model's
/// meshes, surfaces, gaps, checks, plausibility and findings, and warns of too many vertices.
/// The same input gives the same bytes, whatever the number of threads.
/// \throws InvalidInput  edge lengths that ask for more than 200,000 vertices of a surface
void finishBemModel(std::vector<TriangleMesh> dense, BemModel& model, const BemHooks& hooks);

}  // namespace adaptiso
