// Names of projections and views, as on the command line.
#include <algorithm>
#include <array>
#include <utility>

#include "sightline/camera.hpp"

namespace sightline {

namespace {

constexpr std::array<std::pair<Projection, std::string_view>, 4> kProjections{{
    {Projection::perspective, "perspective"},
    {Projection::orthographic, "orthographic"},
    {Projection::cavalier, "cavalier"},
    {Projection::cabinet, "cabinet"},
}};

constexpr std::array<std::pair<NamedView, std::string_view>, 9> kViews{{
    {NamedView::front, "front"},
    {NamedView::back, "back"},
    {NamedView::left, "left"},
    {NamedView::right, "right"},
    {NamedView::top, "top"},
    {NamedView::bottom, "bottom"},
    {NamedView::isometric, "isometric"},
    {NamedView::dimetric, "dimetric"},
    {NamedView::trimetric, "trimetric"},
}};

template <class Table>
auto find_by_name(const Table& table, std::string_view name)
    -> std::optional<decltype(table.front().first)> {
    const auto row = std::find_if(table.begin(), table.end(),
                                  [&](const auto& entry) { return entry.second == name; });
    if (row == table.end()) return std::nullopt;
    return row->first;
}

template <class Table, class Key>
std::string_view name_in(const Table& table, Key key) {
    const auto row = std::find_if(table.begin(), table.end(),
                                  [&](const auto& entry) { return entry.first == key; });
    return row == table.end() ? std::string_view{} : row->second;
}

}  // namespace

std::optional<Projection> parse_projection(std::string_view name) {
    return find_by_name(kProjections, name);
}
std::string_view name_of(Projection projection) { return name_in(kProjections, projection); }
std::optional<NamedView> parse_view(std::string_view name) { return find_by_name(kViews, name); }
std::string_view name_of(NamedView view) { return name_in(kViews, view); }

}  // namespace sightline
