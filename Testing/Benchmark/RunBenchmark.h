#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace adaptiso::benchmarks {

/// The rest of a benchmark's main(): reads the command line and works. What is thrown becomes one
/// line on stderr ("name: what is wrong").
///
/// \param app  with the program's name and options, bound to what `work` sees
/// \return     an exit code, as the programs of Applications/ exit (Common/RunApp.h)
int runBenchmark(CLI::App& app, int argc, const char* const* argv,
                 const std::function<void()>& work);

}  // namespace adaptiso::benchmarks
