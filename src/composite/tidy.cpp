// F. Kainz, "Interpreting OpenEXR Deep Pixels", 2013: splitting and merging of samples.
//
// A volume sample with opacity alpha and premultiplied colour c has the optical depth
// u = -log(1 - alpha) and would shine with e = c u / alpha if nothing of it were absorbed. Both are
// spread evenly from z to z_back, so a part of it has its share of both, and samples that coincide
// have the sum of both. Back again, alpha = 1 - exp(-u) and c = e alpha / u. That is the text's
// formula for a part and its formula for a merged pair at once, for any number of samples.
#include "composite/tidy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

#include "composite/optics.hpp"

namespace sightline {
namespace {

bool is_surface(const DeepSample& sample) { return sample.z == sample.z_back; }

/// What can be reckoned with: ends in order, a volume of finite size, alpha in 0..1.
std::optional<DeepSample> cleaned(DeepSample sample) {
    constexpr float kFarthest = std::numeric_limits<float>::max();
    if (std::isnan(sample.z)) return std::nullopt;
    if (!(sample.z_back > sample.z)) sample.z_back = sample.z;
    if (!is_surface(sample)) {
        sample.z = std::max(sample.z, -kFarthest);
        sample.z_back = std::min(sample.z_back, kFarthest);
    }
    float& alpha = sample.color.a;
    alpha = alpha > 0 ? std::min(alpha, 1.0f) : 0.0f;
    return sample;
}

/// Samples, or parts of samples, that coincide.
class Mixture {
public:
    /// `part` of the way through the sample, which must stay until the end.
    void add(const DeepSample& sample, double part) {
        only_ = count_++ == 0 ? &sample : nullptr;
        const bool opaque = sample.color.a >= 1;
        const double alpha = sample.color.a, all = opaque ? 0 : optical_depth(sample.color.a);
        const double depth = opaque ? std::numeric_limits<double>::infinity() : all * part;
        if (opaque) {
            ++opaque_;
            opaque_light_ += glm::dvec3(sample.color);
        } else {
            depth_ += depth;
            // Clear samples may shine, too: u / alpha is 1 in the limit.
            light_ += glm::dvec3(sample.color) * (part * (alpha > 0 ? all / alpha : 1));
        }
        if (depth > most_) {
            most_ = depth;
            ids_ = &sample;
        }
    }

    /// The one sample that they make.
    [[nodiscard]] DeepSample merged(float z, float z_back) const {
        const bool whole = only_ != nullptr && only_->z == z && only_->z_back == z_back;
        if (whole) return *only_;
        return {z, z_back, color(), ids_->object, ids_->triangle};
    }

private:
    [[nodiscard]] glm::vec4 color() const {
        // Of opaque ones that coincide none is in front: half of each, as the text has it.
        if (opaque_ > 0) return {glm::vec3(opaque_light_ / static_cast<double>(opaque_)), 1.0f};
        const double alpha = opacity(depth_);
        const double kept = depth_ > 0 ? alpha / depth_ : 1;
        return {glm::vec3(light_ * kept), static_cast<float>(alpha)};
    }

    std::size_t count_ = 0, opaque_ = 0;
    double depth_ = 0, most_ = -1;
    glm::dvec3 light_{0, 0, 0}, opaque_light_{0, 0, 0};
    const DeepSample* ids_ = nullptr;   // the one that absorbs most
    const DeepSample* only_ = nullptr;  // where it is alone
};

}  // namespace

void Tidier::add(std::span<const DeepSample> samples) {
    for (const DeepSample& sample : samples) {
        if (const auto good = cleaned(sample)) samples_.push_back(*good);
    }
}

void Tidier::sort() {
    order_.resize(samples_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    const auto key = [this](std::uint32_t i) {
        return std::tuple(samples_[i].z, samples_[i].z_back, i);
    };
    std::sort(order_.begin(), order_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
}

bool Tidier::is_tidy() const {
    const auto overlap = [this](std::uint32_t a, std::uint32_t b) {
        const DeepSample &front = samples_[a], &back = samples_[b];
        if (front.z_back != back.z) return front.z_back > back.z;
        return is_surface(front) && is_surface(back);
    };
    return std::adjacent_find(order_.begin(), order_.end(), overlap) == order_.end();
}

void Tidier::append_to(std::vector<DeepSample>& out) {
    sort();
    if (!is_tidy()) {
        sweep(out);
        return;
    }
    for (const std::uint32_t i : order_) out.push_back(samples_[i]);
}

/// From front to back over all places where a sample begins or ends.
void Tidier::sweep(std::vector<DeepSample>& out) {
    ends_.clear();
    for (const DeepSample& sample : samples_) ends_.insert(ends_.end(), {sample.z, sample.z_back});
    std::sort(ends_.begin(), ends_.end());
    ends_.erase(std::unique(ends_.begin(), ends_.end()), ends_.end());
    active_.clear();
    auto next = order_.begin();
    for (std::size_t k = 0; k < ends_.size(); ++k) {
        const float here = ends_[k];
        std::erase_if(active_, [&](std::uint32_t i) { return samples_[i].z_back <= here; });
        std::optional<Mixture> surfaces;
        for (; next != order_.end() && samples_[*next].z == here; ++next) {
            if (is_surface(samples_[*next])) {
                if (!surfaces) surfaces.emplace();
                surfaces->add(samples_[*next], 1);
            } else {
                active_.insert(std::upper_bound(active_.begin(), active_.end(), *next), *next);
            }
        }
        if (surfaces) out.push_back(surfaces->merged(here, here));
        if (active_.empty()) continue;
        const float there = ends_[k + 1];  // where the first of the active ones ends, at the latest
        Mixture volumes;
        for (const std::uint32_t i : active_) {
            const DeepSample& sample = samples_[i];
            volumes.add(sample, (double{there} - here) / (double{sample.z_back} - sample.z));
        }
        out.push_back(volumes.merged(here, there));
    }
}

}  // namespace sightline
