// Meshes of implicit surfaces against geometry, and how high surfaces reach.
#include "plot/section_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "plot/fields.hpp"
#include "plot/section_grid.hpp"
#include "sightline/sections.hpp"

namespace sightline {
namespace {

using namespace testing;

SectionMesh mesh_of(const std::string& text, double half, std::size_t cells, int threads = 0) {
    const SectionPlanes sections(cube(half), planes(half, 9), planes(half, 9));
    return must(mesh_of_field(field(text), grid_of(sections, cells), threads, {}));
}

/// How many edges do not join two triangles that run along them in opposite directions.
std::size_t open_edges(const SectionMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance, uses;
    for (const Corners& c : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = c[k], b = c[(k + 1) % 3];
            balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
            ++uses[{std::min(a, b), std::max(a, b)}];
        }
    }
    std::size_t open = 0;
    for (const auto& [edge, sum] : balance) open += sum != 0 || uses[edge] != 2 ? 1 : 0;
    return open;
}

double volume(const SectionMesh& mesh) {
    double sum = 0;
    for (const Corners& c : mesh.triangles)
        sum += glm::dot(mesh.points[c.x], glm::cross(mesh.points[c.y], mesh.points[c.z]));
    return sum / 6;
}

TEST(SectionsMesh, ASphereIsClosedAndRound) {
    for (const double half : {1.2, 1.0, 1.5}) {  // with 1.0 and 1.5 nodes lie on it
        const SectionMesh mesh = mesh_of(kSphere, half, 24);
        for (const glm::dvec3& p : mesh.points) ASSERT_NEAR(glm::length(p), 1, 1e-9);
        EXPECT_NEAR(volume(mesh), 4.0 / 3 * std::numbers::pi, 0.06) << half;
        EXPECT_EQ(open_edges(mesh), 0u) << half;
    }
}

TEST(SectionsMesh, SectionsAreClosedCircles) {
    const SectionMesh mesh = mesh_of(kSphere, 1.2, 24);
    const SectionPlanes sections(cube(1.2), planes(1.2, 9), planes(1.2, 9));
    std::map<std::uint32_t, int> ends;
    std::size_t edges = 0;
    for (const Corners& c : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 a = mesh.points[c[k]], b = mesh.points[c[(k + 1) % 3]];
            // Each edge from one of its two triangles.
            if (c[k] > c[(k + 1) % 3] || !sections.contain(a, b, mesh.points[c[(k + 2) % 3]]))
                continue;
            ++edges;
            ++ends[c[k]];
            ++ends[c[(k + 1) % 3]];
            const double at = a.z == b.z ? a.z : a.x;
            const auto in_plane = [&](glm::dvec3 p) {
                return a.z == b.z ? std::hypot(p.x, p.y) : std::hypot(p.y, p.z);
            };
            ASSERT_NEAR(in_plane(a), std::sqrt(1 - at * at), 1e-6);
        }
    }
    EXPECT_GT(edges, 500u);
    for (const auto& [vertex, count] : ends)  // 4 where an x and a z section cross
        ASSERT_TRUE(count == 2 || count == 4) << vertex;
}

TEST(SectionsMesh, FacesInPlanesOfTheGrid) {
    // A cube whose faces consist of nodes.
    const SectionMesh mesh = mesh_of("max(max(abs(x), abs(y)), abs(z)) = 0.5", 1, 16);
    EXPECT_EQ(open_edges(mesh), 0u);
    EXPECT_NEAR(volume(mesh), 1, 0.05);  // some of its edges are bevelled
    // One side of a plane is positive with the plane itself.
    const SectionMesh plane = mesh_of("x", 1, 16);
    EXPECT_EQ(plane.triangles.size(), 2u * 16 * 16);
    for (const glm::dvec3& p : plane.points) ASSERT_EQ(p.x, 0);
    // Nothing is on the other side of a surface that only touches.
    EXPECT_TRUE(mesh_of("0 - abs(x)", 1, 16).triangles.empty());
    EXPECT_TRUE(mesh_of("x^2", 1, 16).triangles.empty());
}

TEST(SectionsMesh, PolesAndJumpsAreNoRoots) {
    for (const std::string text : {"y - 1/x", "y - tan(3 * x)", "y - floor(2 * x + 0.25)"}) {
        const SectionMesh mesh = mesh_of(text, 2, 32);
        EXPECT_GT(mesh.triangles.size(), 500u) << text;
        Evaluator value = field(text).make();
        for (const glm::dvec3& p : mesh.points) ASSERT_NEAR(value(p), 0, 1e-5) << text;
    }
}

TEST(SectionsMesh, EndsWhereThereAreNoValues) {
    const SectionMesh mesh = mesh_of("y - sqrt(x)", 2, 32);
    EXPECT_GT(mesh.triangles.size(), 500u);
    for (const glm::dvec3& p : mesh.points) ASSERT_GE(p.x, 0);
}

TEST(SectionsMesh, DoesNotDependOnThreads) {
    for (const std::string& text : {kSphere, std::string("sin(5*x)*cos(5*y) + sin(5*z)")}) {
        const SectionMesh one = mesh_of(text, 1.2, 48, 1);
        for (const int threads : {2, 8}) {
            const SectionMesh many = mesh_of(text, 1.2, 48, threads);
            EXPECT_EQ(one.points, many.points);
            EXPECT_EQ(one.triangles, many.triangles);
        }
    }
}

TEST(SectionsRange, OfY) {
    const auto range = [](const std::string& text, double half) {
        return must(find_y_range(field(text), {-half, half}, {-half, half}));
    };
    const auto near = [](glm::dvec2 found, double lo, double hi) {
        const double spare = 0.15 * (hi - lo);
        return found.x <= lo && found.y >= hi && found.x >= lo - spare && found.y <= hi + spare;
    };
    EXPECT_TRUE(near(range(kSphere, 1.2), -1, 1));
    EXPECT_TRUE(near(range(kSphere, 10), -1, 1));
    EXPECT_TRUE(near(range(kTorus, 3), -std::sqrt(0.5), std::sqrt(0.5)));
    EXPECT_TRUE(near(range("y - x^4", 5), 0, 625));
    EXPECT_TRUE(near(range("y - 0.01*sin(x)", 5), -0.01, 0.01));
    EXPECT_TRUE(near(range("y + 1000 - x", 1), -1001, -999));
    EXPECT_TRUE(near(range("(y - 3)^2 + x^2 + z^2 - 1", 2), 2, 4));
    EXPECT_EQ(range("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)", 4), glm::dvec2(-4, 4));
    EXPECT_EQ(range("x^2 + z^2 - 1 + 0*y", 2), glm::dvec2(-2, 2));
    const auto nothing = find_y_range(field("x^2 + y^2 + z^2 = 0 - 1"), {-1, 2}, {0, 3});
    ASSERT_FALSE(nothing.ok());
    EXPECT_EQ(nothing.error().kind, ErrorKind::bad_input);
    EXPECT_NE(nothing.error().message.find(
                  "'x^2 + y^2 + z^2 = 0 - 1' has no points over x -1..2, z 0..3"),
              std::string::npos);
}

}  // namespace
}  // namespace sightline
