#include "scene/plane_index.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>

namespace sightline {

namespace {

// 11 bits for each coordinate of a normal, then the distance.
constexpr int kCellBits = 11, kDistanceBits = 31;
constexpr double kCellsPerUnit = 1 << (kCellBits - 1);
// Of a float's bits, those of the mantissa below the first 16 are dropped.
constexpr std::uint32_t kKept = ~std::uint32_t{0} << 7;

std::uint64_t cell_of(double coordinate) {
    const double cell = std::floor((coordinate + 1) * kCellsPerUnit);
    return static_cast<std::uint64_t>(std::clamp(cell, 0.0, 2 * kCellsPerUnit - 1));
}

// Ascending with the distance.
std::uint64_t rank_of(double distance) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(distance)) & kKept;
    const std::uint32_t rank = (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
    return rank >> 1;
}

double distance_of(std::uint64_t key) {
    const auto rank = static_cast<std::uint32_t>(key << 1);
    const std::uint32_t bits = (rank & 0x80000000u) != 0 ? rank & 0x7FFFFFFFu : ~rank;
    return std::bit_cast<float>(bits & kKept);
}

std::uint64_t key_of(const std::array<std::uint64_t, 3>& cells, std::uint64_t rank) {
    return ((cells[0] << kCellBits | cells[1]) << kCellBits | cells[2]) << kDistanceBits | rank;
}

}  // namespace

void PlaneIndex::add(const glm::dvec3& normal, const glm::dvec3& point, std::uint32_t number) {
    if (!origin_) origin_ = point;
    const glm::dvec3 n = heading(normal) < 0 ? -normal : normal;
    const std::array<std::uint64_t, 3> cells = {cell_of(n.x), cell_of(n.y), cell_of(n.z)};
    records_.push_back({key_of(cells, rank_of(glm::dot(n, point - *origin_))), number, 0});
}

void PlaneIndex::tidy() {
    const auto begin = records_.begin() + static_cast<std::ptrdiff_t>(tidy_until_);
    const auto place = [](const Record& r) { return std::tie(r.key, r.number); };
    tbb::parallel_sort(begin, records_.end(),
                       [&](const Record& a, const Record& b) { return place(a) < place(b); });
    records_.erase(
        std::unique(begin, records_.end(),
                    [&](const Record& a, const Record& b) { return place(a) == place(b); }),
        records_.end());
    tidy_until_ = records_.size();
}

void PlaneIndex::finish() {
    tidy_until_ = 0;
    tidy();
    auto next = static_cast<std::uint32_t>(records_.size());
    for (std::size_t i = records_.size(); i-- > 0;) {
        if (i + 1 < records_.size() && records_[i + 1].number != records_[i].number)
            next = static_cast<std::uint32_t>(i + 1);
        records_[i].next_other = next;
    }
}

// Let delta be the tolerance of normals, r the radius. A corner of a face lies within 2r of the
// origin, so turning its normal by delta changes the distance of its plane by 2r delta, and the
// other plane passes within the tolerance of the corner. Distances are kept to 2^-16 of themselves,
// that is to 2r 2^-16, and rounded twice. A hundredth leaves room for the rounding of all this.
template <class Visit>
bool PlaneIndex::any_range(const SheetScale& scale, const Query& query, const Visit& visit) const {
    const double turn = 1.01 * kNormalTolerance + query.uncertain;
    const double reach = 1.01 * (scale.tolerance + 2 * scale.radius * (kNormalTolerance + 0x1p-15));
    const double side = heading(query.normal);
    for (const double sign : {1.0, -1.0}) {
        if (sign * side < -2 * turn) continue;
        const glm::dvec3 n = sign * query.normal;
        const std::uint64_t low = rank_of(sign * query.distance - reach),
                            high = rank_of(sign * query.distance + reach);
        const auto in_cell = [&](std::uint64_t x, std::uint64_t y, std::uint64_t z) {
            const auto first =
                std::ranges::lower_bound(records_, key_of({x, y, z}, low), {}, &Record::key);
            const auto end = std::ranges::upper_bound(first, records_.end(),
                                                      key_of({x, y, z}, high), {}, &Record::key);
            return first != end && visit(first - records_.begin(), end - records_.begin());
        };
        for (std::uint64_t x = cell_of(n.x - turn); x <= cell_of(n.x + turn); ++x)
            for (std::uint64_t y = cell_of(n.y - turn); y <= cell_of(n.y + turn); ++y)
                for (std::uint64_t z = cell_of(n.z - turn); z <= cell_of(n.z + turn); ++z)
                    if (in_cell(x, y, z)) return true;
    }
    return false;
}

PlaneIndex::Query PlaneIndex::query(const glm::dvec3& normal, const glm::dvec3& point) const {
    return {normal, origin_ ? glm::dot(normal, point - *origin_) : 0};
}

bool PlaneIndex::has_other(const SheetScale& scale, const Query& query,
                           std::uint32_t number) const {
    return any_range(scale, query, [&](std::ptrdiff_t first, std::ptrdiff_t end) {
        const Record& r = records_[static_cast<std::size_t>(first)];
        return r.number != number || static_cast<std::ptrdiff_t>(r.next_other) < end;
    });
}

bool PlaneIndex::has_other(const SheetScale& scale, const glm::dvec3& normal,
                           const glm::dvec3& point, std::uint32_t number) const {
    return has_other(scale, query(normal, point), number);
}

std::vector<bool> PlaneIndex::shared_numbers(const SheetScale& scale, std::uint32_t count) const {
    std::vector<bool> shared(count, false);
    for (const Record& r : records_) {
        if (shared[r.number]) continue;
        const auto coordinate = [&](int place) {
            const std::uint64_t cell = r.key >> (kDistanceBits + place * kCellBits);
            return (static_cast<double>(cell & ((1u << kCellBits) - 1)) + 0.5) / kCellsPerUnit - 1;
        };
        // A normal lies within half a cell of the middle of its cell, a distance within 2^-16 of
        // itself: twice that is counted already.
        const Query plane{
            {coordinate(2), coordinate(1), coordinate(0)}, distance_of(r.key), 0.5 / kCellsPerUnit};
        shared[r.number] = has_other(scale, plane, r.number);
    }
    return shared;
}

void PlaneIndex::find(const SheetScale& scale, const glm::dvec3& normal, const glm::dvec3& point,
                      std::vector<std::uint32_t>& numbers) const {
    numbers.clear();
    any_range(scale, query(normal, point), [&](std::ptrdiff_t first, std::ptrdiff_t end) {
        for (std::ptrdiff_t i = first; i < end; ++i)
            numbers.push_back(records_[static_cast<std::size_t>(i)].number);
        return false;
    });
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace sightline
