#pragma once

#include <cstdint>
#include <vector>

#include "adaptive/mesh/Patch.h"

namespace adaptiso::detail {

/// Which edges of a surface need not be tried again: those between two vertices that are Tried. A
/// vertex is, as long as nothing around it has changed since all its edges were tried.
///
/// A patch begins by begin(); whoever changes a star opens its ring; edges that another cut may
/// allow are passed on, and finish() opens their ends. Where the allowed distance grows openAll()
/// lets all that was refused for it be tried again. States that are Final stay so.
class TriedEdges {
public:
    using States = std::vector<Patch::State>;

    /// Keeps a reference to the states. \param cost  up to which the edges were tried
    TriedEdges(States& states, double cost) : states_(states), cost_(cost) {}

    bool has(std::uint32_t a, std::uint32_t b, double cost) const {
        return cost <= cost_ && states_[a] == Patch::State::Tried &&
               states_[b] == Patch::State::Tried;
    }
    /// All edges of the vertex will be tried, unless they are passed on.
    void begin(std::uint32_t v) {
        if (states_[v] == Patch::State::Open) states_[v] = Patch::State::Tried;
    }
    void open(std::uint32_t v) {
        if (states_[v] != Patch::State::Final) states_[v] = Patch::State::Open;
    }
    void passOn(std::uint32_t a, std::uint32_t b) { passedOn_.insert(passedOn_.end(), {a, b}); }
    void finish() {
        for (const std::uint32_t v : passedOn_) reopen(states_[v]);
        passedOn_.clear();
    }
    static void openAll(States& states) {
        for (Patch::State& state : states) reopen(state);
    }

private:
    static void reopen(Patch::State& state) {
        if (state == Patch::State::Tried) state = Patch::State::Open;
    }

    States& states_;
    double cost_;
    std::vector<std::uint32_t> passedOn_;
};

}  // namespace adaptiso::detail
