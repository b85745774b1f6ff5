// io/json.hpp: what is written is read back, in order, and mistakes are said.

#include "io/json.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace repose::io {
namespace {

TEST(Json, IsWrittenAsItIsSpelt) {
  const Json json{{"b", 1},
                  {"a", {1.5, -2, "x", nullptr, true}},
                  {"pairs", {{"of", "texts"}}},
                  {"nothing", Json::array()},
                  {"empty", Json::object()}};
  EXPECT_EQ(json.dump(), R"({"b":1,"a":[1.5,-2,"x",null,true],"pairs":{"of":"texts"},)"
                         R"("nothing":[],"empty":{}})");
  EXPECT_EQ(Json({1, 2}).dump(), "[1,2]");
  EXPECT_EQ((Json{{"one", std::vector<int>{1}}}).dump(1), "{\n \"one\": [\n  1\n ]\n}");
}

TEST(Json, ReadsBackWhatItWrote) {
  Json json;
  json["third"] = 1.0 / 3.0;
  json["least"] = std::numeric_limits<std::int64_t>::min();
  json["most"] = std::numeric_limits<std::uint64_t>::max();
  json["text"] = "\"quoted\"\n\u00e9";
  json["list"].push_back(std::map<std::string, double>{{"k", 0.1}});
  json["flag"] = false;
  const Json read = Json::parse(json.dump());
  EXPECT_EQ(read, json);
  EXPECT_EQ(read.items().front().key, "third");
  EXPECT_EQ(read["third"].get<double>(), 1.0 / 3.0);
  EXPECT_EQ(read["most"].get<std::uint64_t>(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_NE(Json(std::numeric_limits<std::uint64_t>::max()), Json(-1)) << "the same bits";
}

TEST(Json, WhatIsNotFiniteIsNullAndForeignBytesAreReplaced) {
  EXPECT_EQ(Json({std::nan(""), HUGE_VAL, 1.0}).dump(), "[null,null,1.0]");
  EXPECT_EQ(Json("\xff!").dump(), "\"\ufffd!\"");
}

TEST(Json, MembersAreChangedFoundAndTakenAway) {
  Json json{{"a", 1}, {"b", 2}};
  json.update({{"c", 3}, {"a", 4}});
  json.erase("b");
  EXPECT_EQ(json.dump(), R"({"a":4,"c":3})");
  EXPECT_EQ(json.value("a", 0), 4);
  EXPECT_EQ(json.value("b", 7), 7);
  EXPECT_EQ(json.value("b", "none"), "none");
  EXPECT_EQ(json.find("b"), nullptr);
  EXPECT_EQ(Json().find("a"), nullptr);
  EXPECT_EQ(Json({1, 2, 3}).get<std::vector<double>>(), (std::vector{1.0, 2.0, 3.0}));
}

TEST(Json, ALoopOverAPartOfATemporaryHoldsIt) {
  const auto read = [] { return Json{{"list", {"a text too long for its own small buffer"}}}; };
  for (const Json& text : read()["list"])
    EXPECT_EQ(text.get<std::string>(), "a text too long for its own small buffer");
  for (const Json& text : read().at("list")) EXPECT_TRUE(text.is_string());
}

template <class F>
std::string complaint(F&& f) {
  try {
    f();
  } catch (const Json::Error& error) {
    return error.what();
  }
  return "none";
}

TEST(Json, SaysWhatIsWrong) {
  const Json json{{"a", "text"}, {"list", {1, 2}}};
  EXPECT_EQ(complaint([&] { json.at("b"); }), "\"b\" is missing");
  EXPECT_EQ(complaint([&] { json["a"].get<double>(); }), "this is a text, not a number");
  EXPECT_EQ(complaint([&] { json["list"].at(2); }), "element 2 of a list of 2");
  EXPECT_EQ(complaint([&] { json["list"].items(); }), "this is a list, not an object");
  EXPECT_EQ(complaint([&] { Json(1.0).at("a"); }), "this is a number, not an object with \"a\"");
  EXPECT_EQ(complaint([] { Json::parse("{\"a\": }"); }), "line 1, column 7 is no JSON");
  EXPECT_EQ(complaint([] { Json::parse("{\n \"a\": 1,\n}"); }), "line 3, column 1 is no JSON");
  EXPECT_EQ(complaint([] { Json::parse(""); }), "line 1, column 1 is no JSON");
  EXPECT_EQ(complaint([] { Json::parse("[1e999]"); }), "a number is beyond what a double holds");
  EXPECT_FALSE(Json::try_parse("[1,").has_value());
  EXPECT_EQ(complaint([] { Json(1e300).get<int>(); }),
            "this is a number, not an integer of 64 bits");
  const auto nested = [](std::size_t levels) {
    return std::string(levels, '[') + std::string(levels, ']');
  };
  EXPECT_TRUE(Json::try_parse(nested(500)).has_value());
  EXPECT_EQ(complaint([&] { Json::parse(nested(100'000)); }), "nested more than 500 levels deep");
  EXPECT_FALSE(Json::try_parse(nested(100'000)).has_value());
}

}  // namespace
}  // namespace repose::io
