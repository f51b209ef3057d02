#pragma once

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "Common/Resources.h"
#include "Common/Verdict.h"
#include "SelfTestCases.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso::selftest {

/// What the test ran on, as names and values: host, processor, threads, memory, system, libraries.
using Machine = std::vector<std::pair<std::string, std::string>>;
Machine thisMachine();

void printText(std::ostream& out, const SelfTest& test, const Machine& machine,
               const std::string& date, const StageTimer& timer);

std::string jsonText(const SelfTest& test, const Verdict& verdict, const Machine& machine,
                     const std::string& date, const StageTimer& timer);

/// The page; takes the surfaces out of `test`.
Report reportPage(SelfTest& test, const Machine& machine);

}  // namespace adaptiso::selftest
