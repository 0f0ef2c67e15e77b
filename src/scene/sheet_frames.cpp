// The numbers, members, frames and balls of sheets, once it is known which triangle is in which.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <span>
#include <tuple>
#include <utility>

#include "scene/sheets.hpp"

namespace sightline {

namespace {

class SheetFramer {
public:
    explicit SheetFramer(Scene& scene) : scene_(scene), sheets_(scene.sheets) {}

    void run() {
        number_in_order();
        const std::size_t count = sheets_.first.size() - 1;
        if (count == 0) {
            sheets_ = {};
            return;
        }
        sheets_.frame.resize(count);
        sheets_.ball.resize(count);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t s) { frame_sheet(s); });
    }

private:
    void number_in_order() {
        std::uint32_t numbers = 0;
        for (const std::uint32_t s : sheets_.of_triangle)
            if (s != kNone) numbers = std::max(numbers, s + 1);
        std::vector<std::uint32_t> number(numbers, kNone);
        std::vector<std::uint32_t> first;  // counts, to begin with
        for (std::uint32_t& s : sheets_.of_triangle) {
            if (s == kNone) continue;
            if (number[s] == kNone) {
                number[s] = static_cast<std::uint32_t>(first.size());
                first.push_back(0);
            }
            s = number[s];
            ++first[s];
        }
        std::uint32_t end = 0;
        for (std::uint32_t& f : first) f = std::exchange(end, end + f);
        std::vector<std::uint32_t> next = first;  // where a sheet's next member goes
        first.push_back(end);
        sheets_.members.resize(end);
        for (std::uint32_t t = 0; t < sheets_.of_triangle.size(); ++t)
            if (const std::uint32_t s = sheets_.of_triangle[t]; s != kNone)
                sheets_.members[next[s]++] = t;
        sheets_.first = std::move(first);
    }

    // The corner of a sheet with the greatest measure; among equals the lexicographically smallest.
    template <class Measure>
    [[nodiscard]] std::uint32_t farthest(std::span<const std::uint32_t> members,
                                         const Measure& measure) const {
        std::uint32_t best = scene_.triangles[members[0]].x;
        double best_measure = measure(scene_.positions[best]);
        for (const std::uint32_t t : members) {
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t i = scene_.triangles[t][k];
                const glm::dvec3 &p = scene_.positions[i], &b = scene_.positions[best];
                const double m = measure(p);
                if (m > best_measure ||
                    (m == best_measure && std::tie(p.x, p.y, p.z) < std::tie(b.x, b.y, b.z))) {
                    best = i;
                    best_measure = m;
                }
            }
        }
        return best;
    }

    void frame_sheet(std::size_t s) {
        const std::span<const std::uint32_t> members(sheets_.members.data() + sheets_.first[s],
                                                     sheets_.first[s + 1] - sheets_.first[s]);
        const auto at = [&](std::uint32_t i) { return scene_.positions[i]; };
        const auto squared = [](const glm::dvec3& v) { return glm::dot(v, v); };
        const glm::dvec3 start = at(farthest(members, [](const glm::dvec3&) { return 0.0; }));
        const auto p = farthest(members, [&](const glm::dvec3& v) { return squared(v - start); });
        const auto q = farthest(members, [&](const glm::dvec3& v) { return squared(v - at(p)); });
        const glm::dvec3 along = at(q) - at(p);
        const auto r = farthest(
            members, [&](const glm::dvec3& v) { return squared(glm::cross(along, v - at(p))); });
        sheets_.frame[s] = Corners(p, q, r);
        const glm::dvec3 middle = 0.5 * (at(p) + at(q));
        const auto rim =
            farthest(members, [&](const glm::dvec3& v) { return squared(v - middle); });
        sheets_.ball[s] = glm::dvec4(middle, glm::length(at(rim) - middle));
    }

    Scene& scene_;
    Sheets& sheets_;
};

}  // namespace

void frame_sheets(Scene& scene) { SheetFramer(scene).run(); }

}  // namespace sightline
