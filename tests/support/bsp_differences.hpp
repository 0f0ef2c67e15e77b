// Where the pictures of `bsp` differ from the canonical answer, and whether that is explained.
//
// Let a be the canonical winner of a sample and b that of bsp. In the world b is in front of a, or
// equally deep; on the snapped screen it is the other way round. So what snapping may do to both
// depths bounds their distance. With the true gradients gx, gy of a plane on the screen:
//
//   the screen's grid  half a unit in x, y and z:       1/2 + (|gx| + |gy|) / 2
//                      and for a face of a sheet how far the plane that its sheet shares on the
//                      screen, through three snapped corners, passes by those of the face.
//   the world's term   kWorldTerm steps in the world, as derived in bsp_tree.hpp, and for a face of
//                      a sheet how far it stands off the plane that its sheet shares. Moved by that
//                      much, a point moves by some dx, dy, dz on the screen:
//                                                       dz + |gx| dx + |gy| dy
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "math/predicates.hpp"
#include "support/scenes.hpp"
#include "view/transform.hpp"
#include "visibility/bsp_tree.hpp"

namespace sightline::testing {

struct Differences {
    std::uint64_t samples = 0;
    std::uint64_t differing = 0;    ///< of the samples: all of what follows but `steep`
    std::uint64_t explained = 0;    ///< the depths are as close as they must be
    std::uint64_t grazed = 0;       ///< snapping alone covers the sample, see below
    std::uint64_t unexplained = 0;  ///< none of it, or one of the two does not cover the sample
    std::uint64_t steep = 0;  ///< of those explained: only because a surface is nearly edge-on
    std::string first;        ///< describes the first that is unexplained

    Differences& operator+=(const Differences& other);
};

/// Compares two answers for a screen.
class DifferenceJudge {
public:
    explicit DifferenceJudge(const ScreenScene& screen);

    [[nodiscard]] Differences compare(const Visibility& canonical, const Visibility& bsp) const;

private:
    struct Surface {
        double z = 0, screen = 0, world = 0;
        bool covers = false, surely = false;
    };
    [[nodiscard]] Surface surface_at(std::uint32_t id, std::int32_t x, std::int32_t y) const;
    [[nodiscard]] glm::dvec2 gradient(const bsp::TreePlane& plane) const;
    [[nodiscard]] double deviation(std::uint32_t id, const bsp::TreePlane& plane) const;
    [[nodiscard]] double deviation_on_screen(std::uint32_t k) const;

    const ScreenScene& screen_;
    ScreenTransform transform_;
    bsp::WorldGrid grid_;
    bsp::Surfaces surfaces_;
};

}  // namespace sightline::testing
