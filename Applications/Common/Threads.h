#pragma once

namespace adaptiso {

/// How many of `wanted` threads can be started beside this one, right now: a limit of processes
/// (ulimit -u, a container's) or of memory may leave fewer. Starts them and waits for their ends.
int startableThreads(int wanted);

}  // namespace adaptiso
