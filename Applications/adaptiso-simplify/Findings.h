#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::simplifier {

/// A kind of places where a surface is not sound.
struct Finding {
    std::string_view key;         ///< of the report: "borderEdges"
    std::string what;             ///< for people: "open border edge"
    std::int64_t count = 0;       ///< > 0
    std::optional<Vec3> placeMm;  ///< of the first of them, as the file has it
    bool isDropped = false;       ///< else kept as it is
    bool isFault = true;          ///< the surface is not sound for it

    /// "3 triangles without area, dropped; the first at 1, 2, 3"
    std::string text() const;
};

bool isSound(const std::vector<Finding>& findings);

/// What of a surface's topology is not sound.
std::vector<Finding> findTopologyFaults(const TopologyReport& topology);

/// Triangles that cross others. \param triangles  their numbers
std::optional<Finding> crossingFinding(const TriangleMesh& mesh,
                                       const std::vector<std::int64_t>& triangles);

/// Numbers of the triangles that cross others, ascending, found by MeshQuality.
std::vector<std::int64_t> findCrossing(const TriangleMesh& mesh);

}  // namespace adaptiso::simplifier
