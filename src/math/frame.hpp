// An affine frame and its inverse, in a fixed order of + - * /.
#pragma once

#include <array>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sightline::math {

/// Coordinates with an origin and three axes in the world.
class Frame {
public:
    /// Precondition: `to_world` is affine.
    explicit Frame(const glm::dmat4& to_world)
        : axes_{glm::dvec3(to_world[0]), glm::dvec3(to_world[1]), glm::dvec3(to_world[2])},
          origin_(to_world[3]),
          cofactors_{glm::cross(axes_[1], axes_[2]), glm::cross(axes_[2], axes_[0]),
                     glm::cross(axes_[0], axes_[1])},
          determinant_(glm::dot(axes_[0], cofactors_[0])) {}

    [[nodiscard]] double determinant() const { return determinant_; }
    [[nodiscard]] glm::dvec3 point(glm::dvec3 own) const {
        return ((origin_ + own.x * axes_[0]) + own.y * axes_[1]) + own.z * axes_[2];
    }
    /// The direction of a normal (a row vector): times the inverse transpose, up to length.
    [[nodiscard]] glm::dvec3 normal(glm::dvec3 own) const {
        const glm::dvec3 n =
            (own.x * cofactors_[0] + own.y * cofactors_[1]) + own.z * cofactors_[2];
        return determinant_ < 0 ? -n : n;
    }
    // By Cramer's rule. Precondition: the determinant is not 0.
    [[nodiscard]] glm::dvec3 own_vector(glm::dvec3 world) const {
        return {glm::dot(cofactors_[0], world) / determinant_,
                glm::dot(cofactors_[1], world) / determinant_,
                glm::dot(cofactors_[2], world) / determinant_};
    }
    [[nodiscard]] glm::dvec3 own_point(glm::dvec3 world) const {
        return own_vector(world - origin_);
    }

private:
    std::array<glm::dvec3, 3> axes_;
    glm::dvec3 origin_;
    std::array<glm::dvec3, 3> cofactors_;
    double determinant_;
};

}  // namespace sightline::math
