// How much of a pixel each of its fragments contributes.
//
// Source: L. Carpenter, "The A-buffer, an Antialiased Hidden Surface Method", 1984: fragments are
// packed from front to back, masks say what is hidden, areas how much that is.
//
// How this version differs. Where two surfaces overlap in depth and on the samples of their masks,
// the exact depths at each sample decide, so crossing surfaces share the pixel as they share its
// samples. And the areas are kept in balance: fragments whose depths run into one another are a
// layer. Of the light that the layers in front have left, r, a layer of area a receives at most
// min(r, a) and at least r - (1 - a), whatever the masks say; so a layer that covers the pixel
// takes all that is left, and the weights of an opaque surface without gaps add up to exactly 1.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "sightline/fragments.hpp"
#include "visibility/sampled_plane.hpp"

namespace sightline {

namespace {

constexpr std::size_t kSamples = std::size_t{kMaskSide} * kMaskSide;
constexpr double kWhole = kFullArea;
constexpr std::uint64_t kAll = ~std::uint64_t{0};

/// body(sample) for the bits of a mask, in ascending order.
template <class Body>
void for_bits(std::uint64_t mask, const Body& body) {
    for (; mask != 0; mask &= mask - 1) body(static_cast<unsigned>(std::countr_zero(mask)));
}

/// Fragments first .. end-1, whose depths run into one another.
struct Layer {
    std::size_t first = 0, end = 0;
    double alone = 0;    ///< area of those that don't overlap the ones before
    double above = 0;    ///< area of the others
    bool opaque = true;  ///< all of them
};

}  // namespace

class PixelResolver::State {
public:
    explicit State(const ScreenScene& screen)
        : screen_(screen),
          scene_(screen.scene()),
          units_({screen.resolution(), kMaskSide}, screen.subpixel_bits()),
          judge_(screen, units_) {}

    const PixelShares& resolve(std::uint32_t x, std::uint32_t y,
                               std::span<const Fragment> fragments,
                               std::span<const float> opacities) {
        fragments_ = fragments;
        opacities_ = opacities;
        column_ = static_cast<std::int32_t>(x * kMaskSide);
        row_ = static_cast<std::int32_t>(y * kMaskSide);
        known_ = 0;
        while (planes_.size() < fragments.size()) planes_.emplace_back().id = kNone;
        shares_.rest = kWhole;
        shares_.weights.assign(fragments.size(), 0);
        shares_.surfaces.assign(fragments.size(), 0);
        std::uint32_t surface = 0;
        if (fragments_tile()) {
            number_surfaces({0, fragments.size()}, surface);
            std::ranges::transform(fragments, shares_.weights.begin(),
                                   [](const Fragment& f) { return f.area; });
            shares_.rest = 0;
            return shares_;
        }
        expose();
        for (std::size_t k = 0; k < fragments.size();) {
            const Layer layer = layer_from(k);
            number_surfaces(layer, surface);
            weigh(layer);
            k = layer.end;
        }
        close();
        return shares_;
    }

    std::uint64_t crossings = 0;

private:
    // -- what is seen of each fragment at the samples ------------------------------------------

    /// Samples of the pixel at which the order by `near` may be wrong.
    [[nodiscard]] std::uint64_t contested() {
        std::uint64_t found = 0;
        reaching_.clear();  // those that are as deep as the fragment at hand
        for (const Fragment& f : fragments_) {
            if (f.thin) continue;
            std::erase_if(reaching_, [&f](const Fragment* g) { return g->far < f.near; });
            for (const Fragment* g : reaching_) found |= f.mask & g->mask;
            reaching_.push_back(&f);
        }
        return found;
    }

    /// Fills in exposure_: for each fragment the sum, over the samples of its mask, of what the
    /// fragments in front let through.
    void expose() {
        exposure_.assign(fragments_.size(), 0);
        const std::uint64_t open = contested();
        if (open != 0) ++crossings;
        expose_in_order(~open);
        for_bits(open, [this](unsigned sample) { expose_at(sample); });
    }

    void expose_in_order(std::uint64_t samples) {
        std::uint64_t lit = samples;  // not yet black
        std::uint64_t dimmed = 0;     // of those, where light_ holds what is left
        for (std::size_t k = 0; k < fragments_.size(); ++k) {
            if (fragments_[k].thin) {
                exposure_[k] = light_on_thin(k);
                continue;
            }
            const std::uint64_t mask = fragments_[k].mask & lit;
            double sum = std::popcount(mask & ~dimmed);
            for_bits(mask & dimmed, [&](unsigned s) { sum += light_[s]; });
            exposure_[k] = sum;
            const double through = 1 - static_cast<double>(opacities_[k]);
            if (through <= 0) {
                lit &= ~mask;
                continue;
            }
            for_bits(mask & dimmed, [&](unsigned s) { light_[s] *= through; });
            for_bits(mask & ~dimmed, [&](unsigned s) { light_[s] = through; });
            dimmed |= mask;
        }
    }

    void expose_at(unsigned sample) {
        order_ = owners_of(sample);
        sort_at(sample);
        double light = 1;
        for (const std::size_t k : order_) {
            exposure_[k] += light;
            light *= 1 - static_cast<double>(opacities_[k]);
            if (light <= 0) break;
        }
    }

    /// Sorts order_ at a sample. It is nearly sorted already, by `near`, so that exchanging
    /// neighbours is soon done; where it is not, another way is taken.
    void sort_at(unsigned sample) {
        const auto before = [&](std::size_t a, std::size_t b) { return is_before(a, b, sample); };
        std::size_t moves = 8 * order_.size();
        for (std::size_t k = 1; k < order_.size(); ++k) {
            for (std::size_t i = k; i > 0 && before(order_[i], order_[i - 1]); --i, --moves) {
                if (moves == 0) return std::stable_sort(order_.begin(), order_.end(), before);
                std::swap(order_[i], order_[i - 1]);
            }
        }
    }

    /// What reaches a fragment that covers no sample. The one nearest to it may belong to what lies
    /// beside it: only what its plane, continued to there, lies behind can hide it.
    [[nodiscard]] double light_on_thin(std::size_t thin) {
        const auto sample = static_cast<unsigned>(std::countr_zero(fragments_[thin].mask));
        double light = 1;
        for (const std::size_t k : owners_of(sample)) {
            if (hides(k, thin, sample)) light *= 1 - static_cast<double>(opacities_[k]);
            if (light <= 0) break;
        }
        return light;
    }

    /// The fragments that cover a sample, by `near`.
    [[nodiscard]] const std::vector<std::size_t>& owners_of(unsigned sample) {
        std::vector<std::size_t>& owners = owners_[sample];
        if ((known_ >> sample & 1) != 0) return owners;
        known_ |= std::uint64_t{1} << sample;
        owners.clear();
        for (std::size_t k = 0; k < fragments_.size(); ++k)
            if ((fragments_[k].mask >> sample & 1) != 0 && !fragments_[k].thin) owners.push_back(k);
        return owners;
    }

    [[nodiscard]] bool hides(std::size_t front, std::size_t behind, unsigned sample) {
        const std::uint32_t shared = plane(front).shared;
        if (shared != kNone && shared == plane(behind).shared) return false;
        return is_before(front, behind, sample);
    }

    /// Of fragment k; most are never asked for theirs.
    [[nodiscard]] const SampledPlane& plane(std::size_t k) {
        if (planes_[k].id != fragments_[k].id)
            planes_[k] = sampled_plane_of(screen_, units_, fragments_[k].id);
        return planes_[k];
    }

    [[nodiscard]] bool is_before(std::size_t a, std::size_t b, unsigned sample) {
        return judge_.before(plane(a), plane(b),
                             column_ + static_cast<std::int32_t>(sample % kMaskSide),
                             row_ + static_cast<std::int32_t>(sample / kMaskSide));
    }

    /// Whether they are opaque, don't overlap, and cover the pixel: most pixels are so.
    [[nodiscard]] bool fragments_tile() const {
        std::uint64_t mask = 0, area = 0;
        for (std::size_t k = 0; k < fragments_.size(); ++k) {
            const Fragment& f = fragments_[k];
            if (opacities_[k] < 1 || (!f.thin && (f.mask & mask) != 0)) return false;
            if (!f.thin) mask |= f.mask;
            area += f.area;
        }
        return area == kFullArea;
    }

    // -- areas ---------------------------------------------------------------------------------

    [[nodiscard]] Layer layer_from(std::size_t first) const {
        Layer layer{first, first};
        std::uint64_t mask = 0;
        float far = fragments_[first].far;
        double thin = 0;
        for (std::size_t k = first; k < fragments_.size() && fragments_[k].near <= far; ++k) {
            const Fragment& f = fragments_[k];
            const bool overlaps = !f.thin && (f.mask & mask) != 0;
            (f.thin ? thin : overlaps ? layer.above : layer.alone) += f.area;
            if (!f.thin && !overlaps) mask |= f.mask;
            layer.opaque = layer.opaque && opacities_[k] >= 1;
            far = std::max(far, f.far);
            layer.end = k + 1;
        }
        // Nobody knows whether a thin one lies beside the others, but if together they are just the
        // pixel they tile it.
        constexpr double kRounding = 64;
        const bool tile = layer.above == 0 && std::abs(layer.alone + thin - kWhole) <= kRounding;
        (tile ? layer.alone : layer.above) += thin;
        return layer;
    }

    /// Fragments of one object in a layer that don't overlap are one surface.
    void number_surfaces(const Layer& layer, std::uint32_t& next) {
        std::uint64_t mask = 0;
        std::uint32_t object = kNone;
        for (std::size_t k = layer.first; k < layer.end; ++k) {
            const Fragment& f = fragments_[k];
            const std::uint32_t own = object_of(f.id);
            const bool goes_on = own == object && (f.thin || (f.mask & mask) == 0);
            if (!goes_on) {
                mask = 0;
                object = own;
                ++next;
            }
            if (!f.thin) mask |= f.mask;
            shares_.surfaces[k] = next - 1;
        }
    }

    /// Neighbours mostly belong to one object.
    [[nodiscard]] std::uint32_t object_of(std::uint32_t id) {
        if (scene_.objects.empty()) return 0;
        const Object& last = scene_.objects[object_];
        if (id < last.first_triangle || id >= last.first_triangle + last.triangle_count)
            object_ = scene_.object_of(id);
        return object_;
    }

    /// Area times the share of its samples that can be seen.
    [[nodiscard]] double seen_area(std::size_t k) const {
        const Fragment& f = fragments_[k];
        const double samples = std::popcount(f.mask);
        return exposure_[k] == samples ? f.area : f.area * (exposure_[k] / samples);
    }

    /// What a layer receives of the light that is left, given what the masks say.
    [[nodiscard]] double balanced(const Layer& layer, double seen) const {
        // Light that passes a translucent fragment reaches others of the layer as well.
        if (!layer.opaque && layer.above > 0) return seen;
        const double most = std::min(shares_.rest, layer.alone + layer.above);
        const double least = std::min(most, shares_.rest - (kWhole - layer.alone));
        return std::clamp(seen, std::max(least, 0.0), most);
    }

    void weigh(const Layer& layer) {
        double seen = 0;
        for (std::size_t k = layer.first; k < layer.end; ++k) seen += seen_area(k);
        const double given = balanced(layer, seen), all = layer.alone + layer.above;
        const double factor = seen > 0 ? given / seen : 0;
        double sum = 0;
        for (std::size_t k = layer.first; k < layer.end; ++k) {
            const double area =
                seen > 0 ? seen_area(k) * factor : fragments_[k].area * (given / all);
            shares_.weights[k] = area * static_cast<double>(opacities_[k]);
            sum += shares_.weights[k];
        }
        if (sum > shares_.rest) {
            for (std::size_t k = layer.first; k < layer.end; ++k)
                shares_.weights[k] *= shares_.rest / sum;
            sum = shares_.rest;
        }
        // In an opaque layer nothing is lost to rounding.
        shares_.rest = std::max(0.0, shares_.rest - (layer.opaque ? given : sum));
    }

    /// Where the opaque fragments cover every sample, what is left for the background lies between
    /// the samples. It goes to the thin fragments that seemed to be hidden, as far as they have
    /// area, and if all the areas are enough for the pixel, the rest to the others.
    void close() {
        if (shares_.rest <= 0) return;
        std::uint64_t mask = 0;
        double area = 0, weight = 0;
        for (std::size_t k = 0; k < fragments_.size(); ++k) {
            if (opacities_[k] < 1) continue;
            if (!fragments_[k].thin) mask |= fragments_[k].mask;
            area += fragments_[k].area;
        }
        if (mask != kAll) return;
        for (std::size_t k = 0; k < fragments_.size(); ++k) {
            if (opacities_[k] < 1) continue;
            const double more = std::min(shares_.rest, fragments_[k].area - shares_.weights[k]);
            if (fragments_[k].thin && more > 0) {
                shares_.weights[k] += more;
                shares_.rest -= more;
            }
            weight += shares_.weights[k];
        }
        if (area < kWhole || weight <= 0) return;
        for (std::size_t k = 0; k < fragments_.size(); ++k)
            if (opacities_[k] >= 1) shares_.weights[k] *= (weight + shares_.rest) / weight;
        shares_.rest = 0;
    }

    const ScreenScene& screen_;
    const Scene& scene_;
    SampleUnits units_;
    DepthJudge judge_;
    std::vector<SampledPlane> planes_;  // see plane(); they may be those of another pixel
    std::span<const Fragment> fragments_;
    std::span<const float> opacities_;
    std::int32_t column_ = 0, row_ = 0;  // of the pixel's first sample
    PixelShares shares_;
    std::vector<double> exposure_;
    std::array<double, kSamples> light_{};
    std::array<std::vector<std::size_t>, kSamples> owners_;  // of the samples in known_
    std::uint64_t known_ = 0;
    std::vector<std::size_t> order_;
    std::vector<const Fragment*> reaching_;
    std::uint32_t object_ = 0;
};

PixelResolver::PixelResolver(const ScreenScene& screen) : state_(std::make_unique<State>(screen)) {}
PixelResolver::~PixelResolver() = default;

const PixelShares& PixelResolver::resolve(std::uint32_t x, std::uint32_t y,
                                          std::span<const Fragment> fragments,
                                          std::span<const float> opacities) {
    return state_->resolve(x, y, fragments, opacities);
}

std::uint64_t PixelResolver::crossings() const { return state_->crossings; }

}  // namespace sightline
