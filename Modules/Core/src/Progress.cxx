#include "adaptiso/Core/Progress.h"

#include <chrono>

namespace adaptiso {

namespace {

constexpr double kEverySeconds = 0.1;

thread_local InterruptionCheck* current = nullptr;

double now() {
    using Clock = std::chrono::steady_clock;
    return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

}  // namespace

InterruptionCheck::InterruptionCheck(const std::function<void()>& check)
    : check_(check), outer_(current), lastSeconds_(now()) {
    current = this;
}

InterruptionCheck::~InterruptionCheck() {
    current = outer_;
}

void InterruptionCheck::ask() {
    InterruptionCheck* const mine = current;
    if (mine == nullptr) return;
    const double time = now();
    if (time - mine->lastSeconds_ < kEverySeconds) return;
    mine->lastSeconds_ = time;
    mine->check_();
}

}  // namespace adaptiso
