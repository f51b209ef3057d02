#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::selftest {

/// One thing with a known answer, and what came out.
struct Measurement {
    std::string subject;   ///< "torus, adaptive"
    std::string quantity;  ///< "volume"
    std::string unit;      ///< "mm3"; empty for counts
    double expected = 0;
    double tolerance = 0;  ///< 0 for counts
    double measured = 0;
    int digits = 0;        ///< decimals to show
    std::string error{};   ///< what kept it from being measured; empty: nothing
    bool isYesNo = false;  ///< 1 is yes, 0 is no

    /// Never of what is not a number.
    bool hasPassed() const { return error.empty() && std::abs(measured - expected) <= tolerance; }
};

/// What was measured, and surfaces to look at.
struct SelfTest {
    std::vector<Measurement> measurements;
    struct Shown {
        std::string name;
        TriangleMesh mesh;  ///< LPS mm
    };
    std::vector<Shown> shown;

    bool hasPassed() const;
    std::size_t failures() const;
};

/// Makes every phantom, takes it through image file, index, extraction, mesh file and checks as the
/// programs do, and measures. What goes wrong on the way is a measurement that failed, not an
/// exception. Files are in a folder of the system's temporary files that goes at the end.
///
/// Solids (ball, torus, nested spheres, two bearing balls), each with the methods adaptive and mc;
/// the same surface by one thread and by all; each mesh format written and read back; the distance
/// between two surfaces; a defect for every check; files that have to be refused.
/// \param progress  told the name of what comes next
/// \throws FileError  there is nowhere to write
/// Cost: about 3 s on two cores, 200 MB.
SelfTest runSelfTestCases(const std::function<void(const std::string&)>& progress);

}  // namespace adaptiso::selftest
