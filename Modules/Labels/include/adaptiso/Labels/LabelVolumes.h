#pragma once

#include <vector>

#include "adaptiso/Labels/Labels.h"
#include "adaptiso/Tetrahedra/MesherFiles.h"

namespace adaptiso {

/// The spaces between the walls of a complex, as meshers take them: each piece of a region is a
/// volume of its own, with a point in it; regions are numbered from 1 in the order of `labels`.
/// Walls are told apart by the pieces on their sides. What other labels enclose is no volume.
/// \param labels  regions wanted, ascending, each with all its walls in the complex
/// Cost: O(T log T), and for each cavity of a region of several pieces a look at these
MesherInput labelMesherInput(const LabelComplex& complex, const std::vector<Label>& labels);

}  // namespace adaptiso
