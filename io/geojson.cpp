#include "io/geojson.hpp"

#include <cmath>

#include <fmt/format.h>

#include "io/json.hpp"
#include "io/table_error.hpp"

namespace repose::io {
namespace {

class Reader {
 public:
  explicit Reader(const std::string& name) : name_(name) {}

  std::vector<Region> regions;

  void take(const Json& object, std::optional<double> depth) {
    const Json* const given = object.is_object() ? object.find("type") : nullptr;
    const std::string type =
        given != nullptr && given->is_string() ? given->get<std::string>() : "";
    if (type == "FeatureCollection") {
      for (const Json& feature : list_of(object, "features")) take(feature, depth);
    } else if (type == "Feature") {
      const Json* const properties = object.find("properties");
      if (properties != nullptr && properties->is_object() && properties->contains("depth"))
        depth = depth_of(properties->at("depth"));
      const Json* const geometry = object.find("geometry");
      if (geometry != nullptr && !geometry->is_null()) take(*geometry, depth);
    } else if (type == "GeometryCollection") {
      for (const Json& geometry : list_of(object, "geometries")) take(geometry, depth);
    } else if (type == "Polygon") {
      polygon(list_of(object, "coordinates"), depth);
    } else if (type == "MultiPolygon") {
      for (const Json& rings : list_of(object, "coordinates")) polygon(rings, depth);
    } else if (type.empty()) {
      fail("this is no GeoJSON: an object with a \"type\" is missing");
    }  // points and lines are no regions
  }

 private:
  [[noreturn]] void fail(const std::string& cause) const {
    throw TableError(name_, 0, "", cause, "");
  }

  double depth_of(const Json& value) const {
    if (!value.is_number() || !(value.get<double>() > 0.0))
      fail(fmt::format("the property \"depth\" is {}, and must be a number > 0 [m]", value.dump()));
    return value.get<double>();
  }

  const Json& list_of(const Json& object, const char* key) const {
    const Json* const list = object.find(key);
    if (list == nullptr || !list->is_array()) fail(fmt::format("a list of \"{}\" is missing", key));
    return *list;
  }

  Ring ring_of(const Json& list) const {
    Ring ring;
    if (!list.is_array()) fail("a ring of a polygon is no list of places");
    for (const Json& place : list) {
      if (!place.is_array() || place.size() < 2 || !place[0].is_number() || !place[1].is_number())
        fail("a place of a polygon is not [x, y]");
      ring.push_back({place[0].get<double>(), place[1].get<double>()});
      if (!std::isfinite(ring.back()[0]) || !std::isfinite(ring.back()[1]))
        fail("a place of a polygon is not finite");
    }
    if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    if (ring.size() < 3) fail("a ring of a polygon has less than three places");
    return ring;
  }

  void polygon(const Json& rings, std::optional<double> depth) {
    if (!rings.is_array() || rings.empty()) fail("a polygon has no rings");
    Region region;
    region.depth = depth;
    region.outer = ring_of(rings[0]);
    for (std::size_t k = 1; k < rings.size(); ++k) region.holes.push_back(ring_of(rings[k]));
    regions.push_back(std::move(region));
  }

  const std::string& name_;
};

Json ring_json(const Ring& ring) {
  Json::Array places;
  for (std::size_t k = 0; k <= ring.size(); ++k) {
    const auto& [x, y] = ring[k % ring.size()];
    places.push_back(Json(std::array<double, 2>{x, y}));
  }
  return places;
}

}  // namespace

std::vector<Region> parse_geojson(std::string_view text, const std::string& name) {
  const std::optional<Json> document = Json::try_parse(text);
  if (!document) throw TableError(name, 0, "", "this is no JSON", "");
  Reader reader(name);
  reader.take(*document, {});
  if (reader.regions.empty()) throw TableError(name, 0, "", "there is no polygon in it", "");
  return std::move(reader.regions);
}

std::string geojson_text(const std::vector<NamedRegions>& features, const std::string& crs) {
  Json::Array list;
  for (const NamedRegions& feature : features) {
    Json::Array polygons;
    for (const Region& region : feature.regions) {
      Json::Array rings{ring_json(region.outer)};
      for (const Ring& hole : region.holes) rings.push_back(ring_json(hole));
      polygons.push_back(Json(rings));
    }
    list.push_back(Json{{"type", "Feature"},
                        {"properties", Json{{"name", feature.name}}},
                        {"geometry", Json{{"type", "MultiPolygon"}, {"coordinates", polygons}}}});
  }
  Json document{{"type", "FeatureCollection"}};
  if (!crs.empty()) document["crs"] = Json{{"type", "name"}, {"properties", Json{{"name", crs}}}};
  document["features"] = Json(list);
  return document.dump() + "\n";
}

}  // namespace repose::io
