// Height maps in NPY files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "plot/heights.hpp"

namespace sightline {
namespace {

using namespace sightline::testing;

template <class T>
std::string bytes_of(const std::vector<T>& values, bool big_endian) {
    std::string out;
    for (const T& value : values) {
        std::string bytes(sizeof value, '\0');
        std::memcpy(bytes.data(), &value, sizeof value);
        if (big_endian) std::reverse(bytes.begin(), bytes.end());
        out += bytes;
    }
    return out;
}

template <class T>
void check_type(const std::string& type, const std::vector<T>& values) {
    const TemporaryFolder folder;
    std::vector<double> rows(values.begin(), values.end());
    std::vector<double> columns = {rows[0], rows[2], rows[4], rows[1], rows[3], rows[5]};
    for (const bool big_endian : {false, true}) {
        const std::string full = (big_endian ? ">" : "<") + type;
        const std::string data = bytes_of(values, big_endian);
        for (const int version : {1, 2, 3}) {
            expect_heights(
                load_height_map(folder.write("a.npy", npy(npy_header(full), data, version))), rows);
        }
        expect_heights(
            load_height_map(folder.write("a.npy", npy(npy_header(full, "(2, 3)", true), data))),
            columns);
    }
}

TEST(HeightMapNpy, EveryType) {
    check_type<float>("f4", {1.5f, -2.25f, 3e30f, 0, 5, 6});
    check_type<double>("f8", {1.1, -2.2, 3e300, 0, 5, 6});
    check_type<std::int8_t>("i1", {1, -2, 127, -128, 5, 6});
    check_type<std::uint8_t>("u1", {1, 2, 127, 255, 5, 6});
    check_type<std::int16_t>("i2", {1, -2, 300, -32768, 5, 6});
    check_type<std::uint16_t>("u2", {1, 2, 300, 65535, 5, 6});
    check_type<std::int32_t>("i4", {1, -2, 70000, -2147483647, 5, 6});
    check_type<std::uint32_t>("u4", {1, 2, 70000, 4294967295, 5, 6});
    check_type<std::int64_t>("i8", {1, -2, 1ll << 40, -(1ll << 50), 5, 6});
    check_type<std::uint64_t>("u8", {1, 2, 1ull << 63, 4, 5, 6});
}

TEST(HeightMapNpy, HalfPrecision) {
    const TemporaryFolder folder;
    const std::vector<std::uint16_t> bits = {0x3c00, 0xc000, 0x7bff, 0x0001, 0x8400,
                                             0x3555, 0x7c00, 0x7e00, 0x0000};
    const std::vector<double> expected = {
        1, -2, 65504, std::exp2(-24), -std::exp2(-14), 0.333251953125, kMissing, kMissing, 0};
    for (const bool big_endian : {false, true}) {
        expect_heights(load_height_map(folder.write(
                           "a.npy", npy(npy_header(big_endian ? ">f2" : "<f2", "(3,3)"),
                                        bytes_of(bits, big_endian)))),
                       expected);
    }
}

TEST(HeightMapNpy, SpellingsOfTheHeader) {
    const TemporaryFolder folder;
    const std::string data("\1\2\3\4\5\6", 6);
    for (const char* const text :
         {"{\"shape\":(2,3),\"descr\":\"|u1\",\"fortran_order\":False}",
          "{'fortran_order' : False , 'shape' : (2L, 3L,) , 'descr' : '=u1'}",
          "  {'descr': '<u1', 'fortran_order': False, 'shape': (2, 3)  ,  } \n"}) {
        expect_heights(load_height_map(folder.write("a.npy", npy(text, data))), {1, 2, 3, 4, 5, 6});
    }
}

TEST(HeightMapNpy, NotANumberIsNoData) {
    const TemporaryFolder folder;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    const std::string data = bytes_of<float>({1, nan, infinite, -infinite, 5, -9999.1f}, false);
    const std::string path = folder.write("a.npy", npy(npy_header("<f4"), data));
    expect_heights(load_height_map(path), {1, kMissing, kMissing, kMissing, 5, -9999.1f});
    HeightMapOptions options;
    options.no_data = -9999.1;  // no float equals it
    expect_heights(load_height_map(path, options), {1, kMissing, kMissing, kMissing, 5, kMissing});
}

TEST(HeightMapNpy, WhatIsRefused) {
    const TemporaryFolder folder;
    const std::string data(12, '\1');
    const auto load = [&](const std::string& bytes) {
        return load_height_map(folder.write("a.npy", bytes));
    };
    const auto with = [&](const std::string& text) { return load(npy(text, data)); };
    ASSERT_TRUE(with(npy_header("<u2")).ok());
    expect_error(with(npy_header("<c8")), "of type '<c8'");
    expect_error(with(npy_header("|b1")), "of type '|b1'");
    expect_error(with(npy_header("<U2")), "of type '<U2'");
    expect_error(with(npy_header("<f1")), "of type '<f1'");
    expect_error(with(npy_header("|u2")), "of type '|u2'");
    expect_error(with(npy_header("u2")), "of type 'u2'");
    expect_error(with(npy_header("")), "of type ''");
    expect_error(with("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (3,), }"),
                 "structures");
    expect_error(with(npy_header("<u2", "(6,)")), "1 dimensions");
    expect_error(with(npy_header("<u2", "()")), "0 dimensions");
    expect_error(with(npy_header("<u2", "(1, 2, 3)")), "3 dimensions");
    expect_error(with(npy_header("<u2", "(2, 4)")), "12 bytes of data, but 2 x 4 values take 16");
    expect_error(with(npy_header("<u2", "(2, 2)")), "12 bytes of data");
    expect_error(with(npy_header("<u2", "(4294967296, 4294967296)")), "at most");
    expect_error(with(npy_header("<u2", "(0, 4294967296)")), "12 bytes of data");
    for (const char* const text :
         {"", "{}", "{", "}", "nonsense", "{'descr': '<u2', 'shape': (2, 3)}",
          "{'descr': '<u2', 'fortran_order': 0, 'shape': (2, 3)}",
          "{'descr': '<u2', 'fortran_order': False, 'shape': (2, 3)} x",
          "{'descr': '<u2', 'fortran_order': False, 'shape': (2, -3)}",
          "{'descr': '<u2', 'fortran_order': False, 'shape': (99999999999999999999, 3)}",
          "{'descr': '<u2', 'fortran_order': False, 'shape': (2, 3), 'more': 1}",
          "{'descr': '<u2', 'descr': '<u2', 'fortran_order': False, 'shape': (2, 3)}",
          "{'descr': '<u2 'fortran_order': False, 'shape': (2, 3)}"}) {
        expect_error(with(text), "its header makes no sense");
    }
    const std::string good = npy(npy_header("<u2"), data);
    for (std::size_t size = 1; size < good.size(); ++size) {
        expect_error(load(good.substr(0, size)), "again");
    }
    expect_error(load(good + '\0'), "13 bytes of data");
    std::string other = good;
    other[6] = 4;
    expect_error(load(other), "version 4");
    other = npy(npy_header("<u2"), data, 2);
    other[11] = '\x7f';
    expect_error(load(other), "1 MiB");
}

TEST(HeightMapNpy, DamagedFiles) {
    check_damaged("a.npy", npy(npy_header("<f4"), std::string(24, '\x3f')), 1'000);
    check_damaged("b.npy", npy(npy_header(">i2"), std::string(12, '\1'), 2), 1'000);
}

}  // namespace
}  // namespace sightline
