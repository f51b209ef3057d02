#include "RunBenchmark.h"

#include <exception>
#include <iostream>

#include "Common/RunApp.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"

namespace adaptiso::benchmarks {
namespace {

int fail(const CLI::App& app, const std::exception& error, ExitCode code) {
    std::cerr << app.get_name() << ": " << error.what() << '\n';
    return code;
}

}  // namespace

int runBenchmark(CLI::App& app, int argc, const char* const* argv,
                 const std::function<void()>& work) {
    keepFreedMemory();  // as the programs do; for the peers as well
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kExitOk : kExitUsage;
    }
    try {
        work();
    } catch (const InternalError& error) {
        return fail(app, error, kExitInternalError);
    } catch (const Error& error) {
        return fail(app, error, kExitBadInput);
    } catch (const std::exception& error) {
        return fail(app, error, kExitInternalError);
    }
    return kExitOk;
}

}  // namespace adaptiso::benchmarks
