/// \file
/// What the UMAT cannot accept is said in the host's message file and stops the analysis by XIT;
/// here both are the test's.

#include "tests/umat/out/call_umat.hpp"

namespace {
std::string message;
int level = 0;
int stops = 0;
}  // namespace

extern "C" {
void stdb_abqerr_(const int* lop, const char* text, const int*, const double*, const char*,
                  std::size_t length, std::size_t) {
  level = *lop;
  message.assign(text, length);
}
void xit_() { ++stops; }
}

namespace repose::umat {
namespace {

const std::vector<double> kaolin{0.888, 0.161, 0.062, 0.3, 2.759};

Host clay(std::string name = "MODIFIED_CAM_CLAY-V-LN_P", std::vector<double> props = kaolin,
          std::size_t states = 3) {
  Host host(std::move(name), std::move(props), states);
  for (std::size_t i = 0; i < 3; ++i) host.stress[i] = -1e5;
  return host;
}

/// The message about a host that is refused; nothing of it may have changed.
std::string refusal(Host host) {
  const Host before = host;
  message.clear();
  level = 0;
  const int stops_before = stops;
  EXPECT_FALSE(host.step(std::vector<double>(host.components(), 0.0), 1.0));
  EXPECT_EQ(stops, stops_before + 1) << host.name;
  EXPECT_EQ(level, -3);
  EXPECT_TRUE(same_bits(host, before)) << host.name;
  EXPECT_NE(message.find("element 12, integration point 5"), std::string::npos) << message;
  EXPECT_LE(message.size(), 500U);
  EXPECT_EQ(message.find('%'), std::string::npos) << message;
  return message;
}

#define EXPECT_SAYS(host, ...)                                                        \
  do {                                                                                \
    const std::string said = refusal(host);                                           \
    for (const char* const part : {__VA_ARGS__})                                      \
      EXPECT_NE(said.find(part), std::string::npos) << said << "\n  lacks: " << part; \
  } while (false)

TEST(UmatRefusals, AGoodOneIsNone) {
  Host host = clay();
  const int before = stops;
  EXPECT_TRUE(host.step(std::vector<double>(6, 0.0), 1.0));
  EXPECT_EQ(stops, before);
}

TEST(UmatRefusals, NamesTheNearestMaterial) {
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY-V-LNP__KAOLIN"), "MODIFIED_CAM_CLAY-V-LNP__KAOLIN",
              "did you mean MODIFIED_CAM_CLAY-V-LN_P?");
  EXPECT_SAYS(clay("MU_I-REGULARIZED"), "did you mean MU_I-REGULARISED?");
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY"), "must say its form", "MODIFIED_CAM_CLAY-LN_V-LN_P");
  EXPECT_SAYS(clay(""), "no law is called \"\"");
}

TEST(UmatRefusals, NamesTheConstant) {
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY-V-LN_P", {0.888, 0.161, 0.062, 0.5, 2.759}), "PROPS(4), nu",
              "[0, 0.5)");
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY-V-LN_P", {0.888, 0.161, 0.2, 0.3, 2.759}), "PROPS(3), kappa",
              "kappa must be < lambda");
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY-V-LN_P", {0.888, 0.161, 0.062}), "PROPS(4), nu", "needs nu");
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY-V-LN_P", {}), "PROPS(1), M", "needs M");
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY-V-LN_P",
                   {std::numeric_limits<double>::quiet_NaN(), 0.161, 0.062, 0.3, 2.759}),
              "PROPS(1), M", "out of range");
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY-V-LN_P", std::vector<double>(14, 1.0)),
              "at most 13 constants", "11 parameters, ocr and v", "has 14");
  EXPECT_SAYS(clay("NEO_HOOKEAN", {1e7, 0.3, 1000.0, 1.0}), "at most 3 constants", "has 4");
}

TEST(UmatRefusals, NamesTheState) {
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY-V-LN_P", kaolin, 2), "*DEPVAR", "at least 3",
              "density, p_c, rho_sep");
  Host half = clay();
  half.statev[1] = 1e5;
  EXPECT_SAYS(half, "STATEV(1), the density, is 0");
  half.statev[0] = -1.0;
  EXPECT_SAYS(half, "must be > 0");
  half.statev[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_SAYS(half, "must be > 0");
}

TEST(UmatRefusals, NamesTheStart) {
  Host bare = clay();
  std::fill(bare.stress.begin(), bare.stress.end(), 0.0);
  EXPECT_SAYS(bare, "STRESS at the first call", "p must be > p_sep");
  std::vector<double> props = kaolin;
  props.resize(11, 0.0);
  props.push_back(0.5);
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY-V-LN_P", props), "PROPS(12), ocr", "must be >= 1");
  props.back() = 2.0;
  props.push_back(3.0);  // far from the line
  EXPECT_SAYS(clay("MODIFIED_CAM_CLAY-V-LN_P", props), "PROPS(13), v", "contradicts itself");
}

TEST(UmatRefusals, NamesTheElement) {
  Host plane_stress = clay();
  plane_stress.nshr = 2;
  plane_stress.stress.resize(5);
  plane_stress.ddsdde.resize(25);
  EXPECT_SAYS(plane_stress, "NDI = 3", "NSHR = 2");
}

}  // namespace
}  // namespace repose::umat
