/// \file
/// Parameter tables and their checks: the text a user reads, for every law.

#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

/// The message and key of the InputError that f throws.
template <class F>
std::pair<std::string, std::string> refusal(F&& f) {
  try {
    f();
  } catch (const InputError& error) {
    return {error.key(), error.what()};
  }
  return {"", "(accepted)"};
}

std::pair<std::string, std::string> refusal_of(const LawSpec& spec) {
  return refusal([&] { make_material(spec); });
}

/// A number as the messages print it.
std::string text_of(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", x);
  return buffer;
}

class LawParameters : public ::testing::TestWithParam<std::size_t> {
 protected:
  const LawInfo& law() const { return all_laws()[GetParam()]; }
  std::vector<LawExample> examples() const { return examples_of(law()); }
  static std::string unit(const ParamInfo& info) {
    return info.unit == "-" ? "" : std::string(" ").append(info.unit);
  }
};
INSTANTIATE_TEST_SUITE_P(All, LawParameters,
                         ::testing::Range(std::size_t{0}, std::tuple_size_v<AllLaws>),
                         [](const auto& param) {
                           const LawInfo& law = all_laws()[param.param];
                           std::string name = std::string(law.name) + "_" + std::string(law.option);
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

TEST_P(LawParameters, TableIsComplete) {
  EXPECT_FALSE(law().doc.empty());
  for (const ParamInfo& info : law().parameters) {
    EXPECT_FALSE(info.name.empty() || info.symbol.empty() || info.unit.empty() || info.doc.empty())
        << info.name;
    if (info.need == Need::defaulted) {
      EXPECT_TRUE(info.range.contains(info.value)) << info.name << ": default out of range";
    }
    EXPECT_EQ(std::count_if(law().parameters.begin(), law().parameters.end(),
                            [&](const ParamInfo& other) { return other.name == info.name; }),
              1)
        << info.name;
  }
  for (const StateField& field : law().state)
    EXPECT_FALSE(field.name.empty() || field.symbol.empty() || field.unit.empty() ||
                 field.doc.empty());
}

TEST_P(LawParameters, ExamplesAreAccepted) {
  for (const LawExample& example : examples()) {
    const auto material = make_material(example.spec);
    EXPECT_EQ(material->law().name, law().name);
    EXPECT_EQ(material->law().option, law().option);
    EXPECT_EQ(material->theta().size(), law().parameters.size());
    for (const auto& [name, x] : example.spec.values) EXPECT_EQ(material->parameter(name), x);
    EXPECT_EQ(refusal([&] { (void)material->parameter("nonsense"); }).second,
              std::string(law().name) + " has no parameter 'nonsense'");
  }
}

TEST_P(LawParameters, UnknownNameIsAnsweredWithTheNearest) {
  for (const ParamInfo& info : law().parameters) {
    LawSpec spec = examples()[0].spec;
    const std::string misspelt = std::string(info.name) + "x";
    spec.values[misspelt] = 1.0;
    const auto [key, text] = refusal_of(spec);
    EXPECT_EQ(key, misspelt);
    EXPECT_EQ(text, std::string(law().name) + " has no parameter '" + misspelt +
                        "'; did you mean '" + std::string(info.name) + "'?");
  }
  LawSpec spec = examples()[0].spec;
  spec.values["temperature"] = 1.0;
  std::string known;
  for (const ParamInfo& info : law().parameters)
    known += (known.empty() ? " " : ", ") + std::string(info.name);
  EXPECT_EQ(refusal_of(spec).second,
            std::string(law().name) + " has no parameter 'temperature'; it has:" + known);
}

TEST_P(LawParameters, MissingValueSaysWhatIsNeeded) {
  for (const ParamInfo& info : law().parameters) {
    LawSpec spec = examples()[0].spec;
    spec.values.erase(std::string(info.name));
    const auto [key, text] = refusal_of(spec);
    if (info.need == Need::required) {
      EXPECT_EQ(key, info.name);
      EXPECT_EQ(text, std::string(law().name) + " needs " + std::string(info.name) + " (" +
                          std::string(info.doc) + "), a number " + to_string(info.range) +
                          unit(info) +
                          (info.angle.name.empty() ? ""
                                                   : ", or " + std::string(info.angle.name) +
                                                         ", its friction angle in degrees"));
    } else {
      EXPECT_EQ(text, "(accepted)") << info.name;
    }
  }
}

TEST_P(LawParameters, OutOfRangeSaysTheRangeAndUnit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const ParamInfo& info : law().parameters) {
    std::vector<double> bad{nan, infinity, -infinity};
    if (std::isfinite(info.range.lower)) {
      bad.push_back(info.range.lower_open ? info.range.lower : info.range.lower - 0.25);
      bad.push_back(info.range.lower - 1e6);
    }
    if (std::isfinite(info.range.upper)) {
      bad.push_back(info.range.upper_open ? info.range.upper : info.range.upper + 0.25);
      bad.push_back(info.range.upper + 1e6);
    }
    for (const double x : bad) {
      LawSpec spec = examples()[0].spec;
      spec.values[std::string(info.name)] = x;
      const auto [key, text] = refusal_of(spec);
      EXPECT_EQ(key, info.name);
      EXPECT_EQ(text, std::string(info.name) + " = " + text_of(x) + unit(info) +
                          " is out of range: " + std::string(info.doc) + " must be " +
                          to_string(info.range) + unit(info));
    }
  }
}

/// "7 [1, 20]": the default, if there is one, and the range.
std::string default_and_range(const LawInfo& law, std::string_view name) {
  for (const ParamInfo& info : law.parameters)
    if (info.name == name)
      return (info.need == Need::defaulted  ? text_of(info.value) + " "
              : info.need == Need::optional ? "optional "
                                            : "") +
             to_string(info.range);
  return "absent";
}

// Written down a second time: a table alone cannot tell that one of its numbers has changed, and
// finished results depend on every default.
TEST(LawDefaults, AndRangesAreThose) {
  const std::map<std::string, std::map<std::string, std::string>> expected{
      {"modified_cam_clay",
       {{"M", "(0, 3)"},
        {"lambda", "> 0"},
        {"kappa", "> 0"},
        {"nu", "[0, 0.5)"},
        {"Gamma", "optional > 1"},
        {"N", "optional > 1"},
        {"p_ref", "1000 > 0"},
        {"rho_p", "2650 > 0"},
        {"p_sep", "0.01 > 0"},
        {"p_shift", "0 >= 0"},
        {"shape", "0 [0, 1]"}}},
      {"mu_i",
       {{"mu_0", "> 0"},
        {"mu_d", "> 0"},
        {"I_0", "> 0"},
        {"d", "> 0"},
        {"rho_p", "> 0"},
        {"rho_0", "> 0"},
        {"K", "> 0"},
        {"G", "optional > 0"},
        {"r", "0.0001 > 0"},
        {"alpha", "1.9 > 0"},
        {"mu_inf", "0.05 >= 0"},
        {"I_1", "optional > 0"},
        {"shape", "0 [0, 1]"}}},
      {"newtonian", {{"eta", ">= 0"}, {"K", "> 0"}, {"alpha", "7 [1, 20]"}, {"rho_0", "> 0"}}},
      {"neo_hookean", {{"E", "> 0"}, {"nu", "[0, 0.5)"}, {"rho_0", "> 0"}}},
      {"critical_state_mu_i",
       {{"M", "(0, 3)"},
        {"lambda", "> 0"},
        {"kappa", "> 0"},
        {"nu", "[0, 0.5)"},
        {"Gamma", "optional > 1"},
        {"N", "optional > 1"},
        {"p_ref", "1000 > 0"},
        {"rho_p", "2650 > 0"},
        {"p_sep", "0.01 > 0"},
        {"M_inf", "> 0"},
        {"I_M", "> 0"},
        {"I_v", "optional > 0"},
        {"d", "> 0"},
        {"shape", "0 [0, 1]"}}}};
  for (const LawInfo& law : all_laws())
    for (const ParamInfo& info : law.parameters) {
      const auto& of_law = expected.at(std::string(law.name));
      const auto found = of_law.find(std::string(info.name));
      ASSERT_NE(found, of_law.end()) << law.name << ": " << info.name;
      EXPECT_EQ(default_and_range(law, info.name), found->second)
          << law.name << " " << law.option << ": " << info.name;
    }
}

TEST(Range, ToText) {
  EXPECT_EQ(to_string(positive), "> 0");
  EXPECT_EQ(to_string(not_negative), ">= 0");
  EXPECT_EQ(to_string(Range{}), "any number");
  EXPECT_EQ(to_string(Range{0.0, 0.5, false, true}), "[0, 0.5)");
  EXPECT_EQ(to_string(Range{-1.0, 2.0, true, false}), "(-1, 2]");
  EXPECT_EQ(to_string(Range{-std::numeric_limits<double>::infinity(), 3.0, true, true}), "< 3");
  EXPECT_EQ(to_string(Range{-std::numeric_limits<double>::infinity(), 3.0, true, false}), "<= 3");
}

TEST(NearestName, ForgivesAThirdOfTheLettersAndTheirCase) {
  const std::vector<std::string_view> known{"lambda", "kappa", "nu", "M"};
  EXPECT_EQ(nearest_name("lamda", known), "lambda");
  EXPECT_EQ(nearest_name("LAMBDA", known), "lambda");
  EXPECT_EQ(nearest_name("kapa", known), "kappa");
  EXPECT_EQ(nearest_name("m", known), "M");
  EXPECT_EQ(nearest_name("temperature", known), "");
  EXPECT_EQ(nearest_name("", known), "M");  // one letter is missing
  EXPECT_EQ(nearest_name("x", {}), "");
}

LawSpec cam_clay(const std::string& compression, const std::map<std::string, double>& changes) {
  LawSpec spec{"modified_cam_clay",
               {{"compression", compression}},
               {{"M", 0.888}, {"lambda", 0.161}, {"kappa", 0.062}, {"nu", 0.3}}};
  for (const auto& [name, x] : changes) spec.values[name] = x;
  return spec;
}

TEST(CamClayParameters, KappaBelowLambda) {
  for (const double kappa : {0.161, 0.2}) {
    const auto [key, text] = refusal_of(cam_clay("v-ln_p", {{"kappa", kappa}}));
    EXPECT_EQ(key, "kappa");
    EXPECT_EQ(text, "kappa must be < lambda: swelling is stiffer than compression");
  }
  EXPECT_EQ(refusal_of(cam_clay("ln_v-ln_p", {{"lambda", 1.5}, {"kappa", 1.0}})).second,
            "kappa must be < 1 for ln_v-ln_p: beyond it, unloading to p = 0 would release infinite "
            "energy");
  EXPECT_EQ(refusal_of(cam_clay("v-ln_p", {{"lambda", 1.5}, {"kappa", 1.0}})).second, "(accepted)");
}

TEST(CamClayParameters, GammaAndNFollowFromEachOther) {
  const double distance = (0.161 - 0.062) * std::log(2.0);
  const auto value = [](const LawSpec& spec, const char* name) {
    return make_material(spec)->parameter(name);
  };
  // physics.md MCC-5; a rounding or two
  EXPECT_NEAR(value(cam_clay("v-ln_p", {{"Gamma", 2.759}}), "N"), 2.759 + distance, 1e-15 * 3.0);
  EXPECT_NEAR(value(cam_clay("v-ln_p", {{"N", 2.8}}), "Gamma"), 2.8 - distance, 1e-15 * 3.0);
  EXPECT_NEAR(value(cam_clay("ln_v-ln_p", {{"Gamma", 2.759}}), "N"),
              2.759 * std::pow(2.0, 0.161 - 0.062), 1e-15 * 3.0);
  EXPECT_NEAR(value(cam_clay("ln_v-ln_p", {{"N", 2.8}}), "Gamma"),
              2.8 / std::pow(2.0, 0.161 - 0.062), 1e-15 * 3.0);
  EXPECT_TRUE(std::isnan(value(cam_clay("v-ln_p", {}), "N")));
  EXPECT_EQ(value(cam_clay("v-ln_p", {{"Gamma", 2.759}, {"N", 2.759 + distance}}), "Gamma"), 2.759);
  const auto [key, text] = refusal_of(cam_clay("v-ln_p", {{"Gamma", 2.759}, {"N", 2.759}}));
  EXPECT_EQ(key, "N");
  EXPECT_EQ(text,
            "give Gamma or N, not both: one follows from the other (N - Gamma is fixed by lambda - "
            "kappa)");
}

TEST(MuIParameters, FrictionDoesNotFallWithTheInertialNumber) {
  for (const char* form : {"elastoviscoplastic", "regularised", "barker_gray"}) {
    LawSpec spec{"mu_i", {{"form", form}}, {}};
    spec.values = {{"mu_0", 0.4},     {"mu_d", 0.3},     {"I_0", 0.3}, {"d", 1e-3},
                   {"rho_p", 2500.0}, {"rho_0", 1500.0}, {"K", 1e5}};
    const auto [key, text] = refusal_of(spec);
    EXPECT_EQ(key, "mu_d");
    EXPECT_EQ(text, "mu_d must be >= mu_0: friction grows with the inertial number");
    spec.values["mu_d"] = 0.6;
    EXPECT_EQ(refusal_of(spec).second, "(accepted)");
  }
}

TEST(LawOptions, UnknownMissingAndForeign) {
  const std::map<std::string, double> column{{"mu_0", 0.3819}, {"mu_d", 0.5718},  {"I_0", 0.279},
                                             {"d", 0.0053},    {"rho_p", 2000.0}, {"rho_0", 1300.0},
                                             {"K", 254800.0}};
  EXPECT_EQ(refusal_of({"mu_I", {}, column}),
            (std::pair<std::string, std::string>{
                "name",
                "unknown law \"mu_I\"; did you mean \"mu_i\"? (known: \"modified_cam_clay\", "
                "\"mu_i\", \"newtonian\", \"neo_hookean\", \"critical_state_mu_i\")"}));
  EXPECT_EQ(refusal_of({"mu_i", {{"compression", "v-ln_p"}}, column}),
            (std::pair<std::string, std::string>{
                "compression", "mu_i has no option 'compression'; its option is 'form'"}));
  EXPECT_EQ(refusal_of({"mu_i", {{"form", "regularized"}}, column}),
            (std::pair<std::string, std::string>{
                "form",
                "form = \"regularized\" is not one of \"elastoviscoplastic\", \"regularised\", "
                "\"barker_gray\"; did you mean \"regularised\"?"}));
  EXPECT_EQ(refusal_of({"modified_cam_clay", {}, {}}),
            (std::pair<std::string, std::string>{
                "compression",
                "modified_cam_clay needs compression, one of \"ln_v-ln_p\", \"v-ln_p\": the same "
                "numbers mean different laws"}));
  // the default forms
  EXPECT_EQ(make_material({"mu_i", {}, column})->law().option, "elastoviscoplastic");
  EXPECT_EQ(default_form("newtonian")->option, "true");
  EXPECT_EQ(default_form("modified_cam_clay"), nullptr);
  EXPECT_EQ(default_form("water"), nullptr);
  // a parameter of the other form
  std::map<std::string, double> with_r = column;
  with_r["r"] = 1e-4;
  EXPECT_EQ(refusal_of({"mu_i", {}, with_r}),
            (std::pair<std::string, std::string>{
                "r",
                "r belongs to form = \"regularised\" of mu_i, and this is "
                "\"elastoviscoplastic\""}));
  EXPECT_EQ(make_material({"mu_i", {}, column})->parameter("G"), 4.0 * 254800.0);
}

}  // namespace
}  // namespace repose
