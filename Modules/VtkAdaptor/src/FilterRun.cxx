#include "FilterRun.h"

#include <vtkVersionMacros.h>

#include <algorithm>
#include <exception>

#include "adaptiso/Core/Progress.h"

namespace adaptiso::vtk {
namespace {

struct Aborted {};

}  // namespace

void FilterRun::endIfAborted() const {
    if (filter_.GetAbortExecute() != 0) throw Aborted();
}

ProgressCallback FilterRun::progress(int part, int parts) {
    return [this, part, parts](std::string_view stage, double fraction) {
        filter_.SetProgressText(std::string(stage).c_str());
        // a stage after the first starts at 0 again; progress never goes back
        filter_.UpdateProgress(std::max(filter_.GetProgress(), (part + fraction) / parts));
        endIfAborted();
    };
}

std::string FilterRun::run(const std::function<void()>& work) {
    const std::function<void()> look = [this] { endIfAborted(); };
    try {
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 3, 0)
        if (filter_.GetAbortOutput()) throw Aborted();  // its input was
#endif
        const InterruptionCheck check(look);
        work();
    } catch (const Aborted&) {
        isAborted_ = true;
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 3, 0)
        filter_.SetAbortOutput(true);  // filters downstream are told by it
#endif
    } catch (const std::exception& error) {
        return error.what();
    }
    return {};
}

}  // namespace adaptiso::vtk
