// How this version differs: a fragment is shaded at the middle of its samples, so also slivers get
// the colour of a point that they have; and the sums are made in double precision, so what is one
// colour before stays that colour, to the bit, however many fragments it is made of.
#include "shading/antialiased_rows.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "visibility/parallel.hpp"

namespace sightline {
namespace {

struct Point {
    std::int32_t x, y;
};

/// The middle of the samples of a mask, in units of the screen.
Point middle_of(std::uint64_t mask, std::uint32_t x, std::uint32_t y, int subpixel_bits) {
    std::int64_t i = 0, j = 0;
    const int count = std::popcount(mask);
    for (std::uint64_t rest = mask; rest != 0; rest &= rest - 1) {
        const int bit = std::countr_zero(rest);
        i += 2 * (bit % static_cast<int>(kMaskSide)) + 1;
        j += 2 * (bit / static_cast<int>(kMaskSide)) + 1;
    }
    const auto place = [&](std::uint32_t pixel, std::int64_t sum) {
        const std::int64_t size = std::int64_t{1} << subpixel_bits;
        return static_cast<std::int32_t>(pixel * size +
                                         sum * size / (2 * std::int64_t{kMaskSide} * count));
    };
    return {place(x, i), place(y, j)};
}

/// Makes the pixels of a band.
class PixelMaker final : public FragmentSink {
public:
    PixelMaker(const ScreenScene& screen, const SampleShader& shader, const ShadeOptions& options,
               glm::vec4* pixels, std::uint32_t first_row)
        : screen_(screen),
          shader_(shader),
          cache_(shader),
          resolver_(screen),
          background_(options.background),
          pixels_(pixels),
          first_row_(first_row) {}

    void take(std::uint32_t x, std::uint32_t y, std::span<const Fragment> fragments) override {
        anything_seen = anything_seen || !fragments.empty();
        shade(x, y, fragments);
        const PixelShares& shares = resolver_.resolve(x, y, fragments, opacities_);
        glm::dvec4 sum = shares.rest * glm::dvec4(background_);
        for (std::size_t k = 0; k < fragments.size(); ++k)
            sum += shares.weights[k] * glm::dvec4(colors_[k]);
        const std::size_t at = std::size_t{y - first_row_} * screen_.resolution().width + x;
        pixels_[at] = glm::vec4(sum / double{kFullArea});
        if (deep) deep_.push_back({at, samples_of(fragments, shares)});
    }

    /// The samples of the pixels, in ascending order of `at`.
    struct DeepPixel {
        std::size_t at;
        std::vector<DeepSample> samples;
    };
    [[nodiscard]] std::vector<DeepPixel> take_deep() {
        std::sort(deep_.begin(), deep_.end(),
                  [](const DeepPixel& a, const DeepPixel& b) { return a.at < b.at; });
        return std::move(deep_);
    }

    bool deep = false, anything_seen = false;

private:
    void shade(std::uint32_t x, std::uint32_t y, std::span<const Fragment> fragments) {
        colors_.clear();
        opacities_.clear();
        for (const Fragment& f : fragments) {
            if (const PixelColor* constant = cache_.constant_color(f.id)) {
                colors_.push_back(constant->linear);
                opacities_.push_back(material_of(screen_.scene(), f.id).opacity);
                continue;
            }
            const Point p = middle_of(f.mask, x, y, screen_.subpixel_bits());
            const ShadedFace& face = cache_.face(f.id);
            colors_.push_back(shader_.varying_color(face, p.x, p.y));
            opacities_.push_back(shader_.opacity(face, p.x, p.y));
        }
    }

    /// One a surface. "Over" would hide what abuts as if it lay behind, so each gets the alpha with
    /// which "over" gives its weight: that share of what the ones in front left.
    [[nodiscard]] std::vector<DeepSample> samples_of(std::span<const Fragment> fragments,
                                                     const PixelShares& shares) const {
        std::vector<DeepSample> samples;
        double left = kFullArea;
        for (std::size_t k = 0; k < fragments.size();) {
            const std::size_t first = k;
            glm::dvec4 sum{0, 0, 0, 0};
            float near = std::numeric_limits<float>::infinity(), far = 0;
            std::size_t most = k;
            for (; k < fragments.size() && shares.surfaces[k] == shares.surfaces[first]; ++k) {
                if (shares.weights[k] <= 0) continue;
                sum += shares.weights[k] * glm::dvec4(colors_[k]);
                near = std::min(near, fragments[k].near);
                far = std::max(far, fragments[k].far);
                if (shares.weights[k] > shares.weights[most]) most = k;
            }
            if (sum.a <= 0 || left <= 0) continue;
            const std::uint32_t id = fragments[most].id;
            samples.push_back({metric(near), metric(far), glm::vec4(sum / left),
                               screen_.scene().object_of(id), id});
            samples.back().color.a = std::min(samples.back().color.a, 1.0f);
            left -= sum.a;
        }
        tidy(samples);
        return samples;
    }

    [[nodiscard]] float metric(float z) const {
        return static_cast<float>(
            screen_.metric_depth(std::clamp(static_cast<double>(z), 0.0, double{kDepthMax})));
    }

    /// Where depths overlap or coincide the farther sample begins behind the nearer one.
    static void tidy(std::vector<DeepSample>& samples) {
        for (std::size_t k = 1; k < samples.size(); ++k) {
            DeepSample &front = samples[k - 1], &behind = samples[k];
            behind.z =
                std::max(behind.z, std::nextafter(front.z, std::numeric_limits<float>::max()));
            behind.z_back = std::max(behind.z, behind.z_back);
            front.z_back = std::min(front.z_back, behind.z);
        }
    }

    const ScreenScene& screen_;
    const SampleShader& shader_;
    FaceCache cache_;
    PixelResolver resolver_;
    glm::vec4 background_;
    glm::vec4* pixels_;
    std::uint32_t first_row_;
    std::vector<glm::vec4> colors_;
    std::vector<float> opacities_;
    std::vector<DeepPixel> deep_;
};

}  // namespace

AntialiasedRows::AntialiasedRows(const ScreenScene& screen, const ShadeOptions& options, bool deep,
                                 std::unique_ptr<FragmentSource> fragments)
    : screen_(screen),
      shader_(screen, options.shading),
      options_(options),
      deep_(deep),
      fragments_(std::move(fragments)) {}

void AntialiasedRows::resolve(std::uint32_t first, std::uint32_t count,
                              const ResolveOptions& options) {
    const std::size_t width = screen_.resolution().width;
    pixels_.assign(count * width, options_.background);
    const std::uint32_t bands = (count + unit() - 1) / unit();
    bands_.assign(deep_ ? bands : 0, {});
    for_each_index(bands, options, [&](std::uint32_t b) {
        const std::uint32_t row = b * unit(), rows = std::min(unit(), count - row);
        PixelMaker maker(screen_, shader_, options_, pixels_.data() + row * width, first + row);
        maker.deep = deep_;
        fragments_->visit_band(first / unit() + b, maker);
        if (maker.anything_seen) anything_seen_ = true;
        if (!deep_) return;
        Band& band = bands_[b];
        band.counts.assign(rows * width, 0);
        for (const PixelMaker::DeepPixel& pixel : maker.take_deep()) {
            band.counts[pixel.at] = static_cast<std::uint32_t>(pixel.samples.size());
            band.samples.insert(band.samples.end(), pixel.samples.begin(), pixel.samples.end());
        }
    });
}

DeepRows AntialiasedRows::deep_rows(std::uint32_t first, std::uint32_t count) {
    strip_.counts.clear();
    strip_.samples.clear();
    const std::size_t width = screen_.resolution().width;
    for (std::uint32_t y = first; y < first + count;) {
        const Band& band = bands_[y / unit()];
        const std::uint32_t from = y % unit();
        const auto rows = std::min(static_cast<std::uint32_t>(band.counts.size() / width) - from,
                                   first + count - y);
        const auto begin = band.counts.begin() + static_cast<std::ptrdiff_t>(from * width);
        const auto end = begin + static_cast<std::ptrdiff_t>(rows * width);
        const auto sum = [](auto a, auto b) {
            std::ptrdiff_t n = 0;
            for (; a != b; ++a) n += *a;
            return n;
        };
        const auto sample = band.samples.begin() + sum(band.counts.begin(), begin);
        strip_.samples.insert(strip_.samples.end(), sample, sample + sum(begin, end));
        strip_.counts.insert(strip_.counts.end(), begin, end);
        y += rows;
    }
    return {strip_.counts, strip_.samples};
}

}  // namespace sightline
