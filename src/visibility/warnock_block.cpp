// The nearest of a list of triangles at each sample of a block, as many columns at a time as a
// vector holds doubles.
#include "visibility/warnock_block.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/warnock_block.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first.
#include <hwy/highway.h>

#include <bit>

HWY_BEFORE_NAMESPACE();
namespace sightline::warnock::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, 8>;
using Longs = hn::Rebind<std::int64_t, Doubles>;
using Ints = hn::Rebind<std::int32_t, Doubles>;
using VI = hn::Vec<Ints>;
using VD = hn::Vec<Doubles>;

constexpr Doubles kD;
constexpr Longs kL;
constexpr Ints kI;
static_assert(kBlockSide % 8 == 0);  // vectors are aligned to the columns of a row

HWY_INLINE void note_doubts(hn::Mask<Doubles> doubtful, std::size_t at, Doubts& doubts) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(kD, doubtful, bits);
    for (unsigned rest = bits[0]; rest != 0; rest &= rest - 1)
        doubts.at[doubts.count++] =
            static_cast<std::uint8_t>(at + static_cast<std::size_t>(std::countr_zero(rest)));
}

// One vector of columns, all rows.
HWY_INLINE std::size_t offer_columns(const Newcomer& n, std::int32_t column, Block& block,
                                     Doubts& doubts) {
    const VI columns = hn::Iota(kI, column);
    const VI outside = hn::Or(hn::Sub(columns, hn::Set(kI, n.column0)),
                              hn::Sub(hn::Set(kI, n.column1), columns));  // negative there
    const VI steps = hn::Sub(columns, hn::Set(kI, n.column0));
    VI edge[3];
    for (int k = 0; k < 3; ++k)
        edge[k] = hn::Add(hn::Set(kI, n.edge[k]), hn::Mul(steps, hn::Set(kI, n.per_column[k])));
    const VD tx = hn::Mul(hn::Set(kD, n.gx), hn::Iota(kD, static_cast<double>(n.i + column)));
    const VD slack = hn::Set(kD, n.slack);
    std::size_t covered_samples = 0;
    for (std::int32_t row = n.row0; row <= n.row1; ++row) {
        const VI sign = hn::Or(hn::Or(edge[0], edge[1]), hn::Or(edge[2], outside));
        for (int k = 0; k < 3; ++k) edge[k] = hn::Add(edge[k], hn::Set(kI, n.per_row[k]));
        const auto covered =
            hn::RebindMask(kD, hn::Gt(hn::PromoteTo(kL, sign), hn::Set(kL, std::int64_t{-1})));
        const auto at =
            static_cast<std::size_t>(row) * kBlockSide + static_cast<std::size_t>(column);
        const VD old = hn::Load(kD, block.depth + at);
        const VD z = hn::Add(hn::Set(kD, n.z0 + n.gy * (n.j + row)), tx);
        const auto nearer = hn::And(covered, hn::Lt(z, hn::Sub(old, slack)));
        const auto doubtful = hn::AndNot(nearer, hn::And(covered, hn::Le(z, hn::Add(old, slack))));
        covered_samples += hn::CountTrue(kD, covered);
        if (HWY_UNLIKELY(!hn::AllFalse(kD, doubtful))) note_doubts(doubtful, at, doubts);
        hn::Store(hn::IfThenElse(nearer, z, old), kD, block.depth + at);
        hn::Store(hn::IfThenElse(hn::RebindMask(kL, nearer), hn::Set(kL, n.owner),
                                 hn::Load(kL, block.owner + at)),
                  kL, block.owner + at);
    }
    return covered_samples;
}

std::uint32_t offer_all(const Newcomer& n, Block& block, Doubts& doubts) {
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(kD));
    std::size_t covered_samples = 0;
    for (std::int32_t column = n.column0 & -lanes; column <= n.column1; column += lanes)
        covered_samples += offer_columns(n, column, block, doubts);
    return static_cast<std::uint32_t>(covered_samples);
}

}  // namespace
}  // namespace sightline::warnock::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <limits>

namespace sightline::warnock {

HWY_EXPORT(offer_all);

void Block::clear() {
    std::fill(std::begin(depth), std::end(depth), std::numeric_limits<double>::infinity());
    std::fill(std::begin(owner), std::end(owner), kNobody);
}

std::uint32_t offer(const Newcomer& newcomer, Block& block, Doubts& doubts) {
    doubts.count = 0;
    return HWY_DYNAMIC_DISPATCH(offer_all)(newcomer, block, doubts);
}

}  // namespace sightline::warnock
#endif  // HWY_ONCE
