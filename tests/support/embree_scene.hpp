// The triangles of a scene in Embree, an independent ray caster.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <type_traits>

#include "sightline/scene.hpp"

namespace sightline::testing {

class EmbreeScene {
public:
    explicit EmbreeScene(const Scene& scene)
        : device_(rtcNewDevice("threads=2"), rtcReleaseDevice),
          scene_(rtcNewScene(device_.get()), rtcReleaseScene) {
        rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
        RTCGeometry mesh = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* positions = static_cast<float*>(
            rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    3 * sizeof(float), scene.positions.size()));
        for (const glm::dvec3& p : scene.positions)
            for (int k = 0; k < 3; ++k) *positions++ = static_cast<float>(p[k]);
        auto* indices = static_cast<std::uint32_t*>(
            rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(std::uint32_t), scene.triangles.size()));
        for (const Corners& c : scene.triangles)
            for (int k = 0; k < 3; ++k) *indices++ = c[k];
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(scene_.get(), mesh);
        rtcReleaseGeometry(mesh);
        rtcCommitScene(scene_.get());
    }

    [[nodiscard]] RTCScene get() const { return scene_.get(); }

private:
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, decltype(&rtcReleaseDevice)> device_;
    std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)> scene_;
};

}  // namespace sightline::testing
