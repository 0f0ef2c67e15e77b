// What an algorithm counts on one thread, summed over all of them for `--stats`.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "visibility/algorithms.hpp"

namespace sightline {

enum class Combine { sum, maximum };

struct CountName {
    std::string_view name;
    Combine combine = Combine::sum;
};

/// Counters by the enumerators of `Name`, whose names stand in the same order in `kNames`.
template <class Name, const auto& kNames>
class Counts {
public:
    [[nodiscard]] std::uint64_t& operator[](Name name) {
        return values_[static_cast<std::size_t>(name)];
    }

    void reaches(Name name, std::uint64_t value) { (*this)[name] = std::max((*this)[name], value); }

    Counts& operator+=(const Counts& other) {
        for (std::size_t k = 0; k < values_.size(); ++k) {
            if (kNames[k].combine == Combine::sum)
                values_[k] += other.values_[k];
            else
                values_[k] = std::max(values_[k], other.values_[k]);
        }
        return *this;
    }

    void report(const ResolveOptions& options) const {
        for (std::size_t k = 0; k < values_.size(); ++k) count(options, kNames[k].name, values_[k]);
    }

private:
    std::array<std::uint64_t, kNames.size()> values_{};
};

}  // namespace sightline
