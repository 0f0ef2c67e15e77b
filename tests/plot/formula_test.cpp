// What people type.
#include "sightline/formula.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sightline {
namespace {

Formula must_parse(const char* text) {
    Result<Formula> formula = parse_formula(text);
    EXPECT_TRUE(formula) << text;
    return std::move(*formula);
}

std::string complaint_about(const char* text) {
    const Result<Formula> formula = parse_formula(text);
    EXPECT_FALSE(formula) << text;
    if (formula) return "";
    EXPECT_EQ(formula.error().kind, ErrorKind::bad_option);
    EXPECT_EQ(formula.error().message.find('\n'), std::string::npos);
    return formula.error().message;
}

TEST(Formula, FunctionsAndEquationsAreToldApart) {
    for (const char* text : {"y = x*z", "x*z", " x * z ", "x*z = y"}) {
        Formula formula = must_parse(text);
        EXPECT_EQ(formula.kind, Formula::Kind::function) << text;
        EXPECT_EQ(formula.value({2, 99, 3}), 6) << text;
    }
    for (const char* text : {"x^2 + y^2 + z^2 = 1", "y^2 = x", "y = x + y*z", "0 = y - x"}) {
        EXPECT_EQ(must_parse(text).kind, Formula::Kind::implicit) << text;
    }
    EXPECT_EQ(must_parse("x^2 + y^2 + z^2 = 1").value({1, 2, 3}), 13);
    EXPECT_EQ(must_parse("y = x <= z ? 1 : 2").value({1, 0, 0}), 2);
}

TEST(Formula, KnowsTheFunctionsThatItPromises) {
    const glm::dvec3 at(0.5, 0.3, 0.7);
    const double x = at.x, z = at.z;
    EXPECT_DOUBLE_EQ(must_parse("floor(3*x) + ceil(z)").value(at), 2);
    EXPECT_DOUBLE_EQ(must_parse("mod(-x, 1)").value(at), 0.5);
    EXPECT_DOUBLE_EQ(must_parse("hypot(x, z)").value(at), std::sqrt(x * x + z * z));
    EXPECT_DOUBLE_EQ(must_parse("exp(ln(pi)) - e").value(at), std::exp(std::log(M_PI)) - M_E);
    EXPECT_DOUBLE_EQ(must_parse("atan2(x, z) + abs(-x) + sqrt(z) + sign(-3)").value(at),
                     std::atan2(x, z) + x + std::sqrt(z) - 1);
    EXPECT_TRUE(std::isnan(must_parse("sqrt(-x)").value(at)));
    EXPECT_FALSE(std::isfinite(must_parse("1/(x-x)").value(at)));
}

TEST(Formula, ErrorsShowThePlace) {
    EXPECT_NE(complaint_about("y = sin(q)").find("'q' is unknown"), std::string::npos);
    EXPECT_NE(complaint_about("y = sin(q)").find("character 5 of 'sin(q)'"), std::string::npos);
    EXPECT_NE(complaint_about("y = sin(x").find("parenthesis"), std::string::npos);
    EXPECT_NE(complaint_about("x*y").find("x*y = 0"), std::string::npos);
    EXPECT_NE(complaint_about("y = x = z").find("2 equals signs"), std::string::npos);
    EXPECT_NE(complaint_about("1 = 2").find("neither x, y nor z"), std::string::npos);
    for (const char* text :
         {"", " ", "y =", "= 1", "x +", "foo(x)", "y = x y", "y == x", "\"", "(((("})
        complaint_about(text);
}

TEST(Formula, ACommaIsNoDecimalPoint) {
    for (const char* text : {"y = 1,5*x", "y = x,z", "1,5 = x*y", "2,x"}) {
        const Result<Formula> formula = parse_formula(text);
        ASSERT_FALSE(formula) << text;
        EXPECT_NE(formula.error().message.find("decimals with a point"), std::string::npos)
            << formula.error().message;
    }
    EXPECT_TRUE(parse_formula("y = hypot(x, z) + mod(x, 2)"));
}

TEST(Formula, CopiesAreIndependent) {
    Formula one = must_parse("y = x + z");
    Formula two = one;
    EXPECT_EQ(one.value({1, 0, 1}), 2);
    EXPECT_EQ(two.value({5, 0, 5}), 10);
    EXPECT_TRUE(two.value.uses('x'));
    EXPECT_FALSE(two.value.uses('y'));
}

}  // namespace
}  // namespace sightline
