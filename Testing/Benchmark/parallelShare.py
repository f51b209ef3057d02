#!/usr/bin/python3
"""parallelShare.py <TRACE   what `perf script -F ip,sym` wrote of a run with one thread: which part of the processor time lay in
Core's parallel loops, which did not and where, and what that makes of more threads; threads.sh calls it."""
import collections
import re
import sys

LOOP = re.compile(r"detail::run(Pieces|LargestFirst)\b")
PAIR = re.compile(r"detail::runBoth\b")
TAKE = re.compile(r"concrete_filter<std::shared_ptr<void>, void")  # the part of parallelInOrder that is in order
MAKE = re.compile(r"detail::runInOrder\b")
KINDS = {
    "serial": "serial",
    "pairs": "two or three parts at a time",
    "taken": "in order, beside what is made in parallel",
    "made": "in parallel, what is taken in order",
    "pieces": "in parallel",
}


def kindOf(stack):
    pairs = sum(bool(re.search(r"function_invoker<.*runBoth", frame)) for frame in stack)
    if any(map(TAKE.search, stack)):
        return "taken"
    if any(map(LOOP.search, stack)) or pairs > 1:
        return "pieces"
    if any(map(MAKE.search, stack)):
        return "made"
    return "pairs" if any(map(PAIR.search, stack)) else "serial"


def nameOf(frame):
    plain = frame.replace("(anonymous namespace)::", "").replace("adaptiso::", "").replace("detail::", "")
    return re.sub(r"\(.*", "", re.sub(r"<.*>", "<>", plain))


def serialPlaces(stacks):
    """Of serial samples, by the three functions below those that most samples have in common."""
    seen = collections.Counter(name for stack in stacks for name in {nameOf(frame) for frame in stack})
    places = collections.Counter()
    for stack in stacks:
        if kindOf(stack) == "serial":
            own = [name for name in map(nameOf, stack) if name != "[unknown]" and seen[name] < len(stacks) / 2]
            places[" < ".join(own[-3:])] += 1
    return places


def main():
    samples = sys.stdin.read().split("\n\n")
    stacks = [[line.strip().partition(" ")[2] for line in sample.strip().splitlines()] for sample in samples]
    stacks = [stack for stack in stacks if stack]
    total = len(stacks)
    if total == 0:
        sys.exit("parallelShare.py: no samples")
    shares = collections.Counter(map(kindOf, stacks))
    part = {kind: shares[kind] / total for kind in KINDS}
    print(f"\n{total} samples of one thread, % of processor time")
    for kind, text in KINDS.items():
        print(f"  {100 * part[kind]:5.1f}  {text}")
    print("serial:")
    for place, count in serialPlaces(stacks).most_common(16):
        print(f"  {100 * count / total:5.1f}  {place}")
    print("times faster, were all parts of a kind even:")
    for threads in (2, 4, 8, 16):
        made = max(part["taken"], (part["made"] + part["taken"]) / threads)
        time = part["serial"] + part["pairs"] / 2 + made + part["pieces"] / threads
        print(f"  {threads:2d} threads  {1 / time:.2f}")


if __name__ == "__main__":
    main()
