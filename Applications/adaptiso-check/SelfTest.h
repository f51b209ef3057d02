#pragma once

#include <cmath>
#include <functional>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "Common/ProgramRun.h"
#include "Pipeline.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso::checker {

/// Runs phantoms with known answers through the whole chain and prints, for each quantity, what was
/// expected, measured and allowed, with machine, version, date and a line to sign. --json and
/// --report hold the same.
/// \return kExitOk, or kExitCheckFailed when an answer is wrong
/// \throws FileError  nothing can be written
int runSelfTest(const CheckOptions& options);

namespace selftest {

/// One thing with a known answer, and what came out.
struct Measurement {
    std::string subject;   ///< "torus, adaptive"
    std::string quantity;  ///< "volume"
    std::string unit;      ///< "mm3"; empty for counts
    double expected = 0;
    double tolerance = 0;  ///< 0 for counts
    double measured = 0;
    int digits = 0;        ///< decimals to show
    std::string error{};   ///< why it could not be measured; else empty
    bool isYesNo = false;  ///< 1 is yes, 0 is no

    /// Never of what is not a number.
    bool hasPassed() const { return error.empty() && std::abs(measured - expected) <= tolerance; }
};

/// All measurements, and surfaces for the page.
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
/// programs do, and measures. An error on the way becomes a failed measurement, not an
/// exception. Files are in a folder of the system's temporary files that goes at the end.
///
/// Solids (ball, torus, nested spheres, two bearing balls), each with the methods adaptive and mc;
/// the same surface by one thread and by all; each mesh format written and read back; the distance
/// between two surfaces; a defect for every check; files that have to be refused.
/// \param progress  called with the name of the next case
/// \throws FileError  there is nowhere to write
/// Cost: about 3 s on two cores, 200 MB.
SelfTest runSelfTestCases(const std::function<void(const std::string&)>& progress);

/// The machine, as names and values: host, processor, threads, memory, system, libraries.
using Machine = std::vector<std::pair<std::string, std::string>>;
Machine thisMachine();

void printText(std::ostream& out, const SelfTest& test, const Machine& machine,
               const std::string& date, const StageTimer& timer);

std::string jsonText(const SelfTest& test, const Verdict& verdict, const Machine& machine,
                     const std::string& date, const StageTimer& timer);

/// The page; takes the surfaces out of `test`.
Report reportPage(SelfTest& test, const Machine& machine);

}  // namespace selftest
}  // namespace adaptiso::checker
