// Dividing entangled polygons by the planes of some of them.
//
// Source: H. Fuchs, Z. Kedem, B. Naylor, "On Visible Surface Generation by A Priori Tree
// Structures", 1980: what lies behind a plane is painted, then what lies in it, then what lies in
// front of it. How this version differs: it is depth sort's split by the other's plane, made for a
// whole set at once, in the view and with its exact pieces; no tree is kept. Polygons on different
// sides of a plane never meet again, which is what splitting pair by pair can't offer where
// hundreds of polygons cross each other.
#include "visibility/depth_partition.hpp"

#include <algorithm>
#include <utility>

namespace sightline {

namespace {

using State = SortPieces::State;

/// How a plane divides a set, judged by some of its members.
struct Division {
    std::size_t cut = 0, behind = 0, in_front = 0;

    // A split adds a piece to all further work; a bad balance adds a level.
    [[nodiscard]] std::size_t cost() const {
        return 4 * cut + (behind > in_front ? behind - in_front : in_front - behind);
    }
};

Division judge(SortPieces& pieces, const std::vector<std::uint32_t>& set, std::uint32_t cutter) {
    constexpr std::size_t kJudges = 64;
    const std::size_t step = std::max<std::size_t>(1, set.size() / kJudges);
    Division division;
    for (std::size_t k = 0; k < set.size(); k += step) {
        if (pieces.node(set[k]).face == cutter) continue;
        const PlaneSides sides = pieces.sides_of_plane(set[k], cutter);
        division.cut += sides.behind && sides.in_front;
        division.behind += sides.behind && !sides.in_front;
        division.in_front += sides.in_front && !sides.behind;
    }
    return division;
}

std::uint32_t choose_plane(SortPieces& pieces, const std::vector<std::uint32_t>& set) {
    constexpr std::size_t kCandidates = 8;
    const std::size_t step = std::max<std::size_t>(1, set.size() / kCandidates);
    std::uint32_t best = pieces.node(set[0]).face;
    std::size_t least = SIZE_MAX;
    for (std::size_t k = step / 2; k < set.size(); k += step) {
        const std::uint32_t face = pieces.node(set[k]).face;
        const std::size_t cost = judge(pieces, set, face).cost();
        if (cost < least) {
            least = cost;
            best = face;
        }
    }
    return best;
}

/// A set to be ordered, or, when it lies in one plane, painted by id.
struct Task {
    std::vector<std::uint32_t> set;
    bool in_one_plane = false;
};

/// Puts the parts of a set on the stack, so that the one behind the plane comes off first.
void divide(SortPieces& pieces, const std::vector<std::uint32_t>& set, std::vector<Task>& stack) {
    ++pieces.counts[SortCount::partitions];
    const std::uint32_t cutter = choose_plane(pieces, set);
    Task behind, in_plane{{}, true}, in_front;
    for (const std::uint32_t n : set) {
        const PlaneSides sides =
            pieces.node(n).face == cutter ? PlaneSides{} : pieces.sides_of_plane(n, cutter);
        if (sides.behind && sides.in_front) {
            pieces.split(n, cutter);
            const std::uint32_t child = pieces.node(n).place;
            if (pieces.node(child).state == State::waiting) behind.set.push_back(child);
            if (pieces.node(child + 1).state == State::waiting) in_front.set.push_back(child + 1);
        } else {
            Task& part = sides.behind ? behind : sides.in_front ? in_front : in_plane;
            part.set.push_back(n);
        }
    }
    for (Task* task : {&in_front, &in_plane, &behind})
        if (!task->set.empty()) stack.push_back(std::move(*task));
}

void paint_in_plane(SortPieces& pieces, std::vector<std::uint32_t> set) {
    std::ranges::sort(set, [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(pieces.face_of(a).id, a) > std::pair(pieces.face_of(b).id, b);
    });
    for (const std::uint32_t n : set) pieces.paint(n);
}

}  // namespace

void paint_by_partition(SortPieces& pieces, std::vector<std::uint32_t> waiting) {
    std::vector<Task> stack;
    stack.push_back({std::move(waiting), false});
    while (!stack.empty()) {
        Task task = std::move(stack.back());
        stack.pop_back();
        if (task.in_one_plane || task.set.size() == 1)
            paint_in_plane(pieces, std::move(task.set));
        else if (!task.set.empty())
            divide(pieces, task.set, stack);
    }
}

}  // namespace sightline
