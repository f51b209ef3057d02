#pragma once

#include <vector>

#include "CompareRun.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso::compare {

/// What --report and --pictures show, besides what the run tells; LPS mm.
struct ShownSurfaces {
    TriangleMesh a, b;
    std::vector<double> aToBMm, bToAMm;  ///< of the vertices; the second empty with --one-sided
};

/// The report of a run, which must outlive it; the surfaces are moved out of `shown`.
Report makeReport(const CompareRun& run, ShownSurfaces& shown);

}  // namespace adaptiso::compare
