// The vector instruction sets of this machine, one after the other.
#pragma once

#include <hwy/highway.h>

#include <cstdint>
#include <vector>

namespace sightline::testing {

/// Those that the library is compiled for and this machine runs, the widest first. Bits of Highway;
/// hwy::TargetName() has their names.
inline std::vector<std::int64_t> vector_targets() {
    std::vector<std::int64_t> targets;
    for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1)
        targets.push_back(rest & -rest);
    return targets;
}

/// While it lives, the whole process computes with one of them; afterwards with the widest again.
class ForcedTarget {
public:
    explicit ForcedTarget(std::int64_t target) { choose(target); }
    ~ForcedTarget() { choose(0); }
    ForcedTarget(const ForcedTarget&) = delete;
    ForcedTarget& operator=(const ForcedTarget&) = delete;

private:
    static void choose(std::int64_t targets) {
        hwy::SetSupportedTargetsForTest(targets);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    }
};

}  // namespace sightline::testing
