// Ordered pieces as outlines. Clipping a convex polygon by half-planes: I. Sutherland, G. Hodgman,
// "Reentrant Polygon Clipping", 1974.
#include "sightline/order.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "math/predicates.hpp"
#include "visibility/piece_order.hpp"

namespace sightline {

namespace {

/// Keeps what lies on the positive side of a line.
void clip(std::vector<glm::dvec2>& polygon, glm::dvec3 line, std::vector<glm::dvec2>& scratch) {
    const auto height = [line](glm::dvec2 p) { return line.x * p.x + (line.y * p.y + line.z); };
    scratch.clear();
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const glm::dvec2 a = polygon[k], b = polygon[k + 1 == polygon.size() ? 0 : k + 1];
        const double ha = height(a), hb = height(b);
        if (ha >= 0) scratch.push_back(a);
        if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0))
            scratch.push_back(a + (b - a) * (ha / (ha - hb)));
    }
    polygon.swap(scratch);
}

/// Makes the outlines of pieces, one after the other.
class Outliner {
public:
    Outliner(const ScreenScene& screen, const PieceOrder& order)
        : screen_(screen),
          order_(order),
          pixels_per_unit_(1.0 / static_cast<double>(1 << screen.subpixel_bits())) {}

    /// Whether there is anything of it.
    bool take(const Piece& piece) {
        const Corners c = screen_.corners(piece.triangle);
        const OrientedTriangle t(screen_.point(c.x), screen_.point(c.y), screen_.point(c.z));
        if (t.area2 == 0) return false;
        polygon_.clear();
        for (const ScreenPoint& p : {t.p, t.q, t.r}) polygon_.emplace_back(p.x, p.y);
        for (std::uint32_t k = piece.first_cut; k < piece.end_cut; ++k)
            clip(polygon_, order_.lines[k], scratch_);
        for (glm::dvec2& corner : polygon_) corner *= pixels_per_unit_;
        return polygon_.size() >= 3;
    }

    [[nodiscard]] OrderedPiece piece(const Piece& of) const {
        return {screen_.id(of.triangle), of.first_cut == of.end_cut, polygon_};
    }

private:
    const ScreenScene& screen_;
    const PieceOrder& order_;
    double pixels_per_unit_;
    std::vector<glm::dvec2> polygon_, scratch_;
};

Result<PieceOrder> order_of(const Algorithm& algorithm, const ScreenScene& screen,
                            const ResolveOptions& options) {
    if (algorithm.order == nullptr)
        return Error{ErrorKind::bad_option,
                     std::string(algorithm.name) + " does not put surfaces into an order"};
    if (!screen.quadrics().rays.empty())
        return Error{ErrorKind::bad_option, std::string(algorithm.name) +
                                                " takes triangles only: tessellate the quadrics"};
    return algorithm.order(screen, options);
}

void visit_all(const ScreenScene& screen, const PieceOrder& order, const PieceVisitor& visit) {
    Outliner outliner(screen, order);
    for (const Piece& piece : order.pieces)
        if (outliner.take(piece) && !visit(outliner.piece(piece))) return;
}

}  // namespace

Status for_each_back_to_front(const Algorithm& algorithm, const ScreenScene& screen,
                              const ResolveOptions& options, const PieceVisitor& visit) {
    const Result<PieceOrder> order = order_of(algorithm, screen, options);
    if (!order) return order.error();
    visit_all(screen, *order, visit);
    return success();
}

Status for_each_front_to_back(const Algorithm& algorithm, const ScreenScene& screen,
                              const ResolveOptions& options, const PieceVisitor& visit) {
    Result<PieceOrder> order = order_of(algorithm, screen, options);
    if (!order) return order.error();
    std::ranges::reverse(order->pieces);
    visit_all(screen, *order, visit);
    return success();
}

}  // namespace sightline
